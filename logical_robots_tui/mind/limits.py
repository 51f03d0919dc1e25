"""Bounds on what a program may use, and how many bytes values take as objects.

Their text says little about that: an empty record has two characters and takes 64 bytes.
"""

from __future__ import annotations

import mmap
import resource
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = [
    "HEAVIEST_CHARACTER",
    "Limits",
    "check_room",
    "is_bounded",
    "weight_of",
    "weight_of_text",
]


_LEAST_WEIGHT = 8_000  # also for one of a thousand robots


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds on what a program may use; every one can be set.

    Attributes:
        compile_seconds: Longest compilation.
        compile_bytes: Address space of the process that compiles.
        program_characters: Longest program.
        think_steps: Longest thought of all robots together in one tick, in steps of SQLite's
            virtual machine; a call of a function of ours counts for 10, and each character that
            it is given or gives for one more. The same on every machine.
        think_seconds: A guard for whoever waits for a thought that does much in few steps: how long
            it may take while the process has a processor. What it ends is marked, because it may
            go otherwise elsewhere.
        query_steps: Longest query of the inspector, in the same steps.
        query_seconds: The guard of such a query.
        mind_bytes: Memory of SQLite in this process, for all minds together; the smallest value
            that a process has seen is the one that holds, because SQLite never raises it again.
        value_bytes: Largest single text, list or record while thinking, as SQLite stores it.
        think_rows: Most rows of `Robot` for one evaluation.
        rows: Most rows that a query of the inspector shows; the rest is left out.
        result_bytes: Most text in the result of one evaluation or one query.
        memory_bytes: Largest memory of one robot, as JSON in UTF-8.
        memory_weight: Largest memory of one robot, as the objects that it is made of.
        memories_weight: The same for all robots together; each has an equal part.
        think_weight: The same for all rows that one thought, or one query, gives.
        depth: How deep records and lists in a result may be nested.
    """

    compile_seconds: float = 30.0
    compile_bytes: int = 1024**3
    program_characters: int = 200_000
    think_steps: int = 100_000_000
    think_seconds: float = 30.0
    query_steps: int = 200_000_000
    query_seconds: float = 30.0
    mind_bytes: int = 160 * 1024**2
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
        """Bytes of objects that the memory of each of so many robots may be made of."""
        part = self.memories_weight // max(robots, 1)
        return min(self.memory_weight, max(part, _LEAST_WEIGHT))

    def __post_init__(self) -> None:
        for field in fields(self):
            if getattr(self, field.name) < 0:
                raise ValueError(f"{field.name} can't be negative")


HEAVIEST_CHARACTER = 44
"""Bytes that no value takes for each character of its JSON text."""

_RECORD, _FIELD = 184, 28  # CPython's dict, for its least size and for each field
_LIST, _ITEM = 56, 8
_TEXT = 50
_NUMBER = 32

_LONG = 10_000  # characters of a text from which on it is looked at closely


def weight_of(value: Value, most: int) -> int:
    """Bytes that a value takes as objects, or some number above `most`.

    Args:
        value: Any value.
        most: Where to stop counting.
    """
    weight = 0
    left: list[Value] = [value]
    while left and weight <= most:
        value = left.pop()
        if isinstance(value, dict):
            weight += _RECORD + _FIELD * len(value) if value else 64
            weight += sum([_TEXT + len(name) for name in value])
            left += value.values()
        elif isinstance(value, list):
            weight += _LIST + _ITEM * len(value)
            left += value
        elif isinstance(value, str):
            weight += _TEXT + len(value) * (1 if value.isascii() else 4)
        else:
            weight += _NUMBER
    return weight


def weight_of_text(text: str) -> int:
    """At least as many bytes as what JSON text stands for takes as objects."""
    if len(text) < _LONG:
        return len(text) * HEAVIEST_CHARACTER
    parts = text.count(",") * (_ITEM + _FIELD + _NUMBER) + text.count('"') * _TEXT
    opened = text.count("{") * (_RECORD + _FIELD + _NUMBER) + text.count("[") * (_LIST + _NUMBER)
    return len(text) * (1 if text.isascii() else 4) + parts + opened


def is_bounded() -> bool:
    """Whether the address space of the process has a bound, as that of a restricted game has.

    Without one the machine's memory is the bound, and nobody can ask how much is left of it.
    """
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def check_room(size: int) -> None:
    """See whether the process may still take so many bytes of address space.

    Not all that a thought needs fails softly where there is no room: orjson crashes. So there has
    to be enough before it begins.

    Raises:
        MemoryError: There is less.
    """
    if not is_bounded():
        return
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | _NO_RESERVE).close()
    except OSError:
        raise MemoryError from None


_NO_RESERVE = getattr(mmap, "MAP_NORESERVE", 0)
