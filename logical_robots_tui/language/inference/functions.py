"""What built-in functions and aggregates take and give, and what to do about other types."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from logical_robots_tui.language import tree
from logical_robots_tui.language.types import (
    Kind,
    ListOf,
    Plain,
    common,
    family,
    is_number,
    is_text,
)


class Function(NamedTuple):
    """The types of a function.

    Attributes:
        takes: Those of its arguments; the last is that of all further ones.
        gives: That of its value.
    """

    takes: tuple[Kind, ...]
    gives: Kind

    def wanted(self, place: int) -> Kind:
        return self.takes[min(place, len(self.takes) - 1)] if self.takes else Plain.ANY


_KINDS: dict[str, Kind] = {
    "any": Plain.ANY,
    "bool": Plain.TRUTH,
    "list": ListOf(Plain.ANY),
    "num": Plain.REAL,
    "nums": ListOf(Plain.REAL),
    "text": Plain.TEXT,
    "texts": ListOf(Plain.TEXT),
}

_TABLE = """
num -> num: Abs Acos Acosh Asin Asinh Atan Atanh Atan2 Ceil Cos Cosh Exp Floor Ln Log Log10 Mod
num -> num: Num Pow Round Sign Sin Sinh Sqrt Tan Tanh Trunc CumulativeSum
num -> nums: GenerateArray Range
num -> text: Chr
text -> num: CharLength Length Ord Strpos
text -> text: Lower Ltrim RegexpExtract Replace Reverse Rtrim Str Trim Upper
text -> bool: EndsWith Like StartsWith
text -> texts: Split
text num -> text: Repeat Substr
text num text -> text: Lpad Rpad
text any -> text: Format
list -> num: ArrayLength Size
list text -> text: ArrayToString Join
list num -> any: Element
list -> any: Sort Unique
any -> num: Count ExactCount Fingerprint NaturalHash ToFloat64 ToInt64 UniqueNumber
any -> text: RecordAsJson StringAgg ToString TruthToString
any -> bool: IsNull
bool any -> any: If
bool -> bool: ! && ||
any -> bool: != < <= == > >= in is
any -> num: % * + - / ^ Avg Sum WeightedAverage
"""


def _functions() -> dict[str, Function]:
    found: dict[str, Function] = {}
    for line in _TABLE.strip().splitlines():
        kinds, _, names = line.partition(": ")
        takes, _, gives = kinds.partition(" -> ")
        function = Function(tuple(_KINDS[each] for each in takes.split()), _KINDS[gives])
        found |= dict.fromkeys(names.split(), function)
    return {**found, "is not": found["is"]}


FUNCTIONS = _functions()
"""By name."""

ARITHMETIC = frozenset({"%", "*", "+", "-", "/", "^", "Avg", "Sum"})
"""What computes with numbers, also as an aggregate; on DuckDB texts make it fail."""

COMPARISONS = frozenset({"!=", "<", "<=", ">", ">="})

ALIKE = frozenset(
    {"++", "ArrayConcat", "Coalesce", "Concat", "Greatest", "Ifnull", "Least", "Nullif"}
)
"""Functions whose arguments have one type."""

_FIRST = frozenset({"AnyValue", "Max", "Min", "1", "Nullif", "SomeValue", "Sort", "Unique"})
_LISTING = frozenset({"List", "Set"})


def result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of what a built-in function, operator or aggregate gives."""
    first = kinds[0] if kinds else Plain.ANY
    if name == "Element" and isinstance(first, ListOf):
        return first.element
    if name in _FIRST:
        return first
    if name in _LISTING:
        return ListOf(first)
    if name == "If":
        return common(kinds[1:])
    if name in ALIKE:
        return common(kinds)
    return FUNCTIONS[name].gives if name in FUNCTIONS else Plain.ANY


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
