"""How a robot moves: engines, walls that block it, solid areas that push it out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from logical_robots_tui.world.level import Area, Level
    from logical_robots_tui.world.state import RobotState

__all__ = ["PUSH_MARGIN", "WHEEL_BASE", "Mover", "drive", "is_inside", "push_out"]

WHEEL_BASE = 20
"""Map units between the wheels; engines that differ by 1 turn a robot by 1/20 radian a tick."""

PUSH_MARGIN = 0.1
"""Map units from the edge of a solid area to where it pushes a robot."""


@dataclass(slots=True, eq=False)
class Mover:
    """A robot in the middle of a tick; the fields are those of ``RobotState``."""

    x: float
    y: float
    angle: float
    battery_level: float
    left_engine: float = 0.0
    right_engine: float = 0.0
    blocked: bool = False
    dead: bool = False


def drive(mover: Mover, left: float, right: float, level: Level) -> None:
    """Turn and move a robot for one tick.

    The turn comes first and always succeeds. The move is cancelled if it ends in a wall; there are
    no walls outside the map.

    Args:
        mover: Changed in place.
        left: Wanted power of the left engine, finite.
        right: Wanted power of the right engine, finite.
        level: The level with the walls.
    """
    left, right = _clamped(left), _clamped(right)
    angle = math.fmod(mover.angle + (left - right) / WHEEL_BASE + 2 * math.pi, 2 * math.pi)
    speed = (left + right) / 2
    x = mover.x + speed * math.cos(angle)
    y = mover.y + speed * math.sin(angle)
    mover.left_engine, mover.right_engine, mover.angle = left, right, angle
    if not _is_wall(level, x, y):
        mover.x, mover.y = x, y
    else:
        mover.blocked = speed != 0


def push_out(mover: Mover, areas: Iterable[Area]) -> None:
    """Move a robot that is inside a solid area to just outside its edge, one area after another.

    The new position is not checked for walls.

    Args:
        mover: Changed in place.
        areas: The solid active areas, in file order.
    """
    for area in areas:
        dx, dy = mover.x - area.x, mover.y - area.y
        distance = math.hypot(dx, dy)
        if distance >= area.radius:
            continue
        if distance < 1:
            dx, dy, distance = 1.0, 0.0, 1.0
        mover.x = area.x + dx / distance * (area.radius + PUSH_MARGIN)
        mover.y = area.y + dy / distance * (area.radius + PUSH_MARGIN)


def is_inside(mover: Mover | RobotState, area: Area) -> bool:
    """Return whether a robot's centre is strictly inside an area."""
    return math.hypot(mover.x - area.x, mover.y - area.y) < area.radius


def _clamped(power: float) -> float:
    return min(1.0, max(-1.0, power))


def _is_wall(level: Level, x: float, y: float) -> bool:
    column, row = math.floor(x), math.floor(y)
    if not (0 <= column < level.width and 0 <= row < level.height):
        return False
    return bool(level.walls[row, column])
