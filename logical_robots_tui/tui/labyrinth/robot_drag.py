"""Pointing at robots, and dragging and turning them, with the mouse."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual.message import Message

from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from logical_robots_tui.world import RobotState
    from logical_robots_tui.world.changing import Pose

_PICK_REACH = 2.5
"""Columns beside a robot within which it is picked."""


class RobotPointed(Message):
    """The mouse points at another robot than before, or at none."""


@dataclass
class RobotPut(Message):
    name: str
    pose: Pose


@dataclass(frozen=True)
class Grip:
    """How a robot is held: `dx` and `dy` are map units from its centre to the pointer."""

    name: str
    dx: float
    dy: float
    is_turned: bool

    def put(self, robot: RobotState, x: float, y: float) -> RobotPut:
        """Return the robot's pose when the pointer is at a point in map units."""
        if self.is_turned:
            angle = math.atan2(y - robot.y, x - robot.x)
            return RobotPut(robot.name, (robot.x, robot.y, angle))
        return RobotPut(robot.name, (x - self.dx, y - self.dy, robot.angle))


def robot_near(robots: Iterable[RobotState], x: float, y: float, units: float) -> RobotState | None:
    """Return the robot near a point in map units, or None; `units` is map units per column."""
    reach = max(_PICK_REACH * units, ROBOT_RADIUS + CELL_ASPECT * units / 2)
    away = [(math.hypot(robot.x - x, robot.y - y), i, robot) for i, robot in enumerate(robots)]
    distance, _, nearest = min(away, default=(math.inf, 0, None))
    return nearest if distance <= reach else None
