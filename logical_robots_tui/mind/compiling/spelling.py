"""Rewrites of the syntax tree that no SQL template can do: types and truths as text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.compiling import complaints
from logical_robots_tui.mind.compiling.rules import TRUTHS
from logical_robots_tui.mind.diagnostics import ProgramError
from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.text import Prepared

__all__ = ["spell_out"]

_TYPES = {
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


def spell_out(rules: list[Rule], text: str, source: Prepared) -> None:
    """Replace, in place, the type in `TryCast` by its text, and name `ToString` of a truth.

    Raises:
        ProgramError: The second argument of `TryCast` is not a type.
    """
    for call in _calls(rules):
        values = call["record"]["field_value"]
        if call["predicate_name"] == "ToString" and len(values) == 1:
            if _is_truth(values[0]["value"].get("expression", {})):
                call["predicate_name"] = "TruthToString"
        elif call["predicate_name"] == "TryCast":
            if len(values) != 2:
                raise ProgramError((_no_type(text, source),))
            try:
                wanted = to_json(_type(values[1]["value"]["expression"]))
            except KeyError:
                raise ProgramError((_no_type(text, source),)) from None
            values[1]["value"]["expression"] = {
                "literal": {"the_string": {"the_string": wanted}},
                "expression_heritage": wanted,
            }


def _calls(tree: Any) -> list[dict[str, Any]]:
    """All calls in a tree, the inner ones first."""
    found: list[dict[str, Any]] = []
    branches = tree.values() if isinstance(tree, dict) else tree if isinstance(tree, list) else ()
    for branch in branches:
        found += _calls(branch)
    if isinstance(tree, dict) and "call" in tree:
        found.append(tree["call"])
    return found


def _is_truth(expression: dict[str, Any]) -> bool:
    if "literal" in expression:
        return "the_bool" in expression["literal"]
    return expression.get("call", {}).get("predicate_name") in TRUTHS


def _type(expression: dict[str, Any]) -> Any:
    """The type that an expression spells: ``{a: Num}``, ``[Str]``, ``Bool``, ``"BIGINT"``."""
    if "record" in expression:
        fields = expression["record"]["field_value"]
        return {f["field"]: _type(f["value"]["expression"]) for f in fields}
    literal = expression["literal"]
    if "the_list" in literal:
        (element,) = literal["the_list"]["element"] or [{}]
        return [_type(element)]
    if "the_predicate" in literal:
        return _TYPES[str(literal["the_predicate"]["predicate_name"]).upper()]
    return _sql_type(str(literal["the_string"]["the_string"]))


def _sql_type(spelled: str) -> Any:
    """The type that a text spells in SQL, such as ``STRUCT(a BIGINT, b VARCHAR[])``."""
    spelled = spelled.strip()
    if spelled.endswith("[]"):
        return [_sql_type(spelled[:-2])]
    if found := re.fullmatch(r"(?is)struct\s*\((.*)\)", spelled):
        fields = (part.strip().split(None, 1) for part in _parts(found.group(1)))
        return {field[0].strip('"'): _sql_type(field[1]) for field in fields if len(field) == 2}
    return _TYPES[spelled.upper()]


def _parts(text: str) -> list[str]:
    """Text split at the commas outside parentheses."""
    parts, depth = [""], 0
    for character in text:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and not depth:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _no_type(text: str, source: Prepared) -> Any:
    return complaints.at_word(
        "TryCast",
        text,
        source,
        "TryCast needs a value and a type",
        "Such as TryCast(memory, {count: Num, seen: [Str]}).",
    )
