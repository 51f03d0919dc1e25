"""A moment in the tables of a database, and queries of what a robot sees of it."""

from __future__ import annotations

from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.database import (
    COLUMNS_LAYOUT,
    CROWD_LAYOUT,
    PLAIN_LAYOUT,
    Answer,
    Database,
)
from logical_robots_tui.mind.stored import to_input, to_sql

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.moment import Moment, View, Within
    from logical_robots_tui.mind.program import Tuned
    from logical_robots_tui.values import SensorRow

__all__ = ["RAYS", "PlainTables", "TunedTables", "UnfitError"]

RAYS = 1000
"""Most rays of a radar; those of sensor row n are numbered from n * RAYS on."""


class UnfitError(Exception):
    """Sensors that have not the shape that the columns are made for."""


class PlainTables:
    """``Sensor`` and ``Memory`` as programs know them, holding the rows of one view at a time.

    Args:
        limits: Bounds on memory, on values and on results.
    """

    def __init__(self, limits: Limits) -> None:
        self._database = Database(limits, PLAIN_LAYOUT)
        self._loaded: tuple[Moment, View] | None = None

    def ask(self, sql: str, moment: Moment, view: View, within: Within) -> Answer:
        """Rows of a query over what a view shows.

        Raises:
            Exception: As `Database.load` and `Database.ask` do.
        """
        if self._loaded is None or self._loaded[0] is not moment or self._loaded[1] is not view:
            self._loaded = None
            first, last = view.sensors
            sensors = moment.sensors[first : last + 1]
            first, last = view.memories
            memories = moment.memories[first : last + 1]
            self._database.load(
                [(row["robot_name"], to_input(row["sensor"])) for row in sensors],
                [(name, to_sql(memory)) for name, memory in memories],
            )
            self._loaded = (moment, view)
        return self._database.ask(
            sql, most=within.rows + 1, deadline=within.deadline, stop=within.stop
        )

    def close(self) -> None:
        """Free the database."""
        self._database.close()


class TunedTables:
    """All rows of a moment, with sensor fields and radar rays in columns of their own.

    Only columns that are asked for are filled.

    Args:
        limits: Bounds on memory, on values and on results.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._database = Database(limits, COLUMNS_LAYOUT)
        self._is_crowd = False
        self._moment: Moment | None = None
        self._filled: dict[str, frozenset[str]] = {}

    def ask_each(
        self, tuned: Tuned, moment: Moment, views: Iterable[View], within: Within
    ) -> Iterator[Answer]:
        """Rows of a query over what each of several views shows.

        Raises:
            UnfitError: The sensors have not the usual shape.
            Exception: As `Database.fill` and `Database.ask_each` do.
        """
        self._fill(moment, tuned.columns)
        bounds = ((*view.sensors, *view.memories)[: tuned.bounds] for view in views)
        return self._database.ask_each(
            tuned.sql, bounds, most=within.rows + 1, deadline=within.deadline, stop=within.stop
        )

    def close(self) -> None:
        """Free the database."""
        self._database.close()

    def _fill(self, moment: Moment, wanted: Mapping[str, Sequence[str]]) -> None:
        if self._moment is not moment:
            if (len(moment.sensors) >= _CROWD) != self._is_crowd:
                self._change_size()
            self._forget_all_but_names(moment)
            self._moment = moment
        for table, names in wanted.items():
            filled = self._filled.get(table)
            if filled is not None and filled.issuperset(names):
                continue
            columns = tuple(sorted({*names, *(filled or ())}))
            self._filled.pop(table, None)
            try:
                self._database.fill(table, *_FILLERS[table](moment, columns))
            except (TypeError, KeyError, AttributeError, OverflowError, ValueError) as error:
                raise UnfitError(str(error)) from None
            self._filled[table] = frozenset(columns)

    def _change_size(self) -> None:
        """Begin anew with queries prepared for few robots, or for many."""
        self._is_crowd = not self._is_crowd
        self._database.close()
        layout = CROWD_LAYOUT if self._is_crowd else COLUMNS_LAYOUT
        self._database = Database(self._limits, layout)
        self._moment = None
        self._filled = {}

    def _forget_all_but_names(self, moment: Moment) -> None:
        """A new moment has other rows; but where only names are read, they often are the same."""
        before = self._moment
        same = before is not None and (
            [row["robot_name"] for row in before.sensors]
            == [row["robot_name"] for row in moment.sensors]
        )
        names = frozenset({"robot_name"})
        same_sensors = same and self._filled.get("Sensor") == names
        self._filled = {"Sensor": names} if same_sensors else {}


def _sensors(moment: Moment, columns: tuple[str, ...]) -> tuple[str, Iterable[Sequence[Any]]]:
    values = [_SENSOR_VALUES[column] for column in columns]
    rows = (
        (number, *(value(row) for value in values)) for number, row in enumerate(moment.sensors)
    )
    return _insert("Sensor", columns), rows


def _memories(moment: Moment, columns: tuple[str, ...]) -> tuple[str, Iterable[Sequence[Any]]]:
    rows: Iterable[Sequence[Any]]
    if "memory" in columns:
        rows = [(n, to_sql(memory), name) for n, (name, memory) in enumerate(moment.memories)]
        return _insert("Memory", ("memory", "robot_name")), rows
    rows = [(number, name) for number, (name, _) in enumerate(moment.memories)]
    return _insert("Memory", ("robot_name",)), rows


def _rays(moment: Moment, columns: tuple[str, ...]) -> tuple[str, Iterable[Sequence[Any]]]:
    """All rays: one statement a radar where each has as many rays as the first."""
    radars = [row["sensor"]["radar"] for row in moment.sensors]
    usual = len(radars[0])
    if any(len(radar) != usual for radar in radars) or not 0 < usual * len(columns) < _MOST_VALUES:
        raise ValueError("radars of different size")
    return _insert_rays(columns, usual), _flat_rays(radars, columns)


def _flat_rays(
    radars: Iterable[Sequence[Mapping[str, Any]]], columns: tuple[str, ...]
) -> Iterator[list[Any]]:
    fields = [column for column in columns if column != "value"]
    pick: Callable[[Mapping[str, Any]], tuple[Any, ...]]
    pick = itemgetter(*fields) if len(fields) > 1 else lambda ray: tuple(ray[f] for f in fields)
    for number, radar in enumerate(radars):
        values: list[Any] = [number * RAYS]
        for ray in radar:
            values += pick(ray)
            if len(fields) < len(columns):
                values.append(to_input(ray))
        yield values


_MOST_VALUES = 900  # of one statement

_CROWD = 32  # robots from which on it pays that SQLite makes indexes of its own

_FILLERS = {"Sensor": _sensors, "Memory": _memories, "Ray": _rays}


def _in_sensor(name: str) -> Callable[[SensorRow], Any]:
    return lambda row: row["sensor"].get(name)


def _in_self(name: str) -> Callable[[SensorRow], Any]:
    return lambda row: row["sensor"]["self"].get(name)


_SENSOR_VALUES: dict[str, Callable[[SensorRow], Any]] = {
    "robot_name": lambda row: row["robot_name"],
    "sensor": lambda row: to_input(row["sensor"]),
    **{
        name: _in_sensor(name)
        for name in ("forward_distance", "forward_object", "forward_label", "clock")
    },
    **{
        name: _in_self(name)
        for name in ("can_charge", "has_battery", "battery_level", "battery_capacity")
    },
}


@cache
def _insert(table: str, columns: tuple[str, ...]) -> str:
    names = ", ".join(("id", *columns))
    values = ", ".join("?" * (len(columns) + 1))
    return f"INSERT INTO {table}({names}) VALUES ({values})"  # noqa: S608 - our own names


@cache
def _insert_rays(columns: tuple[str, ...], rays: int) -> str:
    """A statement for one radar: its first number, then the columns of each ray."""
    ordered = (*(c for c in columns if c != "value"), *(c for c in columns if c == "value"))
    width = len(ordered)
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{ray * width + i + 2}" for i in range(width))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *ordered))
    values = ", ".join(f"({row})" for row in rows)
    return f"INSERT INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
