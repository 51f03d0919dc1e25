"""Rows for the tables of tuned queries, from the sensors and memories of a moment."""

from __future__ import annotations

from functools import cache, partial
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.layouts import KINDS, RAYS, Filling, in_blocks, insert_into
from logical_robots_tui.mind.sqlite.remembered import memories
from logical_robots_tui.mind.sqlite.stored import to_input
from logical_robots_tui.schema import SELF, SENSOR

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Database
    from logical_robots_tui.mind.sqlite.moment import Moment
    from logical_robots_tui.values import SensorRow


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
    **{name: _in_sensor(name) for name in SENSOR.scalars},
    **{name: _in_self(name) for name in SELF.scalars},
}


_MOST_VALUES = 900  # per statement


class Radars:
    """The content of the table ``Ray`` of a database.

    Args:
        frozen: Whether nobody changes a sensor; then a radar that is the same object as before has
            the same rays, as for a stationary robot.
    """

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._numbers: tuple[str, int] | None = None  # the same where rows have the same numbers
        self._there: list[list[Any]] = []

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Replace the rays of radars that changed.

        Args:
            database: The same as before, unless `forget` was called.
            moment: The moment.
            columns: The columns to fill besides ``id``, in alphabetical order.

        Raises:
            ValueError: The radars don't all have as many rays as the first, or have too many.
            Exception: The exceptions of `Database.fill`, or a ray has another shape.
        """
        radars = [row["sensor"]["radar"] for row in moment.sensors]
        usual = len(radars[0])
        values = usual * (1 + len(columns))
        if any(len(radar) != usual for radar in radars) or not 0 < values < _MOST_VALUES:
            raise ValueError("radars of different size")
        insert, in_ray = _insert_rays(columns, usual)
        numbers = insert, len(radars)
        is_same = numbers == self._numbers
        there = self._there if is_same and self._frozen else [None] * len(radars)
        rows = []
        for number, (radar, before) in enumerate(zip(radars, there, strict=True)):
            if radar is not before:
                row: list[Any] = [number * RAYS]
                for value in in_ray:
                    row += map(value, radar)
                rows.append(row)
        self._numbers = None
        if rows:
            database.fill("Ray", (Filling(insert, rows),), () if is_same else None)
        self._numbers, self._there = numbers, radars

    def forget(self) -> None:
        """Start again with an empty table."""
        self._numbers, self._there = None, []


@cache
def _insert_rays(
    columns: tuple[str, ...], rays: int
) -> tuple[str, Sequence[Callable[[Mapping[str, Any]], Any]]]:
    """Return a statement for one radar, and the function that reads the columns from a ray.

    The statement takes the first number, then the values column by column.
    """
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    insert = f"REPLACE INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
    return insert, [to_input if name == "value" else itemgetter(name) for name in columns]
