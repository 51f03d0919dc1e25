"""How much of each dot is wall, exact at any zoom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster

__all__ = ["WallTable"]

_BAND = 64  # rows; when walls change, only the bands they are in are summed anew


class WallTable:
    """Sums of walls over rectangles, by a summed-area table (Crow, SIGGRAPH 1984) in bands of rows.

    Args:
        walls: Bool array of shape (height, width); True is wall. Kept, and not to be changed.
    """

    def __init__(self, walls: NDArray[np.bool_]) -> None:
        height, width = walls.shape
        self._walls = walls
        # Walls to the left and above: in the bands above, and in the band itself.
        self._above: NDArray[np.int32] = np.zeros((height // _BAND + 1, width + 1), np.int32)
        self._within: NDArray[np.int32] = np.zeros((height + 1, width + 1), np.int32)
        for start in range(0, height, _BAND):
            self._sum(start)

    @property
    def width(self) -> int:
        """Map units across."""
        return len(self._walls[0])

    @property
    def height(self) -> int:
        """Map units down."""
        return len(self._walls)

    def change(self, walls: NDArray[np.bool_]) -> tuple[int, int, int, int] | None:
        """Take other walls of the same size in place of these.

        Returns:
            The map units (left, right, top, bottom) that hold all differences, or None.
        """
        before, self._walls = self._walls, walls
        columns, rows = np.zeros(self.width, np.bool_), []
        for start in range(0, self.height, _BAND):
            band = slice(start, start + _BAND)
            if before is walls or np.array_equal(before[band], walls[band]):
                continue
            self._sum(start)
            differs = before[band] != walls[band]
            columns |= differs.any(axis=0)
            rows += [start + row for row in np.flatnonzero(differs.any(axis=1)).tolist()]
        if not rows:
            return None
        across = np.flatnonzero(columns)
        return int(across[0]), int(across[-1]) + 1, rows[0], rows[-1] + 1

    def inside(self, raster: Raster) -> Floats:
        """Return the share of each dot that lies on the map."""
        across = np.diff(np.clip(raster.x_edges, 0, self.width)) / np.diff(raster.x_edges)
        down = np.diff(np.clip(raster.y_edges, 0, self.height)) / np.diff(raster.y_edges)
        return np.outer(down, across)

    def coverage(self, raster: Raster) -> Floats:
        """Return the share of each dot that is wall."""
        x, y = raster.x_edges, raster.y_edges
        walls = np.diff(self._between(x[:-1], x[1:], y), axis=0)
        # Rounding must not lead below nothing.
        share: Floats = walls / np.outer(np.diff(y), np.diff(x))
        return share.clip(0, 1)

    def openness(self, raster: Raster, reach: float) -> Floats:
        """Return the share that is floor of the square around each dot.

        Args:
            raster: The dots.
            reach: Map units from a dot's centre to the sides of the square.
        """
        left, right = raster.x - reach, raster.x + reach
        top, bottom = raster.y - reach, raster.y + reach
        walls = self._between(left, right, bottom) - self._between(left, right, top)
        on_map = np.outer(
            np.clip(bottom, 0, self.height) - np.clip(top, 0, self.height),
            np.clip(right, 0, self.width) - np.clip(left, 0, self.width),
        )
        share: Floats = (on_map - walls) / (2 * reach) ** 2
        return share.clip(0, 1)

    def _sum(self, start: int) -> None:
        """Sum up the band that starts in a row."""
        rows = self._walls[start : start + _BAND]
        sums = rows.cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32)
        # The last row of a full band is the first one of what lies above the next.
        full = len(rows) == _BAND
        inner = sums[:-1] if full else sums
        self._within[start + 1 : start + 1 + len(inner), 1:] = inner
        if full:
            band = start // _BAND
            more = sums[-1] + self._above[band, 1:] - self._above[band + 1, 1:]
            self._above[band + 1 :, 1:] += more

    def _between(self, left: Floats, right: Floats, y: Floats) -> Floats:
        """Return the walls above any y between pairs of x; shape (len(y), len(left))."""
        y = np.clip(y, 0, self.height)
        whole = np.minimum(y.astype(np.int64), self.height - 1)
        rows = np.concatenate((whole, whole + 1))
        low, high = np.split(self._to_the_left(right, rows) - self._to_the_left(left, rows), 2)
        between: Floats = low + (high - low) * (y - whole)[:, None]
        return between

    def _to_the_left(self, x: Floats, rows: NDArray[np.int64]) -> Floats:
        """Return the walls to the left of any x and above whole rows."""
        x = np.clip(x, 0, self.width)
        whole = np.minimum(x.astype(np.int64), self.width - 1)
        columns = np.concatenate((whole, whole + 1))
        sums = self._above[rows // _BAND][:, columns] + self._within[np.ix_(rows, columns)]
        low, high = np.split(sums, 2, axis=1)
        across: Floats = low + (high - low) * (x - whole)
        return across
