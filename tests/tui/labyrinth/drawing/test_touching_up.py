"""A picture whose walls are painted in pieces is the one that is painted at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.strokes import paint
from logical_robots_tui.tui.labyrinth.drawing import Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.ground import WallTable
from logical_robots_tui.tui.labyrinth.drawing.viewport import Raster
from logical_robots_tui.world import Area, Beacon, Level, Robot
from tests.tui.labyrinth.drawing.scenes import room, start

HALL = room(
    robots=(Robot("Ada", 60, 60), Robot("Bo", 210, 120)),
    beacons=(Beacon("lamp", 100, 40), Beacon("station", 300, 150, True)),
    areas=(
        Area("home", 330, 60, 30, "green", ("Ada",)),
        Area("gate", 200, 100, 40, "red", impenetrable=True),
        Area("door", 120, 140, 30, on_beacon="lamp"),
    ),
)
POINTS = st.tuples(st.integers(-20, 420), st.integers(-20, 220))
STROKES = st.lists(st.tuples(POINTS, POINTS, st.integers(1, 40), st.booleans()), max_size=4)
VIEWS = st.one_of(
    st.just(Viewport.fit(400, 200, 60, 20)),
    st.builds(
        Viewport,
        *(st.integers(1, 80), st.integers(1, 30)),
        *(st.floats(-50, 300), st.floats(-50, 200), st.floats(0.3, 9)),
    ),
)


def painted(level: Level, stroke: tuple[tuple[int, int], tuple[int, int], int, bool]) -> Level:
    one, other, width, wall = stroke
    return paint(level, [one, other], width=width, wall=wall)


@settings(deadline=None)
@given(STROKES, VIEWS, st.sampled_from(Drawing), st.lists(st.booleans(), min_size=5, max_size=5))
def test_strokes_show_as_if_they_had_been_there_from_the_start(
    strokes: list[tuple[tuple[int, int], tuple[int, int], int, bool]],
    view: Viewport,
    drawing: Drawing,
    rays: list[bool],
) -> None:
    frame, kept, level = start(HALL), Picture(), HALL
    looks = [Look(drawing=drawing, rays=lit, selected="Bo") for lit in rays]
    look = looks.pop()
    kept.draw(level, frame, view, look)
    for stroke in strokes:
        look = looks.pop()
        level = painted(level, stroke)
        kept.draw(level, frame, view, look)
    fresh = Picture()
    fresh.draw(level, frame, view, look)
    assert kept.cells.plain() == fresh.cells.plain()
    assert (kept.cells.style == fresh.cells.style).all()


def test_a_beacon_that_is_moved_is_shown_where_it_is() -> None:
    view, look, frame = Viewport.fit(400, 200, 60, 20), Look(), start(HALL)
    kept, fresh = Picture(), Picture()
    kept.draw(HALL, frame, view, look)
    moved = replace(HALL, beacons=(Beacon("lamp", 140, 60), HALL.beacons[1]))
    changes = kept.draw(moved, frame, view, look)
    fresh.draw(moved, frame, view, look)
    assert changes
    assert kept.cells.plain() == fresh.cells.plain()


def test_a_stroke_that_was_drawn_while_rays_were_shown_stays() -> None:
    view, frame, level = Viewport.fit(400, 200, 60, 20), start(HALL), HALL
    kept, fresh = Picture(), Picture()
    dark = Look(rays=False, marks=False)
    for step, look in enumerate((dark, Look(), dark)):
        level = paint(level, [(60 + 90 * step, 100), (80 + 90 * step, 150)], width=12)
        kept.draw(level, frame, view, look)
    fresh.draw(level, frame, view, dark)
    assert kept.cells.plain() == fresh.cells.plain()
    assert (kept.cells.style == fresh.cells.style).all()


def test_a_robot_that_moves_or_is_called_otherwise_is_shown_as_it_is() -> None:
    view, look, frame = Viewport.fit(400, 200, 60, 20), Look(rays=False, marks=False), start(HALL)
    kept = Picture()
    kept.draw(HALL, frame, view, look)
    renamed = replace(HALL, robots=(replace(HALL.robots[0], color="red"), HALL.robots[1]))
    moved = replace(HALL, robots=(replace(HALL.robots[0], x=100), HALL.robots[1]))
    for level, now in ((renamed, frame), (moved, start(moved)), (HALL, frame)):
        fresh = Picture()
        kept.draw(level, now, view, look)
        fresh.draw(level, now, view, look)
        assert kept.cells.plain() == fresh.cells.plain()
        assert (kept.cells.style == fresh.cells.style).all()


def test_a_level_of_another_size_is_drawn_whole() -> None:
    view, look = Viewport.fit(400, 200, 60, 20), Look()
    other = room(300, 150)
    kept, fresh = Picture(), Picture()
    kept.draw(HALL, start(HALL), view, look)
    kept.draw(other, start(other), view, look)
    fresh.draw(other, start(other), view, look)
    assert kept.cells.plain() == fresh.cells.plain()


@settings(deadline=None)
@given(STROKES)
def test_a_table_that_takes_other_walls_is_the_table_of_these(
    strokes: list[tuple[tuple[int, int], tuple[int, int], int, bool]],
) -> None:
    level = HALL
    for stroke in strokes:
        level = painted(level, stroke)
    table = WallTable(HALL.walls)
    changed = table.change(level.walls)
    differs = HALL.walls != level.walls
    assert (changed is None) == (not differs.any())
    if changed is not None:
        left, right, top, bottom = changed
        differs[top:bottom, left:right] = False
        assert not differs.any()
    raster = Raster(Viewport.fit(400, 200, 60, 20), 2, 2)
    fresh = WallTable(level.walls)
    assert (table.coverage(raster) == fresh.coverage(raster)).all()
    assert (table.openness(raster, 7.3) == fresh.openness(raster, 7.3)).all()


def test_sums_over_a_tall_map_are_those_of_its_walls() -> None:
    walls = np.random.default_rng(5).random((200, 30)) < 0.3
    raster = Raster(Viewport(5, 20, 1, 2, 5), 1, 2)
    expected = walls[2:202, 1:26].reshape(-1)[: 198 * 25].reshape(198, 25)
    shares = [
        [expected[y : y + 5, x : x + 5].mean() for x in range(0, 25, 5)] for y in range(0, 195, 5)
    ]
    assert np.allclose(WallTable(walls).coverage(raster)[:39], shares)
