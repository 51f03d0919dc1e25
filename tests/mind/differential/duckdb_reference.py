"""What a program means on the web platform: the package's own DuckDB dialect, on DuckDB."""

import contextlib
import copy
import functools
import json
import pickle
import re
from decimal import Decimal
from pathlib import Path
from typing import Any

import duckdb
from logica.common import concertina_lib
from logica.compiler import dialects, expr_translate, universe
from logica.parser_py import parse
from logica.type_inference.research import infer, reference_algebra, types_of_builtins

from logical_robots_tui.language import package_patches
from logical_robots_tui.language.source_text import original_text, prepare

__all__ = ["Reference", "answer", "answer_in_one"]

WEIGHTED_AVERAGE = "WeightedAverage(pair) = Sum(pair.arg * pair.value) / Sum(pair.arg);"
"""The one predicate of our prelude that the package's DuckDB library lacks."""


def answer(
    text: str, predicate: str, rows: list[Any], memories: dict[str, Any], folder: Path
) -> list[tuple[Any, ...]]:
    """Rows of a predicate as DuckDB computes them, in plain Python values.

    Sensor rows and memories are written as JSON to files in a folder, and read with their schema
    detected, as the platform does.
    """
    with contextlib.closing(Reference(text, predicate, folder)) as reference:
        return reference.answer(rows, memories)


class Reference:
    """One predicate of a program on DuckDB, for several moments; see `answer`."""

    def __init__(self, text: str, predicate: str, folder: Path) -> None:
        self._folder = folder
        types, *self._statements = _statements(text, predicate)
        self._connection = duckdb.connect()
        self._connection.execute("SET threads = 1")
        self._connection.execute(_types_in_order(types))

    def answer(self, rows: list[Any], memories: dict[str, Any]) -> list[tuple[Any, ...]]:
        _load(self._connection, rows, memories, self._folder)
        for statement in self._statements:
            found = self._connection.execute(statement)
        return [tuple(_plain(value) for value in row) for row in found.fetchall()]

    def close(self) -> None:
        self._connection.close()


def _statements(text: str, predicate: str) -> list[str]:
    """What the package would have DuckDB do: types first, and the final query last."""
    statements: list[str] = []

    def run(sql: str, _engine: str, is_final: bool) -> None:
        statements.append(sql)

    concertina_lib.ExecuteLogicaProgram(
        [copy.deepcopy(_compiled(text, predicate))], run, "duckdb", display_mode="silent"
    )
    return statements


def answer_in_one(
    text: str, predicate: str, rows: list[Any], memories: dict[str, Any], folder: Path
) -> list[tuple[Any, ...]]:
    """The same in one statement, which is how the platform evaluates a program."""
    sql = _program(f'@Engine("duckdb");\n{text}').FormattedPredicateSql(predicate)
    with duckdb.connect() as connection:
        connection.execute("SET threads = 1")
        _load(connection, rows, memories, folder)
        result = connection.execute(_types_in_order(sql)).fetchall()
    return [tuple(_plain(value) for value in row) for row in result]


def _load(
    connection: duckdb.DuckDBPyConnection, rows: list[Any], memories: dict[str, Any], folder: Path
) -> None:
    remembered = [{"robot_name": n, "memory": m} for n, m in memories.items()]
    for table, data in (("Sensor", rows), ("Memory", remembered)):
        file = folder / f"{table}.json"
        file.write_text(json.dumps(data), encoding="utf-8")
        connection.execute(
            f"CREATE OR REPLACE TABLE {table} AS SELECT * FROM read_json_auto('{file}')"
        )


@functools.lru_cache(maxsize=1)
def _compiled(text: str, predicate: str) -> Any:
    """What the package would have DuckDB do; the same program is asked in many moments."""
    program = _program(text)
    program.FormattedPredicateSql(predicate)
    return program.execution


def _program(text: str) -> Any:
    rules = _parsed(text)
    if "WeightedAverage" not in {r["head"]["predicate_name"] for r in rules}:
        rules += _Parser.ParseFile(WEIGHTED_AVERAGE)["rule"]
    return universe.LogicaProgram(rules, user_flags={"logica_default_engine": "duckdb"})


_MAKE_TYPE = re.compile(r"drop type if exists \w+ cascade; (create type (\w+) as [^;]*;)")


def _types_in_order(sql: str) -> str:
    """The statements with each type after those that it is made of.

    The package gives them in the order in which it met them, which DuckDB may refuse.
    """
    made = {name: statement for statement, name in _MAKE_TYPE.findall(sql)}
    ordered: dict[str, str] = {}

    def place(name: str) -> None:
        for part in re.findall(r"logicarecord\w+", made[name].split(" as ", 1)[1]):
            if part in made and part not in ordered:
                place(part)
        ordered[name] = made[name]

    for name in made:
        place(name)
    return "\n".join([*ordered.values(), _MAKE_TYPE.sub("", sql)])


def _parsed(text: str) -> list[Any]:
    rules = list(_parse(prepare(text).text)["rule"])
    waiting: list[Any] = list(rules)
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            if isinstance(written := node.get("the_string"), str):
                node["the_string"] = original_text(written)
            waiting += node.values()
        elif isinstance(node, list):
            waiting += node
    return rules


_parse = parse.ParseFile


@functools.cache
def _parsed_library(text: str) -> bytes:
    return pickle.dumps(_parse(text))


class _Parser:
    """The package's parser, which the package calls for its library again and again."""

    @staticmethod
    def ParseFile(text: str) -> Any:  # noqa: N802 - the package's name
        return pickle.loads(_parsed_library(text))


universe.parse = _Parser

_QL = expr_translate.QL
_name_of_type = infer.TypeCollector.PsqlType
_to_sql, _types = _QL.ConvertToSql, types_of_builtins.TypesOfBultins


def _types_with_try_cast() -> dict[str, Any]:
    """The package's types of functions, and `TryCast`, which gives what its second argument is."""
    wanted = reference_algebra.TypeReference("Any")
    given = reference_algebra.TypeReference("Any")
    return {**_types(), "TryCast": {0: given, 1: wanted, "logica_value": wanted}}


def _sql_with_casts(self: Any, expression: Any) -> Any:
    call = expression.get("call", {})
    if call.get("predicate_name") not in ("Cast", "TryCast"):
        return _to_sql(self, expression)
    value, wanted = (fv["value"]["expression"] for fv in call["record"]["field_value"])
    cast = "CAST" if call["predicate_name"] == "Cast" else "TRY_CAST"
    written = _written_type(wanted)
    if written is None and cast == "CAST":
        return _to_sql(self, expression)
    kind = written or _in_duckdb(wanted["type"]["the_type"])
    return f"{cast}({self.ConvertToSql(value)} AS {kind})"


_TYPES = {"Num": "DOUBLE", "Str": "VARCHAR", "Bool": "BOOLEAN"}


def _written_type(node: Any) -> str | None:
    """A type that is written out, ``{a: Num}``, in DuckDB's words."""
    if "record" in node:
        fields = {f["field"]: f["value"]["expression"] for f in node["record"]["field_value"]}
        kinds = {name: _written_type(of) for name, of in fields.items()}
        if None in kinds.values():
            return None
        written = ", ".join(f'"{name}" {kinds[name]}' for name in sorted(kinds))
        return f"STRUCT({written})"
    if "the_list" in node.get("literal", {}):
        (element,) = node["literal"]["the_list"]["element"] or ({},)
        return (kind := _written_type(element)) and f"{kind}[]"
    name = node.get("literal", {}).get("the_predicate", {}).get("predicate_name")
    return _TYPES.get(name)


def _in_duckdb(inferred: Any) -> str:
    """A type of the package's inference in DuckDB's words.

    Raises:
        KeyError: It is not fully known.
    """
    if isinstance(inferred, dict):
        fields = ", ".join(f'"{name}" {_in_duckdb(of)}' for name, of in sorted(inferred.items()))
        return f"STRUCT({fields})"
    if isinstance(inferred, list):
        return f"{_in_duckdb(inferred[0])}[]"
    return _TYPES[inferred]


class _Head(dialects.DuckDB):  # type: ignore[misc]  # the package has no types
    """DuckDB's dialect in the development head, in which `Log` is the natural logarithm."""

    def BuiltInFunctions(self) -> dict[str, Any]:  # noqa: N802 - the package's name
        return {**super().BuiltInFunctions(), "Log": "LN(%s)"}


def _number_as_double(self: Any, kind: Any) -> str:
    """Return DuckDB's name of a type: numbers in lists have digits, not three decimals.

    The development head makes them 32-bit ones, too few digits to compare.
    """
    return "double" if kind == "Num" else str(_name_of_type(self, kind))


package_patches.install()  # the same SQL in a third of the time, see test_package_patches.py

# The release that is installed here has no TryCast; the development head, which the platform uses,
# takes the type from the inference.
dialects.DIALECTS["duckdb"] = _Head
_QL.BUILT_IN_FUNCTIONS = {**_QL.BUILT_IN_FUNCTIONS, "TryCast": "TRY_CAST(%s)"}
_QL.ConvertToSql = _sql_with_casts
types_of_builtins.TypesOfBultins = _types_with_try_cast
infer.TypeCollector.PsqlType = _number_as_double


def _plain(value: Any) -> Any:
    if isinstance(value, Decimal):
        return int(value) if value == value.to_integral_value() else float(value)
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_plain(v) for v in value]
    return value
