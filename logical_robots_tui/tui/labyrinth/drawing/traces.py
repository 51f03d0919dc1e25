"""Where robots came from and what was just switched, as far as the screen has seen it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats

__all__ = ["Traces"]

_TRAIL = 160
"""Ticks that a trail is long."""

_FLASH = 12
"""Ticks for which an area shows that it was switched."""


class Traces:
    """What the frames that were shown tell about the past of one of them.

    Going back in time finds the past of that time; a past that turns out otherwise, under another
    program, replaces the former.
    """

    def __init__(self) -> None:
        self._places: dict[int, Floats] = {}
        self._active: dict[int, tuple[bool, ...]] = {}
        self._number = 0, 0  # of robots and areas

    def forget(self) -> None:
        """Begin anew, in another level."""
        self._places.clear()
        self._active.clear()

    def record(self, frame: Frame) -> None:
        """Remember a frame that is shown."""
        tick = frame.tick
        places = np.array([(robot.x, robot.y) for robot in frame.after.robots], np.float64)
        number = len(places), len(frame.after.areas)
        if number != self._number:
            self.forget()  # robots or areas came or went
            self._number = number
        known = self._places.get(tick)
        if known is not None and not np.array_equal(known, places):
            self._drop(lambda other: other >= tick)
        self._drop(lambda other: abs(other - tick) > _TRAIL)
        self._places[tick] = places
        self._active[tick] = tuple(area.active for area in frame.after.areas)

    def trails(self, tick: int) -> tuple[Floats, Floats]:
        """Return where the robots were.

        Args:
            tick: The present.

        Returns:
            Places of shape (moments, robots, 2) in map units, and the age of each moment from
            nearly 1, about to be forgotten, to nearly 0; the oldest first.
        """
        ticks = sorted(then for then in self._places if tick - _TRAIL < then < tick)
        if not ticks:
            return np.zeros((0, 0, 2)), np.zeros(0)
        ages = (tick - np.array(ticks)) / _TRAIL
        return np.stack([self._places[then] for then in ticks]), ages

    def switched(self, tick: int) -> frozenset[int]:
        """Return the numbers of the areas that were switched a moment ago."""
        ticks = sorted(then for then in self._active if tick - _FLASH <= then <= tick)
        states = [self._active[then] for then in ticks]
        areas = enumerate(zip(*states, strict=True))
        return frozenset(number for number, found in areas if len(set(found)) > 1)

    def _drop(self, is_old: Callable[[int], bool]) -> None:
        for tick in [tick for tick in self._places if is_old(tick)]:
            del self._places[tick], self._active[tick]
