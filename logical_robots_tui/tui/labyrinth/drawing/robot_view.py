"""What robots sense, one picture per robot, seen from the robot, with ahead at the top."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.labyrinth.drawing.cells import (
    BOLD,
    RGB,
    Cells,
    fit_dots,
    mix,
    rgb_number,
    split,
)
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas, Look
from logical_robots_tui.tui.labyrinth.drawing.ground import blend
from logical_robots_tui.tui.labyrinth.drawing.lettering import fit_into, robot_colour, write
from logical_robots_tui.tui.labyrinth.drawing.rays import (
    Fan,
    brightness_of,
    draw_ray,
    draw_ring,
    fans,
)
from logical_robots_tui.tui.labyrinth.drawing.viewport import Raster, Viewport
from logical_robots_tui.world.level import Level

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame

_THICK = 12.0  # map units between the ends of two rays that belong to one wall, at least
_LEAST = (24, 10)  # columns and rows that a picture of one robot needs


def tiles(count: int, columns: int, rows: int) -> tuple[int, int]:
    """Return how many pictures stand side by side and above each other, as large as possible."""
    most_across, most_down = max(columns // _LEAST[0], 1), max(rows // _LEAST[1], 1)
    best, best_size = (most_across, most_down), 0.0
    for across in range(1, most_across + 1):
        down = min(math.ceil(count / across), most_down)
        if across * down < count and (across, down) != (most_across, most_down):
            continue
        size = min(columns / across / 2, 2 * (rows / down - 1) / 1.2)
        if size > best_size:
            best, best_size = (across, down), size
    return best


def draw_senses(level: Level, frame: Frame, columns: int, rows: int, look: Look) -> Cells:
    """Draw what robots sense, the selected one in any case."""
    cells = Cells.blank(rows, columns)
    cells.style[:] = rgb_number(look.palette.void)
    cells.tone[:] = rgb_number(look.palette.void)
    seen = fans(frame)
    if not seen or columns < 3 or rows < 3:
        return cells
    across, down = tiles(len(seen), columns, rows)
    shown = _shown([fan.name for fan in seen], across * down, look.selected)
    colours = {robot.name: robot_colour(robot.color, look.palette) for robot in level.robots}
    by_name = {fan.name: fan for fan in seen}
    width, height = columns // across, rows // down
    for number, name in enumerate(shown):
        tile = _tile(by_name[name], colours.get(name, look.palette.dead), width, height, look)
        left, top = number % across * width, number // across * height
        part = slice(top, top + height), slice(left, left + width)
        cells.text[part], cells.style[part] = tile.text, tile.style
        cells.tone[part] = tile.tone
    return cells


def _shown(names: Sequence[str], room: int, selected: str | None) -> Sequence[str]:
    first = names.index(selected) // room * room if selected in names else 0
    return names[first : first + room]


def _tile(fan: Fan, colour: RGB, columns: int, rows: int, look: Look) -> Cells:
    """Draw one robot's senses: up is ahead, and a frame separates tiles."""
    palette = look.palette
    middle = float(fan.headings[0] + fan.headings[-1]) / 2
    turn = middle + math.pi / 2
    own = replace(fan, x=0.0, y=0.0, headings=fan.headings - turn, ahead=fan.ahead - turn)
    view = _view(columns, rows - 1)
    raster = Raster(view, *look.drawing.dots)
    image = np.empty((*raster.shape, 3), np.float32)
    image[:] = palette.floor
    dx, dy = np.meshgrid(raster.x, raster.y)
    away = np.hypot(dx, dy)
    ring = np.clip(1 - np.abs(away - SENSOR_RANGE) / raster.dot, 0, 1)
    blend(image, (slice(None), slice(None)), palette.rock, ring)
    lit = np.zeros(raster.shape, np.bool_)
    found = brightness_of(own, raster)
    if found is not None:
        window, brightness = found
        lit[window] = brightness > 0
        blend(image, window, colour, np.float32(0.6) * brightness)
    walls = _walls(own, raster)
    image[walls] = palette.rim
    if look.is_plain:
        cells = Cells.blank(rows - 1, columns)
        cells.tone[:] = rgb_number(palette.floor)
        cells.style[:] = rgb_number(palette.dead) << 24 | rgb_number(palette.floor)
        for row, column in zip(*np.nonzero(lit), strict=True):
            cells.put(int(row), int(column), ".", rgb_number(colour))
        for row, column in zip(*np.nonzero(walls), strict=True):
            cells.put(int(row), int(column), "#", rgb_number(palette.rim))
    else:
        coarse = np.clip(image, 0, 255).astype(np.uint8) & np.uint8(0xFC)
        cells = fit_dots(split(coarse, raster.across, raster.down), rows - 1, columns)
    canvas = Canvas(cells, view, look)
    _put_ends(canvas, own)
    if look.highlight is not None and look.highlight.robot == fan.name:
        if look.highlight.ray is not None:
            draw_ray(canvas, own, look.highlight.ray)
        else:
            draw_ring(canvas, 0.0, 0.0)
    canvas.put(view.cell(0.0, 0.0), look.glyphs.heading(-math.pi / 2), colour)
    return _title(cells, fan.name, colour, look)


def _view(columns: int, rows: int) -> Viewport:
    """Return the view around a robot, with less behind it, where no ray goes."""
    reach, behind = SENSOR_RANGE * 1.04, SENSOR_RANGE * 0.2
    view = Viewport.fit(2 * reach, reach + behind, columns, rows)
    return view.centred(0.0, (behind - reach) / 2)


def _walls(fan: Fan, raster: Raster) -> NDArray[np.bool_]:
    """Return which dots show a sensed wall; fills gaps between rays that end close together."""
    found = np.zeros(raster.shape, np.bool_)
    x, y = fan.points()
    is_wall = np.array([kind == "wall" for kind in fan.objects])
    gap = np.hypot(np.diff(x), np.diff(y))
    # Seen at a slant, rays that are neighbours end far apart on the same wall.
    joined = is_wall[1:] & is_wall[:-1] & (gap < 0.25 * fan.distances[1:] + _THICK)
    steps = np.linspace(0, 1, 32)
    along_x = x[:-1, None] + np.diff(x)[:, None] * steps
    along_y = y[:-1, None] + np.diff(y)[:, None] * steps
    every_x = np.concatenate([along_x[joined].ravel(), x[is_wall]])
    every_y = np.concatenate([along_y[joined].ravel(), y[is_wall]])
    rows = np.searchsorted(raster.y_edges, every_y) - 1
    columns = np.searchsorted(raster.x_edges, every_x) - 1
    inside = (rows >= 0) & (rows < found.shape[0]) & (columns >= 0) & (columns < found.shape[1])
    found[rows[inside], columns[inside]] = True
    return found


def _put_ends(canvas: Canvas, fan: Fan) -> None:
    cells, view, look = canvas
    palette, glyphs = look.palette, look.glyphs
    signs = {
        "beacon": (glyphs.beacon, palette.hit_beacon),
        "robot": (glyphs.hit_robot, palette.hit_robot),
    }
    for x, y, kind in fan.ends():
        if kind in signs:
            canvas.put(view.cell(x, y), *signs[kind])
    for x, y, kind, label in fan.sighted():
        cell = view.cell(x, y)
        if cell is None or not look.names:
            continue
        name = fit_into(label, view.columns // 2, look.drawing)
        row, first = cell[0] - 1, min(max(cell[1] - len(name) // 2, 0), view.columns - len(name))
        if row >= 0:
            style = rgb_number(signs[kind][1]) << 24 | rgb_number(palette.plate)
            write(cells, row, first, name, style)


def _title(cells: Cells, name: str, colour: RGB, look: Look) -> Cells:
    rows, columns = cells.text.shape
    titled = Cells.blank(rows + 1, columns)
    paper = rgb_number(mix(look.palette.plate, colour, 0.2))
    titled.style[0], titled.tone[0] = paper, paper
    titled.text[1:], titled.style[1:], titled.tone[1:] = cells.text, cells.style, cells.tone
    text = fit_into(name, columns - 2, look.drawing)
    write(titled, 0, 1, text, BOLD | rgb_number(look.palette.strong(colour)) << 24 | paper)
    return titled
