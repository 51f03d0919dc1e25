"""Cells made of dots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import Cells, text_id
from logical_robots_tui.tui.labyrinth.drawing.dots import BLOCKS, fit, pack

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["fitted", "refit"]

_BLOCK_IDS = {
    count: np.array([text_id(char) for char in chars], np.int64) for count, chars in BLOCKS.items()
}


def fitted(dots: NDArray[np.uint8], rows: int, columns: int) -> Cells:
    """Return the cells that come nearest to dots.

    Args:
        dots: Shape (rows * columns, dots of a cell, 3), as ``split`` gives them.
        rows: Cells down.
        columns: Cells across.
    """
    cells = Cells.blank(rows, columns)
    refit(cells, dots, np.arange(len(dots)))
    return cells


def refit(cells: Cells, dots: NDArray[np.uint8], which: NDArray[np.int64]) -> None:
    """Fit some cells anew.

    Args:
        cells: Changed in place.
        dots: Of all cells.
        which: Numbers of the cells to fit, in reading order.
    """
    pattern, ink, paper = fit(dots[which])
    cells.text.ravel()[which] = _BLOCK_IDS[dots.shape[1]][pattern]
    cells.style.ravel()[which] = pack(ink) << 24 | pack(paper)
    cells.tone.ravel()[which] = pack(dots[which].mean(axis=1, dtype=np.float32))
