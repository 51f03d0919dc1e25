"""Paints areas and robots as antialiased discs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import (
    RGB,
    Cells,
    Palette,
    luminance,
    mix,
    text_id,
)
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster, Viewport
from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.level import Area
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _sextant(pattern: int) -> str:
    """Return the block for six dots; four blocks predate Unicode's sextants."""
    had = {0: " ", 21: "▌", 42: "▐", 63: "█"}
    return had.get(pattern) or chr(0x1FAFF + pattern - (pattern > 21) - (pattern > 42))


BLOCKS = {
    6: "".join(map(_sextant, range(64))),
    4: " ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█",
    2: " ▀▄█",
    1: " ",
}
"""For a number of dots in a cell the character of each pattern; bit i is dot i, row by row."""

_FLAT = 40.0  # squared error, summed over the dots, below which a cell is given one colour only


def split(image: NDArray[np.uint8], across: int, down: int) -> NDArray[np.uint8]:
    """Return each cell's dots, (cells, down * across, 3), in reading order.

    The image has the shape (rows * down, columns * across, 3).
    """
    rows, columns = image.shape[0] // down, image.shape[1] // across
    cells = image.reshape(rows, down, columns, across, 3).swapaxes(1, 2)
    return cells.reshape(rows * columns, down * across, 3)


def pack(colour: Floats) -> NDArray[np.int64]:
    """Pack colours of shape (..., 3) as 0xRRGGBB, rounded to steps of 4."""
    steps = (colour + 2).astype(np.int64) & 0xFC
    packed: NDArray[np.int64] = steps[..., 0] << 16 | steps[..., 1] << 8 | steps[..., 2]
    return packed


def fit(dots: NDArray[np.uint8]) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Divide each cell's dots, (cells, dots of a cell, 3), into the two best colour groups.

    Returns an index into ``BLOCKS``, ink (lighter) and paper (darker) per cell; blank for about
    one colour.
    """
    cells, count, _ = dots.shape
    by_dot = dots.transpose(1, 0, 2).reshape(count, cells * 3).astype(np.float32)
    total = by_dot.sum(axis=0).reshape(cells, 3)
    mean = total / count
    if count == 1 or not cells:
        return np.zeros(cells, np.int64), mean, mean

    # All ways to split the dots in two, and for each a row of its members.
    patterns = np.arange(1, 2**count - 1, 2, dtype=np.int64)
    members = (patterns[:, None] >> np.arange(count) & 1).astype(np.float32)
    sizes = members.sum(axis=1)[:, None]
    sums = (members @ by_dot).reshape(len(patterns), cells, 3)
    rest = total - sums
    # What a colour explains is the squared sum over the number of its dots.
    explained = (sums * sums).sum(axis=2) / sizes + (rest * rest).sum(axis=2) / (count - sizes)
    best = explained.argmax(axis=0)
    every = np.arange(cells)
    flat = explained[best, every] - (total * total).sum(axis=1) / count < _FLAT

    size = sizes[best]
    ink, paper, pattern = (
        sums[best, every] / size,
        rest[best, every] / (count - size),
        patterns[best],
    )
    swap = (ink - paper) @ _BRIGHTNESS < 0
    ink[swap], paper[swap] = paper[swap], ink[swap]
    pattern[swap] ^= 2**count - 1
    pattern[flat] = 0
    ink[flat] = paper[flat] = mean[flat]
    return pattern, ink, paper


_BRIGHTNESS = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


_BLOCK_IDS = {
    count: np.array([text_id(char) for char in chars], np.int64) for count, chars in BLOCKS.items()
}


def fit_dots(dots: NDArray[np.uint8], rows: int, columns: int) -> Cells:
    """Return the cells that approximate dots, (cells, dots of a cell, 3), best."""
    cells = Cells.blank(rows, columns)
    refit(cells, dots, np.arange(len(dots)))
    return cells


def refit(cells: Cells, dots: NDArray[np.uint8], which: NDArray[np.int64]) -> None:
    """Fit some cells, by number in reading order, anew in place; `dots` is of all."""
    pattern, ink, paper = fit(dots[which])
    cells.text.ravel()[which] = _BLOCK_IDS[dots.shape[1]][pattern]
    cells.style.ravel()[which] = pack(ink) << 24 | pack(paper)
    cells.tone.ravel()[which] = pack(dots[which].mean(axis=1, dtype=np.float32))


def blend(image: Floats, window: tuple[slice, slice], colour: RGB, weights: Floats) -> None:
    """Mix a colour into part of an image; weights are 0 to 1, one per dot."""
    part = image[window]
    part += (np.array(colour, np.float32) - part) * weights[..., None]


def area_weights(
    raster: Raster, area: Area, active: bool, *, flash: bool = False
) -> tuple[tuple[slice, slice], Floats, Floats] | None:
    """Return a window of dots, and an area's disc and rim weights there; None out of sight."""
    radius = min(abs(area.radius), 1e6)
    window = raster.window(area.x - radius, area.x + radius, area.y - radius, area.y + radius)
    if window is None:
        return None
    dx, dy = raster.offsets(window, area.x, area.y)
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
        rim *= np.sin(np.arctan2(dy, dx) * dashes) > 0
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


def shows_body(viewport: Viewport) -> bool:
    return ROBOT_RADIUS / viewport.units >= 2.2


def body_rows(viewport: Viewport) -> int:
    return round(ROBOT_RADIUS / (2 * viewport.units) - 0.2) if shows_body(viewport) else 0


def paint_robot(
    image: Floats, raster: Raster, robot: RobotState, colour: RGB, palette: Palette
) -> None:
    """Paint the body of a robot, in place, into the colours of the dots."""
    if not math.isfinite(robot.angle):
        return
    full = shows_body(raster.viewport)
    radius = ROBOT_RADIUS if full else max(ROBOT_RADIUS, 0.9 * raster.dot)
    reach = radius * 1.5
    window = raster.window(robot.x - reach, robot.x + reach, robot.y - reach, robot.y + reach)
    if window is None:
        return
    dx, dy = raster.offsets(window, robot.x, robot.y)
    distance = np.hypot(dx, dy)
    dot = raster.dot
    body = np.clip((radius - distance) / dot + 0.5, 0, 1)
    if not full:
        blend(image, window, colour, body * 0.85)
        return

    shadow = np.clip((radius * 1.4 - distance) / (radius * 0.4), 0, 1)
    blend(image, window, palette.floor, shadow * 0.55)
    blend(image, window, mix(colour, (0, 0, 0), 0.45), body)
    inner = np.clip((radius - max(1.1 * dot, 1.2) - distance) / dot + 0.5, 0, 1)
    blend(image, window, colour, inner)
    cos, sin = math.cos(robot.angle), math.sin(robot.angle)
    ahead, aside = dx * cos + dy * sin, np.abs(dy * cos - dx * sin)
    if radius > 6 * dot:
        nose = np.minimum(ahead + 0.3 * radius, (1.15 * radius - ahead) * 0.33 - aside)
    else:  # Too few dots for a pointer.
        nose = 0.4 * radius - np.hypot(ahead - 0.68 * radius, aside)
    nose = np.clip(nose / dot + 0.5, 0, 1) * body
    blend(image, window, mix(colour, palette.bright, 0.72), nose)


def text_on(colour: RGB) -> RGB:
    return (8, 8, 10) if luminance(colour) > 0.45 else (255, 255, 255)
