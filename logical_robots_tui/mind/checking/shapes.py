"""Shapes of values: the fields of a record, and the elements of a list."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

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


def _record(title: str, *names: str, **others: Shape) -> Record:
    return Record({**{name: Scalar(name) for name in names}, **others}, title)


RAY = _record("a ray of the radar", "angle", "distance", "object", "label")

SENSOR = _record(
    "a sensor",
    "forward_distance",
    "forward_object",
    "forward_label",
    "clock",
    radar=ListOf(RAY, "the radar"),
    self=_record("self", "can_charge", "has_battery", "battery_level", "battery_capacity"),
)
"""What a robot perceives in a tick."""
