"""Which goals robots can reach, as points and with room for their bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.editing.regions import Regions
from logical_robots_tui.world.clearance import row_clearances
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.world.level import Area, Level, Robot

__all__ = ["Reach", "always_solid", "units_of"]

_MARGIN = (
    int(ROBOT_RADIUS) + 2
)  # margin in map units around the map, where robots can drive as well


class Reach:
    """The parts of a level that its robots can reach.

    Obstacles are walls, and solid areas that nothing switches off. Collisions treat a robot as a
    point, but where its body doesn't fit it gets through only by luck.

    Args:
        level: The level.
    """

    def __init__(self, level: Level) -> None:
        blocked = level.walls.copy()
        beacons = {beacon.name for beacon in level.beacons}
        for area in level.areas:
            if always_solid(area, beacons):
                window, disc = units_of(area, level)
                blocked[window] |= disc
        blocked = np.pad(blocked, _MARGIN)
        self._shape = blocked.shape
        self._narrow = Regions(~blocked, corners=True)
        self._wide = Regions(_with_room(blocked), corners=True)
        self._starts = {
            robot.name: (self._start(robot), self._near(robot, ROBOT_RADIUS))
            for robot in level.robots
        }

    def to(self, area: Area) -> tuple[list[str], list[str]]:
        """Return the robots that have trouble reaching their goal.

        Returns:
            Names of those that can't, and of those that can only through gaps where they don't
            fit. A robot that is completely walled in at the start is in neither list.
        """
        narrow = self._narrow.within(area.x + _MARGIN, area.y + _MARGIN, area.radius)
        wide = self._near(area, area.radius + ROBOT_RADIUS)
        never, hardly = [], []
        for name in area.victory_robots:
            start, roomy = self._starts.get(name, (None, None))
            if not start or roomy is None:
                continue
            if not start & narrow:
                never.append(name)
            elif not roomy & wide:
                hardly.append(name)
        return never, hardly

    def _start(self, robot: Robot) -> frozenset[int]:
        """Return the region of a robot, or those that it can reach if it starts in a wall."""
        row, column = math.floor(robot.y) + _MARGIN, math.floor(robot.x) + _MARGIN
        row = min(max(row, 0), self._shape[0] - 1)
        column = min(max(column, 0), self._shape[1] - 1)
        region = self._narrow.at(row, column)
        if region >= 0:
            return frozenset((region,))
        return self._narrow.within(column + 0.5, row + 0.5, 1.0)

    def _near(self, some: Robot | Area, reach: float) -> frozenset[int]:
        """Return the regions with room for a robot near an object."""
        x, y = some.x + _MARGIN, some.y + _MARGIN
        x, y = min(max(x, 0.0), self._shape[1]), min(max(y, 0.0), self._shape[0])
        return self._wide.within(x, y, reach)


def always_solid(area: Area, beacons: set[str]) -> bool:
    """Return whether an area is solid from the start, and none of these beacons switches it off."""
    return area.impenetrable and not area.on_beacon and area.off_beacon not in beacons


def units_of(area: Area, level: Level) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """Return the part of the map around an area, and the units with their centre inside it."""
    left, right = _span(area.x, area.radius, level.width)
    top, bottom = _span(area.y, area.radius, level.height)
    dx = np.arange(left, right) + 0.5 - area.x
    dy = np.arange(top, bottom) + 0.5 - area.y
    disc = np.hypot(dx[None, :], dy[:, None]) < area.radius
    return (slice(top, bottom), slice(left, right)), disc


def _span(middle: float, radius: float, size: int) -> tuple[int, int]:
    first = min(max(math.floor(middle - radius), 0), size)
    return first, max(min(math.ceil(middle + radius), size), first)


def _with_room(blocked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the units farther from all obstacles than a robot's radius."""
    reach = math.ceil(ROBOT_RADIUS) - 1
    beside = row_clearances(blocked, reach + 1)
    free = np.ones(blocked.shape, np.bool_)
    for down in range(-reach, reach + 1):
        across = math.ceil(math.sqrt(ROBOT_RADIUS**2 - down**2)) - 1
        near = beside <= across
        if down >= 0:
            free[: len(free) - down] &= ~near[down:]
        else:
            free[-down:] &= ~near[:down]
    return free
