"""History: what is needed to restore any recent tick exactly, and no more."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.errors import LogicalRobotsError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import WorldState

__all__ = ["History", "Moment", "NoSuchTickError"]

DEFAULT_LENGTH = 20_000


class NoSuchTickError(LogicalRobotsError):
    """A tick was asked for that history does not hold."""

    title = "No such tick"


@dataclass(frozen=True, slots=True)
class Moment:
    """What a finished tick left behind; sensors are not kept, the world senses them again.

    Attributes:
        after: The world after the tick.
        memories: Each robot's memory after the tick, by robot name.
        decisions: What was decided in the tick.
        think_milliseconds: How long thinking took.
    """

    after: WorldState
    memories: Mapping[str, Value]
    decisions: tuple[Decision, ...]
    think_milliseconds: float


class History:
    """The last ticks of a game, oldest first, without gaps.

    Args:
        length: How many ticks to be able to restore.
    """

    def __init__(self, length: int = DEFAULT_LENGTH) -> None:
        # One more than can be restored: a tick is restored from the moment before it.
        self._moments: deque[Moment] = deque(maxlen=length + 1)

    @property
    def first(self) -> int:
        """The earliest tick that can be restored."""
        oldest = self._moments[0].after.tick
        return oldest + 1 if oldest else 0

    @property
    def last(self) -> int:
        """The latest tick that was finished."""
        return self._moments[-1].after.tick

    def add(self, frame: Frame) -> None:
        """Keep a finished tick; what was kept of it or of later ticks is forgotten."""
        while self._moments and self.last >= frame.tick:
            self._moments.pop()
        self._moments.append(
            Moment(frame.after, frame.memories, frame.decisions, frame.think_milliseconds)
        )

    def around(self, tick: int) -> tuple[Moment, Moment]:
        """The moments before and after a tick; for the start, tick 0, twice the same.

        Raises:
            NoSuchTickError: The tick is not in history.
        """
        if not self.first <= tick <= self.last:
            raise NoSuchTickError(
                f"Tick {tick} is not in history, which holds ticks {self.first} to {self.last}."
            )
        at = tick - self._moments[0].after.tick
        return self._moments[max(at - 1, 0)], self._moments[at]
