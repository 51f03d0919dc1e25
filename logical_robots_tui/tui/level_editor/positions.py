"""Where things stand now: while robots run, not where the level lets them start."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.world import Level, Robot, RobotState, WorldState
    from logical_robots_tui.world.changing import Pose

__all__ = ["Poses", "as_it_stands"]


def as_it_stands(level: Level, state: WorldState) -> Level:
    """A level with its robots where they are at the moment."""
    if state.tick == 0:
        return level
    bodies = {body.name: body for body in state.robots}
    robots = tuple(
        robot if (body := bodies.get(robot.name)) is None else _now(robot, body)
        for robot in level.robots
    )
    return replace(level, robots=robots)


class Poses:
    """Where robots are put when the level is changed while they are under way.

    A robot that is moved in the level goes there at once. Undoing that brings it back to where it
    was then, and not to where the level let it start.
    """

    def __init__(self) -> None:
        self._stood: dict[tuple[str, Pose], Pose] = {}

    def note(self, robot: Robot, now: Robot) -> None:
        """Remember where a robot stands before it is moved.

        Args:
            robot: As the level has it.
            now: As it stands.
        """
        self._stood[robot.name, _pose(robot)] = _pose(now)

    def between(self, before: Level, after: Level) -> dict[str, Pose]:
        """Where robots are put when one level takes the place of the other."""
        known = {robot.name: _pose(robot) for robot in before.robots}
        moved = {
            robot.name: _pose(robot)
            for robot in after.robots
            if robot.name in known and known[robot.name] != _pose(robot)
        }
        return {name: self._stood.get((name, pose), pose) for name, pose in moved.items()}


def _now(robot: Robot, body: RobotState) -> Robot:
    return replace(robot, x=body.x, y=body.y, angle=body.angle)


def _pose(robot: Robot) -> Pose:
    return robot.x, robot.y, robot.angle
