"""Rows for the tables of tuned queries, from the sensors and memories of a moment."""

from __future__ import annotations

from functools import cache, partial
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.inserting import Filling, in_blocks, insert_into
from logical_robots_tui.mind.sqlite.remembered import memories
from logical_robots_tui.mind.sqlite.stored import to_input

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.mind.sqlite.moment import Moment
    from logical_robots_tui.values import SensorRow

__all__ = ["IN_SELF", "KINDS", "RAYS", "WHOLE_RAY", "fillings", "whole_ray"]

RAYS = 1000
"""Most rays of a radar; the rays of sensor row n have numbers from n * RAYS."""

WHOLE_RAY = "t_0_whole_ray"
"""The SQL function that returns the JSON text of a ray by its number."""

KINDS = {"RobotRay": "robot", "BeaconRay": "beacon"}
"""Tables of rays that end at a kind of object; few rays do."""

IN_SELF = ("can_charge", "has_battery", "battery_level", "battery_capacity")
"""Columns of ``Sensor`` from a sensor's record ``self``."""


def fillings(table: str, moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Return the statements that fill a table with the rows of a moment.

    Args:
        table: ``Sensor``, ``Memory`` or one of `KINDS`.
        moment: The moment.
        columns: The columns to fill besides ``id``, in alphabetical order; those of memory fields
            with the field, as in ``field_0=seen``.

    Raises:
        TypeError, KeyError, AttributeError, ValueError: Sensors don't have the usual shape.
    """
    return _FILLINGS[table](moment, columns)


def whole_ray(moment: Moment, number: int | None) -> str | None:
    """Return the JSON text of a ray of a moment.

    Args:
        moment: The moment.
        number: Its ``id`` in the tables; None if there is no ray.

    Raises:
        IndexError, KeyError, TypeError: There is no such ray.
    """
    if number is None:
        return None
    robot, ray = divmod(number, RAYS)
    return to_input(moment.sensors[robot]["sensor"]["radar"][ray])


def _sensors(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    values = [_SENSOR_VALUES[column] for column in columns]
    rows = [
        (number, *[value(row) for value in values]) for number, row in enumerate(moment.sensors)
    ]
    return (Filling(insert_into("Sensor", columns), rows),)


def _rays_of_kind(table: str, moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    pick = _picked(columns)
    rows: list[Sequence[Any]] = []
    for first, rays in enumerate(moment.rays_to(KINDS[table])):
        if rays and rays[-1][0] >= RAYS:
            raise ValueError("a radar of too many rays")
        start = first * RAYS
        rows += [(start + number, *pick(ray)) for number, ray in rays]
    return in_blocks(table, columns, rows)


_FILLINGS: dict[str, Callable[[Moment, tuple[str, ...]], Sequence[Filling]]] = {
    "Sensor": _sensors,
    "Memory": memories,
    **{table: partial(_rays_of_kind, table) for table in KINDS},
}


@cache
def _picked(columns: tuple[str, ...]) -> Callable[[Mapping[str, Any]], Sequence[Any]]:
    """Return the function that reads the columns from a ray."""
    if columns and columns[-1] == "value":
        pick = _picked(columns[:-1])
        return lambda ray: (*pick(ray), to_input(ray))
    if len(columns) > 1:
        return itemgetter(*columns)
    return lambda ray: [ray[column] for column in columns]


def _in_sensor(name: str) -> Callable[[SensorRow], Any]:
    return lambda row: row["sensor"].get(name)


def _in_self(name: str) -> Callable[[SensorRow], Any]:
    return lambda row: row["sensor"]["self"].get(name)


_SENSOR_VALUES: dict[str, Callable[[SensorRow], Any]] = {
    "robot_name": itemgetter("robot_name"),
    "sensor": lambda row: to_input(row["sensor"]),
    **{
        name: _in_sensor(name)
        for name in ("forward_distance", "forward_object", "forward_label", "clock")
    },
    **{name: _in_self(name) for name in IN_SELF},
}
