"""Shapes of values: the fields of a record, and the elements of a list."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui import schema

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, text or boolean of the sensor."""

    title: str


@dataclass(frozen=True, slots=True)
class ListOf:
    """A list."""

    element: Shape | None
    title: str = field(default="this list", compare=False)


@dataclass(frozen=True, slots=True)
class Record:
    """A record whose fields are all known.

    Attributes:
        fields: Shapes by name; None if unknown.
        title: Its name in messages.
        names: The names as in the program's text, with their places.
    """

    fields: Mapping[str, Shape | None]
    title: str = field(default="this record", compare=False)
    names: tuple[str, ...] = field(default=(), compare=False)


Shape: TypeAlias = Scalar | ListOf | Record


def _shape_of(name: str, field: schema.FieldType) -> Shape:
    if isinstance(field, schema.Type):
        return Scalar(name)
    if isinstance(field, schema.ListOf):
        return ListOf(_shape_of("", field.element), field.title)
    return Record(
        {each.name: _shape_of(each.name, each.type) for each in field.fields}, field.title
    )


SENSOR = _shape_of("sensor", schema.SENSOR)
"""What a robot perceives in a tick."""
