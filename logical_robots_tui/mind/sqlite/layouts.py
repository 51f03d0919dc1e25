"""The plain and tuned tables of a mind's databases, and rows for the tuned ones."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import isfinite
from operator import itemgetter
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.sqlite.stored import to_input, to_sql
from logical_robots_tui.schema import BEACON, RAY, ROBOT, SELF, SENSOR
from logical_robots_tui.values import SensorRow

if TYPE_CHECKING:
    from logical_robots_tui.mind.sqlite.inputs import Inputs

TABLES = frozenset({"sensor", "memory", "json_each"})
"""Tables that may be read, in lower case."""

RAYS = 1000
"""Most rays of a radar; the rays of sensor row n have numbers from n * RAYS."""

WHOLE_RAY = "t_0_whole_ray"
"""The SQL function that returns the JSON text of a ray by its number."""

KINDS = {"RobotRay": ROBOT, "BeaconRay": BEACON}
"""Tables of rays that end at a kind of object; few rays do."""

MEMORY_FIELDS = tuple(f"field_{number}" for number in range(24))
"""Columns of ``Memory`` with one field each; each program chooses which."""

ITEM_FIELDS = tuple(f"item_{number}" for number in range(16))
"""Columns of ``Item`` with one field each of the records in lists of memories."""

ITEMS = 100_000
"""Most records of a list; those of field f of memory row n, of F fields, have numbers from
(n * F + f) * ITEMS."""


@dataclass(frozen=True, slots=True)
class SqlLayout:
    """The SQL that creates tables, and the lower-case names that queries may read."""

    script: str
    readable: frozenset[str]


PLAIN_LAYOUT = SqlLayout(
    "CREATE TABLE Sensor(robot_name, sensor); CREATE TABLE Memory(robot_name, memory);", TABLES
)
"""The tables as programs know them."""

COLUMNS_LAYOUT = SqlLayout(
    f"""
    CREATE TABLE Sensor(
        id INTEGER PRIMARY KEY, robot_name, sensor, {", ".join(SENSOR.scalars + SELF.scalars)}
    );
    CREATE TABLE Memory(id INTEGER PRIMARY KEY, robot_name, memory, {", ".join(MEMORY_FIELDS)});
    CREATE TABLE Item(id INTEGER PRIMARY KEY, {", ".join(ITEM_FIELDS)});
    CREATE TABLE Ray(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
    CREATE TABLE RobotRay(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
    CREATE TABLE BeaconRay(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
    PRAGMA automatic_index = OFF;
    """,
    TABLES | {"item", "ray", "robotray", "beaconray"},
)
"""Numbered rows with sensor fields and radar rays as columns, and copies of the rays that end at
robots and beacons. For few robots: creating an index would take longer than it saves."""

LISTS_LAYOUT = SqlLayout(
    f"{COLUMNS_LAYOUT.script} PRAGMA automatic_index = ON;", COLUMNS_LAYOUT.readable
)
"""For queries that decide themselves where few robots need no index."""

CROWD_LAYOUT = SqlLayout(
    LISTS_LAYOUT.script
    + """
    CREATE INDEX SensorByName ON Sensor(robot_name);
    CREATE INDEX MemoryByName ON Memory(robot_name);
    """,
    COLUMNS_LAYOUT.readable,
)
"""For many robots."""


Insertion: TypeAlias = tuple[str, Sequence[Sequence[Any]]]
"""A statement that inserts or replaces a row, and the values for each execution."""


@cache
def _insert_into(table: str, columns: tuple[str, ...]) -> str:
    """Return a statement that inserts or replaces a row; parameters are ``id`` and the columns."""
    values = ", ".join("?" * (len(columns) + 1))
    return f"REPLACE INTO {table}({', '.join(('id', *columns))}) VALUES ({values})"  # noqa: S608 - our own names


def insertions(table: str, inputs: Inputs, columns: tuple[str, ...]) -> Sequence[Insertion]:
    """Return the statements that fill a table with a mind's inputs.

    Args:
        table: ``Sensor``, ``Memory``, ``Item`` or one of `KINDS`.
        inputs: The sensors and memories.
        columns: The columns to fill besides ``id``, in alphabetical order; those of memory fields
            with the field, as in ``field_0=seen``, and those of ``Item`` from `item_column_name`.

    Raises:
        TypeError, KeyError, AttributeError, ValueError: Sensors or memories don't have the usual
            shape or size.
    """
    return _INSERTIONS[table](inputs, columns)


def _sensors(inputs: Inputs, columns: tuple[str, ...]) -> Sequence[Insertion]:
    readers = [_SENSOR_VALUES[column] for column in columns]
    rows = [(n, *[read(row) for read in readers]) for n, row in enumerate(inputs.sensor_rows)]
    return ((_insert_into("Sensor", columns), rows),)


def _rays_of_kind(table: str, inputs: Inputs, columns: tuple[str, ...]) -> Sequence[Insertion]:
    read_ray = _ray_reader(columns)
    rows: list[Sequence[Any]] = []
    for row, rays in enumerate(inputs.rays_to(KINDS[table])):
        if rays and rays[-1][0] >= RAYS:
            raise ValueError("a radar of too many rays")
        start = row * RAYS
        rows += [(start + number, *read_ray(ray)) for number, ray in rays]
    return ((_insert_into(table, columns), rows),)


_MOST_CHARACTERS = 16_000_000  # in all rows: a memory has one for each robot that sees it


def _memories(inputs: Inputs, columns: tuple[str, ...]) -> Sequence[Insertion]:
    """Return the rows that fill ``Memory``.

    Raises:
        ValueError: A memory is a text that may contain a record, or all rows are too large.
    """
    insert, fields = _memory_columns(columns)
    if not fields:
        return ((insert, inputs.memory_rows),)
    field_values = {
        name: [
            _column_value(_field_of(field, memory)) if field else to_sql(memory) for field in fields
        ]
        for name, memory in inputs.memory_values.items()
    }
    sizes = {
        name: sum([len(value) for value in values if value.__class__ is str])
        for name, values in field_values.items()
    }
    upper_bound = max(sizes.values(), default=0) * len(inputs.memory_rows)
    if upper_bound > _MOST_CHARACTERS and (
        sum([sizes.get(name, 0) for _, name in inputs.memory_rows]) > _MOST_CHARACTERS
    ):
        raise ValueError("too many characters")
    nulls = [None] * len(fields)
    rows = [(number, name, *field_values.get(name, nulls)) for number, name in inputs.memory_rows]
    return ((insert, rows),)


@cache
def _memory_columns(columns: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    pairs = [column.partition("=") for column in columns if column != "robot_name"]
    names = ("robot_name", *(name for name, _, _ in pairs))
    return _insert_into("Memory", names), tuple(field for _, _, field in pairs)


def _field_of(field: str, memory: Any) -> Any:
    """Return a field of a memory.

    Raises:
        ValueError: The memory is a text that may contain a record; only SQLite can tell.
    """
    kind = memory.__class__
    if kind is dict:
        return memory.get(field)
    if kind not in _NO_RECORDS and not (kind is str and memory.lstrip()[:1] != "{"):
        raise ValueError("a text that may be a record")
    return None


_NO_RECORDS = frozenset({type(None), bool, int, float, list})


def _column_value(value: Any) -> Any:
    """Convert a part of a memory as SQLite would read it from text."""
    kind = value.__class__
    if kind is float:
        return value if isfinite(value) else None
    return to_input(value) if kind in _NESTED else value


_NESTED = frozenset({dict, list})


def item_column_name(column: str, list_number: int, field: str, key: str) -> str:
    """Return the name of a column of ``Item`` with its content."""
    return f"{column}={list_number}:{field}.{key}"


_LIST_OR_NONE = frozenset({list, type(None)})
_ITEM_COLUMN = re.compile(r"(\w+)=(\d+):(\w+)\.(\w+)")


def _items(inputs: Inputs, columns: tuple[str, ...]) -> Sequence[Insertion]:
    """Return the rows that fill ``Item``: records of lists, with null for missing fields.

    Raises:
        ValueError: A value is not a list of records, or there are too many.
    """
    item_insertions: list[Insertion] = []
    for list_number, field, insert, keys in _item_columns(columns):
        lists = {name: _field_of(field, memory) for name, memory in inputs.memory_values.items()}
        if not {*map(type, lists.values())} <= _LIST_OR_NONE:
            raise ValueError("not a list")
        records = {name: _records(items, keys) for name, items in lists.items() if items}
        rows: list[Sequence[Any]] = []
        for number, name in inputs.memory_rows:
            start = (number * len(MEMORY_FIELDS) + list_number) * ITEMS
            rows += [(start + n, *item) for n, item in enumerate(records.get(name, ()))]
            if len(rows) > ITEMS:
                raise ValueError("too many records")
        item_insertions.append((insert, rows))
    return item_insertions


@cache
def _item_columns(columns: tuple[str, ...]) -> list[tuple[int, str, str, tuple[str, ...]]]:
    """Return each list's number, field, insert statement and keys."""
    lists: dict[tuple[int, str], list[tuple[str, str]]] = {}
    for column_name in columns:
        column, list_number, field, key = _ITEM_COLUMN.findall(column_name)[0]
        lists.setdefault((int(list_number), field), []).append((column, key))
    return [
        (list_number, field, _insert_into("Item", tuple(names)), tuple(keys))
        for (list_number, field), pairs in lists.items()
        for names, keys in (zip(*pairs, strict=True),)
    ]


def _records(items: list[Any], keys: tuple[str, ...]) -> Sequence[Sequence[Any]]:
    """Return field values of records; ValueError for texts, which only SQLite can interpret."""
    if str in map(type, items):
        raise ValueError("not a list of records")
    nulls = [None] * len(keys)
    return [
        [_column_value(item.get(key)) for key in keys] if item.__class__ is dict else nulls
        for item in items
    ]


_INSERTIONS: dict[str, Callable[[Inputs, tuple[str, ...]], Sequence[Insertion]]] = {
    "Sensor": _sensors,
    "Memory": _memories,
    "Item": _items,
    **{table: partial(_rays_of_kind, table) for table in KINDS},
}


@cache
def _ray_reader(columns: tuple[str, ...]) -> Callable[[Mapping[str, Any]], Sequence[Any]]:
    """Return the function that reads the columns from a ray."""
    if columns and columns[-1] == "value":
        read_ray = _ray_reader(columns[:-1])
        return lambda ray: (*read_ray(ray), to_input(ray))
    if len(columns) > 1:
        return itemgetter(*columns)
    return lambda ray: [ray[column] for column in columns]


def _scalar(name: str) -> Callable[[SensorRow], Any]:
    if name in SELF.scalars:
        return lambda row: row["sensor"]["self"].get(name)
    return lambda row: row["sensor"].get(name)


_SENSOR_VALUES: dict[str, Callable[[SensorRow], Any]] = {
    "robot_name": itemgetter("robot_name"),
    "sensor": lambda row: to_input(row["sensor"]),
    **{name: _scalar(name) for name in (*SENSOR.scalars, *SELF.scalars)},
}
