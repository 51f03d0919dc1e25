"""Static types of values and of what functions give, as DuckDB knows them before a query runs.

SQLite checks the type of a value when it computes with it. DuckDB decides beforehand, and some of
what a program means depends on that: how a whole real number is printed, how records are compared.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import Enum
from functools import reduce
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui import schema

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


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
class ListOf:
    element: Kind


@dataclass(frozen=True, slots=True)
class RecordOf:
    fields: tuple[tuple[str, Kind], ...]

    def field(self, name: str) -> Kind:
        """Return the type of a field; any type if there is no such field."""
        return dict(self.fields).get(name, Plain.ANY)


Kind: TypeAlias = "Plain | Decimal | ListOf | RecordOf"

MOST_DIGITS = 38  # of a decimal number

_WHOLE_DIGITS: dict[Kind, int] = {Plain.SMALL: 10, Plain.WHOLE: 19, Plain.LARGE: MOST_DIGITS}


def is_nested(kind: Kind) -> bool:
    return isinstance(kind, ListOf | RecordOf)


def is_number(kind: Kind) -> bool:
    return isinstance(kind, Decimal) or kind is Plain.REAL or is_whole(kind)


def is_whole(kind: Kind) -> bool:
    return kind in _WHOLE_DIGITS


def digits(kind: Kind) -> int:
    return kind.scale + kind.whole if isinstance(kind, Decimal) else _WHOLE_DIGITS[kind]


def is_known(kind: Kind) -> bool:
    if isinstance(kind, ListOf):
        return is_known(kind.element)
    if isinstance(kind, RecordOf):
        return all(is_known(of) for _, of in kind.fields)
    return kind is not Plain.ANY


def common(kinds: Iterable[Kind]) -> Kind:
    none: Kind = Plain.NULL
    return reduce(_either, kinds, none)


def _either(one: Kind, other: Kind) -> Kind:
    if one == other or other is Plain.NULL:
        return one
    if one is Plain.NULL:
        return other
    if is_number(one) and is_number(other):
        if Plain.REAL in (one, other):
            return Plain.REAL
        if is_whole(one) and is_whole(other):
            return max(one, other, key=digits)
        return _common_decimal(one, other)
    if isinstance(one, ListOf) and isinstance(other, ListOf):
        return ListOf(_either(one.element, other.element))
    if isinstance(one, RecordOf) and isinstance(other, RecordOf):
        more = dict(other.fields)
        fields = [(name, _either(of, more.pop(name, Plain.NULL))) for name, of in one.fields]
        return RecordOf((*fields, *more.items()))
    return Plain.ANY


def _common_decimal(one: Kind, other: Kind) -> Decimal:
    scale = max(k.scale for k in (one, other) if isinstance(k, Decimal))
    if Plain.LARGE in (one, other):
        return Decimal(scale, MOST_DIGITS - scale)
    whole = max(k.whole if isinstance(k, Decimal) else digits(k) for k in (one, other))
    return Decimal(min(scale, MOST_DIGITS - whole), whole)


def spell(kind: Kind) -> str:
    """Return a type as `try_cast` reads it, all numbers real."""
    return json.dumps(_spelling(kind), ensure_ascii=False, separators=(",", ":"))


def _spelling(kind: Kind) -> Any:
    if isinstance(kind, ListOf):
        return [_spelling(kind.element)]
    if isinstance(kind, RecordOf):
        return {name: _spelling(of) for name, of in kind.fields}
    if is_number(kind):
        return Plain.REAL.value
    return Plain.ANY.value if kind is Plain.NULL else kind.value  # type: ignore[union-attr]  # what has parts, went before


def parse_spelling(text: str) -> Kind:
    """Return the type of what `try_cast` gives, from how that was spelled for it."""
    return _kind(json.loads(text))


def _kind(spelling: Any) -> Kind:
    if isinstance(spelling, dict):
        return RecordOf(tuple((name, _kind(of)) for name, of in spelling.items()))
    if isinstance(spelling, list):
        return ListOf(_kind(spelling[0]))
    return Plain.WHOLE if spelling == "Int" else Plain(spelling)


_SCHEMA_KINDS = {
    schema.Type.TRUTH: Plain.TRUTH,
    schema.Type.WHOLE: Plain.WHOLE,
    schema.Type.REAL: Plain.REAL,
    schema.Type.TEXT: Plain.TEXT,
}


def _kind_of(field: schema.FieldType) -> Kind:
    if isinstance(field, schema.Type):
        return _SCHEMA_KINDS[field]
    if isinstance(field, schema.ListOf):
        return ListOf(_kind_of(field.element))
    return RecordOf(tuple((each.name, _kind_of(each.type)) for each in field.fields))


SENSOR = _kind_of(schema.SENSOR)
"""A sensor as the world fills it."""

_GIVE: dict[Kind, tuple[str, ...]] = {
    Plain.TEXT: (
        *("char", "format", "formatted", "group_concat", "join_list", "lower_text", "ltrim"),
        *("replace", "reverse", "rtrim", "string_agg", "substr", "substring", "to_text", "trim"),
        *("truth_to_text", "typeof", "upper_text", "lower", "upper", "decimal_to_text", "printf"),
    ),
    Plain.WHOLE: (
        *("count", "cume_dist", "dense_rank", "instr", "json_array_length", "length"),
        *("natural_hash", "ntile", "rank", "row_number", "sign", "unicode", "unicode_of"),
    ),
    Plain.REAL: (
        *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "avg", "cos", "cosh"),
        *("degrees", "divide", "exp", "ln", "log", "log10", "log2", "median", "percentile", "pi"),
        *("pow", "power", "radians", "sin", "sinh", "sqrt", "tan", "tanh", "total"),
    ),
    Plain.TRUTH: ("ends_with", "json_valid", "like", "list_has", "starts_with"),
}

_GIVES = {name: kind for kind, names in _GIVE.items() for name in names}

_FIRST = frozenset(
    {
        *("abs", "any_value", "arg_max", "arg_max_of_nested", "arg_min", "arg_min_of_nested"),
        *("first_value", "greatest_nested", "lag", "last_value", "lead", "least_nested"),
        *("likelihood", "likely", "nth_value", "nullif", "sort_list", "unique_list", "unlikely"),
    }
)

_ONE_OF_THEM = frozenset({"coalesce", "concat_two_lists", "greatest", "ifnull", "least"})

_SHORT_DIGITS = 18
"""Decimal numbers of no more digits are multiplied to one of no more, if that holds the scale."""

_ROUNDING = frozenset({"ceil", "ceiling", "floor", "trunc"})


def result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of what a function gives."""
    if name in _GIVES:
        return _GIVES[name]
    if name in _ONE_OF_THEM:
        return common(kinds)
    if not kinds:
        return Plain.ANY
    if name in _FIRST:
        return kinds[0]
    made = _MADE.get(name)
    return made(kinds) if made is not None else Plain.ANY


def sum_of(kinds: Sequence[Kind]) -> Kind:
    return common(kinds) if all(map(is_number, kinds)) else Plain.ANY


def product_of(left: Kind, right: Kind) -> Kind:
    found = sum_of((left, right))
    if not isinstance(found, Decimal):
        return found
    scale = sum(k.scale for k in (left, right) if isinstance(k, Decimal))
    most = digits(left) + digits(right)
    if max(digits(left), digits(right)) <= _SHORT_DIGITS < most:
        most = _SHORT_DIGITS
    return Decimal(scale, min(most, MOST_DIGITS) - scale)


def _total(kinds: Sequence[Kind]) -> Kind:
    kind = sum_of(kinds[:1])
    if isinstance(kind, Decimal):
        return Decimal(kind.scale, MOST_DIGITS - kind.scale)
    return Plain.LARGE if is_whole(kind) else kind


def _rounded(kinds: Sequence[Kind]) -> Kind:
    kind = kinds[0]
    return Decimal(0, digits(kind)) if isinstance(kind, Decimal) else sum_of(kinds[:1])


def _cut(kinds: Sequence[Kind]) -> Kind:
    """Return the type of a floor or ceiling; DuckDB's of a whole number is real."""
    return Plain.REAL if is_whole(kinds[0]) else _rounded(kinds)


def _collected_values(kinds: Sequence[Kind]) -> Kind:
    return ListOf(kinds[1]) if len(kinds) > 1 else Plain.ANY


def _concatenated(kinds: Sequence[Kind]) -> Kind:
    if all(isinstance(kind, ListOf) for kind in kinds):
        return common(kinds)
    return Plain.TEXT if Plain.TEXT in kinds else Plain.ANY


_MADE: dict[str, Callable[[Sequence[Kind]], Kind]] = {
    **dict.fromkeys(_ROUNDING, _cut),
    "arg_max_k": lambda kinds: ListOf(kinds[0]),
    "arg_max_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "arg_min_k": lambda kinds: ListOf(kinds[0]),
    "arg_min_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "array_by": _collected_values,
    "concat_lists": lambda kinds: kinds[0],
    "concatenate": _concatenated,
    "if": lambda kinds: common(kinds[1:]),
    "iif": lambda kinds: common(kinds[1:]),
    "json_group_array": lambda kinds: ListOf(kinds[0]),
    "list_of_distinct": lambda kinds: ListOf(kinds[0]),
    "max": common,
    "min": common,
    "modulo": sum_of,
    "number_range": lambda _: ListOf(Plain.WHOLE),
    "round": _rounded,
    "round_to": _rounded,
    "split_text": lambda _: ListOf(Plain.TEXT),
    "sum": _total,
}
