"""Current places of things while robots run, as opposed to their places in the level."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.world import Level, Robot, RobotState, WorldState
    from logical_robots_tui.world.changing import Pose

__all__ = ["Poses", "as_it_stands"]


def as_it_stands(level: Level, state: WorldState) -> Level:
    """Return a level with its robots at their current places."""
    if state.tick == 0:
        return level
    bodies = {body.name: body for body in state.robots}
    robots = tuple(
        robot if (body := bodies.get(robot.name)) is None else _now(robot, body)
        for robot in level.robots
    )
    return replace(level, robots=robots)


class Poses:
    """Where robots are put when the level is changed while they run.

    A robot that is moved in the level goes there at once. Undo moves it back to its place at that
    moment, not to its start in the level.
    """

    def __init__(self) -> None:
        self._stood: dict[tuple[str, Pose], Pose] = {}

    def note(self, robot: Robot, now: Robot) -> None:
        """Remember a robot's place before it is moved.

        Args:
            robot: The robot in the level.
            now: Its current state.
        """
        self._stood[robot.name, _pose(robot)] = _pose(now)

    def between(self, before: Level, after: Level) -> dict[str, Pose]:
        """Return where robots are put when one level replaces the other."""
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
