"""Marks where the robots' rays end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, Cells, text_id
from logical_robots_tui.tui.labyrinth.drawing.palette import RGB, packed
from logical_robots_tui.tui.labyrinth.drawing.rays import KINDS
from logical_robots_tui.tui.labyrinth.drawing.robots import shows_body
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.drawing.look import Look
    from logical_robots_tui.tui.labyrinth.drawing.rays import Fan
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
    from logical_robots_tui.world.state import RobotState

__all__ = ["mark_ends"]


def mark_ends(
    cells: Cells,
    fans: Sequence[Fan],
    robots: Sequence[tuple[RobotState, RGB]],
    viewport: Viewport,
    look: Look,
) -> None:
    """Mark where rays end: one mark in a cell, the most important of them.

    Args:
        cells: The picture, changed in place.
        fans: The rays.
        robots: All robots with their colours; no mark stands on a body.
        viewport: The view.
        look: How to draw.
    """
    if not fans:
        return
    most = _ends(fans, viewport)
    if shows_body(viewport):
        for robot, _ in robots:
            _clear_body(most, robot, viewport)
    glyphs, palette = look.drawing.glyphs, look.palette
    at_wall = glyphs.hit_wall_near if shows_body(viewport) else glyphs.hit_wall
    texts = [text_id(text) for text in (at_wall, glyphs.hit_beacon, glyphs.hit_robot)]
    inks = [packed(ink) for ink in (palette.hit_wall, palette.hit_beacon, palette.hit_robot)]
    rows, columns = np.nonzero(most)
    kinds = most[rows, columns] - 1
    bold = np.where(kinds, BOLD, 0)
    cells.put_all(rows, columns, np.array(texts)[kinds], np.array(inks)[kinds], bold)


def _ends(fans: Sequence[Fan], viewport: Viewport) -> NDArray[np.int64]:
    """Return for each cell the most important kind of what rays hit there, or 0."""
    kinds = np.array([KINDS.get(what, 0) for fan in fans for what in fan.objects])
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = np.concatenate([fan.points() for fan in fans], axis=1)
        across = (x - viewport.left) / viewport.units
        down = (y - viewport.top) / (viewport.units * CELL_ASPECT)
        # Compared as floats: what is not a number is nowhere.
        seen = (across >= 0) & (across < viewport.columns) & (down >= 0) & (down < viewport.rows)
    found = np.flatnonzero(seen & (kinds > 0))
    found = found[np.argsort(kinds[found], kind="stable")]
    most = np.zeros((viewport.rows, viewport.columns), np.int64)
    most[down[found].astype(np.int64), across[found].astype(np.int64)] = kinds[found]
    return most


def _clear_body(most: NDArray[np.int64], robot: RobotState, viewport: Viewport) -> None:
    """Leave out the cells whose middle lies on the body of a robot."""
    cell = viewport.cell(robot.x, robot.y)
    if cell is None:
        return
    reach = 0.8 * ROBOT_RADIUS
    across = round(reach / viewport.units)
    down = round(reach / (viewport.units * CELL_ASPECT))
    for row in range(max(cell[0] - down, 0), min(cell[0] + down + 1, viewport.rows)):
        for column in range(max(cell[1] - across, 0), min(cell[1] + across + 1, viewport.columns)):
            x, y = viewport.position(row, column)
            if math.hypot(x - robot.x, y - robot.y) < reach:
                most[row, column] = 0
