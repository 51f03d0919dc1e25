"""Where rays meet circles: other robots, beacons and solid areas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from logical_robots_tui.world.rays import (
    FORWARD,
    MIDDLE,
    PER_RADIAN,
    RADAR_RAYS,
    RAYS,
    SENSOR_RANGE,
)
from logical_robots_tui.world.singly import take_singly

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.world.rays import Rays

__all__ = ["FEW", "FEWEST", "Circles", "Pairs", "take_nearer_circles"]

FEWEST = 10
"""Pairs of robot and circle that are quicker looked at one by one."""

FEW = 96
"""Pairs of robot and circle of which it is quicker to try all rays."""

_PAIRS_AT_ONCE = 4096  # bounds the memory for robots that crowd around each other
_EACH_RAY = np.arange(RAYS)
_THREE = np.arange(3.0)[:, None]


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
        return Circles(self.number[near], self.x[near], self.y[near], self.radius[near])


class Pairs(NamedTuple):
    """Robots and circles that may be within reach of their rays; all of shape (pairs,).

    Attributes:
        robot: Place of the robot among those that cast.
        circle: Place of the circle among those that are met.
        dx: From the robot to the centre, map units.
        dy: The same.
        radius: Of the circle.
        least: No hit is less.
    """

    robot: NDArray[np.intp]
    circle: NDArray[np.intp]
    dx: NDArray[np.float64]
    dy: NDArray[np.float64]
    radius: NDArray[np.float64]
    least: NDArray[np.int64]

    def some(self, which: NDArray[np.intp]) -> Pairs:
        """Return some of them, by their places."""
        return Pairs(
            self.robot[which],
            self.circle[which],
            self.dx[which],
            self.dy[which],
            self.radius[which],
            self.least[which],
        )


def take_nearer_circles(hits: NDArray[np.int64], codes: int, rays: Rays, circles: Circles) -> None:
    """Lower hits where a circle is met before what was hit so far.

    Args:
        hits: ``distance * codes + code`` of shape (robots, rays), changed in place. The code of a
            circle is its number plus 1.
        codes: How many codes there are.
        rays: What is cast.
        circles: What is met, the robots that cast among them. No robot meets itself.
    """
    pairs = _within_reach(hits, codes, rays, circles)
    if pairs is None:
        return
    if len(pairs.robot) <= FEWEST:
        take_singly(hits, codes, rays, circles, pairs)
        return
    if len(pairs.robot) <= _PAIRS_AT_ONCE:
        _take(hits, codes, rays, circles, pairs)
        return
    # The nearest first: in a crowd they hide most of the others.
    pairs = pairs.some(pairs.least.argsort())
    for start in range(0, len(pairs.robot), _PAIRS_AT_ONCE):
        some = slice(start, start + _PAIRS_AT_ONCE)
        worst = hits.max(axis=1)[pairs.robot[some]]
        shown = (pairs.least[some] < worst).nonzero()[0] + start
        _take(hits, codes, rays, circles, pairs.some(shown))


def _within_reach(
    hits: NDArray[np.int64], codes: int, rays: Rays, circles: Circles
) -> Pairs | None:
    """Return who may meet what is not hidden by a wall, or None."""
    if len(circles.number) == 1 == len(rays.robot):
        return None
    to_x = circles.x - rays.x[:, None]
    to_y = circles.y - rays.y[:, None]
    away = to_x * to_x
    away += to_y * to_y
    reach = hits.max(axis=1) // codes
    near = away <= np.square(circles.radius + reach[:, None])
    near[np.arange(len(near)), circles.number.searchsorted(rays.robot)] = False  # its own
    robot, circle = near.nonzero()
    if not len(robot):
        return None
    radius = circles.radius[circle]
    least = np.floor(np.sqrt(away[near]) - radius)
    least = np.maximum(least, 1.0).astype(np.int64) * codes + circles.number[circle] + 1
    return Pairs(robot, circle, to_x[near], to_y[near], radius, least)


def _take(hits: NDArray[np.int64], codes: int, rays: Rays, circles: Circles, pairs: Pairs) -> None:
    """Lower hits where pairs meet.

    A chord through the circle tells within less than a step where a ray enters it; whether a
    step is inside is then decided by the distance itself, at the three steps around there.
    """
    pair, ray = _all_rays(pairs) if len(pairs.robot) <= FEW else _between_tangents(rays, pairs)
    hits = hits.reshape(-1)
    shown = (pairs.least[pair] < hits[ray]).nonzero()[0]
    if not len(shown):
        return
    pair, ray = pair[shown], ray[shown]

    cos, sin = rays.cos.reshape(-1)[ray], rays.sin.reshape(-1)[ray]
    size, dx, dy = pairs.radius[pair], pairs.dx[pair], pairs.dy[pair]
    along = dx * cos + dy * sin
    aside = dx * sin - dy * cos
    # Rounding may not lose a grazed circle, so more than it can amount to is added; that
    # widens a chord by far less than a step.
    size_squared = size * size
    half_squared = size_squared - aside * aside
    half_squared += 1e-9 * size + 1e-14 * (along * along + size_squared)
    half = np.sqrt(np.maximum(half_squared, 0.0))
    met = ((half_squared >= 0) & (along + half > 0.5)).nonzero()[0]

    pair, ray = pair[met], ray[met]
    robot, circle = pairs.robot[pair], pairs.circle[pair]
    entry = np.maximum(np.floor((along - half)[met] - 1e-6), 1.0)
    step = entry + _THREE
    dx = cos[met] * step + rays.x[robot] - circles.x[circle]
    dy = sin[met] * step + rays.y[robot] - circles.y[circle]
    inside = _is_nearer(dx, dy, size[met])
    inside &= step < SENSOR_RANGE
    which = inside.argmax(axis=0)
    found = np.flatnonzero(inside.any(axis=0))
    hit = (entry + which)[found].astype(np.int64) * codes + circles.number[circle[found]] + 1
    np.minimum.at(hits, ray[found], hit)


def _all_rays(pairs: Pairs) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return every ray of every pair, as `_between_tangents` does with those that may meet."""
    ray = (pairs.robot * RAYS)[:, None] + _EACH_RAY
    return np.arange(len(ray)).repeat(RAYS), ray.reshape(-1)


def _between_tangents(rays: Rays, pairs: Pairs) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rays that may meet the circle of a pair, all in a row: the pair, and the ray."""
    dx, dy, robot = pairs.dx, pairs.dy, pairs.robot
    cos, sin = rays.cos[robot, FORWARD], rays.sin[robot, FORWARD]
    ahead, right = dx * cos + dy * sin, dy * cos - dx * sin
    sine = pairs.radius / np.maximum(np.hypot(ahead, right), 1e-300)
    # Counted in rays of the radar. From within a circle, and from its very rim, all rays may meet
    # it.
    center = np.arctan2(right, ahead) * PER_RADIAN + MIDDLE
    half = np.arcsin(np.minimum(sine, 1.0)) * PER_RADIAN
    half[sine > 1 - 1e-9] = np.inf
    # More than rounding can amount to; the headings of the rays of a great angle are coarse.
    half += (1e-13 * np.abs(rays.angle) + 1e-3)[robot]
    first = np.ceil(np.minimum(np.maximum(center - half, 0.0), RADAR_RAYS)).astype(np.intp)
    last = np.floor(np.minimum(np.maximum(center + half, -1.0), RADAR_RAYS - 1)).astype(np.intp)
    # The forward ray stands behind the middle one.
    first += first >= FORWARD
    last += last >= FORWARD - 1
    count = last - first + 1
    pair = np.arange(len(first)).repeat(count)
    return pair, np.arange(len(pair)) + (first - count.cumsum() + count + robot * RAYS)[pair]


def _is_nearer(
    dx: NDArray[np.float64], dy: NDArray[np.float64], radius: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return where ``math.hypot(dx, dy) < radius``; the last axis is that of ``radius``.

    Squares decide all but what lies on the rim within rounding.
    """
    squared, limit = dx * dx + dy * dy, radius * radius
    nearer = squared < limit
    rim = np.abs(squared - limit) <= 1e-12 * limit
    if rim.any():
        for i, j in np.argwhere(rim):
            nearer[i, j] = math.hypot(dx[i, j], dy[i, j]) < radius[j]
    return nearer
