"""How much of each dot is wall, exact at any zoom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.tui.drawing.viewport import Floats, Raster

__all__ = ["WallTable"]


class WallTable:
    """Sums of walls over rectangles, by a summed-area table (Crow, SIGGRAPH 1984).

    Args:
        walls: Bool array of shape (height, width); True is wall.
    """

    def __init__(self, walls: NDArray[np.bool_]) -> None:
        height, width = walls.shape
        self._sums: NDArray[np.float64] = np.zeros((height + 1, width + 1))
        self._sums[1:, 1:] = walls.cumsum(axis=0, dtype=np.int64).cumsum(axis=1)

    @property
    def width(self) -> int:
        """Map units across."""
        return int(self._sums.shape[1]) - 1

    @property
    def height(self) -> int:
        """Map units down."""
        return int(self._sums.shape[0]) - 1

    def inside(self, raster: Raster) -> Floats:
        """Return the share of each dot that lies on the map."""
        across = np.diff(np.clip(raster.x_edges, 0, self.width)) / np.diff(raster.x_edges)
        down = np.diff(np.clip(raster.y_edges, 0, self.height)) / np.diff(raster.y_edges)
        return np.outer(down, across)

    def coverage(self, raster: Raster) -> Floats:
        """Return the share of each dot that is wall."""
        sums = self._below(self._to_the_left(raster.x_edges), raster.y_edges)
        walls = np.diff(np.diff(sums, axis=0), axis=1)
        # Rounding must not lead below nothing.
        share: Floats = walls / np.outer(np.diff(raster.y_edges), np.diff(raster.x_edges))
        return share.clip(0, 1)

    def openness(self, raster: Raster, reach: float) -> Floats:
        """Return the share that is floor of the square around each dot.

        Args:
            raster: The dots.
            reach: Map units from a dot's centre to the sides of the square.
        """
        left, right = raster.x - reach, raster.x + reach
        top, bottom = raster.y - reach, raster.y + reach
        across = self._to_the_left(right) - self._to_the_left(left)
        walls = self._below(across, bottom) - self._below(across, top)
        on_map = np.outer(
            np.clip(bottom, 0, self.height) - np.clip(top, 0, self.height),
            np.clip(right, 0, self.width) - np.clip(left, 0, self.width),
        )
        share: Floats = (on_map - walls) / (2 * reach) ** 2
        return share.clip(0, 1)

    def _to_the_left(self, x: Floats) -> Floats:
        """Return the table's columns at any x."""
        x = np.clip(x, 0, self.width)
        whole = np.minimum(x.astype(np.int64), self.width - 1)
        low, high = self._sums[:, whole], self._sums[:, whole + 1]
        return low + (high - low) * (x - whole)

    def _below(self, columns: Floats, y: Floats) -> Floats:
        """Return the rows at any y of the table's columns."""
        y = np.clip(y, 0, self.height)
        whole = np.minimum(y.astype(np.int64), self.height - 1)
        low, high = columns[whole], columns[whole + 1]
        between: Floats = low + (high - low) * (y - whole)[:, None]
        return between
