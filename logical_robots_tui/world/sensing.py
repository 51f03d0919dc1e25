"""What robots sense: one row for each robot, from what its rays hit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.world.circles import Circles, take_nearer_circles
from logical_robots_tui.world.rays import FORWARD, SENSOR_RANGE, rays_of
from logical_robots_tui.world.walls import Walls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.values import SensorRow
    from logical_robots_tui.world.level import Level, Robot
    from logical_robots_tui.world.rays import Rays
    from logical_robots_tui.world.state import AreaState, RobotState

__all__ = ["BEACON_RADIUS", "ROBOT_RADIUS", "SENSOR_RANGE", "Senses"]

ROBOT_RADIUS = 9.0
"""Map units within which a ray hits a robot."""

BEACON_RADIUS = 8.0
"""Map units within which a ray hits a beacon."""

_ROBOTS_AT_ONCE = 64  # keeps the arrays of one pass within a processor's cache


class Senses:
    """Casts the rays of all robots of one level.

    A ray is tested at 1, 2, ... 199 map units from the robot's centre. The first distance at which
    anything is hit is the one reported. Within one distance walls go before robots, robots before
    beacons, beacons before solid areas, each in file order.

    Args:
        level: The level.
        like: The senses in a level with nearly the same walls, from which these are made quicker.
    """

    def __init__(self, level: Level, *, like: Senses | None = None) -> None:
        self._robots = level.robots
        like_walls = None if like is None else like._walls
        self._walls: Walls = Walls(level.walls, SENSOR_RANGE, like=like_walls)
        self._solid = [i for i, area in enumerate(level.areas) if area.impenetrable]
        solid = [level.areas[i] for i in self._solid]
        places = [(b.x, b.y) for b in level.beacons] + [(area.x, area.y) for area in solid]
        self._still_x = np.array([x for x, _ in places], dtype=np.float64)
        self._still_y = np.array([y for _, y in places], dtype=np.float64)
        # What a ray hits has a code: 0 is a wall, the circles follow, and the last is nothing.
        # A hit is one number, distance * codes + code, so that the least is the one to report.
        kinds = [
            *(("robot", robot.name, ROBOT_RADIUS) for robot in level.robots),
            *(("beacon", beacon.name, BEACON_RADIUS) for beacon in level.beacons),
            *(("wall", area.name, area.radius) for area in solid),
        ]
        self._numbers = np.arange(len(kinds))
        self._radius = np.array([radius for _, _, radius in kinds], dtype=np.float64)
        self._objects = np.array(["wall", *(kind for kind, _, _ in kinds), "none"], dtype=object)
        self._labels = np.array(["wall", *(name for _, name, _ in kinds), "nothing"], dtype=object)
        self._codes = len(self._labels)
        self._nothing = SENSOR_RANGE * self._codes + self._codes - 1
        self._beacons = slice(1 + len(level.robots), self._codes - 1 - len(solid))

    def sense(
        self, robots: Sequence[RobotState], areas: Sequence[AreaState], clock: int
    ) -> tuple[list[SensorRow], frozenset[str]]:
        """Return what every robot senses, and which beacons are on any radar.

        Args:
            robots: All robots, in file order.
            areas: All areas, in file order; the active solid ones are seen as walls.
            clock: Number of the tick to report.

        Returns:
            One ``{"robot_name": ..., "sensor": {...}}`` per robot, in file order; distances are
            whole map units from 1 to 200, angles radians with the robot's left positive. Then the
            names of the beacons; the forward ray doesn't count.
        """
        rays = rays_of(robots)
        distance, code = np.divmod(self._hits(rays, self._circles(rays, areas)), self._codes)
        on_radar = np.zeros(self._codes, dtype=np.bool_)
        on_radar[code[:, :FORWARD]] = on_radar[code[:, FORWARD + 1 :]] = True
        seen = self._labels[self._beacons][on_radar[self._beacons]]
        return self._rows(robots, rays, distance, code, clock), frozenset(seen.tolist())

    def _circles(self, rays: Rays, areas: Sequence[AreaState]) -> Circles:
        x, y = np.concatenate((rays.x, self._still_x)), np.concatenate((rays.y, self._still_y))
        for number, i in enumerate(self._solid, len(x) - len(self._solid)):
            if not areas[i].active:
                x[number] = np.inf
        return Circles(self._numbers, x, y, self._radius)

    def _hits(self, rays: Rays, circles: Circles) -> NDArray[np.int64]:
        """Return the hits of all rays, of shape (robots, rays)."""
        if len(rays.robot) <= _ROBOTS_AT_ONCE:
            return self._cast(rays, circles)
        hits = np.empty(rays.cos.shape, dtype=np.int64)
        # Neighbours go together, so that they have to look at few circles.
        order = np.lexsort((rays.y, np.floor(rays.x / SENSOR_RANGE)))
        for start in range(0, len(order), _ROBOTS_AT_ONCE):
            neighbours = order[start : start + _ROBOTS_AT_ONCE]
            some = rays.some(neighbours)
            hits[neighbours] = self._cast(some, circles.around(some))
        return hits

    def _cast(self, rays: Rays, circles: Circles) -> NDArray[np.int64]:
        walls = self._walls.distances(rays.x, rays.y, rays.cos, rays.sin)
        hits = np.where(walls < SENSOR_RANGE, walls * self._codes, self._nothing)
        take_nearer_circles(hits, self._codes, rays, circles)
        return hits

    def _rows(
        self,
        robots: Sequence[RobotState],
        rays: Rays,
        distance: NDArray[np.int64],
        code: NDArray[np.int64],
        clock: int,
    ) -> list[SensorRow]:
        each = zip(
            self._robots,
            robots,
            rays.aside.tolist(),
            distance.tolist(),
            self._objects[code].tolist(),
            self._labels[code].tolist(),
            strict=True,
        )
        return [
            _row(robot, state, angles, distances, objects, labels, clock)
            for robot, state, angles, distances, objects, labels in each
        ]


def _row(
    robot: Robot,
    state: RobotState,
    angles: list[float],
    distances: list[int],
    objects: list[str],
    labels: list[str],
    clock: int,
) -> SensorRow:
    """What one robot senses; the lists hold a value for each ray and are used up."""
    del angles[FORWARD]
    return {
        "robot_name": robot.name,
        "sensor": {
            "forward_distance": distances.pop(FORWARD),
            "forward_object": objects.pop(FORWARD),
            "forward_label": labels.pop(FORWARD),
            "radar": [
                {"angle": angle, "distance": distance, "object": kind, "label": label}
                for angle, distance, kind, label in zip(
                    angles, distances, objects, labels, strict=True
                )
            ],
            "self": {
                "can_charge": robot.can_charge,
                "has_battery": robot.has_battery,
                "battery_level": state.battery_level,
                "battery_capacity": robot.battery_capacity,
            },
            "clock": clock,
        },
    }
