"""Walls as lines of text: exact, as coarse as can be, and close to what was there before."""

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from logical_robots_tui.world.levels.fields import Fields
from logical_robots_tui.world.levels.native import coarsest_cell, draw_rows, expresses, read_drawing

SMALL = st.tuples(st.integers(1, 8), st.integers(1, 12))
WALLS = SMALL.flatmap(lambda shape: arrays(np.bool_, shape))
CELLS = st.integers(1, 25)


def scaled(cells: NDArray[np.bool_], cell: int) -> NDArray[np.bool_]:
    return cells.repeat(cell, axis=0).repeat(cell, axis=1)


def read(lines: list[str], cell: int) -> NDArray[np.bool_]:
    record: dict[str, Any] = {"cell": cell, "walls": "\n".join(lines) + "\n"}
    return read_drawing(Fields(record, "level.toml"), "")


def written_short(walls: NDArray[np.bool_]) -> list[str]:
    wide = np.zeros((walls.shape[0], walls.shape[1] + 300), np.bool_)
    wide[:, : walls.shape[1]] = walls
    return draw_rows(wide, 1)


@settings(deadline=None)
@given(WALLS, CELLS)
def test_walls_are_read_as_they_were_drawn(cells: NDArray[np.bool_], cell: int) -> None:
    walls = scaled(cells, cell)
    assert expresses(walls, cell)
    assert (read(draw_rows(walls, cell), cell) == walls).all()


@settings(deadline=None)
@given(WALLS)
def test_walls_are_read_as_they_were_shortened(walls: NDArray[np.bool_]) -> None:
    found = read(written_short(walls), 1)
    assert (found[:, : walls.shape[1]] == walls).all()
    assert not found[:, walls.shape[1] :].any()


@settings(deadline=None)
@given(WALLS, CELLS)
def test_the_coarsest_cell_expresses_and_no_larger_one(cells: NDArray[np.bool_], cell: int) -> None:
    walls = scaled(cells, cell)
    assert [size for size in range(1, 21) if expresses(walls, size)][-1] == coarsest_cell(walls)


@settings(deadline=None)
@given(SMALL.flatmap(lambda shape: st.tuples(*[arrays(np.bool_, shape)] * 2)), st.booleans())
def test_only_rows_that_changed_are_drawn_anew(
    both: tuple[NDArray[np.bool_], NDArray[np.bool_]], short: bool
) -> None:
    before, after = both
    if short:
        before, after = (np.pad(walls, ((0, 0), (0, 300))) for walls in both)
    earlier = draw_rows(before, 1)
    lines = draw_rows(after, 1, earlier)
    assert (read(lines, 1) == after).all()
    changed = np.count_nonzero((before != after).any(axis=1))
    if short:
        assert len(set(lines) - set(earlier)) <= 3 * changed
    else:
        assert sum(one != other for one, other in zip(earlier, lines, strict=True)) == changed


def test_free_cells_stay_the_characters_they_were_unless_the_size_is_another() -> None:
    drawing = ["#. #", "#   ", "2#2."]
    walls = read(drawing, 1)
    assert draw_rows(walls, 1, drawing) == drawing
    walls = walls.copy()
    walls[:, 0] = False
    walls[:, 3] = True
    assert draw_rows(walls, 1, drawing) == [".. #", "   #", "1. 1# 1. 1#"]
    for earlier in (["###"], ["####", "#"], ["9*"], ["####", "####", "####"]):
        assert draw_rows(np.ones((2, 4), np.bool_), 1, earlier) == ["####", "####"]


def test_a_large_level_with_fine_walls_is_written_compactly() -> None:
    walls = np.zeros((4000, 4000), np.bool_)
    walls[::97] = walls[:, ::89] = True
    lines = draw_rows(walls, coarsest_cell(walls))
    assert len(lines) < 90
    assert (read(lines, 1) == walls).all()
