"""How far the robots have driven since the start, and whether one program drove them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.world import WorldState

__all__ = ["Odometer", "driven"]


def driven(before: WorldState, after: WorldState) -> float:
    """Map units between the places of all robots before and after, along straight lines."""
    return sum(
        math.hypot(now.x - then.x, now.y - then.y)
        for then, now in zip(before.robots, after.robots, strict=True)
    )


class Odometer:
    """Follows a game frame by frame, also back."""

    def __init__(self) -> None:
        self._distances = [0.0]
        self._programs: list[str] = [""]

    def count(self, frame: Frame, program: str) -> None:
        """Take in the frame that is the present now.

        Args:
            frame: It follows the last one, or is one that was counted before.
            program: The text that decided in it, if it is a new one.
        """
        if frame.tick == len(self._distances):
            self._distances.append(self._distances[-1] + driven(frame.before, frame.after))
            self._programs.append(program)
        else:
            del self._distances[frame.tick + 1 :]
            del self._programs[frame.tick + 1 :]

    def distance(self, tick: int) -> float:
        """Map units that all robots together have driven up to a tick."""
        return self._distances[tick]

    def is_all_by(self, program: str, tick: int) -> bool:
        """Whether one program decided in every tick up to that one."""
        return all(text == program for text in self._programs[1 : tick + 1])
