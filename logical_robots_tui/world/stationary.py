"""Stationary robots with nothing moving in view, which can reuse their last reading."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from logical_robots_tui.world.state import RobotState

__all__ = ["may_have_changed"]

_Spot: TypeAlias = tuple[float, float]

_MARGIN = 1.0
"""Map units; far more than any rounding error."""


def may_have_changed(
    robots: Sequence[RobotState],
    before: Sequence[RobotState],
    radius: float,
    reach: Callable[[int], float],
) -> list[int]:
    """Return the indices of the robots whose reading may have changed.

    All others have not moved, and no moving robot was or is in their view.

    Args:
        robots: All robots, in file order.
        before: The same robots at the last reading.
        radius: Map units within which a ray hits a robot.
        reach: Returns the longest distance in a robot's last reading, by the robot's index.
    """
    spots: list[_Spot] = []
    found: list[int] = []
    still: list[int] = []
    for place, (now, then) in enumerate(zip(robots, before, strict=True)):
        if now.x != then.x or now.y != then.y:
            spots += ((now.x, now.y), (then.x, then.y))
            found.append(place)
        elif now.angle != then.angle:
            found.append(place)
        else:
            still.append(place)
    for place in still:
        near = _in_front(robots[place], spots, radius + _MARGIN)
        if near and min(near) < reach(place) + radius + _MARGIN:
            found.append(place)
    return sorted(found)


def _in_front(robot: RobotState, spots: Sequence[_Spot], radius: float) -> list[float]:
    """Return the distances of the spots whose circle is not entirely behind the robot."""
    cos, sin = math.cos(robot.angle), math.sin(robot.angle)
    ways = [(x - robot.x, y - robot.y) for x, y in spots]
    return [math.hypot(dx, dy) for dx, dy in ways if dx * cos + dy * sin > -radius]
