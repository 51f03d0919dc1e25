"""A picture whose walls are painted in pieces is the one that is painted at once."""

from dataclasses import replace
from typing import TypeAlias

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.strokes import paint
from logical_robots_tui.tui.labyrinth.drawing import Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.ground import WallTable
from logical_robots_tui.tui.labyrinth.drawing.viewport import Raster
from logical_robots_tui.world import Area, Beacon, Level, Robot
from tests.tui.labyrinth.drawing.scenes import draws_as_anew, room, start

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


Stroke: TypeAlias = tuple[tuple[int, int], tuple[int, int], int, bool]


def painted(level: Level, stroke: Stroke) -> Level:
    one, other, width, wall = stroke
    return paint(level, [one, other], width=width, wall=wall)


@settings(deadline=None)
@given(STROKES, VIEWS, st.sampled_from(Drawing), st.lists(st.booleans(), min_size=5, max_size=5))
def test_strokes_show_as_if_they_had_been_there_from_the_start(
    strokes: list[Stroke], view: Viewport, drawing: Drawing, rays: list[bool]
) -> None:
    kept, level = Picture(), HALL
    looks = [Look(drawing=drawing, rays=lit, selected="Bo") for lit in rays]
    kept.draw(level, start(HALL), view, looks.pop())
    for stroke in strokes:
        level = painted(level, stroke)
        assert draws_as_anew(kept, level, start(HALL), view, looks.pop())


def test_what_is_moved_renamed_or_gone_is_shown_as_it_is() -> None:
    kept, view, still = Picture(), Viewport.fit(400, 200, 60, 20), Look(rays=False, marks=False)
    (ada, bo), (lamp, station) = HALL.robots, HALL.beacons
    lit_elsewhere = replace(HALL, beacons=(replace(lamp, x=140, y=60), station))
    renamed = replace(HALL, robots=(replace(ada, color="red"), bo))
    moved = replace(HALL, robots=(replace(ada, x=100), bo))
    kept.draw(HALL, start(HALL), view, Look())
    before = kept.cells
    assert kept.draw(lit_elsewhere, start(HALL), view, Look()).changes(before)
    assert draws_as_anew(kept, lit_elsewhere, start(HALL), view, Look())
    for level, frame in ((renamed, start(HALL)), (moved, start(moved)), (HALL, start(HALL))):
        assert draws_as_anew(kept, level, frame, view, still)
    other = room(300, 150)
    assert draws_as_anew(kept, other, start(other), view, Look()), "another size"

    # A stroke that was drawn while rays were shown stays.
    level, kept = HALL, Picture()
    for step, look in enumerate((still, Look(), still)):
        level = paint(level, [(60 + 90 * step, 100), (80 + 90 * step, 150)], width=12)
        kept.draw(level, start(HALL), view, look)
    assert draws_as_anew(kept, level, start(HALL), view, still)


@settings(deadline=None)
@given(STROKES)
def test_a_table_that_takes_other_walls_is_the_table_of_these(strokes: list[Stroke]) -> None:
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
