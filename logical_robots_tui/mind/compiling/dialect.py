"""The SQL dialect for Logica: the package's SQLite dialect with DuckDB's semantics."""

from __future__ import annotations

import functools
import math
import re
import sqlite3
from typing import Any

from logica.compiler import dialects, expr_translate

from logical_robots_tui.language.adapter import tie_pair
from logical_robots_tui.language.definitions import arity, built_in_names
from logical_robots_tui.mind.sqlite.database import Database

_COLUMN = re.compile(r"\w+\.\w+")
_ALWAYS_JSON = (".sensor", ".value")

_FUNCTIONS = {
    # An expression that the optimizer can't move out of its subquery.
    "MagicalEntangle": "IIF({1} = 0, {0}, NULL)",
    "Set": "list_of_distinct({0})",
    "Join": "join_list({0}, {1})",
    "Sort": "sort_list({0})",
    "Agg++": "concat_lists(%s)",
    "Concat": "concat_some_lists(%s)",
    "ArrayConcat": "concat_some_lists(%s)",
    "ArrayConcatAgg": "concat_lists(%s)",
    "ArrayLength": "JSON_ARRAY_LENGTH(%s)",
    "ArrayToString": "join_list(%s)",
    "GenerateArray": "generate_array(%s)",
    "CharLength": "LENGTH(%s)",
    "Lpad": "pad_left(%s)",
    "RegexpExtract": "regexp_extract(%s)",
    "Repeat": "repeat_text(%s)",
    "Rpad": "pad_right(%s)",
    "Strpos": "instr(%s)",
    "Split": "split_text(%s)",
    "If": "IIF(%s)",
    # MIN, but also for records; it need not be the least of them.
    "1": "any_value(%s)",
    "AnyValue": "any_value(%s)",
    "SomeValue": "any_value(%s)",
    "Format": "formatted(%s)",
    "Log": "LN(%s)",
    "Element": "json_extract({0}, '$[' || CAST({1} AS INTEGER) || ']')",
    "ToInt64": "to_whole(%s)",
    "ToFloat64": "CAST(%s AS REAL)",
    "Range": "number_range({0})",
    "Unique": "unique_list({0})",
    # Like DuckDB, return null instead of an empty list.
    "List": "NULLIF(json_group_array({0}), '[]')",
    "Least": "least(%s)",
    "Greatest": "greatest(%s)",
    "Mod": "modulo(%s)",
    "Upper": "upper_text(%s)",
    "Lower": "lower_text(%s)",
    "ToString": "to_text(%s)",
}
_OPERATORS = {
    "/": "divide(%s, %s)",
    "%": "modulo(%s, %s)",
    "++": "concatenate(%s, %s)",
    "in": "%s IN (SELECT value FROM json_each(%s))",
}


class RobotDialect(dialects.SqLiteDialect):  # type: ignore[misc]  # the package has no types
    """SQLite with DuckDB's division, no errors on null, and only our own functions."""

    def BuiltInFunctions(self) -> dict[str, str | None]:
        return {**super().BuiltInFunctions(), **_FUNCTIONS}

    def InfixOperators(self) -> dict[str, str]:
        return {**super().InfixOperators(), **_OPERATORS}

    def Subscript(self, record: str, subscript: str, record_is_table: bool) -> str:
        """Return the SQL of `record.subscript`; null for a column that may hold plain text."""
        if record_is_table:
            return f"{record}.{subscript}"
        field = subscript.replace("'", "''")
        sql = f"json_extract({record}, '$.{field}')"
        if _COLUMN.fullmatch(record) and not record.endswith(_ALWAYS_JSON):
            return f"CASE WHEN json_valid({record}) THEN {sql} END"
        return sql

    def LibraryProgram(self) -> str:
        """Return nothing: the prelude is added to the program's rules instead."""
        return ""

    def DecorateCombineRule(self, rule: dict[str, Any], var: str) -> dict[str, Any]:
        """Tie an aggregated expression to its subquery; for `argument -> value`, its parts."""
        tied = tie_pair(rule, var)
        decorated: dict[str, Any] = tied or super().DecorateCombineRule(rule, var)
        return decorated


_QL = expr_translate.QL
_SPECIAL = frozenset({"Aggr", "Cast"})
"""Functions that the package compiles without a template."""
_INTERNAL = frozenset(
    {"Container", "FlagValue", "MagicalEntangle", "SqlExpr"} | {"ToUInt64", "ValueOfUnnested"}
)


@functools.cache
def runs(name: str) -> bool:
    """Return whether a built-in function works in a mind's SQLite, by trying it."""
    if name in _INTERNAL:
        return False
    if name in _SPECIAL or name in _QL.BUILT_IN_INFIX_OPERATORS:
        return True
    if name in _QL.ANALYTIC_FUNCTIONS:
        template = _QL.ANALYTIC_FUNCTIONS[name].format("NULL", "NULL", "NULL", "0")
        return _compiles(template)
    template = _templates().get(name)
    if not template:
        return False
    low, high = arity(name)
    counts = range(low, min(int(high), low + 2) + 1) if high < math.inf else range(2, 3)
    return any(_compiles(template, count) for count in counts)


@functools.cache
def _templates() -> dict[str, str | None]:
    built_in_names()  # reads the package's own table
    ours = RobotDialect().BuiltInFunctions()
    return {**_QL.BULK_FUNCTIONS, **_QL.BUILT_IN_FUNCTIONS, **ours}


def _compiles(template: str, arguments: int = 0) -> bool:
    nulls = ["NULL"] * arguments
    try:
        text = template % ", ".join(nulls) if "%s" in template else template.format(*nulls)
        _database().prepare(f"SELECT {text}")
    except (IndexError, TypeError, sqlite3.Error):
        return False
    return True


_database = functools.cache(Database)
