"""Robots that go round in circles: they follow their own trace again and again."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.world import RobotState

__all__ = ["ROUNDS", "Rounds"]

ROUNDS = 3
"""How often in a row a robot that goes round in circles has gone the same way."""

_CELL = 10.0  # map units
_SECTORS = 8  # of headings
_LONGEST = 1024  # places that are remembered, so that a round has at most a third of them


class Rounds:
    """Follows the robots, and notices who goes round in circles.

    The trace of a robot is a list of places, each a square of the map with a sector of headings. A
    round is a part of it that follows immediately on the same places in the same order.
    """

    def __init__(self) -> None:
        self._traces: dict[str, _Trace] = {}

    def follow(self, robots: Sequence[RobotState]) -> int:
        """Return the indices of robots that have just ended their last round, as bits.

        Args:
            robots: All robots after the next tick.
        """
        found = 0
        for index, robot in enumerate(robots):
            place = (
                robot.x // _CELL,
                robot.y // _CELL,
                robot.angle % math.tau * _SECTORS // math.tau,
            )
            trace = self._traces.get(robot.name)
            if trace is None:
                trace = self._traces[robot.name] = _Trace()
            if place != trace.places[-1] and trace.enter(place):
                found |= 1 << index
        return found


_Place = tuple[float, float, float]


class _Trace:
    """Where one robot was, and how far it has followed its earlier trace."""

    __slots__ = ("followed", "latest", "match", "places")

    def __init__(self) -> None:
        self._forget()

    def _forget(self) -> None:
        self.places: list[_Place] = [(math.inf, math.inf, math.inf)]
        self.latest: dict[_Place, int] = {}
        self.match = self.followed = 0

    def enter(self, place: _Place) -> bool:
        """Add a place; return whether the last round ends there."""
        if len(self.places) > _LONGEST:
            self._forget()
        here = len(self.places)
        if self.match and self.places[self.match + 1] == place:
            self.match += 1
            self.followed += 1
        else:
            self.match = self.latest.get(place, 0)
            self.followed = int(self.match > 0)
        self.places.append(place)
        self.latest[place] = here
        return self.match > 0 and self.followed == (ROUNDS - 1) * (here - self.match)
