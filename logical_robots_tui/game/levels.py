"""Levels by tick: the level of a course at each tick, if it was edited on the way."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.world.bitmaps import PackedBits

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

__all__ = ["Levels"]

_NO_WALLS = np.zeros((0, 0), np.bool_)


class Levels:
    """The levels of one course. All except the latest have packed walls.

    Args:
        tick: The first tick of the course.
        level: Its first level.
    """

    def __init__(self, tick: int, level: Level) -> None:
        self._ticks = [tick]
        self._latest = level
        self._earlier: list[_Packed] = []
        self._opened: tuple[_Packed, Level] | None = None

    @property
    def packed_bytes(self) -> int:
        """Bytes of the packed walls."""
        return sum(len(packed.walls.data) for packed in self._earlier)

    def at(self, tick: int) -> Level:
        """Return the level from the end of a tick on."""
        place = max(bisect_right(self._ticks, tick) - 1, 0)
        if place == len(self._earlier):
            return self._latest
        packed = self._earlier[place]
        if self._opened is None or self._opened[0] is not packed:
            self._opened = packed, packed.level()
        return self._opened[1]

    def is_changed_in(self, tick: int) -> bool:
        """Return whether the level changed at the end of a tick."""
        return tick in self._ticks[1:]

    def is_changed_up_to(self, tick: int) -> bool:
        """Return whether the level changed after the start, up to the end of a tick."""
        return any(changed <= tick for changed in self._ticks[1:])

    def change(self, tick: int, level: Level) -> None:
        """Set the level from the end of a tick on, which must not precede the latest change."""
        if tick > self._ticks[-1]:
            self._earlier.append(_Packed.of(self._latest))
            self._ticks.append(tick)
        self._latest = level

    def up_to(self, tick: int) -> Levels:
        """Return a copy up to a tick."""
        copy = Levels(self._ticks[0], self.at(tick))
        place = max(bisect_right(self._ticks, tick), 1)
        copy._ticks = self._ticks[:place]
        copy._earlier = self._earlier[: place - 1]
        return copy

    def forget_before(self, tick: int) -> None:
        """Drop the levels of earlier ticks."""
        place = bisect_right(self._ticks, tick) - 1
        if place > 0:
            del self._ticks[:place], self._earlier[:place]


@dataclass(frozen=True, slots=True, eq=False)
class _Packed:
    """A level without its walls, and the packed walls."""

    rest: Level
    walls: PackedBits

    @classmethod
    def of(cls, level: Level) -> _Packed:
        return cls(replace(level, walls=_NO_WALLS), PackedBits.of(level.walls))

    def level(self) -> Level:
        walls = self.walls.bits()
        walls.flags.writeable = False
        return replace(self.rest, walls=walls)
