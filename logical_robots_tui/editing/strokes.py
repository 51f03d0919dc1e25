"""Painting walls: brush strokes, lines, rectangles and filled regions.

On a grid coarser than 1 whole squares are covered, so that a level drawn with large cells
keeps them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from logical_robots_tui.world.level import Level, LevelError
from logical_robots_tui.world.levels.fields import MOST_OF_A_NUMBER, MOST_SIDE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Bits = NDArray[np.bool_]


Point = tuple[float, float]
"""Map units (x, y)."""


def fill(level: Level, x: float, y: float, *, wall: bool = True) -> Level:
    """Turn the region of side-sharing units around a point into wall, or walls into floor."""
    if not (0 <= x < level.width and 0 <= y < level.height):
        return level
    regions = Regions(level.walls != wall, corners=False)
    region = regions.region_at(math.floor(y), math.floor(x))
    return level if region < 0 else _painted(level, 0, 0, regions.mask(region), wall)


def _painted(level: Level, top: int, left: int, units: _Bits, wall: bool) -> Level:
    window = slice(top, top + units.shape[0]), slice(left, left + units.shape[1])
    if not (units & (level.walls[window] != wall)).any():
        return level
    walls = level.walls.copy()
    walls[window][units] = wall
    walls.flags.writeable = False
    return replace(level, walls=walls)


class Regions:
    """The connected components of a map, built from runs of adjacent units in a row for speed.

    `units` has the shape (height, width); `corners` also connects units touching at corners.
    """

    def __init__(self, units: _Bits, *, corners: bool) -> None:
        self._shape = units.shape
        edges = np.zeros((units.shape[0], units.shape[1] + 2), np.int8)
        edges[:, 1:-1] = units
        edges = np.diff(edges, axis=1)
        self._row, self._start = np.nonzero(edges == 1)
        self._stop = np.nonzero(edges == -1)[1]
        self._stride = units.shape[1] + 2
        self._starts = self._row * self._stride + self._start
        below = self._starts + self._stride
        stops = self._row * self._stride + self._stop
        first = stops.searchsorted(below, "left" if corners else "right")
        last = self._starts.searchsorted(stops + self._stride, "right" if corners else "left")
        count = np.maximum(last - first, 0)
        upper = np.arange(len(count)).repeat(count)
        lower = np.arange(len(upper)) + (first - count.cumsum() + count)[upper]
        self._region = _roots(len(self._row), upper, lower)

    def region_at(self, row: int, column: int) -> int:
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

    def mask(self, region: int) -> _Bits:
        runs = self._region == region
        edges = np.zeros((self._shape[0], self._shape[1] + 1), np.int8)
        edges[self._row[runs], self._start[runs]] += 1
        edges[self._row[runs], self._stop[runs]] -= 1
        inside: _Bits = edges.cumsum(axis=1, dtype=np.int8)[:, :-1] > 0
        return inside


def _roots(count: int, upper: NDArray[np.intp], lower: NDArray[np.intp]) -> NDArray[np.intp]:
    root = np.arange(count)
    while True:
        low, high = np.minimum(root[upper], root[lower]), np.maximum(root[upper], root[lower])
        is_split = low != high
        if not is_split.any():
            return root
        upper, lower = upper[is_split], lower[is_split]
        np.minimum.at(root, high[is_split], low[is_split])
        while (root[root] != root).any():
            root = root[root]


_PIECE = 64.0  # squares of the grid; a long line is drawn in pieces with small bounding boxes


def paint(
    level: Level, points: Sequence[Point], *, width: int = 1, grid: int = 1, wall: bool = True
) -> Level:
    """Draw or erase walls with a round brush, along a path without gaps, not even diagonal ones.

    `width` is in squares of the grid, `grid` in map units. Raises LevelError if a value is out of
    range.
    """
    _check(width, grid, points)
    shape = level.walls.shape
    path = [(_snap(x / grid, width), _snap(y / grid, width)) for x, y in points]
    reach = width / 2 + 1
    box = _Box.around(path, reach, grid, shape)
    if box is None:
        return level
    mask = np.zeros((box.bottom - box.top, box.right - box.left), np.bool_)
    for start, stop in zip(path, path[1:] or path, strict=False):
        dx, dy = stop[0] - start[0], stop[1] - start[1]
        # One square wide, a line needs enough for neighbours to share a side (Reveillès' standard
        # line).
        thinnest = (abs(dx) + abs(dy)) / (2 * math.hypot(dx, dy)) if dx or dy else 0.5
        cover = max(width / 2, thinnest) + 1e-9
        pieces = max(math.ceil(math.hypot(dx, dy) / _PIECE), 1)
        shares = [i / pieces for i in range(pieces + 1)]
        ends = [(start[0] + dx * share, start[1] + dy * share) for share in shares]
        for first, last in pairwise(ends):
            part = _Box.around((first, last), reach, grid, shape)
            if part is not None:
                window = part.within(box)
                mask[window] |= part.distances(first, last) <= cover
    return box.painted(level, mask, grid, wall)


def paint_rectangle(
    level: Level,
    corner: Point,
    opposite: Point,
    *,
    border: int = 0,
    grid: int = 1,
    wall: bool = True,
) -> Level:
    """Draw or erase a rectangle of walls, including the squares of both corners.

    `border` is in squares of the grid, 0 to fill; `grid` in map units. Raises LevelError if a
    value is out of range.
    """
    _check(max(border, 1), grid, (corner, opposite))
    xs = sorted(math.floor(x / grid) for x, _ in (corner, opposite))
    ys = sorted(math.floor(y / grid) for _, y in (corner, opposite))
    box = _Box(ys[0], xs[0], ys[1] + 1, xs[1] + 1).clipped(grid, level.walls.shape)
    if box is None:
        return level
    rows, columns = np.arange(box.top, box.bottom), np.arange(box.left, box.right)
    mask = np.ones((len(rows), len(columns)), np.bool_)
    if border:
        near_y = np.minimum(rows - ys[0], ys[1] - rows) < border
        near_x = np.minimum(columns - xs[0], xs[1] - columns) < border
        mask = near_y[:, None] | near_x[None, :]
    return box.painted(level, mask, grid, wall)


class _Box(NamedTuple):
    """A rectangle of grid squares; its end is exclusive."""

    top: int
    left: int
    bottom: int
    right: int

    @classmethod
    def around(
        cls, points: Sequence[Point], reach: float, grid: int, shape: tuple[int, int]
    ) -> _Box | None:
        xs, ys = [x for x, _ in points], [y for _, y in points]
        return cls(
            math.floor(min(ys) - reach),
            math.floor(min(xs) - reach),
            math.ceil(max(ys) + reach),
            math.ceil(max(xs) + reach),
        ).clipped(grid, shape)

    def clipped(self, grid: int, shape: tuple[int, int]) -> _Box | None:
        box = _Box(
            max(self.top, 0),
            max(self.left, 0),
            min(self.bottom, -(-shape[0] // grid)),
            min(self.right, -(-shape[1] // grid)),
        )
        return box if box.top < box.bottom and box.left < box.right else None

    def within(self, outer: _Box) -> tuple[slice, slice]:
        return (
            slice(self.top - outer.top, self.bottom - outer.top),
            slice(self.left - outer.left, self.right - outer.left),
        )

    def distances(self, start: Point, stop: Point) -> NDArray[np.float64]:
        dx, dy = stop[0] - start[0], stop[1] - start[1]
        x = (np.arange(self.left, self.right) + 0.5 - start[0])[None, :]
        y = (np.arange(self.top, self.bottom) + 0.5 - start[1])[:, None]
        along = (x * dx + y * dy) / max(dx * dx + dy * dy, 1e-12)
        along = along.clip(0, 1)
        distances: NDArray[np.float64] = np.hypot(x - along * dx, y - along * dy)
        return distances

    def painted(self, level: Level, mask: _Bits, grid: int, wall: bool) -> Level:
        """Paint the squares of a mask; the edge of the map may cut the last ones."""
        top, left = self.top * grid, self.left * grid
        units = mask.repeat(grid, axis=0).repeat(grid, axis=1)
        units = units[: level.height - top, : level.width - left]
        return _painted(level, top, left, units, wall)


def _check(width: int, grid: int, points: Sequence[Point]) -> None:
    for noun, size in (("brush", width), ("grid", grid)):
        if not 1 <= size <= MOST_SIDE:
            raise LevelError(f"The {noun} must be from 1 to {MOST_SIDE} wide, not {size}.")
    for point in points:
        if not all(abs(number) <= MOST_OF_A_NUMBER for number in point):
            raise LevelError("This point is too far outside the labyrinth.")


def _snap(place: float, width: int) -> float:
    return math.floor(place) + 0.5 if width % 2 else float(math.floor(place + 0.5))
