"""The rays that robots cast (one forward, a radar of 31 around it) and the circles they meet."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from logical_robots_tui.schema import RADAR_DEGREES, RADAR_RAYS, SENSOR_RANGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.world.state import RobotState

RADAR_SPAN = RADAR_DEGREES * math.pi / 180
"""Radians between the leftmost and the rightmost ray of the radar."""

PER_RADIAN = (RADAR_RAYS - 1) / RADAR_SPAN
"""Rays of the radar per radian."""

MIDDLE = (RADAR_RAYS - 1) / 2
"""Index of the radar's ray that points forward, as a float."""

RAYS = RADAR_RAYS + 1

FORWARD = RADAR_RAYS // 2 + 1
"""Column of the forward ray, right after the middle one of the radar, so that neighbouring rays are
in neighbouring columns."""

_TURNS = np.array([i * (RADAR_SPAN / (RADAR_RAYS - 1)) for i in range(RADAR_RAYS)])
_TURNS = np.insert(_TURNS, FORWARD, 0.0)


class Rays(NamedTuple):
    """The rays of some robots: number in file order, start and heading, of shape (robots,).

    `aside`, of shape (robots, rays), are reported angles in radians, left positive, from left
    to right with the forward ray at ``FORWARD``; `cos` and `sin` are of the rays' headings.
    """

    robot: NDArray[np.intp]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    angle: NDArray[np.float64]
    aside: NDArray[np.float64]
    cos: NDArray[np.float64]
    sin: NDArray[np.float64]

    def some(self, which: NDArray[np.intp]) -> Rays:
        return Rays._make(part[which] for part in self)


class Circles(NamedTuple):
    """What rays can meet, in map units; all of shape (circles,).

    `number` tells circles apart, robots first, ascending; `x` is infinite for what is not
    there.
    """

    number: NDArray[np.intp]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    radius: NDArray[np.float64]

    def around(self, rays: Rays) -> Circles:
        far = self.radius + SENSOR_RANGE
        near = (self.x + far >= rays.x.min()) & (self.x - far <= rays.x.max())
        near &= (self.y + far >= rays.y.min()) & (self.y - far <= rays.y.max())
        return Circles._make(part[near] for part in self)


def rays_of(robots: Sequence[RobotState], which: Sequence[int]) -> Rays:
    some = [robots[place] for place in which]
    x = np.array([robot.x for robot in some])
    y = np.array([robot.y for robot in some])
    angle = np.array([robot.angle for robot in some])
    headings = (angle - RADAR_SPAN / 2)[:, None] + _TURNS
    headings[:, FORWARD] = angle
    # math.cos and not numpy's, which differs between processors.
    each = headings.ravel().tolist()
    cos = np.fromiter(map(math.cos, each), np.float64, len(each)).reshape(headings.shape)
    sin = np.fromiter(map(math.sin, each), np.float64, len(each)).reshape(headings.shape)
    number = np.array(which, dtype=np.intp)
    return Rays(number, x, y, angle, angle[:, None] - headings, cos, sin)
