"""Rewrites of the syntax tree that SQL templates can't express: types, and booleans as text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.checking import error_messages
from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.compiling.rules import TRUTHS, nodes, predicate_of
from logical_robots_tui.mind.diagnostics import ProgramError
from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["TYPES", "spell_out"]

TYPES = {
    "BIGINT": "Int",
    "BOOL": "Bool",
    "BOOLEAN": "Bool",
    "DOUBLE": "Num",
    "FLOAT": "Num",
    "FLOAT64": "Num",
    "INT": "Int",
    "INT64": "Int",
    "INTEGER": "Int",
    "NUM": "Num",
    "NUMERIC": "Num",
    "STR": "Str",
    "STRING": "Str",
    "TEXT": "Str",
    "VARCHAR": "Str",
}
"""Accepted names of types, in upper case, and their name here."""


def spell_out(rules: list[Rule], text: str, source: Prepared) -> None:
    """Replace, in place, the type in `TryCast` by its text, and `ToString` of a boolean.

    Raises:
        ProgramError: A `TryCast` does not have two arguments.
    """
    found = (node["call"] for node in nodes(rules) if "call" in node)
    for call in reversed([*found]):  # inner ones first
        values = call["record"]["field_value"]
        if call["predicate_name"] == "ToString" and len(values) == 1:
            if _is_truth(values[0]["value"].get("expression", {})):
                call["predicate_name"] = "TruthToString"
        elif call["predicate_name"] == "TryCast":
            if len(values) != 2:
                raise ProgramError((_no_type(text, source),))
            _name_type(call, values[1]["value"])


def _name_type(call: dict[str, Any], second: dict[str, Any]) -> None:
    """Pass the type of a `TryCast` as text; in an example, a type becomes a value of that type."""
    try:
        wanted = to_json(_type(second["expression"]))
    except KeyError:
        second["expression"] = _with_samples(second["expression"])
        return
    first = call["record"]["field_value"][0]
    given = trees.record({"t": trees.text(wanted)})
    given["record"]["field_value"].insert(0, {**first, "field": "v"})
    call["predicate_name"] = "SqlExpr"
    template = trees.text("try_cast({v}, {t})")
    call["record"]["field_value"] = trees.fields({0: template, 1: given})


_SAMPLES = {
    "Num": {"the_number": {"number": "0"}},
    "Int": {"the_number": {"number": "0"}},
    "Str": {"the_string": {"the_string": ""}},
    "Bool": {"the_bool": {"the_bool": "true"}},
}


def _with_samples(tree: Any) -> Any:
    if isinstance(tree, list):
        return [_with_samples(branch) for branch in tree]
    if not isinstance(tree, dict):
        return tree
    if sample := _SAMPLES.get(TYPES.get(predicate_of(tree).upper(), "")):
        return {**tree, "literal": sample}
    return {key: _with_samples(branch) for key, branch in tree.items()}


def _is_truth(expression: dict[str, Any]) -> bool:
    if "literal" in expression:
        return "the_bool" in expression["literal"]
    return expression.get("call", {}).get("predicate_name") in TRUTHS


def _type(expression: dict[str, Any]) -> Any:
    """Return the type that an expression names: ``{a: Num}``, ``[Str]``, ``Bool``, ``"BIGINT"``.

    Raises:
        KeyError: It is not a type but an example.
    """
    if "record" in expression:
        fields = expression["record"]["field_value"]
        if any("expression" not in field["value"] for field in fields):
            raise KeyError("expression")
        return {f["field"]: _type(f["value"]["expression"]) for f in fields}
    literal = expression["literal"]
    if "the_list" in literal:
        elements = literal["the_list"]["element"]
        return [_type(elements[0] if len(elements) == 1 else {})]
    if "the_predicate" in literal:
        return TYPES[str(predicate_of(expression)).upper()]
    return _sql_type(str(literal["the_string"]["the_string"]))


def _sql_type(spelled: str) -> Any:
    """Return the type that an SQL text describes, such as ``STRUCT(a BIGINT, b VARCHAR[])``."""
    spelled = spelled.strip()
    if spelled.endswith("[]"):
        return [_sql_type(spelled[:-2])]
    if found := re.fullmatch(r"(?is)struct\s*\((.*)\)", spelled):
        fields = (part.strip().split(None, 1) for part in _parts(found.group(1)))
        return {field[0].strip('"'): _sql_type(field[1]) for field in fields if len(field) == 2}
    return TYPES[spelled.upper()]


def _parts(text: str) -> list[str]:
    """Return a text split at the commas outside parentheses."""
    parts, depth = [""], 0
    for character in text:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and not depth:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _no_type(text: str, source: Prepared) -> Any:
    return error_messages.at_word(
        "TryCast",
        text,
        source,
        "TryCast needs a value and an example of the result",
        'Such as TryCast(memory, {count: 0, seen: [""]}), or types: {count: Num, seen: [Str]}.',
    )
