"""Approximates the dots of each cell by one block character in two colours."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import Cells, text_id

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats


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

_FLAT = 40.0
"""Squared error, summed over the dots, below which a cell is given one colour only."""


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


def fit(
    dots: NDArray[np.uint8],
) -> tuple[NDArray[np.int64], Floats, Floats]:
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

    patterns, members = _patterns(count)
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


def _patterns(count: int) -> tuple[NDArray[np.int64], Floats]:
    """Return all ways to split dots in two, and for each a row of its members."""
    patterns = np.arange(1, 2**count - 1, 2, dtype=np.int64)
    return patterns, (patterns[:, None] >> np.arange(count) & 1).astype(np.float32)


_BLOCK_IDS = {
    count: np.array([text_id(char) for char in chars], np.int64) for count, chars in BLOCKS.items()
}


def fitted(dots: NDArray[np.uint8], rows: int, columns: int) -> Cells:
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
