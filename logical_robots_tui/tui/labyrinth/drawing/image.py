"""A level as an image of pixels, and as a file of PNG."""

from __future__ import annotations

import math
import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.areas import blend
from logical_robots_tui.tui.labyrinth.drawing.ground import beacon_colour, lay_ground
from logical_robots_tui.tui.labyrinth.drawing.lettering import robot_colour
from logical_robots_tui.tui.labyrinth.drawing.palette import DARK, Palette
from logical_robots_tui.tui.labyrinth.drawing.robots import paint_robot
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Raster, Viewport
from logical_robots_tui.tui.labyrinth.drawing.walls import WallTable
from logical_robots_tui.world import World
from logical_robots_tui.world.sensing import BEACON_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats
    from logical_robots_tui.world import Beacon, Level

__all__ = ["draw_pixels", "png"]

_STRIP = 256  # rows of pixels painted at once, which bounds the memory


def draw_pixels(level: Level, longest: int, palette: Palette = DARK) -> NDArray[np.uint8]:
    """Draw a level at its start, without names.

    Args:
        level: The level.
        longest: Pixels of the longer side.
        palette: The colours that don't come from the level.

    Returns:
        Colours of shape (height, width, 3).
    """
    units = max(level.width, level.height) / longest
    width = max(math.ceil(level.width / units), 1)
    height = max(math.ceil(level.height / units), 1)
    # A cell is a pixel wide and two high.
    down = round(CELL_ASPECT)
    viewport = Viewport(width, math.ceil(height / down), 0.0, 0.0, units)
    raster = Raster(viewport, 1, down)
    start = World(level).save()
    active = [area.active for area in start.areas]
    walls = WallTable(level.walls)
    strips = []
    for top in range(0, height, _STRIP):
        part = raster.only((slice(top, min(top + _STRIP, height)), slice(0, width)))
        image = lay_ground(level, walls, active, part, palette).image
        for beacon in level.beacons:
            _paint_beacon(image, part, beacon, palette)
        for robot, state in zip(level.robots, start.robots, strict=True):
            paint_robot(image, part, state, robot_colour(robot.color, palette), palette)
        strips.append(np.clip(image, 0, 255).astype(np.uint8))
    return np.concatenate(strips)


def _paint_beacon(image: Floats, raster: Raster, beacon: Beacon, palette: Palette) -> None:
    """Paint a diamond in the glow of a beacon."""
    size = max(BEACON_RADIUS * 0.8, raster.dot)
    window = raster.window(beacon.x - size, beacon.x + size, beacon.y - size, beacon.y + size)
    if window is not None:
        dx, dy = raster.offsets(window, beacon.x, beacon.y)
        inside = np.clip((size - np.abs(dx) - np.abs(dy)) / raster.dot + 0.5, 0, 1)
        blend(image, window, beacon_colour(beacon, palette), inside)


def png(pixels: NDArray[np.uint8]) -> bytes:
    """Return an image as a file of PNG (W3C Portable Network Graphics, 8 bits, true colour).

    Args:
        pixels: Colours of shape (height, width, 3).
    """
    height, width, _ = pixels.shape
    rows = np.zeros((height, 1 + width * 3), np.uint8)  # 0 before a row: it isn't filtered
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes())), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
