"""Sensing: one sensor row per robot, from what its rays hit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from logical_robots_tui.schema import BEACON, NO_LABEL, NO_OBJECT, ROBOT, SELF, SENSOR_RANGE, WALL
from logical_robots_tui.values import SensorRow
from logical_robots_tui.world.dynamics import AreaState, RobotState
from logical_robots_tui.world.level import Area, Beacon, Level, Robot
from logical_robots_tui.world.rays import (
    Circles,
    RayLayout,
    Rays,
    rays_of,
    take_nearer_circles,
)
from logical_robots_tui.world.walls import Walls

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Hits = NDArray[np.int64]

ROBOT_RADIUS = 9.0
"""Map units within which a ray hits a robot."""

BEACON_RADIUS = 8.0
"""Map units within which a ray hits a beacon."""

_SUMMANDS = 12

_ROBOTS_AT_ONCE = 64  # keeps the arrays of one pass within a processor's cache
_FEW_ROBOTS = 16  # with more robots, finding out whose reading may change costs more than it saves

_View: TypeAlias = dict[str, Any]
"""The part of a sensor that comes from rays."""


class _Reading(NamedTuple):
    """The last reading of all robots, as reported in `views`, and the state it depends on."""

    robots: Sequence[RobotState]
    active: list[bool]
    hits: _Hits
    views: list[_View]


class Senses:
    """Casts the rays of all robots of one level, at 1, 2, ... 199 map units from the centre.

    That, and how many rays there are, is up to the sensors of the level. At the same distance
    walls precede robots, robots beacons, and beacons solid areas, each in file order; with teams a
    ray instead reports the robot nearest to its end. `like` has nearly the same walls, for speed.
    """

    def __init__(self, level: Level, *, like: Senses | None = None) -> None:
        self._robots = level.robots
        like_walls = None if like is None else like._walls
        self._layout, self._sensors = RayLayout(level.sensors), level.sensors
        self._walls: Walls = Walls(level.walls, level.sensors.reach, like=like_walls)
        self._solid = [i for i, area in enumerate(level.areas) if area.impenetrable]
        solid = [level.areas[i] for i in self._solid]
        circles: list[Robot | Beacon | Area] = [*level.robots, *level.beacons, *solid]
        self._x = np.array([circle.x for circle in circles], dtype=np.float64)
        self._y = np.array([circle.y for circle in circles], dtype=np.float64)
        # What a ray hits has a code: 0 is a wall, the circles follow, and the last is nothing.
        # A hit is one number, distance * codes + code, so that the smallest is reported.
        kinds = [
            *((ROBOT, robot.name, ROBOT_RADIUS) for robot in level.robots),
            *((BEACON, beacon.name, BEACON_RADIUS) for beacon in level.beacons),
            *((WALL, area.name, area.radius) for area in solid),
        ]
        self._numbers = np.arange(len(kinds))
        self._radius = np.array([radius for _, _, radius in kinds], dtype=np.float64)
        self._objects = np.array([WALL, *(kind for kind, _, _ in kinds), NO_OBJECT], dtype=object)
        self._labels = np.array([WALL, *(name for _, name, _ in kinds), NO_LABEL], dtype=object)
        self._codes = len(self._labels)
        self._wall_hits = np.arange(level.sensors.reach + 1) * self._codes
        self._wall_hits[-1] += self._codes - 1
        self._beacons = slice(1 + len(level.robots), self._codes - 1 - len(solid))
        switches = {name for area in level.areas for name in (area.on_beacon, area.off_beacon)}
        self._has_switches = any(beacon.name in switches for beacon in level.beacons)
        self._last: _Reading | None = None
        names = [robot.name for robot in level.robots]
        self._by_name, self._has_teams = np.argsort(names), bool(level.teams)

    def sense(
        self, robots: Sequence[RobotState], areas: Sequence[AreaState], clock: int
    ) -> tuple[list[SensorRow], frozenset[str]]:
        """Return every robot's reading, and which switching beacons are on any radar.

        Readings are ``{"robot_name": ..., "sensor": {...}}`` in file order, distances whole map
        units from 1 to 200, angles radians with left positive. The forward ray doesn't count for
        beacons; active solid areas are seen as walls.
        """
        last = self._last = self._look(robots, [areas[i].active for i in self._solid], clock)
        rows: list[SensorRow] = []
        for robot, state, view in zip(self._robots, robots, last.views, strict=True):
            fields = {name: getattr(state if changes else robot, name) for name, changes in _SELF}
            sensor = {**view, "self": fields, "clock": clock}
            rows.append({"robot_name": robot.name, "sensor": sensor})
        if not self._has_switches:
            return rows, frozenset()
        code = last.hits % self._codes
        on_radar = np.zeros(self._codes, dtype=np.bool_)
        forward = self._layout.forward
        on_radar[code[:, :forward]] = on_radar[code[:, forward + 1 :]] = True
        return rows, frozenset(self._labels[self._beacons][on_radar[self._beacons]].tolist())

    def _look(self, robots: Sequence[RobotState], active: list[bool], clock: int) -> _Reading:
        """Return what robots see; only robots whose reading may have changed look again."""
        last, indices = None if self._sensors.noise else self._last, list(range(len(robots)))
        if last is not None and last.active == active and len(robots) <= _FEW_ROBOTS:
            indices = self._may_have_changed(robots, last)
            if not indices:
                return last._replace(robots=robots)
        rays = rays_of(robots, indices, self._layout)
        x, y = self._x.copy(), self._y.copy()
        x[: len(robots)] = [robot.x for robot in robots]
        y[: len(robots)] = [robot.y for robot in robots]
        for number, is_active in enumerate(active, len(x) - len(active)):
            if not is_active:
                x[number] = np.inf
        hits = self._hits(rays, Circles(self._numbers, x, y, self._radius))
        if self._has_teams:
            self._settle(hits, rays, robots, self._by_name)
        distance, code = np.divmod(hits, self._codes)
        if self._sensors.noise:
            distance = np.where(code == self._codes - 1, distance, self._noisy(distance, clock))
        parts = (rays.aside, distance, self._objects[code], self._labels[code])
        forward = [self._layout.forward] * len(indices)
        views = list(map(_view, *(part.tolist() for part in parts), forward))
        if last is not None and len(indices) < len(robots):
            all_hits = last.hits.copy()
            all_hits[indices] = hits
            new_views = dict(zip(indices, views, strict=True))
            views = [new_views.get(index, view) for index, view in enumerate(last.views)]
            hits = all_hits
        return _Reading(robots, active, hits, views)

    def _may_have_changed(self, robots: Sequence[RobotState], last: _Reading) -> list[int]:
        """Return the indices of robots that moved, or had a moving robot in view, then or now."""
        positions: list[tuple[float, float]] = []
        indices: list[int] = []
        unmoved: list[int] = []
        for index, (robot, old_robot) in enumerate(zip(robots, last.robots, strict=True)):
            if robot.x != old_robot.x or robot.y != old_robot.y:
                positions += ((robot.x, robot.y), (old_robot.x, old_robot.y))
                indices.append(index)
            elif robot.angle != old_robot.angle:
                indices.append(index)
            else:
                unmoved.append(index)
        for index in unmoved:
            robot, radius = robots[index], ROBOT_RADIUS + _MARGIN
            cos, sin = math.cos(robot.angle), math.sin(robot.angle)
            offsets = [(x - robot.x, y - robot.y) for x, y in positions]
            # Circles that are entirely behind the robot don't matter, unless a ray points there.
            nearest = -math.inf if self._sensors.view > 180 else -radius
            near = [math.hypot(dx, dy) for dx, dy in offsets if dx * cos + dy * sin > nearest]
            if near and min(near) < last.hits[index].max().item() // self._codes + radius:
                indices.append(index)
        return sorted(indices)

    def _noisy(self, distance: _Hits, clock: int) -> _Hits:
        """Return distances with the noise of a tick, the same on every machine.

        A robot's noise does not depend on its place in the file, but on that of its name in the
        alphabet. It is nearly Gaussian: the sum of twelve uniform numbers, whose variance is 1.
        """
        raw = np.random.Philox(key=self._sensors.seed, counter=[0, 0, 0, clock])
        numbers = np.asarray(raw.random_raw(_SUMMANDS * distance.size) >> np.uint64(32), np.int64)
        sums = numbers.reshape(_SUMMANDS, *distance.shape).sum(axis=0)
        noise = np.empty(distance.shape)
        noise[self._by_name] = (sums / 2**32 - _SUMMANDS / 2) * self._sensors.noise
        distances = np.rint(distance + noise).astype(np.int64)
        noisy: _Hits = np.minimum(np.maximum(distances, 1), self._sensors.reach - 1)
        return noisy

    def _hits(self, rays: Rays, circles: Circles) -> _Hits:
        if len(rays.robot) <= _ROBOTS_AT_ONCE:
            return self._cast(rays, circles)
        hits = np.empty(rays.cos.shape, dtype=np.int64)
        # Neighbours are cast together, so that they test few circles.
        order = np.lexsort((rays.y, np.floor(rays.x / SENSOR_RANGE)))
        for start in range(0, len(order), _ROBOTS_AT_ONCE):
            neighbours = order[start : start + _ROBOTS_AT_ONCE]
            batch = rays.take(neighbours)
            hits[neighbours] = self._cast(batch, circles.around(batch))
        return hits

    def _cast(self, rays: Rays, circles: Circles) -> _Hits:
        walls = self._walls.distances(rays.x, rays.y, rays.cos, rays.sin)
        hits = self._wall_hits.take(walls)
        take_nearer_circles(hits, self._codes, rays, circles)
        return hits

    def _settle(
        self, hits: _Hits, rays: Rays, robots: Sequence[RobotState], order: NDArray[np.intp]
    ) -> None:
        """Choose, in place, among robots hit at once by position, then by `order`."""
        places = np.array([(robots[i].x, robots[i].y) for i in order])
        between = np.hypot(*(places[:, None] - places).T)
        if np.count_nonzero(between < 2 * ROBOT_RADIUS + _MARGIN) == len(order):
            return  # each is only near itself
        distance, code = np.divmod(hits, self._codes)
        viewer, ray = ((code >= 1) & (code <= len(order))).nonzero()
        steps = distance[viewer, ray]
        x = rays.x[viewer] + steps * rays.cos[viewer, ray]
        y = rays.y[viewer] + steps * rays.sin[viewer, ray]
        separation = np.hypot(x[:, None] - places[:, 0], y[:, None] - places[:, 1])
        separation[order == rays.robot[viewer][:, None]] = np.inf  # its own body
        is_hit = separation.min(axis=1) < ROBOT_RADIUS
        nearest = order[separation.argmin(axis=1)]
        hits[viewer[is_hit], ray[is_hit]] = (steps * self._codes + nearest + 1)[is_hit]


def _view(
    angles: list[float], distances: list[int], objects: list[str], labels: list[str], forward: int
) -> _View:
    """Return what the rays of one robot report; consumes the lists, which hold a value per ray."""
    del angles[forward]
    return {
        "forward_distance": distances.pop(forward),
        "forward_object": objects.pop(forward),
        "forward_label": labels.pop(forward),
        "radar": [
            {"angle": angle, "distance": distance, "object": kind, "label": label}
            for angle, distance, kind, label in zip(angles, distances, objects, labels, strict=True)
        ],
    }


_SELF = [(name, name in RobotState.__slots__) for name in SELF.names]
"""What a robot knows of itself, and whether that is part of its state."""

_MARGIN = 1.0
"""Map units; far more than any rounding error."""
