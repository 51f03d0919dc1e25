"""What robots see: one forward ray and a radar of 31, cast through walls, robots and bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.values import SensorRow
    from logical_robots_tui.world.level import Level, Robot
    from logical_robots_tui.world.state import AreaState, RobotState

__all__ = [
    "BEACON_RADIUS",
    "RADAR_RAYS",
    "RADAR_SPAN",
    "ROBOT_RADIUS",
    "SENSOR_RANGE",
    "Senses",
    "seen_beacons",
]

SENSOR_RANGE = 200
"""Map units; also the distance that a ray reports when it hits nothing."""

RADAR_RAYS = 31
RADAR_SPAN = 120 * math.pi / 180
"""Radians between the leftmost and the rightmost ray of the radar."""

ROBOT_RADIUS = 9.0
"""Map units within which a ray hits a robot."""

BEACON_RADIUS = 8.0
"""Map units within which a ray hits a beacon."""

_RAYS = 1 + RADAR_RAYS
_ROBOTS_AT_ONCE = 8  # keeps the arrays of one pass within a processor's cache
_WALL = 0  # the code of a wall; robots, beacons and solid areas follow in that order


def seen_beacons(rows: Iterable[SensorRow]) -> frozenset[str]:
    """Return the labels of all beacons on any radar; the forward ray doesn't count.

    Args:
        rows: Sensor rows of one tick.
    """
    return frozenset(
        ray["label"] for row in rows for ray in row["sensor"]["radar"] if ray["object"] == "beacon"
    )


class Senses:
    """Casts the rays of all robots of one level.

    A ray is tested at 1, 2, ... 199 map units from the robot's centre. The first distance at which
    anything is hit is the one reported. Within one distance walls go before robots, robots before
    beacons, beacons before solid areas, each in file order.
    """

    def __init__(self, level: Level) -> None:
        self._robots = level.robots
        self._solid = [i for i, area in enumerate(level.areas) if area.impenetrable]
        solid = [level.areas[i] for i in self._solid]
        # A rim of wall stands for everything outside the map.
        self._width, self._height = level.width + 2, level.height + 2
        self._walls = np.pad(level.walls, 1, constant_values=True).ravel()
        self._steps = np.arange(1, SENSOR_RANGE, dtype=np.float64)

        places = [(beacon.x, beacon.y) for beacon in level.beacons]
        places += [(area.x, area.y) for area in solid]
        self._still_x = np.array([x for x, _ in places], dtype=np.float64)
        self._still_y = np.array([y for _, y in places], dtype=np.float64)
        kinds = (
            [("robot", robot.name, ROBOT_RADIUS) for robot in level.robots]
            + [("beacon", beacon.name, BEACON_RADIUS) for beacon in level.beacons]
            + [("wall", area.name, area.radius) for area in solid]
        )
        self._radius = np.array([radius for _, _, radius in kinds], dtype=np.float64)
        self._objects = ["wall", *(kind for kind, _, _ in kinds), "none"]
        self._labels = ["wall", *(name for _, name, _ in kinds), "nothing"]
        # A hit is one number, distance * codes + code, so that the least of them is the hit to
        # report.
        self._codes = len(self._labels)
        self._nothing = SENSOR_RANGE * self._codes + self._codes - 1

    def rows(
        self, robots: Sequence[RobotState], areas: Sequence[AreaState], clock: int
    ) -> list[SensorRow]:
        """Return what every robot senses, in file order.

        Args:
            robots: All robots, in file order.
            areas: All areas, in file order; the active solid ones are seen as walls.
            clock: Number of the tick to report.

        Returns:
            One ``{"robot_name": ..., "sensor": {...}}`` per robot. Distances are whole map units
            from 1 to 200, angles radians with the robot's left positive.
        """
        headings = [_ray_headings(robot.angle) for robot in robots]
        radius = self._radius.copy()
        first = len(radius) - len(self._solid)
        for k, i in enumerate(self._solid):
            if not areas[i].active:
                radius[first + k] = 0.0  # nothing is nearer than 0
        x = np.array([robot.x for robot in robots], dtype=np.float64)
        y = np.array([robot.y for robot in robots], dtype=np.float64)
        circles = (np.append(x, self._still_x), np.append(y, self._still_y), radius)

        rows: list[SensorRow] = []
        for start in range(0, len(robots), _ROBOTS_AT_ONCE):
            some = slice(start, start + _ROBOTS_AT_ONCE)
            # math.cos and not numpy's, which differs between processors.
            cos = np.array([[math.cos(a) for a in rays] for rays in headings[some]])
            sin = np.array([[math.sin(a) for a in rays] for rays in headings[some]])
            hits = self._wall_hits(x[some], y[some], cos, sin)
            self._take_nearer_circles(hits, start, x[some], y[some], cos, sin, circles)
            for i, robot_hits in enumerate(hits.tolist(), start):
                row = self._row(self._robots[i], robots[i], headings[i], robot_hits, clock)
                rows.append(row)
        return rows

    def _row(
        self, robot: Robot, state: RobotState, headings: list[float], hits: list[int], clock: int
    ) -> SensorRow:
        codes, objects, labels, angle = self._codes, self._objects, self._labels, state.angle
        seen = [(hit // codes, hit % codes) for hit in hits]
        distance, code = seen[0]
        sensor: dict[str, Any] = {
            "forward_distance": distance,
            "forward_object": objects[code],
            "forward_label": labels[code],
            "radar": [
                {
                    "angle": angle - heading,
                    "distance": distance,
                    "object": objects[code],
                    "label": labels[code],
                }
                for heading, (distance, code) in zip(headings[1:], seen[1:], strict=True)
            ],
            "self": {
                "can_charge": robot.can_charge,
                "has_battery": robot.has_battery,
                "battery_level": state.battery_level,
                "battery_capacity": robot.battery_capacity,
            },
            "clock": clock,
        }
        return {"robot_name": robot.name, "sensor": sensor}

    def _wall_hits(
        self,
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        cos: NDArray[np.float64],
        sin: NDArray[np.float64],
    ) -> NDArray[np.int64]:
        """Return the hits of walls alone, for rays of shape (robots, rays)."""
        cell = _floors(y, sin, self._steps, -1, self._height - 2)
        cell += 1
        cell *= self._width
        cell += _floors(x, cos, self._steps, -1, self._width - 2)
        cell += 1
        is_wall = self._walls.take(cell.astype(np.intp))
        first = is_wall.argmax(axis=2)
        found = np.take_along_axis(is_wall, first[:, :, None], axis=2)[:, :, 0]
        return np.where(found, (first + 1) * self._codes + _WALL, self._nothing)

    def _take_nearer_circles(
        self,
        hits: NDArray[np.int64],
        start: int,
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        cos: NDArray[np.float64],
        sin: NDArray[np.float64],
        circles: tuple[NDArray[np.float64], ...],
    ) -> None:
        """Lower ``hits`` of shape (robots, rays) where a circle is hit before the wall.

        A chord through the circle tells within less than a step where a ray enters it; whether a
        step is inside is then decided by the distance itself, at the three steps around there.
        """
        circle_x, circle_y, radius = circles
        to_x = circle_x - x[:, None]
        to_y = circle_y - y[:, None]
        away = to_x * to_x + to_y * to_y
        in_reach = (away <= (radius + SENSOR_RANGE) ** 2) & (radius > 0)
        own = np.arange(len(x))
        in_reach[own, start + own] = False
        robot, circle = np.nonzero(in_reach)
        if not len(robot):
            return

        pair = (robot, circle)
        ray_cos, ray_sin, size = cos[robot], sin[robot], radius[circle][:, None]
        along = to_x[pair][:, None] * ray_cos + to_y[pair][:, None] * ray_sin
        aside = np.abs(to_x[pair][:, None] * ray_sin - to_y[pair][:, None] * ray_cos)
        # Rounding may not lose a grazed circle, so more than it can amount to is added; that
        # widens a chord by far less than a step.
        rounding = 1e-9 * size + 1e-14 * (away[pair][:, None] + size * size)
        half_squared = (size - aside) * (size + aside) + rounding
        half = np.sqrt(np.maximum(half_squared, 0.0))
        touched = (half_squared >= 0) & (along + half > 0.5) & (along - half < SENSOR_RANGE)
        which, ray = np.nonzero(touched)
        robot, circle = robot[which], circle[which]

        entry = np.floor((along - half)[which, ray] - 1e-6)
        step = np.maximum(entry, 1.0)[:, None] + np.arange(3.0)
        dx = x[robot][:, None] + cos[robot, ray][:, None] * step - circle_x[circle][:, None]
        dy = y[robot][:, None] + sin[robot, ray][:, None] * step - circle_y[circle][:, None]
        inside = _is_nearer(dx, dy, radius[circle][:, None]) & (step < SENSOR_RANGE)
        found = inside.any(axis=1)
        distance = step[:, 0].astype(np.int64) + inside.argmax(axis=1)
        hit = (distance * self._codes + 1 + circle)[found]
        np.minimum.at(hits, (robot[found], ray[found]), hit)


def _ray_headings(angle: float) -> list[float]:
    """Return the absolute headings of the forward ray and the radar, left to right."""
    left = angle - RADAR_SPAN / 2
    return [angle, *(left + i * (RADAR_SPAN / (RADAR_RAYS - 1)) for i in range(RADAR_RAYS))]


def _floors(
    start: NDArray[np.float64],
    slope: NDArray[np.float64],
    steps: NDArray[np.float64],
    least: int,
    most: int,
) -> NDArray[np.float64]:
    """Return the cells, kept within bounds, that rays pass at every step along one axis."""
    cells = slope[:, :, None] * steps
    cells += start[:, None, None]
    np.floor(cells, out=cells)
    return np.clip(cells, least, most, out=cells)


def _is_nearer(
    dx: NDArray[np.float64], dy: NDArray[np.float64], radius: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return where ``math.hypot(dx, dy) < radius``.

    Squares decide all but what lies on the rim within rounding.
    """
    squared, limit = dx * dx + dy * dy, radius * radius
    nearer = squared < limit
    on_rim = np.nonzero(np.abs(squared - limit) <= 1e-12 * limit)
    for i, j in zip(*on_rim, strict=True):
        nearer[i, j] = math.hypot(dx[i, j], dy[i, j]) < radius[i, 0]
    return nearer
