"""Which parts of a map hang together, beside a plain search."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from logical_robots_tui.editing.strokes import Regions

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAPS = st.tuples(st.integers(1, 12), st.integers(1, 12)).flatmap(lambda s: arrays(np.bool_, s))


def flooded(
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
    for row in range(units.shape[0]):
        for column in range(units.shape[1]):
            region = regions.at(row, column)
            assert (region >= 0) == units[row, column]
            if region >= 0:
                found = set(map(tuple, np.argwhere(regions.mask(region)).tolist()))
                assert found == flooded(units, (row, column), corners)


@settings(deadline=None)
@given(MAPS, st.floats(-3, 15), st.floats(-3, 15), st.floats(0, 9))
def test_regions_within_a_circle_are_those_of_the_units_that_it_touches(
    units: NDArray[np.bool_], x: float, y: float, radius: float
) -> None:
    regions = Regions(units, corners=False)
    touched = {
        regions.at(row, column)
        for row, column in np.argwhere(units).tolist()
        if math.hypot(x - min(max(x, column), column + 1), y - min(max(y, row), row + 1)) < radius
    }
    assert regions.within(x, y, radius) == touched


def test_outside_the_map_is_no_region() -> None:
    regions = Regions(np.ones((3, 4), np.bool_), corners=False)
    assert [regions.at(*unit) for unit in [(-1, 0), (3, 0), (0, -1), (0, 4)]] == [-1] * 4
