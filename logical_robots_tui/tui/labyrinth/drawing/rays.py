"""The radar of robots as light on the floor, and marks where its rays end."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.world.sensing import SENSOR_RANGE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster

__all__ = ["KINDS", "Fan", "fans", "shine"]

_FINE = 16
"""Steps between two rays in which the shape of a fan is tabulated."""

_STEPS = 12
"""Steps of brightness."""

KINDS = {"robot": 3, "beacon": 2, "wall": 1}
"""What a ray may hit; a greater number is more important."""


@dataclass(frozen=True, eq=False)
class Fan:
    """The rays of one robot in one tick.

    Attributes:
        name: The robot.
        x: Where it sensed, map units.
        y: Where it sensed, map units.
        headings: Of the rays, clockwise from the right in radians, ascending and evenly spread.
        distances: Map units at which they end.
        objects: What they hit: ``wall``, ``robot``, ``beacon`` or ``none``.
        labels: Its name.
        ahead: Where the robot was heading, which is the ray with the angle 0.
    """

    name: str
    x: float
    y: float
    headings: Floats
    distances: Floats
    objects: Sequence[str]
    labels: Sequence[str]
    ahead: float

    def sighted(self) -> Iterable[tuple[float, float, str, str]]:
        """Return (x, y, object, label) of each beacon and robot, where its middle ray ends."""
        rays: dict[tuple[str, str], list[int]] = {}
        for ray, what in enumerate(zip(self.objects, self.labels, strict=True)):
            if what[0] in ("beacon", "robot"):
                rays.setdefault(what, []).append(ray)
        for (kind, label), hits in rays.items():
            ray = hits[len(hits) // 2]
            away, heading = float(self.distances[ray]), float(self.headings[ray])
            yield self.x + away * math.cos(heading), self.y + away * math.sin(heading), kind, label

    def points(self) -> tuple[Floats, Floats]:
        """Return map units x and y of where the rays end."""
        x = self.x + self.distances * np.cos(self.headings)
        return x, self.y + self.distances * np.sin(self.headings)

    def nearest(self, angle: float) -> int:
        """Return the number of the ray nearest to an angle as the program reads it, radians."""
        return int(np.abs(self.headings - (self.ahead - angle)).argmin())

    def ends(self) -> Iterable[tuple[float, float, str]]:
        """Return (x, y, object) of the rays that hit something, the most important last."""
        x, y = self.points()
        ends = zip(x.tolist(), y.tolist(), self.objects, strict=True)
        hits = [end for end in ends if end[2] in KINDS]
        return sorted(hits, key=lambda end: KINDS[end[2]])


def fans(frame: Frame) -> list[Fan]:
    """Return the fan of each robot that sensed, from where it stood then."""
    poses = {robot.name: robot for robot in frame.before.robots}
    found = []
    for row in frame.sensors:
        pose, radar = poses.get(row["robot_name"]), row["sensor"]["radar"]
        if pose is None or len(radar) < 2:
            continue
        if not (math.isfinite(pose.x) and math.isfinite(pose.y) and math.isfinite(pose.angle)):
            continue
        found.append(
            Fan(
                name=pose.name,
                x=pose.x,
                y=pose.y,
                headings=pose.angle - np.array([ray["angle"] for ray in radar], np.float64),
                distances=np.array([ray["distance"] for ray in radar], np.float64),
                objects=[ray["object"] for ray in radar],
                labels=[str(ray["label"]) for ray in radar],
                ahead=pose.angle,
            )
        )
    return found


def shine(fan: Fan, raster: Raster) -> tuple[tuple[slice, slice], Floats] | None:
    """Return how brightly a fan lights the dots around it.

    Args:
        fan: The rays.
        raster: The dots.

    Returns:
        The window of dots that it may reach and a brightness from 0 to 1 for each; None if it is
        out of sight.
    """
    spill = 1.5 * raster.dot + 2
    reach = fan.distances + spill
    x, y = fan.x + reach * np.cos(fan.headings), fan.y + reach * np.sin(fan.headings)
    window = raster.window(
        min(fan.x, float(x.min())),
        max(fan.x, float(x.max())),
        min(fan.y, float(y.min())),
        max(fan.y, float(y.max())),
    )
    if window is None:
        return None
    dx, dy = raster.offsets(window, fan.x, fan.y)
    distance = np.sqrt(dx * dx + dy * dy)

    # Turn so that the middle of the fan is 0: it is far from where angles wrap around.
    first, last = float(fan.headings[0]), float(fan.headings[-1])
    middle, half = (first + last) / 2, (last - first) / 2
    half = half if abs(half) > 1e-6 else 1e-6
    cos, sin = np.float32(math.cos(middle)), np.float32(math.sin(middle))
    aside = np.arctan2(dy * cos - dx * sin, dx * cos + dy * sin)
    count = len(fan.distances)
    at = aside * np.float32((count - 1) / (2 * half) * _FINE) + np.float32((count / 2) * _FINE)
    slots = np.clip(at + 1, 0, count * _FINE + 1).astype(np.int32)

    ends, solid, line = _shape(fan)
    end = ends[slots]
    light = np.clip((end + solid[slots] * np.float32(spill) - distance) / raster.dot + 0.5, 0, 1)
    light *= 1 - np.float32(0.6 / SENSOR_RANGE) * distance
    # Rays show one by one where they are several dots apart.
    apart = distance * np.float32(2 * half / (count - 1) / raster.dot)
    light *= 1 - line[slots] * np.clip((apart - 4) / 16, 0, 0.25)
    # In few steps, so that a robot that moves a little changes few cells.
    return window, np.rint(np.maximum(light, 0) * _STEPS) * np.float32(1 / _STEPS)


def _shape(fan: Fan) -> tuple[Floats, Floats, Floats]:
    """Tabulate a fan over its angle, with a dark slot before and after.

    Each ray has ``_FINE`` slots around it. Returns where the light ends, 1 where that is a wall,
    and how far a slot is from the ray, 0 on it to 1 between two.
    """
    count = len(fan.distances)
    nearest, low, part, line = _slots(count)
    one, other = fan.distances[low], fan.distances[low + 1]
    # Between rays that end on the same thing the end is nearly a straight line, and along one
    # the inverse of the distance grows evenly.
    between = 1 / ((1 - part) / np.maximum(one, 1) + part / np.maximum(other, 1))
    smooth = np.abs(one - other) < 0.3 * np.minimum(one, other) + 3
    ends = np.full(count * _FINE + 2, -1e9, np.float32)
    ends[1:-1] = np.where(smooth, between, fan.distances[nearest])
    solid = np.zeros(count * _FINE + 2, np.float32)
    solid[1:-1] = np.array([name == "wall" for name in fan.objects])[nearest]
    return ends, solid, line


@lru_cache(maxsize=8)
def _slots(
    count: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Return for each slot the nearest ray, the one before it, how far it is past that one.

    And for each slot with those outside, how far it is from the nearest ray.
    """
    place = (np.arange(count * _FINE) + 0.5) / _FINE - 0.5
    nearest = np.rint(place).astype(np.int64).clip(0, count - 1)
    low = np.floor(place).astype(np.int64).clip(0, count - 2)
    line = np.zeros(count * _FINE + 2, np.float32)
    line[1:-1] = 2 * np.abs(place - nearest)
    return nearest, low, np.clip(place - low, 0, 1), line
