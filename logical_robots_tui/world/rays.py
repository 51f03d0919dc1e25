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
    """The rays of some robots.

    Attributes:
        robot: The robots' numbers in file order, of shape (robots,).
        x: Where they start, of shape (robots,).
        y: The same.
        angle: The robots' headings in radians, of shape (robots,).
        aside: Reported angles of the rays in radians, left positive, of shape (robots, rays), from
            left to right with the forward ray at ``FORWARD``.
        cos: Of the rays' headings, of the same shape.
        sin: The same.
    """

    robot: NDArray[np.intp]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    angle: NDArray[np.float64]
    aside: NDArray[np.float64]
    cos: NDArray[np.float64]
    sin: NDArray[np.float64]

    def some(self, which: NDArray[np.intp]) -> Rays:
        """Return the rays of some of the robots."""
        return Rays._make(part[which] for part in self)


class Circles(NamedTuple):
    """What rays can meet; all of shape (circles,).

    Attributes:
        number: To tell them apart, ascending. The robots, in file order, have the first ones.
        x: Centres in map units; infinite for what is not there.
        y: The same, but finite.
        radius: Map units.
    """

    number: NDArray[np.intp]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    radius: NDArray[np.float64]

    def around(self, rays: Rays) -> Circles:
        """Return those of the circles that could be in reach of any of the rays."""
        far = self.radius + SENSOR_RANGE
        near = (self.x + far >= rays.x.min()) & (self.x - far <= rays.x.max())
        near &= (self.y + far >= rays.y.min()) & (self.y - far <= rays.y.max())
        return Circles._make(part[near] for part in self)


def rays_of(robots: Sequence[RobotState], which: Sequence[int]) -> Rays:
    """Return the rays that some of the robots cast from their positions."""
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
