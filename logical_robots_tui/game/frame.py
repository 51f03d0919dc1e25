"""A frame: the immutable record of one finished tick."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from logical_robots_tui.errors import LogicalRobotsError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.decision import Decision
    from logical_robots_tui.values import SensorRow, Value
    from logical_robots_tui.world.state import WorldState

__all__ = ["Frame", "NoSuchTickError", "Superseded"]


@dataclass(frozen=True, slots=True)
class Frame:
    """Everything that the screen, the inspector and a replay need of one tick.

    Frame 0 is the start: nobody has thought yet, ``decisions`` is empty, ``before`` is ``after``,
    and ``sensors`` show what the robots see from where they start (clock 0). So is the frame of a
    tick at whose end robots or areas came or went because the level was changed by hand; if it
    was changed otherwise, ``after`` is the changed world, and all else is as it was.

    Attributes:
        tick: Number of the tick, 0 for the start.
        before: The world from which the robots sensed.
        after: The world after they acted.
        sensors: The program's ``Sensor`` rows, one per robot in file order. Don't change them.
        memories_before: Each robot's memory as the program saw it, by robot name.
        decisions: What the program decided, one per robot in file order.
        memories: Each robot's memory afterwards, by robot name.
        think_milliseconds: How long thinking took; two frames that differ only in it are equal.
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
        """Whether the tick would be the same on any machine: no clock ended a thought in it."""
        return all(decision.is_reliable for decision in self.decisions)


class NoSuchTickError(LogicalRobotsError):
    """A tick was asked for that history does not hold."""

    title = "No such tick"


class Superseded(Exception):  # noqa: N818 - not an error: the player did something else meanwhile
    """The work belonged to a run that is over; its result was dropped."""
