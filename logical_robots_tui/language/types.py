"""Types of values, as DuckDB knows them before a query runs.

They serve messages about a program, and the SQL that computes what DuckDB would.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import reduce
from typing import Any, TypeAlias

from logical_robots_tui import schema


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
        of: What it tells: an ``object``, a ``label`` or a ``robot_name``.
    """

    of: str


@dataclass(frozen=True, slots=True)
class ListOf:
    element: Kind
    title: str = field(default="this list", compare=False)


@dataclass(frozen=True, slots=True)
class RecordOf:
    """A record whose fields are all known.

    Attributes:
        names: The names as written, with their places.
    """

    fields: tuple[tuple[str, Kind], ...]
    title: str = field(default="this record", compare=False)
    names: tuple[str, ...] = field(default=(), compare=False)

    def field(self, name: str) -> Kind:
        """Return the type of a field; any type if there is no such field."""
        return dict(self.fields).get(name, Plain.ANY)


Kind: TypeAlias = "Plain | Decimal | Word | ListOf | RecordOf"

Tables: TypeAlias = "Mapping[str, Mapping[str, Kind]]"
"""The types of columns, by table."""

MOST_DIGITS = 38  # of a decimal number

_WHOLE_DIGITS: dict[Kind, int] = {Plain.SMALL: 10, Plain.WHOLE: 19, Plain.LARGE: MOST_DIGITS}


def is_nested(kind: Kind) -> bool:
    return isinstance(kind, ListOf | RecordOf)


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
    if is_text(one) and is_text(other):
        return Plain.TEXT
    if isinstance(one, ListOf) and isinstance(other, ListOf):
        return ListOf(_either(one.element, other.element), one.title)
    if isinstance(one, RecordOf) and isinstance(other, RecordOf):
        more = dict(other.fields)
        fields = [(name, _either(of, more.pop(name, Plain.NULL))) for name, of in one.fields]
        return RecordOf((*fields, *more.items()), one.title)
    return Plain.ANY


def _common_decimal(one: Kind, other: Kind) -> Decimal:
    scale = max(k.scale for k in (one, other) if isinstance(k, Decimal))
    if Plain.LARGE in (one, other):
        return Decimal(scale, MOST_DIGITS - scale)
    whole = max(k.whole if isinstance(k, Decimal) else digits(k) for k in (one, other))
    return Decimal(min(scale, MOST_DIGITS - whole), whole)


def meet(one: Kind, other: Kind) -> Kind:
    """Return the type of what has two types at once; any type if that is not known."""
    if one == other or (is_number(one) and is_number(other)):
        return one
    if is_text(one) and is_text(other):
        return other if one is Plain.TEXT else one
    return Plain.ANY


def clash(one: Kind, other: Kind) -> bool:
    """Return whether no value has both types, null and what it is part of aside."""
    if isinstance(one, ListOf) and isinstance(other, ListOf):
        return clash(one.element, other.element)
    if isinstance(one, RecordOf) and isinstance(other, RecordOf):
        theirs = dict(other.fields)
        return any(clash(kind, theirs.get(name, Plain.ANY)) for name, kind in one.fields)
    return "" not in (family(one), family(other)) and family(one) != family(other)


def family(kind: Kind) -> str:
    """Return the word for types whose values can be compared, or "" if it is not known."""
    if is_number(kind):
        return "number"
    if is_text(kind):
        return "text"
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


def dump_kind(kind: Kind) -> Any:
    """Return a type as JSON, which `load_kind` reads; a word becomes a text, titles are lost."""
    if isinstance(kind, Decimal):
        return f"{kind.scale} {kind.whole}"
    if isinstance(kind, ListOf):
        return [dump_kind(kind.element)]
    if isinstance(kind, RecordOf):
        return {name: dump_kind(of) for name, of in kind.fields}
    return kind.value if isinstance(kind, Plain) else Plain.TEXT.value


def load_kind(data: Any) -> Kind:
    if isinstance(data, str) and data[:1].isdigit():
        scale, whole = map(int, data.split())
        return Decimal(scale, whole)
    if isinstance(data, list):
        return ListOf(load_kind(data[0]))
    if isinstance(data, dict):
        return RecordOf(tuple((name, load_kind(of)) for name, of in data.items()))
    return Plain(data)


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
        return ListOf(_kind_of(field.element), field.title)
    kinds = tuple((each.name, _kind_of(each.type)) for each in field.fields)
    return RecordOf(kinds, field.title)


SENSOR = _kind_of(schema.SENSOR)
"""A sensor as the world fills it."""
