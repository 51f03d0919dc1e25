"""The last change of a part of a memory, found by comparing recorded memories."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass

from logical_robots_tui.explain.why.explanation import Path, part_of
from logical_robots_tui.mind import QueryError
from logical_robots_tui.values import Value, is_same

FEWEST_STEPS = 3
"""From this number on, changes are reported together."""


@dataclass(frozen=True, slots=True)
class Steps:
    """A series of like changes, up to the last one.

    Attributes:
        increment: The difference between two values; None if each tick changed it differently.
        since: The tick of the first of these changes.
        times: The number of changes.
        begin: The value before them.
    """

    increment: float | None
    since: int
    times: int
    begin: Value


@dataclass(frozen=True, slots=True)
class Change:
    """The last change of a part of a memory.

    Attributes:
        tick: The tick that set the value, or the first known tick if it was set earlier.
        path: Its path then, because an element may have moved within its list.
        is_known: Whether it is known that it had another value before.
    """

    tick: int
    path: Path
    value: Value
    is_known: bool
    steps: Steps | None = None


async def last_change(memories: AsyncIterator[Sequence[Value]], path: Path, tick: int) -> Change:
    """Return the last change of a part of a memory, up to a tick.

    `memories` are those after the tick, after the tick before, and so on, in batches. Raises
    QueryError if there is no such part after the tick.
    """
    changes: _Changes | None = None
    async for batch in memories:
        for memory in batch:
            if changes is None:
                changes = _Changes(memory, path, tick)
            elif not changes.go_back(memory):
                return changes.as_change(is_known=True)
    if changes is None:
        raise QueryError(f"What was remembered after tick {tick} is no longer known.")
    return changes.as_change(is_known=bool(changes.ticks))


class _Changes:
    def __init__(self, memory: Value, path: Path, tick: int) -> None:
        self.ticks: list[int] = []  # of the changes, the last one first
        self._tick, self._memory = tick, memory
        self._path: Path = ()
        for name in path:
            value = part_of(memory, self._path)
            if isinstance(name, int) and name < 0 and isinstance(value, list):
                name += len(value)
            self._path = (*self._path, name)
        self._values = [part_of(memory, self._path)]  # after each change, and before the first
        self._increment: float | None = None
        self._even = 0  # changes by the same difference
        self._running = 0  # changes in consecutive ticks

    def go_back(self, memory: Value) -> bool:
        """Compare with the memory before; return whether still earlier ones are needed."""
        tick, self._tick = self._tick, self._tick - 1
        if not self.ticks:
            path = _old_path(memory, self._memory, self._path)
            if path is not None:
                self._path, self._memory = path, memory
                return True
        try:
            old_value = part_of(memory, self._path)
        except QueryError:
            self._tick = tick
            self.ticks += [] if self.ticks else [tick]
            return False
        if not is_same(self._values[-1], old_value):
            self._compare(tick, old_value)
        elif self._running == len(self.ticks) and self._even < len(self.ticks):
            return False
        return len(self.ticks) in (self._even, self._running)

    def as_change(self, *, is_known: bool) -> Change:
        tick = self.ticks[0] if self.ticks else self._tick
        return Change(tick, self._path, self._values[0], is_known, self._steps())

    def _compare(self, tick: int, old_value: Value) -> None:
        pair = (self._values[-1], old_value)
        numbers = [v for v in pair if isinstance(v, int | float) and not isinstance(v, bool)]
        increment = numbers[0] - numbers[1] if len(numbers) == 2 else None
        if not self.ticks:
            self._increment = increment
        step = self._increment
        if increment is not None and step is not None and math.isclose(increment, step):
            self._even += self._even == len(self.ticks)
        if not self.ticks or tick == self.ticks[-1] - 1:
            self._running += self._running == len(self.ticks)
        self.ticks.append(tick)
        self._values.append(old_value)

    def _steps(self) -> Steps | None:
        is_even = self._even >= FEWEST_STEPS
        times = self._even if is_even else self._running
        if times < FEWEST_STEPS:
            return None
        increment = self._increment if is_even else None
        return Steps(increment, self.ticks[times - 1], times, self._values[times])


def _old_path(memory: Value, new_memory: Value, path: Path) -> Path | None:
    if memory is new_memory:
        return path
    index = next((n for n in reversed(range(len(path))) if isinstance(path[n], int)), None)
    try:
        if index is None:
            return path if is_same(part_of(memory, path), part_of(new_memory, path)) else None
        items, new_items = part_of(memory, path[:index]), part_of(new_memory, path[:index])
        place = path[index]
        if isinstance(items, list) and isinstance(new_items, list) and isinstance(place, int):
            element = new_items[place]
            if not (place < len(items) and is_same(items[place], element)):
                indices = (n for n, item in enumerate(items) if is_same(item, element))
                place = next(indices, place)
            old_path = (*path[:index], place, *path[index + 1 :])
            if is_same(part_of(memory, old_path), part_of(new_memory, path)):
                return old_path
        return None
    except QueryError:
        return None
