"""Painting walls, and which parts of a map hang together, beside a plain search."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from logical_robots_tui.editing.strokes import Regions, fill, paint, paint_rectangle
from logical_robots_tui.world import LevelError
from logical_robots_tui.world.levels.native import expresses
from tests.editing.making import drawn, room, sketch

INSIDE = st.floats(0, 79.9)
MAPS = st.tuples(st.integers(1, 12), st.integers(1, 12)).flatmap(lambda s: arrays(np.bool_, s))


def test_a_dab_of_the_brush_is_as_wide_as_the_brush_and_round_and_a_line_is_straight() -> None:
    level = paint(drawn("." * 7, *["." * 7] * 6), [(3.5, 3.5)], width=5)
    assert sketch(level)[1:6] == ["..###..", ".#####.", ".#####.", ".#####.", "..###.."]
    line = paint(room(), [(10, 40.9), (90, 40.1)]).walls
    assert line.sum() == 81
    assert line[40, 10:91].all()
    for width in range(1, 9):
        walls = paint(room(), [(40.2, 30.7)], width=width).walls
        assert walls.any(axis=0).sum() == walls.any(axis=1).sum() == width


@settings(deadline=None)
@given(st.tuples(INSIDE, INSIDE), st.tuples(INSIDE, INSIDE), st.integers(1, 9))
def test_a_line_covers_what_is_near_it_and_nothing_else_and_lets_no_robot_slip_through(
    one: tuple[float, float], other: tuple[float, float], width: int
) -> None:
    walls = paint(room(80, 80), [one, other], width=width).walls
    painted = Regions(walls, corners=False)
    ends = [painted.region_at(math.floor(y), math.floor(x)) for x, y in (one, other)]
    assert ends[0] == ends[1]
    assert ends[0] >= 0 or width % 2 == 0
    assert len({painted.region_at(*unit) for unit in np.argwhere(walls).tolist()}) == 1
    y, x = np.mgrid[:80, :80] + 0.5
    dx, dy = other[0] - one[0], other[1] - one[1]
    share = ((x - one[0]) * dx + (y - one[1]) * dy) / max(dx * dx + dy * dy, 1e-9)
    share = share.clip(0, 1)
    away = np.hypot(x - one[0] - share * dx, y - one[1] - share * dy)
    snapping = 0.75
    assert not walls[away > max(width / 2, 0.71) + snapping].any()
    assert walls[away < width / 2 - snapping].all()


def test_a_coarse_grid_has_whole_squares_and_a_rectangle_both_corners_and_a_border() -> None:
    assert expresses(paint(room(), [(14, 14), (97, 55)], width=2, grid=10).walls, 10)
    level = paint(room(125, 80), [(1, 75), (124, 79)], grid=10)
    assert level.walls[70:, :].all()
    assert level.walls.sum() == 1250
    ring = paint_rectangle(room(), (59.5, 30.2), (20.0, 10.9), border=3).walls
    assert ring.sum() == 40 * 21 - 34 * 15
    assert ring[10:31, 20:60].any(axis=1).all()
    assert not ring[13:28, 23:57].any()
    assert paint_rectangle(room(), (59, 30), (20, 10)).walls.sum() == 40 * 21
    walls = paint_rectangle(room(), (-50, 20), (500, 40), border=2).walls
    assert walls[20:22].all()  # there is no border at the rim of the map
    assert walls[39:41].all()
    assert not walls[22:39].any()


def test_filling_stops_at_walls_also_where_they_only_touch_at_corners() -> None:
    level = drawn("..#..", ".#...", "#....")
    assert sketch(fill(level, 0.5, 0.5)) == ["###..", "##...", "#...."]
    assert sketch(fill(level, 4.5, 0.5)) == ["..###", ".####", "#####"]
    assert sketch(fill(level, 2.5, 0.5, wall=False)) == [".....", ".#...", "#...."]


def test_the_eraser_takes_walls_away_and_what_changes_nothing_is_the_level_itself() -> None:
    full = paint_rectangle(room(), (0, 0), (119, 79))
    assert full.walls.all()
    assert (~paint(full, [(40, 40)], width=3, wall=False).walls).sum() == 9
    assert not paint_rectangle(full, (0, 0), (119, 79), wall=False).walls.any()
    level = paint(room(), [(5, 5)])
    assert paint(level, [(5, 5)]) is level
    assert paint(level, [(-50, 5)]) is level
    assert paint_rectangle(level, (-9, -9), (-2, -2)) is level
    assert not paint(level, [(9, 9)]).walls.flags.writeable
    assert level.walls.sum() == 1  # the level before stays as it was
    assert fill(level, -1, 5) is level
    assert fill(level, 5, 5) is level
    assert fill(level, 50, 5, wall=False) is level


def test_what_makes_no_sense_is_refused() -> None:
    arguments: Any
    for arguments, message in (
        ({"width": 0}, "The brush must be from 1 to 4000 wide, not 0."),
        ({"width": 5000}, "The brush must be from 1 to 4000 wide, not 5000."),
        ({"grid": 0}, "The grid must be from 1 to 4000 wide, not 0."),
        ({"points": [(math.nan, 3)]}, "This point is too far outside the labyrinth."),
        ({"points": [(3, 1e9)]}, "This point is too far outside the labyrinth."),
    ):
        with pytest.raises(LevelError, match=message):
            paint(room(), **({"points": [(1, 1)]} | arguments))


def reached(
    units: NDArray[np.bool_], start: tuple[int, int], corners: bool
) -> set[tuple[int, int]]:
    """Units that hang together with one, found step by step."""
    found, border = set(), [start]
    while border:
        row, column = border.pop()
        inside = 0 <= row < units.shape[0] and 0 <= column < units.shape[1]
        if not inside or not units[row, column] or (row, column) in found:
            continue
        found.add((row, column))
        border += [
            (row + down, column + across)
            for down in (-1, 0, 1)
            for across in (-1, 0, 1)
            if corners or not (down and across)
        ]
    return found


@settings(deadline=None)
@given(MAPS, st.booleans())
def test_regions_are_what_a_search_finds(units: NDArray[np.bool_], corners: bool) -> None:
    regions = Regions(units, corners=corners)
    for (row, column), is_free in np.ndenumerate(units):
        region = regions.region_at(row, column)
        assert (region >= 0) == is_free
        if region >= 0:
            found = set(map(tuple, np.argwhere(regions.mask(region)).tolist()))
            assert found == reached(units, (row, column), corners)
    height, width = units.shape
    outside = [(-1, 0), (height, 0), (0, -1), (0, width)]
    assert [regions.region_at(*unit) for unit in outside] == [-1] * 4


@settings(deadline=None)
@given(MAPS, st.floats(-3, 15), st.floats(-3, 15), st.floats(0, 9))
def test_regions_within_a_circle_are_those_of_the_units_that_it_touches(
    units: NDArray[np.bool_], x: float, y: float, radius: float
) -> None:
    regions = Regions(units, corners=False)
    touched = {
        regions.region_at(row, column)
        for row, column in np.argwhere(units).tolist()
        if math.hypot(x - min(max(x, column), column + 1), y - min(max(y, row), row + 1)) < radius
    }
    assert regions.within(x, y, radius) == touched
