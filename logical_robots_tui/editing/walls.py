"""Painting walls: every function returns a level with changed walls, or the level itself."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.editing.regions import Regions
from logical_robots_tui.editing.strokes import Patch, Point, rectangle, stroke

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.world.level import Level

__all__ = ["fill", "paint", "paint_rectangle"]


def paint(
    level: Level, points: Sequence[Point], *, width: int = 1, grid: int = 1, wall: bool = True
) -> Level:
    """Draw a round brush from point to point; two points are a line.

    Args:
        level: The level.
        points: Map units (x, y), at least one; anything outside the map is ignored.
        width: Width of the brush in squares of the grid.
        grid: Size of a square in map units.
        wall: Whether to paint walls, or to erase them.

    Raises:
        LevelError: A width, grid or point is out of range.
    """
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
    """Draw a rectangle.

    Args:
        level: The level.
        corner: One corner (x, y) in map units.
        opposite: The opposite corner (x, y) in map units.
        border: Width of the border in squares of the grid; 0 fills the rectangle.
        grid: Size of a square in map units.
        wall: Whether to paint walls, or to erase them.

    Raises:
        LevelError: A border, grid or corner is out of range.
    """
    return _with(level, rectangle(corner, opposite, border, grid, level.walls.shape), wall)


def fill(level: Level, x: float, y: float, *, wall: bool = True) -> Level:
    """Turn the region around a point into wall, or the walls around it into floor.

    Units are connected if they share a side.

    Args:
        level: The level.
        x: Map units; outside the map nothing changes.
        y: Map units.
        wall: Whether to fill floor with wall, or to remove walls.
    """
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
