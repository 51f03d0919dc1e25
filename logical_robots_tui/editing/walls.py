"""Walls: painting, and the connected regions that they form."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.editing.strokes import Patch, Point, rectangle, stroke

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.world.level import Level


def paint(
    level: Level, points: Sequence[Point], *, width: int = 1, grid: int = 1, wall: bool = True
) -> Level:
    """Draw or erase walls with a round brush, or raise LevelError; arguments as of `stroke`."""
    return _with(level, stroke(points, width, grid, level.walls.shape), wall)


def paint_rectangle(
    level: Level,
    corner: Point,
    opposite: Point,
    *,
    border: int = 0,
    grid: int = 1,
    wall: bool = True,
) -> Level:
    """Draw or erase a rectangle of walls, or raise LevelError; arguments as of `rectangle`."""
    return _with(level, rectangle(corner, opposite, border, grid, level.walls.shape), wall)


def fill(level: Level, x: float, y: float, *, wall: bool = True) -> Level:
    """Turn the region of side-sharing units around a point into wall, or walls into floor."""
    if not (0 <= x < level.width and 0 <= y < level.height):
        return level
    regions = Regions(level.walls != wall, corners=False)
    region = regions.at(math.floor(y), math.floor(x))
    return level if region < 0 else _with(level, Patch(0, 0, regions.mask(region)), wall)


def _with(level: Level, patch: Patch | None, wall: bool) -> Level:
    if patch is None or not (patch.mask & (level.walls[patch.window] != wall)).any():
        return level
    walls = level.walls.copy()
    walls[patch.window][patch.mask] = wall
    walls.flags.writeable = False
    return replace(level, walls=walls)


class Regions:
    """The connected components of a map, built from runs of adjacent units in a row for speed.

    `units` has the shape (height, width); `corners` also connects units touching at corners.
    """

    def __init__(self, units: NDArray[np.bool_], *, corners: bool) -> None:
        self._shape = units.shape
        edges = np.zeros((units.shape[0], units.shape[1] + 2), np.int8)
        edges[:, 1:-1] = units
        edges = np.diff(edges, axis=1)
        self._row, self._start = np.nonzero(edges == 1)
        self._stop = np.nonzero(edges == -1)[1]
        self._stride = units.shape[1] + 2
        self._starts = self._row * self._stride + self._start
        self._region = _roots(len(self._row), *self._neighbours(corners))

    def at(self, row: int, column: int) -> int:
        """Return the number of the region that a unit belongs to, or -1."""
        if not (0 <= row < self._shape[0] and 0 <= column < self._shape[1]):
            return -1
        run = int(self._starts.searchsorted(row * self._stride + column, "right")) - 1
        if run < 0 or self._row[run] != row or self._stop[run] <= column:
            return -1
        return int(self._region[run])

    def within(self, x: float, y: float, radius: float) -> frozenset[int]:
        first, last = self._row.searchsorted((y - radius - 1, y + radius + 1)).tolist()
        runs = slice(first, last)
        dx = x - np.clip(x, self._start[runs], self._stop[runs])
        dy = y - np.clip(y, self._row[runs], self._row[runs] + 1)
        return frozenset(self._region[runs][np.hypot(dx, dy) < radius].tolist())

    def mask(self, region: int) -> NDArray[np.bool_]:
        runs = self._region == region
        edges = np.zeros((self._shape[0], self._shape[1] + 1), np.int8)
        edges[self._row[runs], self._start[runs]] += 1
        edges[self._row[runs], self._stop[runs]] -= 1
        inside: NDArray[np.bool_] = edges.cumsum(axis=1, dtype=np.int8)[:, :-1] > 0
        return inside

    def _neighbours(self, corners: bool) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        below = (self._row + 1) * self._stride
        stops = self._row * self._stride + self._stop
        first = stops.searchsorted(below + self._start, "left" if corners else "right")
        last = self._starts.searchsorted(below + self._stop, "right" if corners else "left")
        count = np.maximum(last - first, 0)
        upper = np.arange(len(count)).repeat(count)
        lower = np.arange(len(upper)) + (first - count.cumsum() + count)[upper]
        return upper, lower


def _roots(count: int, one: NDArray[np.intp], other: NDArray[np.intp]) -> NDArray[np.intp]:
    root = np.arange(count)
    while True:
        low, high = np.minimum(root[one], root[other]), np.maximum(root[one], root[other])
        apart = low != high
        if not apart.any():
            return root
        one, other = one[apart], other[apart]
        np.minimum.at(root, high[apart], low[apart])
        while (root[root] != root).any():
            root = root[root]
