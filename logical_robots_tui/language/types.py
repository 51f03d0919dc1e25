"""Types of values, as DuckDB knows them before a query runs, and types of functions.

They serve messages about a program, and the SQL that computes what DuckDB would.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import reduce
from typing import Any, NamedTuple, TypeAlias

from logical_robots_tui import schema
from logical_robots_tui.language import tree
from logical_robots_tui.language.diagnostics import Proposal


class Plain(Enum):
    ANY = "Any"
    NULL = "Null"
    TRUTH = "Bool"
    SMALL = "Small"  # whole numbers as they are written
    WHOLE = "Whole"
    LARGE = "Large"  # sums of whole numbers
    REAL = "Num"
    TEXT = "Str"


@dataclass(frozen=True, slots=True)
class Decimal:
    """An exact number, as literals are: `scale` digits after the point, up to `whole` before."""

    scale: int
    whole: int


@dataclass(frozen=True, slots=True)
class Word:
    """A text of a sensor that is one of a few words; only messages tell it from other texts.

    Attributes:
        field: The field it is in: ``object``, ``label`` or ``robot_name``.
    """

    field: str


@dataclass(frozen=True, slots=True)
class ListOf:
    element: Kind
    title: str = field(default="This list", compare=False)


@dataclass(frozen=True, slots=True)
class RecordOf:
    """A record whose fields are all known.

    Attributes:
        names: The names as written, with their places.
    """

    fields: tuple[tuple[str, Kind], ...]
    title: str = field(default="This record", compare=False)
    names: tuple[str, ...] = field(default=(), compare=False)

    def field(self, name: str) -> Kind:
        """Return the type of a field; any type if there is no such field."""
        return dict(self.fields).get(name, Plain.ANY)


@dataclass(frozen=True, slots=True)
class Remembered:
    """A memory: "", or a record with some of these fields; only messages tell it from any value."""

    fields: frozenset[str] = frozenset()


Kind: TypeAlias = "Plain | Decimal | Word | ListOf | RecordOf | Remembered"

Tables: TypeAlias = "Mapping[str, Mapping[str, Kind]]"
"""The types of columns, by table."""

MOST_DIGITS = 38  # of a decimal number

_WHOLE_DIGITS: dict[Kind, int] = {Plain.SMALL: 10, Plain.WHOLE: 19, Plain.LARGE: MOST_DIGITS}


def is_nested(kind: Kind) -> bool:
    return isinstance(kind, ListOf | RecordOf | Remembered)


def is_number(kind: Kind) -> bool:
    return isinstance(kind, Decimal) or kind is Plain.REAL or is_whole(kind)


def is_text(kind: Kind) -> bool:
    return kind is Plain.TEXT or isinstance(kind, Word)


def is_whole(kind: Kind) -> bool:
    return kind in _WHOLE_DIGITS


def digits(kind: Kind) -> int:
    return kind.scale + kind.whole if isinstance(kind, Decimal) else _WHOLE_DIGITS[kind]


def is_known(kind: Kind) -> bool:
    if isinstance(kind, ListOf):
        return is_known(kind.element)
    if isinstance(kind, RecordOf):
        return all(is_known(inner) for _, inner in kind.fields)
    return kind is not Plain.ANY and not isinstance(kind, Remembered)


def common(kinds: Iterable[Kind]) -> Kind:
    bottom: Kind = Plain.NULL
    return reduce(_either, kinds, bottom)


def _either(left: Kind, right: Kind) -> Kind:
    if left == right or right is Plain.NULL:
        return left
    if left is Plain.NULL:
        return right
    if is_number(left) and is_number(right):
        if Plain.REAL in (left, right):
            return Plain.REAL
        if is_whole(left) and is_whole(right):
            return max(left, right, key=digits)
        scale = max(k.scale for k in (left, right) if isinstance(k, Decimal))
        if Plain.LARGE in (left, right):
            return Decimal(scale, MOST_DIGITS - scale)
        whole = max(k.whole if isinstance(k, Decimal) else digits(k) for k in (left, right))
        return Decimal(min(scale, MOST_DIGITS - whole), whole)
    if is_text(left) and is_text(right):
        return Plain.TEXT
    if isinstance(left, ListOf) and isinstance(right, ListOf):
        return ListOf(_either(left.element, right.element), left.title)
    if isinstance(left, RecordOf) and isinstance(right, RecordOf):
        right_fields = dict(right.fields)
        fields = [
            (name, _either(kind, right_fields.pop(name, Plain.NULL))) for name, kind in left.fields
        ]
        return RecordOf((*fields, *right_fields.items()), left.title)
    if isinstance(left, Remembered) and isinstance(right, Remembered):
        return Remembered(left.fields | right.fields)
    return Plain.ANY


def remember(memory: Kind, kinds: Iterable[Kind]) -> Kind:
    """Return the type of memories that may also be of some types; any type if it is unknown."""
    for kind in kinds:
        if not isinstance(memory, Remembered):
            return Plain.ANY
        if isinstance(kind, RecordOf) and kind.fields:
            memory = Remembered(memory.fields.union(name for name, _ in kind.fields))
        elif not isinstance(kind, Remembered) and kind is not Plain.NULL:
            return Plain.ANY
    return memory


def meet(left: Kind, right: Kind) -> Kind:
    """Return the type of a value that has two types at once; any type if it is unknown."""
    if left == right or (is_number(left) and is_number(right)):
        return left
    if is_text(left) and is_text(right):
        return right if left is Plain.TEXT else left
    if isinstance(left, Remembered):
        return _either(left, right) if isinstance(right, Remembered) else left
    return Plain.ANY


def clash(left: Kind, right: Kind) -> bool:
    """Return whether no value has both types, leaving null and its containers aside."""
    if isinstance(left, ListOf) and isinstance(right, ListOf):
        return clash(left.element, right.element)
    if isinstance(left, RecordOf) and isinstance(right, RecordOf):
        right_fields = dict(right.fields)
        return any(clash(kind, right_fields.get(name, Plain.ANY)) for name, kind in left.fields)
    return "" not in (family(left), family(right)) and family(left) != family(right)


def family(kind: Kind) -> str:
    """Return the word for types whose values can be compared, or "" if it is not known."""
    if is_number(kind):
        return "number"
    if is_text(kind):
        return "string"
    if isinstance(kind, ListOf):
        return "list"
    if isinstance(kind, RecordOf):
        return "record"
    return "Boolean" if kind is Plain.TRUTH else ""


def describe(kind: Kind) -> str:
    """Return a type in words: "a list of numbers"."""
    element = family(kind.element) if isinstance(kind, ListOf) else ""
    return f"a {family(kind)} of {element}s" if element else f"a {family(kind)}"


def spell(kind: Kind) -> str:
    """Return a type as `try_cast` reads it, all numbers real."""
    return json.dumps(dump_kind(kind, is_cast=True), ensure_ascii=False, separators=(",", ":"))


def parse_spelling(text: str) -> Kind:
    """Return the type that `spell` wrote for `try_cast`."""
    return load_kind(json.loads(text))


def dump_kind(kind: Kind, *, is_cast: bool = False) -> Any:
    """Return a type as JSON, which `load_kind` reads; a word becomes a text, titles are lost."""
    if isinstance(kind, ListOf):
        return [dump_kind(kind.element, is_cast=is_cast)]
    if isinstance(kind, RecordOf):
        return {name: dump_kind(inner, is_cast=is_cast) for name, inner in kind.fields}
    if is_cast and (is_number(kind) or kind is Plain.NULL):
        return Plain.ANY.value if kind is Plain.NULL else Plain.REAL.value
    if isinstance(kind, Decimal):
        return f"{kind.scale} {kind.whole}"
    return kind.value if isinstance(kind, Plain) else Plain.TEXT.value


def load_kind(raw: Any) -> Kind:
    if isinstance(raw, list):
        return ListOf(load_kind(raw[0]))
    if isinstance(raw, dict):
        return RecordOf(tuple((name, load_kind(inner)) for name, inner in raw.items()))
    if raw[:1].isdigit():
        return Decimal(*map(int, raw.split()))
    return Plain.WHOLE if raw == "Int" else Plain(raw)


def _kind_of(field: schema.FieldType, words: Mapping[str, Word], name: str = "") -> Kind:
    if isinstance(field, schema.Type):
        return words.get(name, Plain[field.name])
    if isinstance(field, schema.ListOf):
        return ListOf(_kind_of(field.element, words), field.title)
    fields = tuple((part.name, _kind_of(part.type, words, part.name)) for part in field.fields)
    return RecordOf(fields, field.title)


SENSOR = _kind_of(schema.SENSOR, {})
"""A sensor as the world fills it."""

ROBOT_NAME, LABEL, OBJECT = Word("robot_name"), Word("label"), Word("object")

SENSED = _kind_of(
    schema.SENSOR,
    {"object": OBJECT, "forward_object": OBJECT, "label": LABEL, "forward_label": LABEL},
)
"""A sensor whose objects and labels are words."""


# -- functions -----------------------------------------------------------------------------------


class Function(NamedTuple):
    """The types of a function.

    Attributes:
        arguments: Those of its arguments; the last is that of all further ones.
        result: That of its value.
    """

    arguments: tuple[Kind, ...]
    result: Kind

    def argument(self, place: int) -> Kind:
        return self.arguments[min(place, len(self.arguments) - 1)] if self.arguments else Plain.ANY


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
    functions: dict[str, Function] = {}
    for line in _TABLE.strip().splitlines():
        kinds, _, names = line.partition(": ")
        arguments, _, result = kinds.partition(" -> ")
        function = Function(tuple(_KINDS[word] for word in arguments.split()), _KINDS[result])
        functions |= dict.fromkeys(names.split(), function)
    return {**functions, "is not": functions["is"]}


FUNCTIONS = _functions()
"""By name."""

ARITHMETIC = frozenset({"%", "*", "+", "-", "/", "^", "Avg", "Sum"})
"""Operators and aggregates that compute with numbers; on DuckDB they fail with texts."""

COMPARISONS = frozenset({"!=", "<", "<=", ">", ">="})

ALIKE = frozenset(
    {"++", "ArrayConcat", "Coalesce", "Concat", "Greatest", "Ifnull", "Least", "Nullif"}
)
"""Functions whose arguments have one type."""

_FIRST = frozenset({"AnyValue", "Max", "Min", "1", "Nullif", "SomeValue", "Sort", "Unique"})
_LISTING = frozenset({"List", "Set"})


def result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of the result of a built-in function, operator or aggregate."""
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
    return FUNCTIONS[name].result if name in FUNCTIONS else Plain.ANY


LONGEST = 40  # characters of a quotation
_NUMERAL = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*", re.IGNORECASE)


def repair(node: tree.Expression, expected: Kind, actual: Kind) -> str:
    """Return how to give an expression, or its counterpart, the expected type."""
    is_short = isinstance(node, tree.Literal) and len(node.value) <= LONGEST
    if is_short and isinstance(node, tree.Number) and is_text(expected):
        return f'Put it in quotes: "{node.value}".'
    if is_short and is_number(expected) and isinstance(node, tree.Text) and is_numeral(node):
        return Proposal(node.value, "Write {} without quotes.")
    match family(expected), family(actual):
        case "number", "string":
            return "ToFloat64 turns a string into a number."
        case "string", "number":
            return "ToString turns a number into a string."
        case ("list", "list") | ("record", "record"):
            return "Their parts must have the same type."
        case (_, "list") | ("list", _):
            return "A list's elements are taken one by one: x in list."
        case (_, "record") | ("record", _):
            return "Read a field of a record with a dot: record.field."
    return "A Boolean is true, false or the result of a comparison."


def is_numeral(node: tree.Text) -> bool:
    return _NUMERAL.fullmatch(node.value) is not None
