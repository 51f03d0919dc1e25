"""The static layer of a view: floor, walls, areas and the glow of beacons; exact at any zoom."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import RGB, Palette, parse
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster, Window
from logical_robots_tui.world.level import Area, Beacon, Level
from logical_robots_tui.world.sensing import BEACON_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

ASCII_KINDS = " #:%,"
"""The characters for ``Ground.kinds``: floor, wall, area, solid area, area switched off."""

_FLOOR, _WALL, _AREA, _SOLID, _OFF = range(5)


@dataclass(frozen=True, eq=False)
class Ground:
    """The static layer of a view.

    `image` has colours from 0 to 255, shape (down, across, 3); `reflectance` of light is about
    0 to 1; `kinds` of dots are indices into ``ASCII_KINDS``.
    """

    image: Floats
    reflectance: Floats
    kinds: NDArray[np.uint8]

    def repaint(
        self, raster: Raster, changed: tuple[int, int, int, int], paint: Callable[[Raster], Ground]
    ) -> Window | None:
        """Repaint what walls changed in (left, right, top, bottom) affect; return it, if seen."""
        left, right, top, bottom = changed
        reach = _far_reach(raster)
        window = raster.window(left - reach, right + reach, top - reach, bottom + reach)
        if window is not None:
            part = paint(raster.only(window))
            self.image[window] = part.image
            self.reflectance[window] = part.reflectance
            self.kinds[window] = part.kinds
        return window


def draw_ground(
    level: Level,
    walls: WallTable,
    active: Sequence[bool],
    palette: Palette,
    switched: Container[int],
    raster: Raster,
) -> Ground:
    """Paint the static layer; `active` is by area, `switched` has numbers just switched."""
    # Emphasise low coverage, so that thin walls stay visible.
    rock = walls.coverage(raster).astype(np.float32) ** np.float32(0.6)
    rim = _rim(walls, raster, rock)
    image = np.empty((*raster.shape, 3), np.float32)
    image[:] = palette.floor
    everywhere = slice(None), slice(None)
    blend(image, everywhere, palette.grid, _grid(raster))
    blend(image, everywhere, palette.rock, rock)
    blend(image, everywhere, palette.rim, rim)

    kinds = np.where(rock >= 0.55, _WALL, _FLOOR).astype(np.uint8)
    for number, (area, is_active) in enumerate(zip(level.areas, active, strict=False)):
        weights = _area_weights(raster, area, is_active, flash=number in switched)
        if weights is None:
            continue
        window, disc, edge = weights
        over = 1 - 0.6 * rock[window]
        colour = palette.legible(parse(area.color))
        blend(image, window, colour, disc * over)
        blend(image, window, colour, edge * over)
        kind = _OFF if not is_active else _SOLID if area.impenetrable else _AREA
        marked = edge > 0.1 if kind == _OFF else disc > 0.1
        kinds[window][marked & (kinds[window] != _WALL)] = kind

    inside = walls.inside(raster).astype(np.float32)
    blend(image, everywhere, palette.void, 1 - inside)
    for beacon in level.beacons:
        _glow(image, raster, beacon, beacon_colour(beacon, palette))
    return Ground(image, (1 - rock + 1.1 * rim) * inside, kinds)


_LIGHTS = {"red", "green", "blue", "white", "gold"}  # in names such as "Blue" or "Bell of red"


def beacon_colour(beacon: Beacon, palette: Palette) -> RGB:
    if beacon.charging_station:
        return palette.charger
    lights = (word for word in beacon.name.lower().split() if word in _LIGHTS)
    return next((palette.legible(parse(light)) for light in lights), palette.beacon)


def blend(image: Floats, window: Window, colour: RGB, weights: Floats) -> None:
    """Mix a colour into part of an image; weights are 0 to 1, one per dot."""
    part = image[window]
    part += (np.array(colour, np.float32) - part) * weights[..., None]


def _area_weights(
    raster: Raster, area: Area, active: bool, *, flash: bool = False
) -> tuple[Window, Floats, Floats] | None:
    """Return a window of dots, and an area's disc and rim weights there; None out of sight."""
    radius = min(abs(area.radius), 1e6)
    around = raster.vicinity(area.x, area.y, radius)
    if around is None:
        return None
    window, dx, dy = around
    distance = np.hypot(dx, dy)
    dot = raster.dot
    disc = np.clip((radius - distance) / dot + 0.5, 0, 1)

    thick = max(1.2 * dot, 1.5)
    rim = np.clip((thick / 2 - np.abs(distance - radius + thick / 2)) / dot + 0.5, 0, 1)
    if flash:
        rim = np.clip((2 * thick - np.abs(distance - radius + thick)) / dot + 0.5, 0, 1)
        return window, disc * (0.5 if active else 0.3), rim * 1.0
    if not active:
        dashes = max(round(2 * math.pi * radius / (6 * dot)), 4)
        # On the axes the sine is 0 but for rounding, which depends on the processor.
        rim *= np.sin(np.arctan2(dy, dx) * dashes) > 1e-6
        return window, disc * 0.07, rim * 0.42

    if area.impenetrable:
        # Stripes are fixed to the map, so that they don't crawl when the view moves.
        period = max(6.0, 6 * dot)
        x, y = raster.x[window[1]][None, :], raster.y[window[0]][:, None]
        striped = (x + y) / period % 1 < 0.5
        disc *= np.where(striped, 0.62, 0.34).astype(np.float32)
        return window, disc, rim * 0.95
    if area.victory_robots:
        inner = radius - 3 * thick
        second = np.clip((thick / 2 - np.abs(distance - inner)) / dot + 0.5, 0, 1)
        if inner > 3 * dot:
            rim = np.maximum(rim, second * 0.55)
        return window, disc * 0.26, rim * 0.95
    return window, disc * 0.22, rim * 0.8


def _rim(walls: WallTable, raster: Raster, rock: Floats) -> Floats:
    """Return the brightness of walls: bright next to the floor, fading into the rock."""
    near = walls.openness(raster, max(1.5 * raster.dot, 3.0))
    far = walls.openness(raster, _far_reach(raster))
    lit: Floats = (2.2 * near).clip(0, 0.8) + 0.45 * (2 * far).clip(0, 1)
    return rock * lit.clip(0, 1).astype(np.float32)


def _far_reach(raster: Raster) -> float:
    """Return how far in map units a wall affects the brightness of a dot."""
    return max(3.5 * raster.dot, 10.0)


def _grid(raster: Raster) -> Floats:
    """Return 1 on the lines of a grid spaced by a round number of map units."""
    least_spacing = raster.viewport.units * 5
    spacing = next((s for s in (10, 20, 50, 100, 200, 500) if s >= least_spacing), 1000)
    across = np.diff(np.floor(raster.x_edges / spacing)) > 0
    down = np.diff(np.floor(raster.y_edges / spacing)) > 0
    return (across[None, :] | down[:, None]).astype(np.float32)


def _glow(image: Floats, raster: Raster, beacon: Beacon, colour: RGB) -> None:
    size = max(BEACON_RADIUS, 1.1 * raster.dot)
    around = raster.vicinity(beacon.x, beacon.y, 2.2 * size)
    if around is not None:
        window, dx, dy = around
        distance = np.hypot(dx, dy) / size
        blend(image, window, colour, 0.62 * np.exp(-1.4 * distance * distance))


_BAND = 64  # rows; when walls change, only the bands they are in are summed anew


class WallTable:
    """Sums of walls over rectangles by a summed-area table (Crow, SIGGRAPH 1984)."""

    def __init__(self, walls: NDArray[np.bool_]) -> None:
        self._walls = walls
        self.height, self.width = height, width = walls.shape
        # Walls to the left and above: in the bands above, and in the band itself.
        self._above: NDArray[np.int32] = np.zeros((height // _BAND + 1, width + 1), np.int32)
        self._within: NDArray[np.int32] = np.zeros((height + 1, width + 1), np.int32)
        for start in range(0, height, _BAND):
            self._sum(start)

    def change(self, walls: NDArray[np.bool_]) -> tuple[int, int, int, int] | None:
        """Replace walls of the same size; return (left, right, top, bottom) of changes, or None."""
        old_walls, self._walls = self._walls, walls
        columns, rows = np.zeros(self.width, np.bool_), []
        for start in range(0, self.height, _BAND):
            band = slice(start, start + _BAND)
            if old_walls is walls or np.array_equal(old_walls[band], walls[band]):
                continue
            self._sum(start)
            differs = old_walls[band] != walls[band]
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
        """Return the floor's share of squares reaching `reach` map units from dots' centres."""
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
        rows = self._walls[start : start + _BAND]
        sums = rows.cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32)
        # The last row of a full band is the first one of what lies above the next.
        full = len(rows) == _BAND
        inner = sums[:-1] if full else sums
        self._within[start + 1 : start + 1 + len(inner), 1:] = inner
        if full:
            band = start // _BAND
            increase = sums[-1] + self._above[band, 1:] - self._above[band + 1, 1:]
            self._above[band + 1 :, 1:] += increase

    def _between(self, left: Floats, right: Floats, y: Floats) -> Floats:
        """Return the wall area above each y between pairs of x; shape (len(y), len(left))."""
        y = np.clip(y, 0, self.height)
        whole = np.minimum(y.astype(np.int64), self.height - 1)
        rows = np.concatenate((whole, whole + 1))
        low, high = np.split(self._to_the_left(right, rows) - self._to_the_left(left, rows), 2)
        between: Floats = low + (high - low) * (y - whole)[:, None]
        return between

    def _to_the_left(self, x: Floats, rows: NDArray[np.int64]) -> Floats:
        """Return the wall area to the left of each x, above whole rows."""
        x = np.clip(x, 0, self.width)
        whole = np.minimum(x.astype(np.int64), self.width - 1)
        columns = np.concatenate((whole, whole + 1))
        sums = self._above[rows // _BAND][:, columns] + self._within[np.ix_(rows, columns)]
        low, high = np.split(sums, 2, axis=1)
        across: Floats = low + (high - low) * (x - whole)
        return across
