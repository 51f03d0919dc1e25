"""How robots moved in a run: blocked, standing still, going in circles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.game.history.rounds import last_rounds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from logical_robots_tui.world import RobotState

__all__ = ["Stretch", "stretches"]

LONG = 150
"""Ticks for which a robot must be blocked or stand still to be reported."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Ticks in which a robot made no progress.

    `period` is in ticks per round, or 0.
    """

    kind: Literal["blocked", "still", "circle", "unfinished"]
    robot: str
    first: int
    last: int
    period: int = 0


def stretches(path: Sequence[RobotState], first: int) -> Iterator[Stretch]:
    """Yield the longest stretch of each kind in which a robot made no progress.

    The path is the robot at the end of each tick, from the first one on.
    """
    name = path[-1].name if path else ""
    kinds: tuple[tuple[Literal["blocked", "still"], Callable[[RobotState], bool]], ...] = (
        ("blocked", lambda robot: robot.blocked),
        ("still", lambda robot: not (robot.left_engine or robot.right_engine or robot.dead)),
    )
    for kind, is_so in kinds:
        begin, end = _longest([is_so(robot) for robot in path])
        if end - begin >= LONG and (kind == "blocked" or end == len(path)):
            yield Stretch(kind, name, first + begin, first + end - 1)
            return
    if (found := last_rounds(path)) is not None:
        begin, period = found
        yield Stretch("circle", name, first + begin, first + len(path) - 1, period)
    elif len(path) > LONG:
        yield Stretch("unfinished", name, first + len(path) - LONG, first + len(path) - 1)


def _longest(holds: Sequence[bool]) -> tuple[int, int]:
    """Return start and end of the longest stretch of True; the last of equally long ones."""
    best, begin = (0, 0), 0
    for at, each in enumerate([*holds, False]):
        if not each:
            if at - begin >= best[1] - best[0]:
                best = (begin, at)
            begin = at + 1
    return best
