"""Rows for the tables of tuned queries, from the sensors and memories of a moment."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from math import isfinite
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from logical_robots_tui.mind.sqlite.layouts import ITEMS, KINDS, MEMORY_FIELDS, RAYS
from logical_robots_tui.mind.sqlite.stored import to_input, to_sql
from logical_robots_tui.schema import SELF, SENSOR
from logical_robots_tui.values import SensorRow

if TYPE_CHECKING:
    from logical_robots_tui.mind.sqlite.database import Database
    from logical_robots_tui.mind.sqlite.moment import Moment


class Filling(NamedTuple):
    """Rows for a table.

    Attributes:
        insert: A statement that inserts one of the items.
        items: The values of each execution.
    """

    insert: str
    items: Sequence[Sequence[Any]]


@cache
def insert_into(table: str, columns: tuple[str, ...]) -> str:
    """Return a statement that inserts or replaces a row; parameters are ``id`` and the columns."""
    values = ", ".join("?" * (len(columns) + 1))
    return f"REPLACE INTO {table}({', '.join(('id', *columns))}) VALUES ({values})"  # noqa: S608 - our own names


def fillings(table: str, moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Return the statements that fill a table with the rows of a moment.

    Args:
        table: ``Sensor``, ``Memory``, ``Item`` or one of `KINDS`.
        moment: The moment.
        columns: The columns to fill besides ``id``, in alphabetical order; those of memory fields
            with the field, as in ``field_0=seen``, and those of ``Item`` as `spell_item` gives
            them.

    Raises:
        TypeError, KeyError, AttributeError, ValueError: Sensors or memories don't have the usual
            shape or size.
    """
    return _FILLINGS[table](moment, columns)


def whole_ray(moment: Moment, number: int | None) -> str | None:
    """Return a ray as JSON; IndexError, KeyError or TypeError if there is none."""
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
    pick = _picker(columns)
    rows: list[Sequence[Any]] = []
    for first, rays in enumerate(moment.rays_to(KINDS[table])):
        if rays and rays[-1][0] >= RAYS:
            raise ValueError("a radar of too many rays")
        start = first * RAYS
        rows += [(start + number, *pick(ray)) for number, ray in rays]
    return (Filling(insert_into(table, columns), rows),)


_MOST_CHARACTERS = 16_000_000  # in all rows: a memory has one for each robot that sees it


def _memories(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Return the rows that fill ``Memory``.

    Raises:
        ValueError: A memory is a text that may contain a record, or all rows are too large.
    """
    insert, fields = _memory_columns(columns)
    if not fields:
        return (Filling(insert, moment.memories),)
    stored = {
        name: [
            _column_value(_field_of(field, memory)) if field else to_sql(memory) for field in fields
        ]
        for name, memory in moment.remembered.items()
    }
    sizes = {
        name: sum([len(value) for value in values if value.__class__ is str])
        for name, values in stored.items()
    }
    most = max(sizes.values(), default=0) * len(moment.memories)
    if most > _MOST_CHARACTERS and (
        sum([sizes.get(name, 0) for _, name in moment.memories]) > _MOST_CHARACTERS
    ):
        raise ValueError("too many characters")
    nothing = [None] * len(fields)
    rows = [(number, name, *stored.get(name, nothing)) for number, name in moment.memories]
    return (Filling(insert, rows),)


@cache
def _memory_columns(columns: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    pairs = [column.partition("=") for column in columns if column != "robot_name"]
    names = ("robot_name", *(name for name, _, _ in pairs))
    return insert_into("Memory", names), tuple(field for _, _, field in pairs)


def _field_of(field: str, memory: Any) -> Any:
    """Return a field of a memory.

    Raises:
        ValueError: The memory is a text that may contain a record; only SQLite can tell.
    """
    kind = memory.__class__
    if kind is dict:
        return memory.get(field)
    if kind not in _NO_RECORDS and not (kind is str and memory.lstrip()[:1] != "{"):
        raise ValueError("what may be a record")
    return None


_NO_RECORDS = frozenset({type(None), bool, int, float, list})


def _column_value(value: Any) -> Any:
    """Return a part of a memory as SQLite would read it from text."""
    kind = value.__class__
    if kind is float:
        return value if isfinite(value) else None
    return to_input(value) if kind in _NESTED else value


_NESTED = frozenset({dict, list})


def spell_item(column: str, place: int, field: str, key: str) -> str:
    """Return the name of a column of ``Item`` with its content."""
    return f"{column}={place}:{field}.{key}"


_SPELLED = re.compile(r"(\w+)=(\d+):(\w+)\.(\w+)")


def _items(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Return the rows that fill ``Item``: records of lists, with null for missing fields.

    Raises:
        ValueError: A value is not a list of records, or there are too many.
    """
    found: list[Filling] = []
    for place, field, insert, keys in _item_columns(columns):
        named = {name: _list_in(field, memory) for name, memory in moment.remembered.items()}
        records = {name: _records(listed, keys) for name, listed in named.items() if listed}
        rows: list[Sequence[Any]] = []
        for number, name in moment.memories:
            start = (number * len(MEMORY_FIELDS) + place) * ITEMS
            rows += [(start + n, *item) for n, item in enumerate(records.get(name, ()))]
            if len(rows) > ITEMS:
                raise ValueError("too many records")
        found.append(Filling(insert, rows))
    return found


@cache
def _item_columns(columns: tuple[str, ...]) -> list[tuple[int, str, str, tuple[str, ...]]]:
    """Return for each list its place, its field, the statement that inserts, and its keys."""
    lists: dict[tuple[int, str], list[tuple[str, str]]] = {}
    for spelled in columns:
        column, place, field, key = _SPELLED.findall(spelled)[0]
        lists.setdefault((int(place), field), []).append((column, key))
    return [
        (place, field, insert_into("Item", tuple(names)), tuple(keys))
        for (place, field), pairs in lists.items()
        for names, keys in (zip(*pairs, strict=True),)
    ]


def _list_in(field: str, memory: Any) -> list[Any] | None:
    """Return a list in a memory; raise ValueError for any other value."""
    found = _field_of(field, memory)
    if found is not None and found.__class__ is not list:
        raise ValueError("not a list")
    return found


def _records(found: list[Any], keys: tuple[str, ...]) -> Sequence[Sequence[Any]]:
    """Return field values of records; ValueError for texts, which only SQLite can interpret."""
    if str in map(type, found):
        raise ValueError("not a list of records")
    nothing = [None] * len(keys)
    return [
        [_column_value(item.get(key)) for key in keys] if item.__class__ is dict else nothing
        for item in found
    ]


_FILLINGS: dict[str, Callable[[Moment, tuple[str, ...]], Sequence[Filling]]] = {
    "Sensor": _sensors,
    "Memory": _memories,
    "Item": _items,
    **{table: partial(_rays_of_kind, table) for table in KINDS},
}


@cache
def _picker(columns: tuple[str, ...]) -> Callable[[Mapping[str, Any]], Sequence[Any]]:
    """Return the function that reads the columns from a ray."""
    if columns and columns[-1] == "value":
        pick = _picker(columns[:-1])
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
    """The table ``Ray``; if `frozen`, a radar that is the same object keeps its rays."""

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._numbers: tuple[str, int] | None = None  # the same where rows have the same numbers
        self._there: list[list[Any]] = []

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Replace the rays of changed radars; ValueError if their numbers of rays differ."""
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
            database.fill("Ray", (Filling(insert, rows),), clear=not is_same)
        self._numbers, self._there = numbers, radars

    def forget(self) -> None:
        self._numbers, self._there = None, []


@cache
def _insert_rays(
    columns: tuple[str, ...], rays: int
) -> tuple[str, Sequence[Callable[[Mapping[str, Any]], Any]]]:
    """Return a statement for a radar (first number, then values by column) and a ray's reader."""
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    insert = f"REPLACE INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
    return insert, [to_input if name == "value" else itemgetter(name) for name in columns]
