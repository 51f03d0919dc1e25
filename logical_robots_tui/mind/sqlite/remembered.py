"""Rows of memories for the tables of tuned queries: fields, and records in their lists."""

from __future__ import annotations

import re
from functools import cache
from math import isfinite
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.layouts import (
    ITEMS,
    MEMORY_FIELDS,
    Filling,
    in_blocks,
    insert_into,
)
from logical_robots_tui.mind.sqlite.stored import to_input, to_sql

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Database
    from logical_robots_tui.mind.sqlite.moment import Moment

_MOST_CHARACTERS = 16_000_000  # in all rows: a memory has one for each robot that sees it


def memories(moment: Moment, columns: tuple[str, ...]) -> Sequence[Filling]:
    """Return the rows that fill ``Memory``.

    Raises:
        ValueError: A memory is a text that may contain a record, or all rows are too large.
    """
    insert, fields = _memory_columns(columns)
    if not fields:
        return (Filling(insert, moment.memories),)
    stored = {
        name: [_stored(_found(field, memory)) if field else to_sql(memory) for field in fields]
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
    """Return the statement that inserts a memory, and the fields in it; "" for the whole memory."""
    pairs = [column.partition("=") for column in columns if column != "robot_name"]
    names = ("robot_name", *(name for name, _, _ in pairs))
    return insert_into("Memory", names), tuple(field for _, _, field in pairs)


def _found(field: str, memory: Any) -> Any:
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


def _stored(value: Any) -> Any:
    """Return a part of a memory as SQLite would read it from text."""
    kind = value.__class__
    if kind is float:
        return value if isfinite(value) else None
    return to_input(value) if kind in _NESTED else value


_NESTED = frozenset({dict, list})


def spelled_item(column: str, place: int, field: str, key: str) -> str:
    """Return the name of a column of ``Item`` with its content."""
    return f"{column}={place}:{field}.{key}"


_SPELLED = re.compile(r"(\w+)=(\d+):(\w+)\.(\w+)")


def items(
    moment: Moment, columns: tuple[str, ...], there: Mapping[int, list[Any]]
) -> tuple[Sequence[Filling], dict[int, list[Any]]]:
    """Return the rows to add to ``Item``: records of lists, with null for missing fields.

    Args:
        moment: The moment.
        columns: In the form of `spelled_item`.
        there: Lists whose records stay in the table, by the number of the first record.

    Returns:
        The rows to add, and all lists whose records are in the table then, by the number of the
        first.

    Raises:
        ValueError: A value is not a list of records, or there are too many.
    """
    found: list[Filling] = []
    now: dict[int, list[Any]] = {}
    for place, field, wanted, keys in _item_columns(columns):
        named = {name: _list_in(field, memory) for name, memory in moment.remembered.items()}
        values: dict[str, Sequence[Sequence[Any]]] = {}
        rows: list[Sequence[Any]] = []
        count = 0
        for number, name in moment.memories:
            listed = named.get(name)
            if not listed:
                continue
            count += len(listed)
            if count > ITEMS:
                raise ValueError("too many records")
            start = (number * len(MEMORY_FIELDS) + place) * ITEMS
            now[start] = listed
            if there.get(start) is listed:
                continue
            if name not in values:
                values[name] = _records(listed, keys)
            rows += [(start + n, *item) for n, item in enumerate(values[name])]
        found += in_blocks("Item", wanted, rows)
    return found, now


@cache
def _item_columns(
    columns: tuple[str, ...],
) -> list[tuple[int, str, tuple[str, ...], tuple[str, ...]]]:
    """Return for each list its place, its field, and its columns of ``Item`` with their content."""
    lists: dict[tuple[int, str], list[tuple[str, str]]] = {}
    for spelled in columns:
        column, place, field, key = _SPELLED.findall(spelled)[0]
        lists.setdefault((int(place), field), []).append((column, key))
    return [
        (place, field, tuple(column for column, _ in pairs), tuple(key for _, key in pairs))
        for (place, field), pairs in lists.items()
    ]


def _list_in(field: str, memory: Any) -> list[Any] | None:
    """Return a list in a memory.

    Raises:
        ValueError: It is not a list.
    """
    found = _found(field, memory)
    if found is not None and found.__class__ is not list:
        raise ValueError("not a list")
    return found


def _records(found: list[Any], keys: tuple[str, ...]) -> Sequence[Sequence[Any]]:
    """Return the values of some fields of each record in a list.

    Raises:
        ValueError: It contains texts, which only SQLite can interpret.
    """
    if str in map(type, found):
        raise ValueError("not a list of records")
    nothing = [None] * len(keys)
    return [
        [_stored(item.get(key)) for key in keys] if item.__class__ is dict else nothing
        for item in found
    ]


class Lists:
    """The content of the table ``Item`` of a database.

    Args:
        frozen: Whether nobody changes a memory; then a list that is the same object as before has
            the same records.
    """

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._columns: tuple[str, ...] | None = ()  # None: unknown
        self._there: dict[int, list[Any]] = {}

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Update the records of lists that changed.

        Args:
            database: The same as before, unless `forget` was called.
            moment: The moment.
            columns: In the form of `spelled_item`.

        Raises:
            Exception: The exceptions of `items` and `Database.fill`.
        """
        there = self._there if self._frozen and columns == self._columns else {}
        fillings, now = items(moment, columns, there)
        gone: list[tuple[int, int]] | None = None
        if there:
            gone = [(n, n + ITEMS - 1) for n, listed in there.items() if now.get(n) is not listed]
        elif self._columns is not None and not self._there:
            gone = []
        if fillings or gone is None or gone:
            self._columns = None
            database.fill("Item", fillings, gone)
        self._columns, self._there = columns, now

    def forget(self) -> None:
        """Start again with an empty table."""
        self._columns, self._there = (), {}
