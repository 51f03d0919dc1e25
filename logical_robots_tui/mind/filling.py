"""Rows for the tables of tuned queries, out of the sensors and memories of a moment."""

from __future__ import annotations

import re
from functools import cache, partial
from itertools import chain
from math import isfinite
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from logical_robots_tui.mind.stored import to_input, to_sql

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.mind.moment import Moment
    from logical_robots_tui.values import SensorRow

__all__ = [
    "IN_SELF",
    "ITEMS",
    "ITEM_FIELDS",
    "KINDS",
    "MEMORY_FIELDS",
    "RAYS",
    "Filling",
    "fillings",
    "spelled_item",
]

RAYS = 1000
"""Most rays of a radar; those of sensor row n are numbered from n * RAYS on."""

KINDS = {"RobotRay": "robot", "BeaconRay": "beacon"}
"""Tables of the rays that end at a kind of thing, which few do."""

IN_SELF = ("can_charge", "has_battery", "battery_level", "battery_capacity")
"""Columns of ``Sensor`` that come from the record ``self`` of a sensor."""

MEMORY_FIELDS = tuple(f"field_{number}" for number in range(24))
"""Columns of ``Memory`` that hold a field each; which, a program says for itself."""

ITEM_FIELDS = tuple(f"item_{number}" for number in range(16))
"""Columns of ``Item``, which holds records of lists in memories: a field of these each."""

ITEMS = 100_000
"""Most records of a list; those of field f of memory row n, of F fields, are numbered from
(n * F + f) * ITEMS on."""

_MOST_VALUES = 900  # of one statement

_AT_ONCE = 16  # rows that are inserted with one statement; each fewer is a statement of its own


class Filling(NamedTuple):
    """What goes into a table.

    Attributes:
        insert: A statement that inserts one of the items.
        items: Its values, each time.
    """

    insert: str
    items: Sequence[Sequence[Any]]


def fillings(table: str, moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """What fills a table with the rows of a moment.

    Args:
        table: ``Sensor``, ``Memory``, ``Item``, ``Ray`` or one of `KINDS`.
        moment: Where the rows come from.
        columns: Which columns to fill beside ``id``, in alphabetical order; those of fields of
            memories with the field, as in ``field_0=seen``, and all of ``Item`` as `spelled_item`
            has them.

    Raises:
        TypeError, KeyError, AttributeError, ValueError: Sensors have not the usual shape.
    """
    return _FILLINGS[table](moment, columns)


def _sensors(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    values = [_SENSOR_VALUES[column] for column in columns]
    rows = [
        (number, *[value(row) for value in values]) for number, row in enumerate(moment.sensors)
    ]
    return (Filling(_insert("Sensor", columns), rows),)


def _memories(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """All memories. A column of a field is written with the field, as in ``field_0=seen``."""
    insert, fields = _memory_columns(columns)
    if not fields:
        return (Filling(insert, moment.memories),)
    stored = {
        name: [_stored(_found(field, memory)) if field else to_sql(memory) for field in fields]
        for name, memory in moment.remembered.items()
    }
    nothing = [None] * len(fields)
    rows = [(number, name, *stored.get(name, nothing)) for number, name in moment.memories]
    return (Filling(insert, rows),)


@cache
def _memory_columns(columns: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """The statement that inserts a memory, and the fields in it; "" for the whole memory."""
    pairs = [column.partition("=") for column in columns if column != "robot_name"]
    names = ("robot_name", *(name for name, _, _ in pairs))
    return _insert("Memory", names), tuple(field for _, _, field in pairs)


def _found(field: str, memory: Any) -> Any:
    """A field of a memory.

    Raises:
        ValueError: Only SQLite can tell: the memory is a text that may spell a record.
    """
    if memory.__class__ is dict:
        return memory.get(field)
    if memory.__class__ is str and memory.lstrip()[:1] == "{":
        raise ValueError("a text that may spell a record")
    return None


def _stored(value: Any) -> Any:
    """A part of a memory as SQLite would find it in text."""
    kind = value.__class__
    if kind is float:
        return value if isfinite(value) else None
    return to_input(value) if kind in _NESTED else value


_NESTED = frozenset({dict, list})


def spelled_item(column: str, place: int, field: str, key: str) -> str:
    """A column of ``Item``, with what it holds.

    Args:
        column: Its name.
        place: The place of the list among `MEMORY_FIELDS`.
        field: The field of memories that is the list.
        key: The field of its records.
    """
    return f"{column}={place}:{field}.{key}"


_SPELLED = re.compile(r"(\w+)=(\d+):(\w+)\.(\w+)")


def _items(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Records in lists of memories, with null where there is no such field."""
    lists: dict[tuple[int, str], list[tuple[str, str]]] = {}
    for spelled in columns:
        column, place, field, key = _SPELLED.findall(spelled)[0]
        lists.setdefault((int(place), field), []).append((column, key))
    found: list[Filling] = []
    for (place, field), pairs in lists.items():
        keys = tuple(key for _, key in pairs)
        values = {
            name: _records(_found(field, memory), keys)
            for name, memory in moment.remembered.items()
        }
        rows: list[Sequence[Any]] = []
        for number, name in moment.memories:
            start = (number * len(MEMORY_FIELDS) + place) * ITEMS
            rows += [(start + n, *item) for n, item in enumerate(values.get(name, ()))]
        found += _in_blocks("Item", tuple(column for column, _ in pairs), rows)
    return found


def _records(items: Any, keys: tuple[str, ...]) -> Sequence[Sequence[Any]]:
    """The values of some fields of each record in a list.

    Raises:
        ValueError: It is no list, or too long, or holds texts: only SQLite can tell what they are.
    """
    if items is None:
        return ()
    if items.__class__ is not list or len(items) > ITEMS or str in map(type, items):
        raise ValueError("not a list of records")
    try:
        values = [*zip(*(map(itemgetter(key), items) for key in keys), strict=True)]
    except (KeyError, TypeError):
        values = []
    if not values or not all(map(_is_stored_as_it_is, zip(*values, strict=True))):
        nothing = [None] * len(keys)
        return [
            [_stored(item.get(key)) for key in keys] if item.__class__ is dict else nothing
            for item in items
        ]
    return values


def _is_stored_as_it_is(values: Sequence[Any]) -> bool:
    """Whether values, usually all numbers or all texts, need no look at each of them."""
    kinds = set(map(type, values))
    return (kinds == {float} and isfinite(sum(values))) or kinds == {str} or kinds == {int}


def _in_blocks(
    table: str, columns: tuple[str, ...], rows: Sequence[Sequence[Any]]
) -> Sequence[Filling]:
    """Rows for a table, many with one statement."""
    together = len(rows) // _AT_ONCE * _AT_ONCE
    whole = [[*chain.from_iterable(rows[i : i + _AT_ONCE])] for i in range(0, together, _AT_ONCE)]
    rest = [*chain.from_iterable(rows[together:])]
    return [
        Filling(_insert(table, columns, count), items)
        for count, items in ((_AT_ONCE, whole), (len(rows) - together, [rest]))
        if count and items
    ]


def _rays(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """All rays: one statement a radar, so each must have as many rays as the first."""
    radars = [row["sensor"]["radar"] for row in moment.sensors]
    usual = len(radars[0])
    if any(len(radar) != usual for radar in radars) or not 0 < usual * len(columns) < _MOST_VALUES:
        raise ValueError("radars of different size")
    items = []
    for first, radar in enumerate(radars):
        values: list[Any] = [first * RAYS]
        for column in columns:
            values += map(to_input if column == "value" else itemgetter(column), radar)
        items.append(values)
    return (Filling(_insert_rays(columns, usual), items),)


def _rays_of_kind(table: str, moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    pick = _picked(columns)
    rows: list[Sequence[Any]] = []
    for first, rays in enumerate(moment.rays_to(KINDS[table])):
        if rays and rays[-1][0] >= RAYS:
            raise ValueError("a radar of too many rays")
        start = first * RAYS
        rows += [(start + number, *pick(ray)) for number, ray in rays]
    return _in_blocks(table, columns, rows)


_FILLINGS: dict[str, Callable[[Moment, tuple[str, ...]], Sequence[Filling]]] = {
    "Sensor": _sensors,
    "Memory": _memories,
    "Item": _items,
    "Ray": _rays,
    **{table: partial(_rays_of_kind, table) for table in KINDS},
}


@cache
def _picked(columns: tuple[str, ...]) -> Callable[[Mapping[str, Any]], Sequence[Any]]:
    """What takes the columns out of a ray."""
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


@cache
def _insert(table: str, columns: tuple[str, ...], rows: int = 1) -> str:
    names = ", ".join(("id", *columns))
    row = ", ".join("?" * (len(columns) + 1))
    values = ", ".join([f"({row})"] * rows)
    return f"INSERT OR FAIL INTO {table}({names}) VALUES {values}"  # noqa: S608 - our own names


@cache
def _insert_rays(columns: tuple[str, ...], rays: int) -> str:
    """A statement for one radar: its first number, then column by column."""
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    return f"INSERT OR FAIL INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
