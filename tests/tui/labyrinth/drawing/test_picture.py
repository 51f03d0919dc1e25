"""Whatever there is to draw, the picture is whole."""

from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, Look, Picture, Viewport
from logical_robots_tui.world import Area, AreaState, Beacon, Level, Robot, RobotState, WorldState
from tests.tui.labyrinth.drawing.scenes import draws_as_anew, room, run, seeing, with_active

_numbers = st.one_of(st.floats(-300, 600), st.sampled_from((nan, inf, -inf, 1e300, 0.0)))
_names = st.one_of(
    st.text(max_size=12),
    st.sampled_from(("機械人形", "👩\u200d🚀", "a\x1b[2J", "\u202eabc", "é" * 30)),
)
_colours = st.sampled_from(("red", "#fff", "#12345678", "", "no colour", "auto", "hsl(10,50%,50%)"))
_truths = st.booleans()
_looks = st.builds(
    Look,
    drawing=st.sampled_from(Drawing),
    palette=st.sampled_from((DARK, LIGHT)),
    rays=st.booleans(),
    marks=st.booleans(),
    names=st.booleans(),
    selected=st.one_of(st.none(), _names),
)


@st.composite
def scenes(draw: st.DrawFn) -> tuple[Level, Frame]:
    width, height = draw(st.integers(1, 300)), draw(st.integers(1, 200))
    walls = np.random.default_rng(draw(st.integers(0, 99))).random((height, width))
    a_robot = st.builds(Robot, _names, *[_numbers] * 3, _colours)
    a_beacon = st.builds(Beacon, _names, *[_numbers] * 2, st.booleans())
    winners = st.sampled_from(((), ("a",)))
    an_area = st.builds(
        Area, *(_names, *[_numbers] * 3, _colours), victory_robots=winners, impenetrable=_truths
    )
    robots, areas = draw(st.lists(a_robot, max_size=4)), draw(st.lists(an_area, max_size=4))
    things = tuple(robots), tuple(draw(st.lists(a_beacon))), tuple(areas)
    level = Level("odd", "Odd", width, height, walls < draw(st.sampled_from((0, 0.3, 1))), *things)
    states = tuple(
        RobotState(robot.name, robot.x, robot.y, robot.angle, 1.0, blocked=blocked, dead=dead)
        for robot in robots
        for blocked, dead in (draw(st.tuples(_truths, _truths)),)
    )
    state = WorldState(1, states, tuple(AreaState(area.name, draw(_truths)) for area in areas))
    kinds = st.sampled_from(("wall", "robot", "beacon", "none", "news"))
    ray = st.tuples(st.floats(-4, 4), st.integers(0, 200), kinds)
    sensors = tuple(
        seeing(robot.name, draw(st.lists(ray, max_size=31))) for robot in robots if draw(_truths)
    )
    return level, Frame(1, state, state, sensors, {}, (), {}, 0.0)


@st.composite
def views(draw: st.DrawFn, level: Level) -> Viewport:
    columns, rows = draw(st.integers(0, 60)), draw(st.integers(0, 24))
    view = Viewport.fit(level.width, level.height, columns, rows)
    return view.zoomed(draw(st.floats(0.05, 50))).centred(
        draw(st.floats(-50, 350)), draw(st.floats(-50, 250))
    )


def changes_of(picture: Picture, *scene: Any, hurried: bool = False) -> list[tuple[int, int, int]]:
    before = picture.cells
    return picture.draw(*scene, hurried=hurried).changes(before)


def count(changes: list[tuple[int, int, int]]) -> int:
    return sum(stop - first for _, first, stop in changes)


@given(st.data(), st.lists(st.tuples(scenes(), _looks), min_size=1, max_size=3))
def test_any_scene_fills_every_line_exactly_and_drawing_on_is_as_drawing_anew(
    data: st.DataObject, scenes_and_looks: list[tuple[tuple[Level, Frame], Look]]
) -> None:
    picture = Picture()
    for (level, frame), look in scenes_and_looks:
        view = data.draw(views(level))
        assert draws_as_anew(picture, level, frame, view, look)
        assert picture.cells.text.shape == (view.rows, view.columns)
        for strip in map(picture.cells.strip, range(view.rows)):
            assert strip.cell_length == view.columns
            assert sum(cell_len(segment.text) for segment in strip) == view.columns
            assert all(segment.style is not None for segment in strip)
            assert strip.text.isprintable()


def rows_of(picture: Picture) -> list[str]:
    return [str(list(picture.cells.strip(row))) for row in range(20)]


@pytest.mark.sampled
@pytest.mark.parametrize("drawing", Drawing)
def test_a_run_drawn_frame_by_frame_equals_each_frame_drawn_alone(drawing: Drawing) -> None:
    level = room(
        robots=(Robot("Ann", 60, 60, 0.4, "red"), Robot("Bob", 200, 120, 2.0, "#00ff88")),
        beacons=(Beacon("lamp", 120, 80), Beacon("dock", 300, 90, charging_station=True)),
        areas=(Area("pool", 200, 60, 30, on_beacon="lamp"), Area("home", 330, 150, 30)),
    )
    view, look = Viewport.fit(level.width, level.height, 60, 20), Look(drawing=drawing)
    picture = Picture()
    shown: list[str] = []
    for frame in run(level, 14):
        changes = changes_of(picture, level, frame, view, look)
        drawn, anew = rows_of(picture), Picture()
        shown = shown or list(drawn)
        for row, _, _ in changes:
            shown[row] = drawn[row]
        anew.draw(level, frame, view, look)
        assert shown == rows_of(anew)


def test_only_what_changed_is_reported() -> None:
    level = room(800, 400, robots=(Robot("Ann", 400, 200),))
    view, look = Viewport.fit(800, 400, 100, 25), Look(rays=False, marks=False, names=False)
    frames, picture = run(level, 30), Picture()
    assert len(changes_of(picture, level, frames[0], view, look)) == 25
    assert changes_of(picture, level, frames[0], view, look) == []
    changes = changes_of(picture, level, frames[30], view, look)
    assert 1 <= len(changes) <= 6
    assert count(changes) < 60


def test_a_hurried_picture_is_nearly_right_and_the_next_calm_one_is_exact() -> None:
    level = room(800, 400, robots=(Robot("Ann", 400, 200, 0.3, "red"),))
    view, look = Viewport.fit(800, 400, 100, 25), Look(marks=False, names=False)
    frames = run(level, 30)
    picture, calm = Picture(), Picture()
    sent = needed = 0
    for frame in frames:
        sent += count(changes_of(picture, level, frame, view, look, hurried=True))
        needed += count(changes_of(calm, level, frame, view, look))
    assert sent < 0.7 * needed
    picture.draw(level, frames[-1], view, look)
    assert (picture.cells.style == calm.cells.style).all()
    assert (picture.cells.text == calm.cells.text).all()


def test_an_area_that_is_switched_is_drawn_anew() -> None:
    level = room(areas=(Area("pool", 200, 100, 40),))
    (frame,) = run(level, 0)
    view, picture = Viewport.fit(400, 200, 60, 15), Picture()
    picture.draw(level, frame, view, Look())
    for shown in (with_active(frame, active=False), frame):
        assert changes_of(picture, level, shown, view, Look())
