"""What stands still in a view: floor, walls, areas and the glow of beacons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.areas import area_weights, blend
from logical_robots_tui.tui.labyrinth.drawing.palette import RGB, Palette, parse
from logical_robots_tui.world.sensing import BEACON_RADIUS

if TYPE_CHECKING:
    from collections.abc import Container, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster
    from logical_robots_tui.tui.labyrinth.drawing.walls import WallTable
    from logical_robots_tui.world.level import Beacon, Level

__all__ = ["ASCII_KINDS", "Ground", "lay_ground", "touch_up"]

ASCII_KINDS = " #:%,"
"""The characters for ``Ground.kinds``: floor, wall, area, solid area, area switched off."""

_FLOOR, _WALL, _AREA, _SOLID, _OFF = range(5)


@dataclass(frozen=True, eq=False)
class Ground:
    """The still layer of a view.

    Attributes:
        image: Colours from 0 to 255, shape (down, across, 3).
        gleam: How strongly each dot shows light that falls on it, about 0 to 1.
        kinds: What each dot mostly is, as an index into ``ASCII_KINDS``.
    """

    image: Floats
    gleam: Floats
    kinds: NDArray[np.uint8]


def lay_ground(
    level: Level,
    walls: WallTable,
    active: Sequence[bool],
    raster: Raster,
    palette: Palette,
    switched: Container[int] = (),
) -> Ground:
    """Paint what stands still.

    Args:
        level: The level.
        walls: Its walls.
        active: For each area whether it is switched on.
        raster: The dots to paint.
        palette: Their colours.
        switched: Numbers of the areas for which that has just changed.
    """
    # A thin wall must not vanish between the dots, so little counts for more.
    stone = walls.coverage(raster).astype(np.float32) ** np.float32(0.6)
    rim = _rim(walls, raster, stone)
    image = np.empty((*raster.shape, 3), np.float32)
    image[:] = palette.floor
    everywhere = slice(None), slice(None)
    blend(image, everywhere, palette.grid, _grid(raster))
    blend(image, everywhere, palette.rock, stone)
    blend(image, everywhere, palette.rim, rim)

    kinds = np.where(stone >= 0.55, _WALL, _FLOOR).astype(np.uint8)
    for number, (area, is_active) in enumerate(zip(level.areas, active, strict=False)):
        found = area_weights(raster, area, is_active, flash=number in switched)
        if found is None:
            continue
        window, disc, edge = found
        over = 1 - 0.6 * stone[window]
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
    return Ground(image, (1 - stone + 1.1 * rim) * inside, kinds)


def touch_up(
    ground: Ground,
    level: Level,
    walls: WallTable,
    changed: tuple[int, int, int, int],
    active: Sequence[bool],
    raster: Raster,
    palette: Palette,
    switched: Container[int] = (),
) -> tuple[slice, slice] | None:
    """Paint that part of a still layer anew where walls changed.

    Args:
        ground: What was painted with the walls before, changed in place.
        level: The level.
        walls: Its walls.
        changed: Map units (left, right, top, bottom) that hold all that changed.
        active: For each area whether it is switched on.
        raster: The dots that were painted.
        palette: Their colours.
        switched: Numbers of the areas for which that has just changed.

    Returns:
        The dots (down, across) that were painted, or None if nothing of it is in view.
    """
    left, right, top, bottom = changed
    reach = _far_reach(raster)
    window = raster.window(left - reach, right + reach, top - reach, bottom + reach)
    if window is not None:
        part = lay_ground(level, walls, active, raster.only(window), palette, switched)
        ground.image[window] = part.image
        ground.gleam[window] = part.gleam
        ground.kinds[window] = part.kinds
    return window


def beacon_colour(beacon: Beacon, palette: Palette) -> RGB:
    """Return the colour in which a beacon shines."""
    return palette.charger if beacon.charging_station else palette.beacon


def _rim(walls: WallTable, raster: Raster, stone: Floats) -> Floats:
    """Return how lit the walls are: bright next to the floor, then fading into the rock."""
    near = walls.openness(raster, max(1.5 * raster.dot, 3.0))
    far = walls.openness(raster, _far_reach(raster))
    lit: Floats = (2.2 * near).clip(0, 0.8) + 0.45 * (2 * far).clip(0, 1)
    return stone * lit.clip(0, 1).astype(np.float32)


def _far_reach(raster: Raster) -> float:
    """Return how many map units away from it a wall can change how a dot is lit."""
    return max(3.5 * raster.dot, 10.0)


def _grid(raster: Raster) -> Floats:
    """Return 1 on the lines of a grid whose spacing is a round number of map units."""
    wanted = raster.viewport.units * 5
    spacing = next((s for s in (10, 20, 50, 100, 200, 500) if s >= wanted), 1000)
    across = np.diff(np.floor(raster.x_edges / spacing)) > 0
    down = np.diff(np.floor(raster.y_edges / spacing)) > 0
    return (across[None, :] | down[:, None]).astype(np.float32)


def _glow(image: Floats, raster: Raster, beacon: Beacon, colour: RGB) -> None:
    size = max(BEACON_RADIUS, 1.1 * raster.dot)
    reach = 2.2 * size
    window = raster.window(beacon.x - reach, beacon.x + reach, beacon.y - reach, beacon.y + reach)
    if window is not None:
        dx, dy = raster.offsets(window, beacon.x, beacon.y)
        distance = np.hypot(dx, dy) / size
        blend(image, window, colour, 0.62 * np.exp(-1.4 * distance * distance))
