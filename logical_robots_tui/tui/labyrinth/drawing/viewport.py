"""The part of a map that is shown: what a camera sees, and where that falls on cells and dots."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeAlias

import numpy as np

from logical_robots_tui.world.level import Level
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
    def middle(self) -> tuple[float, float]:
        return self.left + self.width / 2, self.top + self.height / 2

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
        return self._replace(units=self.units / factor).centred(*self.middle)

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

    def vicinity(self, x: float, y: float, reach: float) -> tuple[Window, Floats, Floats] | None:
        """Return the dots not farther from a point than `reach` each way, and their offsets."""
        window = self.window(x - reach, x + reach, y - reach, y + reach)
        return None if window is None else (window, *self.offsets(window, x, y))

    def offsets(self, window: Window, x: float, y: float) -> tuple[Floats, Floats]:
        """Return map units from a point to the dots of a window: a row dx and a column dy."""
        down, across = window
        dx = (self.x[across] - x).astype(np.float32)[None, :]
        dy = (self.y[down] - y).astype(np.float32)[:, None]
        return dx, dy


ZOOMS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0)
"""Zoom factors; at 1 the whole labyrinth fits."""

_NEAR = 3  # the default zoom for following a robot

_CALM = 0.22
"""The share of the view, on each side of its middle, in which a robot moves without scrolling."""


class Sight(Enum):
    """What the camera shows."""

    WHOLE = "whole"
    """The whole labyrinth."""
    FOLLOW = "follow"
    """A part around the selected robot."""
    SENSES = "senses"
    """What robots sense, one picture per robot."""
    FREE = "free"
    """A part that the player chose."""


class Camera(NamedTuple):
    """The player's view: index into ``ZOOMS``, and its middle in map units."""

    sight: Sight = Sight.WHOLE
    step: int = 0
    x: float = 0.0
    y: float = 0.0

    @property
    def zoom(self) -> float:
        return ZOOMS[self.step]

    def viewport(self, level: Level, columns: int, rows: int) -> Viewport:
        whole = Viewport.fit(level.width, level.height, columns, rows)
        if self.sight not in (Sight.FOLLOW, Sight.FREE):
            return whole
        view = whole.zoomed(self.zoom)
        if self.sight is Sight.FREE:
            return view.centred(self.x, self.y)
        x = _beside_rim(self.x, view.width, level.width)
        return view.centred(x, _beside_rim(self.y, view.height, level.height))

    def next_sight(self) -> Camera:
        if self.sight is Sight.WHOLE:
            return self._replace(sight=Sight.FOLLOW, step=self.step or _NEAR)
        return self._replace(sight=Sight.SENSES if self.sight is Sight.FOLLOW else Sight.WHOLE)

    def following(self, x: float, y: float, view: Viewport, *, at_once: bool = False) -> Camera:
        """Centre a robot (map units) that has left the view's middle; always if `at_once`.

        A view that moved with every step would change every cell in every picture.
        """
        if self.sight is not Sight.FOLLOW:
            return self
        middle_x, middle_y = view.middle
        is_calm_x = not at_once and abs(x - middle_x) <= _CALM * view.width
        is_calm_y = not at_once and abs(y - middle_y) <= _CALM * view.height
        if is_calm_x and is_calm_y:
            return self
        return self._replace(x=self.x if is_calm_x else x, y=self.y if is_calm_y else y)

    def zoomed(
        self, steps: int, view: Viewport, point: tuple[float, float] | None = None
    ) -> Camera:
        """Zoom (out if negative) around a point in map units, or around a followed robot."""
        if self.sight is Sight.SENSES:
            return self
        old_step = 0 if self.sight is Sight.WHOLE else self.step
        step = min(max(old_step + steps, 0), len(ZOOMS) - 1)
        if step == 0 and self.sight is not Sight.FOLLOW:
            return Camera()
        if self.sight is Sight.FOLLOW:
            return self._replace(step=step)
        x, y = point or view.middle
        share, middle = ZOOMS[old_step] / ZOOMS[step], view.middle
        return Camera(Sight.FREE, step, x + (middle[0] - x) * share, y + (middle[1] - y) * share)

    def panned(self, columns: float, rows: float, view: Viewport, level: Level) -> Camera:
        if self.sight is Sight.SENSES:
            return self
        x = min(max(view.middle[0] + columns * view.units, 0.0), level.width)
        y = min(max(view.middle[1] + rows * view.units * CELL_ASPECT, 0.0), level.height)
        return Camera(Sight.FREE, self.step if self.sight is not Sight.WHOLE else 0, x, y)


def _beside_rim(middle: float, length: float, whole: float) -> float:
    """Return the closest middle that shows as little as possible beyond the map."""
    if length >= whole:
        return whole / 2
    return min(max(middle, length / 2), whole - length / 2)
