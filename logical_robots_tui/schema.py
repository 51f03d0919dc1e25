"""The inputs and results of programs: each field's name, type, unit, range and meaning.

Written once. The rows that the world makes, the columns of SQL, the types that programs are checked
by, completion and the documentation are made from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import radians
from typing import TypeAlias


class Type(Enum):
    """Types without parts; the value is their name in the documentation."""

    TRUTH = "Boolean"
    WHOLE = "whole number"
    REAL = "number"
    TEXT = "string"


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a record.

    Attributes:
        name: As programs write it.
        type: Of its values.
        meaning: What it is, as a phrase.
        range: Which values there are, in words; "" for any.
        unit: Of a number; "" if it has none.
    """

    name: str
    type: FieldType
    meaning: str
    range: str = ""
    unit: str = ""

    @property
    def values(self) -> str:
        return f"{self.range} {self.unit}".strip()

    @property
    def explanation(self) -> str:
        return f"{self.meaning}: {self.values}" if self.values else self.meaning


@dataclass(frozen=True, slots=True)
class Record:
    """A record.

    Attributes:
        path: How programs usually reach it, such as ``sensor.self``.
        title: What messages call it.
        fields: In the order of the world's rows.
    """

    path: str
    title: str
    fields: tuple[Field, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(field.name for field in self.fields)

    @property
    def scalars(self) -> tuple[str, ...]:
        return tuple(field.name for field in self.fields if isinstance(field.type, Type))


@dataclass(frozen=True, slots=True)
class ListOf:
    title: str
    element: Record


FieldType: TypeAlias = Type | Record | ListOf

MAIN = "Robot"
"""The predicate that decides what robots do."""

INPUTS = {"Sensor": ("robot_name", "sensor"), "Memory": ("robot_name", "memory")}
"""The game's own predicates, with their columns."""

VALUE = "logica_value"
"""The column with the value of a function."""

WALL, BEACON, ROBOT, NO_OBJECT = OBJECTS = ("wall", "beacon", "robot", "none")
"""What a ray can hit; the last is nothing."""

NO_LABEL = "nothing"
"""The label of a ray that hits nothing. That of a wall is `WALL`; all others are names."""

SENSOR_RANGE = 200
"""Map units; also the distance that a ray reports when it hits nothing."""

RADAR_RAYS = 31

RADAR_DEGREES = 120
"""Between the leftmost and the rightmost ray of the radar."""

_OBJECT = ", ".join(f'"{name}"' for name in OBJECTS[:-1]) + f' or "{NO_OBJECT}"'
_LABEL = f'a name, "{WALL}" or "{NO_LABEL}"'
_DISTANCE = f"1 to {SENSOR_RANGE}"
_ANGLE = f"{radians(RADAR_DEGREES / 2):.2f}"

RAY = Record(
    "ray",
    "A ray of the radar",
    (
        Field("angle", Type.REAL, "where it points", f"{_ANGLE} (left) to -{_ANGLE}", "radians"),
        Field("distance", Type.WHOLE, "length of the ray", _DISTANCE, "map units"),
        Field("object", Type.TEXT, "kind of thing it hits", _OBJECT),
        Field("label", Type.TEXT, "name of that thing", _LABEL),
    ),
)

SELF = Record(
    "sensor.self",
    "self",
    (
        Field("can_charge", Type.TRUTH, "whether the robot charges others"),
        Field("has_battery", Type.TRUTH, "whether the engines need charge"),
        Field("battery_level", Type.REAL, "remaining charge", "0 or more"),
        Field("battery_capacity", Type.REAL, "full charge", "0 or more"),
    ),
)

SENSOR = Record(
    "sensor",
    "A sensor",
    (
        Field(
            "forward_distance",
            Type.WHOLE,
            "distance to the nearest thing straight ahead",
            _DISTANCE,
            "map units",
        ),
        Field("forward_object", Type.TEXT, "kind of that thing", _OBJECT),
        Field("forward_label", Type.TEXT, "name of that thing", _LABEL),
        Field("radar", ListOf("The radar", RAY), f"{RADAR_RAYS} rays from left to right"),
        Field("self", SELF, "the robot's own battery"),
        Field("clock", Type.WHOLE, "number of the tick", "1 or more"),
    ),
)

DESIRE = Record(
    "desire",
    "A desire",
    (
        Field("left_engine", Type.REAL, "power of the left engine", "-1 to 1"),
        Field("right_engine", Type.REAL, "power of the right engine", "-1 to 1"),
    ),
)

RECORDS = (SENSOR, RAY, SELF, DESIRE)
"""In the order in which the documentation explains them."""


_RAY_FIELDS = frozenset(RAY.names)


def ray_angle(value: object) -> float | None:
    """Return where a value points, in radians, if it is a ray; else None."""
    if not isinstance(value, Mapping) or value.keys() != _RAY_FIELDS:
        return None
    angle = value["angle"]
    return float(angle) if isinstance(angle, int | float) else None
