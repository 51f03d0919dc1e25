"""The rays that robots cast (one forward, and a radar around it) and the circles they meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.level import Sensors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Floats = NDArray[np.float64]
    _Ints = NDArray[np.int64]
    _Places = NDArray[np.intp]


class RayLayout:
    """Where the rays of a robot point.

    Attributes:
        span: Radians between the leftmost and the rightmost ray of the radar.
        per_radian: Rays of the radar per radian.
        middle: Index of the radar's ray that points forward, as a float.
        radar: Rays of the radar.
        columns: All rays.
        forward: Column of the forward ray, right after the middle one of the radar, so that
            neighbouring rays are in neighbouring columns.
        turns: Radians to the right of the leftmost ray, by column.
        reach: Map units.
        is_wide: Whether rays to either side may meet the same circle behind a robot.
    """

    def __init__(self, sensors: Sensors) -> None:
        self.radar, self.reach = sensors.rays, sensors.reach
        self.span = sensors.view * math.pi / 180
        self.per_radian = (self.radar - 1) / self.span
        self.middle = (self.radar - 1) / 2
        self.columns, self.forward = self.radar + 1, self.radar // 2 + 1
        turns = np.array([i * (self.span / (self.radar - 1)) for i in range(self.radar)])
        self.turns = np.insert(turns, self.forward, 0.0)
        self.is_wide = sensors.view > _HALF_TURN


_HALF_TURN = 180


class Rays(NamedTuple):
    """The rays of some robots: number in file order, start and heading, of shape (robots,).

    `aside`, of shape (robots, rays), are reported angles in radians, left positive, from left
    to right as in `layout`; `cos` and `sin` are of the rays' headings.
    """

    robot: _Places
    x: _Floats
    y: _Floats
    angle: _Floats
    aside: _Floats
    cos: _Floats
    sin: _Floats
    layout: RayLayout

    def take(self, indices: _Places) -> Rays:
        return Rays._make((*(part[indices] for part in self[:-1]), self.layout))


class Circles(NamedTuple):
    """What rays can meet, in map units; all of shape (circles,).

    `number` tells circles apart, robots first, ascending; `x` is infinite for what is not
    there.
    """

    number: _Places
    x: _Floats
    y: _Floats
    radius: _Floats

    def around(self, rays: Rays) -> Circles:
        far = self.radius + rays.layout.reach
        near = (self.x + far >= rays.x.min()) & (self.x - far <= rays.x.max())
        near &= (self.y + far >= rays.y.min()) & (self.y - far <= rays.y.max())
        return Circles._make(part[near] for part in self)


def rays_of(robots: Sequence[RobotState], indices: Sequence[int], layout: RayLayout) -> Rays:
    casters = [robots[index] for index in indices]
    x = np.array([robot.x for robot in casters])
    y = np.array([robot.y for robot in casters])
    angle = np.array([robot.angle for robot in casters])
    headings = (angle - layout.span / 2)[:, None] + layout.turns
    headings[:, layout.forward] = angle
    # math.cos and not numpy's, which differs between processors.
    flat = headings.ravel().tolist()
    cos = np.fromiter(map(math.cos, flat), np.float64, len(flat)).reshape(headings.shape)
    sin = np.fromiter(map(math.sin, flat), np.float64, len(flat)).reshape(headings.shape)
    number = np.array(indices, dtype=np.intp)
    return Rays(number, x, y, angle, angle[:, None] - headings, cos, sin, layout)


FEWEST = 80
"""Up to this many pairs of robot and circle are faster tested one by one."""

FEWEST_NEAR = 10
"""Of these, at most so many may be within reach."""

FEW = 200
"""Up to this many pairs within reach it is faster to try all rays."""

_PAIRS_AT_ONCE = 4096  # bounds the memory for robots that crowd around each other
_THREE = np.arange(3.0)[:, None]


class Pairs(NamedTuple):
    """Robots and circles that may be within reach of their rays; all of shape (pairs,).

    `dx` and `dy` are map units from robot to centre; `robot` is an index among those that cast.
    """

    robot: _Places
    circle: _Places
    dx: _Floats
    dy: _Floats
    squared: _Floats
    radius: _Floats

    def take(self, indices: _Places) -> Pairs:
        return Pairs._make(part[indices] for part in self)


class Chords(NamedTuple):
    """Rays that may cross a circle, possibly behind their start; all of shape (chords,).

    `along` is from the robot to the chord's middle, map units, negative behind; `half_squared`
    is the square of half its length, plus a small margin.
    """

    pair: _Places
    ray: _Places
    along: _Floats
    half_squared: _Floats


def take_nearer_circles(hits: _Ints, codes: int, rays: Rays, circles: Circles) -> None:
    """Lower hits where a circle is closer than what was hit so far; no robot hits itself.

    `hits` are ``distance * codes + code`` of shape (robots, rays), changed in place; the code
    of a circle is its number plus 1.
    """
    possible = len(rays.robot) * len(circles.number)
    if possible == 1 or (
        possible <= FEWEST and _take_one_by_one(hits, codes, rays, circles, limit=FEWEST_NEAR)
    ):
        return
    pairs = _within_reach(hits, codes, rays, circles)
    if not len(pairs.robot):
        return
    if len(pairs.robot) <= FEW:
        _take(hits, codes, rays, circles, pairs, _of_all_rays(rays, pairs))
        return
    bounds = np.maximum(np.floor(np.sqrt(pairs.squared) - pairs.radius), 1.0).astype(np.int64)
    bounds = bounds * codes + circles.number[pairs.circle] + 1
    if len(pairs.robot) <= _PAIRS_AT_ONCE:
        _take(hits, codes, rays, circles, pairs, _between_tangents(hits, bounds, rays, pairs))
        return
    # Nearest first: in a crowd they hide most of the others.
    order = bounds.argsort()
    pairs, bounds = pairs.take(order), bounds[order]
    for start in range(0, len(order), _PAIRS_AT_ONCE):
        worst = hits.max(axis=1)[pairs.robot[start : start + _PAIRS_AT_ONCE]]
        closer = (bounds[start : start + _PAIRS_AT_ONCE] < worst).nonzero()[0] + start
        part = pairs.take(closer)
        chords = _between_tangents(hits, bounds[closer], rays, part)
        _take(hits, codes, rays, circles, part, chords)


def _within_reach(hits: _Ints, codes: int, rays: Rays, circles: Circles) -> Pairs:
    to_x = circles.x - rays.x[:, None]
    to_y = circles.y - rays.y[:, None]
    squared = to_x * to_x
    squared += to_y * to_y
    reach = hits.max(axis=1) // codes
    near = squared <= np.square(circles.radius + reach[:, None])
    near[np.arange(len(near)), circles.number.searchsorted(rays.robot)] = False  # its own
    indices = near.reshape(-1).nonzero()[0]
    robot, circle = np.divmod(indices, len(circles.number))
    dx, dy, squared = to_x.take(indices), to_y.take(indices), squared.take(indices)
    return Pairs(robot, circle, dx, dy, squared, circles.radius[circle])


def _of_all_rays(rays: Rays, pairs: Pairs) -> Chords:
    cos, sin = rays.cos.take(pairs.robot, axis=0), rays.sin.take(pairs.robot, axis=0)
    dx, dy = pairs.dx[:, None], pairs.dy[:, None]
    along = dx * cos
    along += dy * sin
    aside = dx * sin
    aside -= dy * cos
    half_squared = _widen(pairs)[:, None] - np.square(aside, out=aside)
    indices = (half_squared >= 0).reshape(-1).nonzero()[0]
    pair, ray = np.divmod(indices, rays.layout.columns)
    ray += pairs.robot.take(pair) * rays.layout.columns
    return Chords(pair, ray, along.take(indices), half_squared.take(indices))


def _between_tangents(hits: _Ints, bounds: _Ints, rays: Rays, pairs: Pairs) -> Chords:
    """Return the chords ahead of rays that have not hit something closer.

    `bounds`, of shape (pairs,), are lower bounds of the hits of each pair.
    """
    dx, dy, robot, layout = pairs.dx, pairs.dy, pairs.robot, rays.layout
    cos, sin = rays.cos[robot, layout.forward], rays.sin[robot, layout.forward]
    ahead, right = dx * cos + dy * sin, dy * cos - dx * sin
    sine = pairs.radius / np.maximum(np.hypot(ahead, right), 1e-300)
    # In units of radar rays. From inside a circle, and exactly from its edge, all rays may hit
    # it.
    center = np.arctan2(right, ahead) * layout.per_radian + layout.middle
    half = np.arcsin(np.minimum(sine, 1.0)) * layout.per_radian
    half[(sine > 1 - 1e-9) | layout.is_wide] = np.inf
    # More than any rounding error; the headings of rays with large angles are imprecise.
    half += (1e-13 * np.abs(rays.angle) + 1e-3)[robot]
    first = np.ceil(np.minimum(np.maximum(center - half, 0.0), layout.radar)).astype(np.intp)
    last = np.floor(np.minimum(np.maximum(center + half, -1.0), layout.radar - 1)).astype(np.intp)
    # The forward ray comes after the middle one.
    first += first >= layout.forward
    last += last >= layout.forward - 1
    count = last - first + 1
    pair = np.arange(len(first)).repeat(count)
    ray = np.arange(len(pair)) + (first - count.cumsum() + count + robot * layout.columns)[pair]

    visible = (bounds[pair] < hits.reshape(-1)[ray]).nonzero()[0]
    pair, ray = pair[visible], ray[visible]
    cos, sin = rays.cos.reshape(-1)[ray], rays.sin.reshape(-1)[ray]
    dx, dy = dx[pair], dy[pair]
    along = dx * cos + dy * sin
    aside = dx * sin - dy * cos
    half_squared = _widen(pairs)[pair] - aside * aside
    crossing = (half_squared >= 0).nonzero()[0]
    return Chords(pair[crossing], ray[crossing], along[crossing], half_squared[crossing])


def _widen(pairs: Pairs) -> _Floats:
    """Return squared radii enlarged by more than any rounding error, so no circle is missed."""
    squared = pairs.radius * pairs.radius
    return squared + 1e-9 * pairs.radius + 1e-14 * (pairs.squared + squared)


def _take(
    hits: _Ints, codes: int, rays: Rays, circles: Circles, pairs: Pairs, chords: Chords
) -> None:
    """Lower hits where rays enter circles; exact distances decide among three steps."""
    pair, ray, along, half_squared = chords
    if not len(pair):
        return
    robot, circle = pairs.robot.take(pair), pairs.circle.take(pair)
    entry = np.maximum(np.floor(along - np.sqrt(half_squared) - 1e-6), 1.0)
    step = entry + _THREE
    dx = rays.cos.take(ray) * step
    dx += rays.x.take(robot)
    dx -= circles.x.take(circle)
    dy = rays.sin.take(ray) * step
    dy += rays.y.take(robot)
    dy -= circles.y.take(circle)
    inside = _is_nearer(dx, dy, pairs.radius.take(pair))
    inside &= step < rays.layout.reach
    which = inside.argmax(axis=0)
    hit_chords = np.flatnonzero(inside.any(axis=0))
    distance = (entry + which).take(hit_chords).astype(np.int64)
    number = circles.number.take(circle.take(hit_chords))
    np.minimum.at(hits.reshape(-1), ray.take(hit_chords), distance * codes + number + 1)


def _is_nearer(dx: _Floats, dy: _Floats, radius: _Floats) -> NDArray[np.bool_]:
    """Return where ``math.hypot(dx, dy) < radius``; squares decide all but the rounded edge."""
    limit = radius * radius
    over = dx * dx
    over += dy * dy
    over -= limit
    nearer = over < 0
    rim = np.abs(over, out=over) <= 1e-12 * limit
    if rim.any():
        for i, j in np.argwhere(rim):
            nearer[i, j] = math.hypot(dx[i, j], dy[i, j]) < radius[j]
    return nearer


def _take_one_by_one(hits: _Ints, codes: int, rays: Rays, circles: Circles, limit: int) -> bool:
    """Like `take_nearer_circles`; with more than `limit` pairs return False and change nothing."""
    rows, layout, forward = hits.tolist(), rays.layout, rays.layout.forward
    targets = list(zip(*(part.tolist() for part in circles), strict=True))
    starts = zip(rays.robot.tolist(), rays.x.tolist(), rays.y.tolist(), strict=True)
    pairs = []
    for row, (robot, x, y) in enumerate(starts):
        reach = max(rows[row]) // codes
        for number, center_x, center_y, radius in targets:
            distance = math.hypot(center_x - x, center_y - y)
            if distance <= radius + reach and number != robot:
                pairs.append((row, number, center_x, center_y, radius, distance))
    if len(pairs) > limit:
        return False
    for row, number, center_x, center_y, radius, distance in pairs:
        hit, cos, sin = rows[row], rays.cos[row].tolist(), rays.sin[row].tolist()
        angle, x, y = rays.angle.item(row), rays.x.item(row), rays.y.item(row)
        dx, dy = center_x - x, center_y - y
        ahead, right = dx * cos[forward] + dy * sin[forward], dy * cos[forward] - dx * sin[forward]
        lower_bound = max(math.floor(distance - radius), 1) * codes + number + 1
        for ray in _rays_between_tangents(ahead, right, radius, angle, layout):
            if lower_bound >= hit[ray]:
                continue
            along, aside = dx * cos[ray] + dy * sin[ray], dx * sin[ray] - dy * cos[ray]
            for step in _steps_around_entry(along, aside, radius, layout.reach):
                to_x, to_y = cos[ray] * step + x - center_x, sin[ray] * step + y - center_y
                if math.hypot(to_x, to_y) < radius:
                    hits[row, ray] = hit[ray] = min(hit[ray], step * codes + number + 1)
                    break
    return True


def _rays_between_tangents(
    ahead: float, right: float, radius: float, angle: float, layout: RayLayout
) -> range:
    distance = math.hypot(ahead, right)
    if layout.is_wide or radius >= distance * (1 - 1e-9):
        return range(layout.columns)
    center = math.atan2(right, ahead) * layout.per_radian + layout.middle
    # More than any rounding error.
    half = math.asin(radius / distance) * layout.per_radian + 1e-13 * abs(angle) + 1e-3
    first = math.ceil(max(center - half, 0.0))
    last = math.floor(min(center + half, layout.radar - 1.0))
    # The forward ray comes after the middle one.
    return range(first + (first >= layout.forward), last + (last >= layout.forward - 1) + 1)


def _steps_around_entry(along: float, aside: float, radius: float, reach: int) -> range:
    """Return the steps that include the first one inside the circle, if there is one."""
    half_squared = radius * radius - aside * aside
    half_squared += 1e-9 * radius + 1e-14 * (along * along + radius * radius)
    half = math.sqrt(max(half_squared, 0.0))
    if half_squared < 0 or along + half <= 0.5:
        return range(0)
    entry = max(math.floor(along - half - 1e-6), 1)
    return range(entry, min(entry + 3, reach))
