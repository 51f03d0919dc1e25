"""Divergence: where two courses of a game begin to differ, and how."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind import Decision

Matter: TypeAlias = Literal["desire", "memory", "notices", "position", "battery"]


@dataclass(frozen=True, slots=True)
class Difference:
    """A difference between the current course (`here`) and the other one for one robot.

    A ``position`` includes heading and engines.
    """

    robot_name: str
    matter: Matter
    here: Any
    there: Any


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first tick in which two courses differ; decisions first, in file order."""

    tick: int
    differences: tuple[Difference, ...]

    def reversed(self) -> Divergence:
        return Divergence(
            self.tick,
            tuple(
                Difference(each.robot_name, each.matter, each.there, each.here)
                for each in self.differences
            ),
        )


def find_divergence(here: TickState, there: TickState) -> Divergence | None:
    if here.decisions == there.decisions and here.after == there.after:
        return None
    return Divergence(here.after.tick, (*_of_decisions(here, there), *_of_robots(here, there)))


def _of_decisions(here: TickState, there: TickState) -> Iterator[Difference]:
    others = {decision.robot_name: decision for decision in there.decisions}
    for mine in here.decisions:
        other = others.get(mine.robot_name)
        if other is not None and mine != other:
            for matter, value in _said(mine).items():
                if value != (that := _said(other)[matter]):
                    yield Difference(mine.robot_name, matter, value, that)


def _said(decision: Decision) -> dict[Matter, object]:
    return {
        "desire": decision.desire,
        "memory": decision.memory,
        "notices": tuple(notice.message for notice in decision.notices),
    }


def _of_robots(here: TickState, there: TickState) -> Iterator[Difference]:
    others = {robot.name: robot for robot in there.after.robots}
    for mine in here.after.robots:
        other = others.get(mine.name)
        if other is None:
            continue
        place, that = (mine.x, mine.y, mine.angle), (other.x, other.y, other.angle)
        if place != that:
            yield Difference(mine.name, "position", place, that)
        if mine.battery_level != other.battery_level:
            yield Difference(mine.name, "battery", mine.battery_level, other.battery_level)
