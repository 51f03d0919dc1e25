"""The overlay of the level editor: grid, preview, selection and cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.editing.editor import (
    PAINTING,
    LevelEditor,
    Tool,
    handle_of,
    reach_of,
)
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, RGB, Cells, rgb_number, text_id
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Floats, Viewport

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.editing.checks import LevelFinding

_LEAST_COLUMNS = 4  # between two dots of the grid
_UNSEEN = 28  # of 255, the largest difference of a cell's two colours that looks even
_ACCENT: RGB = (255, 180, 84)
_WIPE: RGB = (255, 123, 133)
_WARN: RGB = (242, 198, 95)
_BLANK = text_id(" ")


def mark(
    cells: Cells, view: Viewport, editor: LevelEditor, findings: Sequence[LevelFinding], look: Look
) -> None:
    plain = look.drawing is Drawing.ASCII
    if editor.settings.is_grid_shown:
        _dot_grid(cells, view, editor, "." if plain else "·", look)
    for finding in findings:
        if finding.x is not None and finding.y is not None:
            _put(cells, view, finding.x, finding.y, "!", _WARN)
    covered = _cover(view, editor)
    if covered is not None:
        colour = _ACCENT if editor.settings.paints_wall else _WIPE
        _tint(cells, covered, colour)
        if plain:
            cells.text[covered] = text_id("*")
    _mark_selection(cells, view, editor, plain=plain)
    _put_cursor(cells, view, editor)


def _dot_grid(cells: Cells, view: Viewport, editor: LevelEditor, dot: str, look: Look) -> None:
    """Draw a dot at each crossing of grid lines; when zoomed out, only at every n-th."""
    level, grid = editor.level, editor.settings.grid
    times = next(
        (n for n in (1, 2, 4, 5, 10, 20, 50, 100) if n * grid >= _LEAST_COLUMNS * view.units), 200
    )
    spacing = grid * times
    columns = _cells_of(level.width, spacing, view.left, view.units, view.columns)
    rows = _cells_of(level.height, spacing, view.top, view.units * CELL_ASPECT, view.rows)
    where = np.ix_(rows, columns)
    style = cells.style[where]
    ink, paper = style >> 24 & 0xFFFFFF, style & 0xFFFFFF
    apart = np.zeros(style.shape, np.int64)
    for shift in (16, 8, 0):
        apart = np.maximum(apart, np.abs((ink >> shift & 0xFF) - (paper >> shift & 0xFF)))
    is_plain = (cells.text[where] == _BLANK) | (apart < _UNSEEN)
    dotted = np.zeros(cells.text.shape, np.bool_)
    dotted[where] = is_plain
    cells.text[dotted] = text_id(dot)
    cells.style[dotted] = rgb_number(look.palette.rim) << 24 | cells.tone[dotted]


def _cells_of(
    length: int, spacing: int, first: float, units: float, count: int
) -> NDArray[np.intp]:
    places = np.arange(spacing, length, spacing)
    found = np.floor((places - first) / units).astype(np.intp)
    return np.unique(found[(found >= 0) & (found < count)])


def _cover(view: Viewport, editor: LevelEditor) -> NDArray[np.bool_] | None:
    settings, stroke = editor.settings, editor.stroke
    if settings.tool not in PAINTING:
        return None
    is_free = settings.tool in (Tool.BRUSH, Tool.ERASER) or stroke is None
    start = editor.cursor if is_free or stroke is None else stroke.start
    end = editor.cursor
    across = view.left + (np.arange(view.columns) + 0.5) * view.units
    down = view.top + (np.arange(view.rows) + 0.5) * view.units * CELL_ASPECT
    x, y = across[None, :], down[:, None]
    if settings.tool is Tool.RECTANGLE and stroke is not None:
        return _rectangle(
            x, y, start, end, view, 0 if settings.is_filled else settings.width * settings.grid
        )
    half = max(settings.width * settings.grid / 2, view.units / 2)
    dx, dy = end[0] - start[0], end[1] - start[1]
    along = ((x - start[0]) * dx + (y - start[1]) * dy) / max(dx * dx + dy * dy, 1e-9)
    along = np.clip(along, 0, 1)
    far_x = np.maximum(np.abs(x - start[0] - along * dx) - view.units / 2, 0)
    far_y = np.maximum(np.abs(y - start[1] - along * dy) - view.units * CELL_ASPECT / 2, 0)
    inside: NDArray[np.bool_] = np.hypot(far_x, far_y) < half - view.units / 4
    return inside


def _rectangle(
    x: Floats,
    y: Floats,
    start: tuple[float, float],
    end: tuple[float, float],
    view: Viewport,
    border: int,
) -> NDArray[np.bool_]:
    """Return the cells of a rectangle, or of its border, whose width is in map units."""
    half_x, half_y = view.units / 2, view.units * CELL_ASPECT / 2
    left, right = sorted((start[0], end[0]))
    top, bottom = sorted((start[1], end[1]))
    inside: NDArray[np.bool_] = (
        (x + half_x > left) & (x - half_x < right) & (y + half_y > top) & (y - half_y < bottom)
    )
    if not border:
        return inside
    near_x = (x - half_x < left + border) | (x + half_x > right - border)
    near_y = (y - half_y < top + border) | (y + half_y > bottom - border)
    on_border: NDArray[np.bool_] = inside & (near_x | near_y)
    return on_border


def _tint(cells: Cells, where: NDArray[np.bool_], colour: RGB) -> None:
    style = cells.style[where]
    mixed = style & BOLD
    for shift, wanted in zip((40, 32, 24, 16, 8, 0), colour * 2, strict=True):
        channel = style >> shift & 0xFF
        mixed |= (channel + (wanted - channel) * 2 // 5) << shift
    cells.style[where] = mixed


def _mark_selection(cells: Cells, view: Viewport, editor: LevelEditor, *, plain: bool) -> None:
    thing = editor.thing
    if thing is None:
        return
    reach = reach_of(thing) + view.units * 0.8
    corners = "++++" if plain else "┌┐└┘"
    signs = zip(corners, ((-1, -1), (1, -1), (-1, 1), (1, 1)), strict=True)
    for sign, (across, down) in signs:
        _put(
            cells,
            view,
            thing.x + across * reach,
            thing.y + down * max(reach, view.units * 1.5),
            sign,
            _ACCENT,
        )
    handle = handle_of(thing, view.units)
    if handle is not None:
        _put(cells, view, *handle, "*" if plain else "◆", _ACCENT)


def _put_cursor(cells: Cells, view: Viewport, editor: LevelEditor) -> None:
    place = view.cell(*editor.cursor)
    if place is not None:
        row, column = place
        paper = rgb_number(_ACCENT if editor.settings.paints_wall else _WIPE)
        cells.put(row, column, "+", 0, paper, bold=True)


def _put(cells: Cells, view: Viewport, x: float, y: float, text: str, ink: RGB) -> None:
    if math.isfinite(x + y) and (place := view.cell(x, y)) is not None:
        cells.put(*place, text, rgb_number(ink), bold=True)
