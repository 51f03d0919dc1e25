"""What to do about types that do not fit."""

from __future__ import annotations

import re

from logical_robots_tui.language import tree
from logical_robots_tui.language.types import Kind, family, is_number, is_text

LONGEST = 40  # characters of a quotation
_NUMERAL = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*", re.IGNORECASE)


def repair(node: tree.Expression, wanted: Kind, given: Kind) -> str:
    """Return how an expression, or what it meets, becomes one of the wanted type."""
    is_short = isinstance(node, tree.Literal) and len(node.value) <= LONGEST
    if is_short and isinstance(node, tree.Number) and is_text(wanted):
        return f'Put it in quotes: "{node.value}".'
    if is_short and is_number(wanted) and isinstance(node, tree.Text) and is_numeral(node):
        return f"Write {node.value} without quotes."
    match family(wanted), family(given):
        case "number", "text":
            return "ToFloat64 makes a number of a text."
        case "text", "number":
            return "ToString makes a text of a number."
        case ("list", "list") | ("record", "record"):
            return "Their parts must have the same type."
        case (_, "list") | ("list", _):
            return "A list's elements are taken one by one: x in list."
        case (_, "record") | ("record", _):
            return "A field is taken from a record with a point: record.field."
    return "A Boolean is true or false, or what a comparison gives."


def is_numeral(node: tree.Text) -> bool:
    return _NUMERAL.fullmatch(node.value) is not None
