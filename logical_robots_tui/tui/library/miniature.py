"""Shipped levels, and small pictures of levels, each made once and kept."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from logical_robots_tui.game import Frame
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
from logical_robots_tui.tui.labyrinth.drawing.picture import Picture
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
from logical_robots_tui.world import World, load_level

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
    from logical_robots_tui.tui.labyrinth.drawing.palette import Palette
    from logical_robots_tui.world import Level

__all__ = ["draw_miniature", "miniature", "shipped_level"]


@lru_cache(maxsize=64)
def shipped_level(name: str) -> Level:
    """A level that came with the game; raises `LevelError`."""
    return load_level(name)


@lru_cache(maxsize=128)
def miniature(level: Level, columns: int, rows: int, drawing: Drawing, palette: Palette) -> Cells:
    """A level at its start, in so many cells. Takes milliseconds the first time."""
    return draw_miniature(level, columns, rows, drawing, palette)


def draw_miniature(
    level: Level,
    columns: int,
    rows: int,
    drawing: Drawing,
    palette: Palette,
    *,
    names: bool = False,
) -> Cells:
    """A level at its start, without rays, and without names unless they are wanted."""
    state = World(level).save()
    start = Frame(0, state, state, (), {}, (), {}, 0.0)
    viewport = Viewport.fit(level.width, level.height, columns, rows)
    look = Look(drawing=drawing, palette=palette, rays=False, marks=False, names=names)
    return Picture().draw(level, start, viewport, look)
