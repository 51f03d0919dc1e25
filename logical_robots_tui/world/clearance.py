"""The distance from every cell of a labyrinth to the nearest wall."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["clearances", "row_clearances"]

_ROWS_AT_ONCE = 64  # bounds the memory for distances along rows


def clearances(walls: NDArray[np.bool_], most: int) -> NDArray[np.uint8]:
    """Return the distance in cells from every cell to the nearest wall; diagonal steps count as 1.

    All closer cells, in a square around the cell, are free.

    Args:
        walls: Of shape (height, width); True is wall.
        most: Distances are capped here; 1 to 254.

    Returns:
        An array of the shape of ``walls``: 0 in a wall, 1 beside one, ``most`` far from all.
    """
    found = row_clearances(walls, most)
    # A shortest path to a wall goes to the wall's row first, diagonally as far as that helps,
    # and then along the row.
    _carry_over(found)
    _carry_over(found[::-1])
    return found


def row_clearances(walls: NDArray[np.bool_], most: int) -> NDArray[np.uint8]:
    """Return the distance in cells from every cell to the nearest wall in the same row.

    Args:
        walls: Of shape (height, width); True is wall.
        most: Distances are capped here; 1 to 254.

    Returns:
        An array of the shape of ``walls``: 0 in a wall, 1 beside one, ``most`` far from all.
    """
    found = np.empty(walls.shape, dtype=np.uint8)
    for start in range(0, len(walls), _ROWS_AT_ONCE):
        some = slice(start, start + _ROWS_AT_ONCE)
        found[some] = _along_rows(walls[some], most)
    return found


def _along_rows(walls: NDArray[np.bool_], most: int) -> NDArray[np.int32]:
    """Return the distance to the nearest wall in the same row."""
    column = np.arange(walls.shape[1], dtype=np.int32)
    left = np.maximum.accumulate(np.where(walls, column, -most), axis=1)
    beyond = np.int32(walls.shape[1] + most)
    right = np.minimum.accumulate(np.where(walls, column, beyond)[:, ::-1], axis=1)[:, ::-1]
    return np.minimum(np.minimum(column - left, right - column), most)


def _carry_over(found: NDArray[np.uint8]) -> None:
    """Limit every row, from the second on, to 1 more than its neighbours in the row before."""
    least = np.empty_like(found[0])
    for before, row in pairwise(found):
        np.minimum(before[1:], before[:-1], out=least[1:])
        least[0] = before[0]
        np.minimum(least[:-1], before[1:], out=least[:-1])
        least += 1
        np.minimum(row, least, out=row)
