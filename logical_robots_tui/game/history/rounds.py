"""Robots that go round in circles: they go the same way again and again."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.world import RobotState

ROUNDS = 3
"""How often in a row a robot that goes round in circles has gone the same way."""

_CELL = 10.0  # map units
_SECTORS = 8  # of headings
_SHORTEST = 20  # ticks of a round
_SOONEST = 100  # ticks of rounds before they are told
_FEWEST = 4  # places of a round; a robot on the border between two may change to and fro
_MISSES = 3  # places in a row that may differ from the round before
_MOST = 4096  # places that are remembered


class Rounds:
    """Detects robots that go round in circles.

    A place is a square of the map with a sector of headings. A robot circles if it revisits
    place after place in the same number of ticks, within a tenth.
    """

    def __init__(self) -> None:
        self._traces: dict[str, _Trace] = {}
        self._tick = 0

    def follow(self, robots: Sequence[RobotState]) -> int:
        """Return the indices of robots that have just ended their last round, as bits."""
        found = 0
        self._tick += 1
        for index, robot in enumerate(robots):
            place = _place_of(robot)
            trace = self._traces.get(robot.name)
            if trace is None:
                trace = self._traces[robot.name] = _Trace()
            if place != trace.place and trace.enter(place, self._tick):
                found |= 1 << index
        return found


def last_rounds(path: Sequence[RobotState]) -> tuple[int, int] | None:
    """Return index and period of the rounds in which one robot's path ends, or None."""
    trace = _Trace()
    for tick, robot in enumerate(path):
        if (place := _place_of(robot)) != trace.place:
            trace.enter(place, tick)
    end = len(path) - 1
    if trace.place is None or not trace.goes_round(end):
        return None
    if end - trace.seen[trace.place] > trace.period:
        return None  # it has stopped since
    return max(trace.since - trace.period, 0), trace.period


_Place = tuple[float, float, float]


def _place_of(robot: RobotState) -> _Place:
    return (
        robot.x // _CELL,
        robot.y // _CELL,
        robot.angle % math.tau * _SECTORS // math.tau,
    )


class _Trace:
    """Where one robot was when.

    `period` is the ticks of a round, or 0 if the robot is somewhere new; `hits` counts places
    reached a period after their last visit, `misses` others in a row.
    """

    __slots__ = ("hits", "is_told", "misses", "period", "place", "seen", "since")

    def __init__(self) -> None:
        self.place: _Place | None = None
        self.seen: dict[_Place, int] = {}
        self.period = self.since = self.hits = self.misses = 0
        self.is_told = False

    def enter(self, place: _Place, tick: int) -> bool:
        """Record a visit to a place; return whether to report the rounds now."""
        self.place = place
        if len(self.seen) >= _MOST:
            self.seen.clear()
        lag = tick - self.seen.get(place, tick)
        self.seen[place] = tick
        if 0 < lag < _SHORTEST:
            return False
        if self.period and abs(lag - self.period) <= max(3, self.period // 10):
            self.hits, self.misses = self.hits + 1, 0
        else:
            self.misses += 1
            if not self.period or self.misses > _MISSES:
                self.period, self.since, self.hits, self.misses = lag, tick, 0, 0
                self.is_told = self.is_told and lag > 0
        if self.is_told or not self.goes_round(tick):
            return False
        self.is_told = True
        return True

    def goes_round(self, tick: int) -> bool:
        again = ROUNDS - 1
        return (
            self.period > 0
            and tick - self.since >= max(again * self.period, _SOONEST)
            and self.hits >= again * _FEWEST
        )
