"""How robots moved in a run: blocked, standing still, going in circles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from logical_robots_tui.world import RobotState

__all__ = ["Stretch", "stretches"]

LONG = 150
"""Ticks for which a robot must be blocked or stand still to be reported."""

_NEAR = 6.0  # map units within which a robot counts as not having moved
_ALIKE = 0.25  # radians within which its heading counts as the same
_AWAY = 20.0  # map units that it must move away in between
_ROUNDS = 3
_SPIN = 3 * math.tau  # radians turned within `LONG` ticks while staying in place
_SMALL = 60.0  # diameter of a circle in map units


@dataclass(frozen=True, slots=True)
class Stretch:
    """Ticks in which a robot made no progress.

    Attributes:
        kind: The kind of movement.
        robot: The robot's name.
        first: The first tick.
        last: The last one.
        period: Ticks per round, or 0.
    """

    kind: Literal["blocked", "still", "circle", "unfinished"]
    robot: str
    first: int
    last: int
    period: int = 0


def stretches(path: Sequence[RobotState], first: int) -> Iterator[Stretch]:
    """Yield the longest stretch of each kind in which a robot made no progress.

    Args:
        path: The robot at the end of each tick.
        first: Number of the first tick.
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
    found = _round(path) or _spin(path)
    if found is not None:
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


def _round(path: Sequence[RobotState]) -> tuple[int, int] | None:
    """Return the start and period of a path that repeats until the end."""
    visits = []
    is_away = False
    end = path[-1] if path else None
    for at in range(len(path) - 2, -1, -1):
        assert end is not None
        gone = math.hypot(path[at].x - end.x, path[at].y - end.y)
        if gone > _AWAY:
            is_away = True
        elif is_away and gone < _NEAR and _turned(path[at], end) < _ALIKE:
            visits.append(at)
            is_away = False
    gaps = [a - b for a, b in zip([len(path) - 1, *visits], visits, strict=False)]
    for number, gap in enumerate(gaps):
        if abs(gap - gaps[0]) > max(3, 0.1 * gaps[0]):
            gaps = gaps[:number]
            break
    if len(gaps) < _ROUNDS:
        return None
    return visits[len(gaps) - 1], gaps[0]


def _spin(path: Sequence[RobotState]) -> tuple[int, int] | None:
    """Return the start of spinning in place until the end, and the ticks per turn."""
    if len(path) < LONG:
        return None
    left = right = path[-1].x
    top = bottom = path[-1].y
    turned = 0.0
    begin = len(path) - 1
    for at in range(len(path) - 2, -1, -1):
        robot = path[at]
        left, right = min(left, robot.x), max(right, robot.x)
        top, bottom = min(top, robot.y), max(bottom, robot.y)
        if max(right - left, bottom - top) > _SMALL:
            break
        turned += _angle(path[at + 1].angle - robot.angle)
        begin = at
    ticks = len(path) - 1 - begin
    if ticks < LONG or abs(turned) < _SPIN:
        return None
    return begin, round(ticks * math.tau / abs(turned))


def _turned(one: RobotState, other: RobotState) -> float:
    return abs(_angle(one.angle - other.angle))


def _angle(angle: float) -> float:
    return math.remainder(angle, math.tau)
