"""Limits for programs, and the sizes of values as Python objects.

JSON text tells little about sizes: an empty record has two characters and takes 64 bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

from logical_robots_tui.values import Value

_MIN_WEIGHT = 8_000  # also for one of a thousand robots


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits for programs.

    A step is one of SQLite's virtual machine, the same on every machine; a call of one of our
    functions counts 10, plus one per character of its arguments and result. Seconds are
    processor seconds; `*_weight` and `aggregate_bytes` are bytes of Python objects.

    Attributes:
        compile_bytes: Address space of the compile process.
        think_steps: For all robots in one tick.
        think_seconds: For a think that does much in few steps. One that it ends is marked as
            unreliable, because another machine may differ.
        query_steps, query_seconds: For one query of the inspector.
        mind_bytes: SQLite's memory in this process, for all minds together. The smallest value
            that a process has seen applies, because SQLite never raises it again.
        aggregate_bytes: For all aggregates of one evaluation or query at a time.
        value_bytes: The largest text, list or record during a think, as SQLite stores it.
        think_rows: The most rows of `Robot` in one evaluation.
        rows: The most rows that a query of the inspector shows.
        result_bytes: The most text in the result of one evaluation or query.
        memory_bytes: The largest memory of one robot, as JSON in UTF-8.
        memory_weight, memories_weight: For one robot's memory; for all, in equal shares.
        think_weight: For all rows of one think or query.
        depth: The deepest nesting of records and lists in a result.
    """

    compile_seconds: float = 30.0
    compile_bytes: int = 1024**3
    program_characters: int = 200_000
    think_steps: int = 100_000_000
    think_seconds: float = 30.0
    query_steps: int = 200_000_000
    query_seconds: float = 30.0
    mind_bytes: int = 160 * 1024**2
    aggregate_bytes: int = 96 * 1024**2
    value_bytes: int = 2_000_000
    think_rows: int = 10_000
    rows: int = 1_000
    result_bytes: int = 8_000_000
    memory_bytes: int = 1_000_000
    memory_weight: int = 4_000_000
    memories_weight: int = 48_000_000
    think_weight: int = 96_000_000
    depth: int = 100

    def weight_of_each(self, robots: int) -> int:
        """Return the bytes that each robot's memory may take as objects, by number of robots."""
        part = self.memories_weight // max(robots, 1)
        return min(self.memory_weight, max(part, _MIN_WEIGHT))

    def __post_init__(self) -> None:
        for field in fields(self):
            if getattr(self, field.name) < 0:
                raise ValueError(f"{field.name} can't be negative")


MAX_CHARACTER_WEIGHT = 44
"""Upper bound for the bytes of objects per character of JSON text."""

_RECORD, _FIELD = 184, 28  # CPython's dict: its least size, and the size of a field
_LIST, _ITEM = 56, 8
_TEXT = 50
_NUMBER = 32
_ROW, _COLUMN = 400, 64  # a row, and the same as a record of its columns


def weight_of(value: Value, limit: int) -> int:
    """Return the bytes that a value takes as objects, or any number above `limit`."""
    weight = 0
    pending: list[Value] = [value]
    while pending and weight <= limit:
        value = pending.pop()
        if isinstance(value, dict):
            weight += _RECORD + _FIELD * len(value) if value else 64
            weight += sum([_TEXT + len(name) for name in value])
            pending += value.values()
        elif isinstance(value, list):
            weight += _LIST + _ITEM * len(value)
            pending += value
        elif isinstance(value, str):
            weight += _TEXT + len(value) * (1 if value.isascii() else 4)
        else:
            weight += _NUMBER
    return weight


def weight_of_text(text: str) -> int:
    """Return an upper bound for the bytes that JSON text takes as objects."""
    parts = text.count(",") * (_ITEM + _FIELD + _NUMBER) + text.count('"') * _TEXT
    records = text.count("{") * (_RECORD + _FIELD + _NUMBER)
    lists = text.count("[") * (_LIST + _ITEM + _NUMBER)
    return len(text) * (1 if text.isascii() else 4) + parts + records + lists


def weight_of_row(row: Sequence[object]) -> int:
    """Return an upper bound for the bytes that a row of SQLite's values takes as objects."""
    return _ROW + _COLUMN * len(row) + sum([weight_of_scalar(v) for v in row if v.__class__ is str])


def weight_of_scalar(value: object) -> int:
    if not isinstance(value, str):
        return _NUMBER
    if value[:1] in ("{", "["):
        return _TEXT + weight_of_text(value)
    return _TEXT + len(value) * (1 if value.isascii() else 4)
