"""Frames: immutable records of finished ticks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from logical_robots_tui.errors import LogicalRobotsError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.decision import Decision
    from logical_robots_tui.values import SensorRow, Value
    from logical_robots_tui.world import WorldState

__all__ = ["Frame", "NoSuchTickError", "Superseded", "driven"]


@dataclass(frozen=True, slots=True)
class Frame:
    """Everything that the screen, the inspector and a replay need from one tick.

    Frame 0 is the start: nobody has thought yet, ``decisions`` is empty, ``before`` equals
    ``after``, and ``sensors`` shows what the robots see from their start (clock 0). The same holds
    for a tick at whose end an edit of the level added or removed robots or areas. After any other
    edit ``after`` is the edited world, and everything else is unchanged.

    Attributes:
        tick: Number of the tick, 0 for the start.
        before: The world from which the robots sensed.
        after: The world after they acted.
        sensors: The program's ``Sensor`` rows, one per robot in file order. Don't modify them.
        memories_before: Each robot's memory as the program saw it, by robot name.
        decisions: The program's decisions, one per robot in file order.
        memories: Each robot's memory afterwards, by robot name.
        think_milliseconds: How long thinking took; ignored when frames are compared.
    """

    tick: int
    before: WorldState
    after: WorldState
    sensors: tuple[SensorRow, ...]
    memories_before: Mapping[str, Value]
    decisions: tuple[Decision, ...]
    memories: Mapping[str, Value]
    think_milliseconds: float = field(compare=False)

    @property
    def is_reliable(self) -> bool:
        """Whether the tick is the same on any machine: the clock cut off no thought."""
        return all(decision.is_reliable for decision in self.decisions)


class NoSuchTickError(LogicalRobotsError):
    """A tick was asked for that history does not hold."""

    title = "No such tick"


class Superseded(Exception):  # noqa: N818 - not an error: the player did something else meanwhile
    """The work belonged to a run that is over; its result was dropped."""


def driven(before: WorldState, after: WorldState) -> float:
    """Return the total straight-line distance of all robots between two states, in map units."""
    return sum(
        math.hypot(now.x - then.x, now.y - then.y)
        for then, now in zip(before.robots, after.robots, strict=True)
    )
