"""Where map units fall on the cells of a terminal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeAlias

import numpy as np

from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

Floats: TypeAlias = "NDArray[np.floating[Any]]"
"""An array of floats; single precision unless it holds places on the map."""

Window: TypeAlias = tuple[slice, slice]
"""Dots as slices (down, across)."""

CELL_ASPECT = 2.0
"""Height of a terminal cell in widths of one."""


class Viewport(NamedTuple):
    """The rectangle of a map that a block of cells shows, in map units from its top left.

    `units` are map units per column; a row holds twice as many.
    """

    columns: int
    rows: int
    left: float
    top: float
    units: float

    @classmethod
    def fit(cls, width: float, height: float, columns: int, rows: int) -> Self:
        units = max(width / max(columns, 1), height / (max(rows, 1) * CELL_ASPECT), 1e-9)
        return cls(columns, rows, 0.0, 0.0, units).centred(width / 2, height / 2)

    @property
    def width(self) -> float:
        return self.columns * self.units

    @property
    def height(self) -> float:
        return self.rows * self.units * CELL_ASPECT

    @property
    def shows_bodies(self) -> bool:
        """Whether a robot is more than a character."""
        return ROBOT_RADIUS / self.units >= 2.2

    @property
    def body_rows(self) -> int:
        """Rows that a robot's body covers above the one of its middle, and below."""
        return round(ROBOT_RADIUS / (2 * self.units) - 0.2) if self.shows_bodies else 0

    def centred(self, x: float, y: float) -> Self:
        """Move the view's centre to a point in map units."""
        return self._replace(left=x - self.width / 2, top=y - self.height / 2)

    def zoomed(self, factor: float) -> Self:
        x, y = self.left + self.width / 2, self.top + self.height / 2
        return self._replace(units=self.units / factor).centred(x, y)

    def cell(self, x: float, y: float) -> tuple[int, int] | None:
        """Return the (row, column) that shows a point of the map, or None if it is outside."""
        across, down = (x - self.left) / self.units, (y - self.top) / (self.units * CELL_ASPECT)
        # Compared as floats: what is not a number is nowhere.
        if not (0 <= across < self.columns and 0 <= down < self.rows):
            return None
        return math.floor(down), math.floor(across)

    def dots(
        self, x: Floats, y: Floats, across: int = 1, down: int = 1
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        """Return row and column of the dots of those points that are in sight, and which are.

        Shapes (in sight,) twice, and (points,); a cell has ``across`` x ``down`` dots.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            columns = (x - self.left) / self.units * across
            rows = (y - self.top) / (self.units * CELL_ASPECT) * down
            # Compared as floats: what is not a number is nowhere.
            inside = (columns >= 0) & (columns < across * self.columns)
            inside &= (rows >= 0) & (rows < down * self.rows)
        return rows[inside].astype(np.int64), columns[inside].astype(np.int64), inside

    def position(self, row: float, column: float) -> tuple[float, float]:
        """Return the map units (x, y) of a cell's centre; the cell may lie outside."""
        return (
            self.left + (column + 0.5) * self.units,
            self.top + (row + 0.5) * self.units * CELL_ASPECT,
        )


@dataclass(frozen=True)
class Raster:
    """A viewport's dots, ``across`` x ``down`` a cell; a part is (top, bottom, left, right)."""

    viewport: Viewport
    across: int
    down: int
    part: tuple[int, int, int, int] | None = None

    def only(self, window: Window) -> Self:
        """Return some of the dots, given as (down, across), at exactly the same positions."""
        down, across = window
        return replace(self, part=(down.start, down.stop, across.start, across.stop))

    @property
    def shape(self) -> tuple[int, int]:
        """Dots (down, across)."""
        top, bottom, left, right = self._bounds
        return bottom - top, right - left

    @cached_property
    def x_edges(self) -> Floats:
        """Map units of the dots' left edges, then of the last dot's right edge."""
        view, (_, _, left, right) = self.viewport, self._bounds
        return view.left + np.arange(left, right + 1) * (view.units / self.across)

    @cached_property
    def y_edges(self) -> Floats:
        """Map units of the dots' upper edges, then of the last dot's lower edge."""
        view, (top, bottom, _, _) = self.viewport, self._bounds
        return view.top + np.arange(top, bottom + 1) * (view.units * CELL_ASPECT / self.down)

    @cached_property
    def x(self) -> Floats:
        """Map units of the dots' centres, across."""
        return (self.x_edges[1:] + self.x_edges[:-1]) / 2

    @cached_property
    def y(self) -> Floats:
        """Map units of the dots' centres, down."""
        return (self.y_edges[1:] + self.y_edges[:-1]) / 2

    @property
    def dot(self) -> float:
        """Side in map units of a square with a dot's area."""
        return self.viewport.units * math.sqrt(CELL_ASPECT / (self.across * self.down))

    def window(self, left: float, right: float, top: float, bottom: float) -> Window | None:
        """Return slices (down, across) of dots that touch a map rectangle, or None."""
        far_left, far_right, far_top, far_bottom = self._far
        if not (far_left <= right and left <= far_right and left <= right):
            return None
        if not (far_top <= bottom and top <= far_bottom and top <= bottom):
            return None
        first_x, last_x = np.searchsorted(self.x_edges, (left, right)).tolist()
        first_y, last_y = np.searchsorted(self.y_edges, (top, bottom)).tolist()
        down = slice(max(first_y - 1, 0), min(last_y, self.shape[0]))
        across = slice(max(first_x - 1, 0), min(last_x, self.shape[1]))
        if down.start >= down.stop or across.start >= across.stop:
            return None
        return down, across

    @property
    def _bounds(self) -> tuple[int, int, int, int]:
        view = self.viewport
        return self.part or (0, view.rows * self.down, 0, view.columns * self.across)

    @cached_property
    def _far(self) -> tuple[float, float, float, float]:
        """Map units of the outermost edges: left, right, top, bottom."""
        x, y = self.x_edges, self.y_edges
        return float(x[0]), float(x[-1]), float(y[0]), float(y[-1])

    def around(self, x: float, y: float, reach: float) -> tuple[Window, Floats, Floats] | None:
        """Return the dots not farther from a point than `reach` each way, and their offsets."""
        window = self.window(x - reach, x + reach, y - reach, y + reach)
        return None if window is None else (window, *self.offsets(window, x, y))

    def offsets(self, window: Window, x: float, y: float) -> tuple[Floats, Floats]:
        """Return map units from a point to the dots of a window: a row dx and a column dy."""
        down, across = window
        dx = (self.x[across] - x).astype(np.float32)[None, :]
        dy = (self.y[down] - y).astype(np.float32)[:, None]
        return dx, dy
