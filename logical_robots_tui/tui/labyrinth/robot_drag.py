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
    """A robot was dragged or turned."""

    name: str
    pose: Pose


@dataclass(frozen=True)
class Grip:
    """How a robot is held with the mouse.

    Attributes:
        dx: Map units from its centre to the pointer.
        dy: Map units from its centre to the pointer.
        is_turned: Whether it turns towards the pointer instead of following it.
    """

    name: str
    dx: float
    dy: float
    is_turned: bool

    def put(self, robot: RobotState, x: float, y: float) -> RobotPut:
        """Return where the robot is with the pointer at a point in map units."""
        if self.is_turned:
            angle = math.atan2(y - robot.y, x - robot.x)
            return RobotPut(robot.name, (robot.x, robot.y, angle))
        return RobotPut(robot.name, (x - self.dx, y - self.dy, robot.angle))


def robot_near(robots: Iterable[RobotState], x: float, y: float, units: float) -> RobotState | None:
    """Return the robot nearest to a point, if it is close.

    x and y are map units, `units` is map units per column.
    """
    reach = max(_PICK_REACH * units, ROBOT_RADIUS + CELL_ASPECT * units / 2)
    away = [(math.hypot(robot.x - x, robot.y - y), i, robot) for i, robot in enumerate(robots)]
    distance, _, nearest = min(away, default=(math.inf, 0, None))
    return nearest if distance <= reach else None
