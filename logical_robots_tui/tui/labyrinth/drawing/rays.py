"""The radar of robots as light on the floor, and marks where its rays end."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, RGB, Cells, rgb_number, text_id
from logical_robots_tui.tui.labyrinth.drawing.discs import shows_body
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Floats, Raster, Viewport
from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame

_FINE = 16  # steps between two rays in which the shape of a fan is tabulated
_STEPS = 12  # steps of brightness

KINDS = {"robot": 3, "beacon": 2, "wall": 1}
"""What a ray may hit; a greater number is more important."""


@dataclass(frozen=True, eq=False)
class Fan:
    """The rays of one robot in one tick; places and distances are map units.

    `headings` are clockwise from the right in radians, ascending and evenly spread; `ahead` is
    the heading of the ray with the angle 0; `objects` are ``wall``, ``robot``, ``beacon`` or
    ``none``.
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
        """Yield (x, y, object, label) of each sensed beacon and robot, by its middle ray."""
        rays: dict[tuple[str, str], list[int]] = {}
        for ray, what in enumerate(zip(self.objects, self.labels, strict=True)):
            if what[0] in ("beacon", "robot"):
                rays.setdefault(what, []).append(ray)
        for (kind, label), hits in rays.items():
            ray = hits[len(hits) // 2]
            away, heading = float(self.distances[ray]), float(self.headings[ray])
            yield self.x + away * math.cos(heading), self.y + away * math.sin(heading), kind, label

    def points(self) -> tuple[Floats, Floats]:
        """Return the map units x and y where the rays end."""
        x = self.x + self.distances * np.cos(self.headings)
        return x, self.y + self.distances * np.sin(self.headings)

    def nearest(self, angle: float) -> int:
        """Return the number of the ray nearest to an angle in radians, as programs read it."""
        return int(np.abs(self.headings - (self.ahead - angle)).argmin())

    def ends(self) -> Iterable[tuple[float, float, str]]:
        """Return (x, y, object) of the rays that hit something, the most important last."""
        x, y = self.points()
        ends = zip(x.tolist(), y.tolist(), self.objects, strict=True)
        hits = [end for end in ends if end[2] in KINDS]
        return sorted(hits, key=lambda end: KINDS[end[2]])


def fans(frame: Frame) -> list[Fan]:
    """Return the fan of each robot that sensed, from its position at that time."""
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


def brightness_of(fan: Fan, raster: Raster) -> tuple[tuple[slice, slice], Floats] | None:
    """Return a window of dots and a fan's brightness there, 0 to 1; None out of sight."""
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
    """Tabulate a fan by angle, ``_FINE`` slots around each ray, a dark one before and after.

    Returns where the light ends, 1 where that is a wall, and how far a slot is from the ray, 0
    on it to 1 between two.
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
def _slots(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Return each slot's nearest ray, the one before it, and how far it is past that one.

    Last, with the slots outside, how far each is from the nearest ray.
    """
    place = (np.arange(count * _FINE) + 0.5) / _FINE - 0.5
    nearest = np.rint(place).astype(np.int64).clip(0, count - 1)
    low = np.floor(place).astype(np.int64).clip(0, count - 2)
    line = np.zeros(count * _FINE + 2, np.float32)
    line[1:-1] = 2 * np.abs(place - nearest)
    return nearest, low, np.clip(place - low, 0, 1), line


def mark_ends(
    cells: Cells,
    fans: Sequence[Fan],
    robots: Sequence[tuple[RobotState, RGB]],
    viewport: Viewport,
    look: Look,
) -> None:
    """Mark where rays end, the most important in a cell, but not on robots' bodies."""
    if not fans:
        return
    most = _ends(fans, viewport)
    if shows_body(viewport):
        for robot, _ in robots:
            _clear_body(most, robot, viewport)
    glyphs, palette = look.drawing.glyphs, look.palette
    at_wall = glyphs.hit_wall_near if shows_body(viewport) else glyphs.hit_wall
    texts = [text_id(text) for text in (at_wall, glyphs.hit_beacon, glyphs.hit_robot)]
    inks = [rgb_number(ink) for ink in (palette.hit_wall, palette.hit_beacon, palette.hit_robot)]
    rows, columns = np.nonzero(most)
    kinds = most[rows, columns] - 1
    bold = np.where(kinds, BOLD, 0)
    cells.put_all(rows, columns, np.array(texts)[kinds], np.array(inks)[kinds], bold)


def _ends(fans: Sequence[Fan], viewport: Viewport) -> NDArray[np.int64]:
    kinds = np.array([KINDS.get(what, 0) for fan in fans for what in fan.objects])
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = np.concatenate([fan.points() for fan in fans], axis=1)
        across = (x - viewport.left) / viewport.units
        down = (y - viewport.top) / (viewport.units * CELL_ASPECT)
        # Compared as floats: what is not a number is nowhere.
        seen = (across >= 0) & (across < viewport.columns) & (down >= 0) & (down < viewport.rows)
    found = np.flatnonzero(seen & (kinds > 0))
    found = found[np.argsort(kinds[found], kind="stable")]
    most = np.zeros((viewport.rows, viewport.columns), np.int64)
    most[down[found].astype(np.int64), across[found].astype(np.int64)] = kinds[found]
    return most


def _clear_body(most: NDArray[np.int64], robot: RobotState, viewport: Viewport) -> None:
    cell = viewport.cell(robot.x, robot.y)
    if cell is None:
        return
    reach = 0.8 * ROBOT_RADIUS
    across = round(reach / viewport.units)
    down = round(reach / (viewport.units * CELL_ASPECT))
    for row in range(max(cell[0] - down, 0), min(cell[0] + down + 1, viewport.rows)):
        for column in range(max(cell[1] - across, 0), min(cell[1] + across + 1, viewport.columns)):
            x, y = viewport.position(row, column)
            if math.hypot(x - robot.x, y - robot.y) < reach:
                most[row, column] = 0
