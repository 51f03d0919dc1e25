"""Looking around in the labyrinth."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual import events

from logical_robots_tui.tui.labyrinth.drawing import Viewport
from logical_robots_tui.tui.labyrinth.drawing.viewport import ZOOMS, Camera, Sight
from tests.tui.conftest import opened
from tests.tui.labyrinth.drawing.scenes import room

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.tui.labyrinth.view import LabyrinthView

LEVEL = room(800, 400)
_cameras = st.builds(
    Camera,
    st.sampled_from(Sight),
    st.integers(0, len(ZOOMS) - 1),
    st.floats(0, 800),
    st.floats(0, 400),
)
_sizes = st.tuples(st.integers(1, 300), st.integers(1, 100))


@given(_cameras, _sizes)
def test_a_map_unit_is_as_long_down_as_across(camera: Camera, size: tuple[int, int]) -> None:
    view = camera.viewport(LEVEL, *size)
    x, y = view.position(0, 0)
    beside, below = view.position(0, 2)[0], view.position(1, 0)[1]
    assert beside - x == pytest.approx(below - y)


@given(_cameras, _sizes, st.integers(0, 99), st.integers(0, 299))
def test_a_cell_shows_the_place_that_is_its_position(
    camera: Camera, size: tuple[int, int], row: int, column: int
) -> None:
    view = camera.viewport(LEVEL, *size)
    cell = view.cell(*view.position(row, column))
    inside = row < size[1] and column < size[0]
    assert cell == ((row, column) if inside else None)


@given(_sizes, st.integers(1, 3), st.floats(0, 1), st.floats(0, 1))
def test_zooming_keeps_the_point_under_the_pointer(
    size: tuple[int, int], steps: int, across: float, down: float
) -> None:
    view = Camera().viewport(LEVEL, *size)
    x, y = view.left + across * view.width, view.top + down * view.height
    nearer = Camera().zoomed(steps, view, (x, y)).viewport(LEVEL, *size)
    assert nearer.units == pytest.approx(view.units / ZOOMS[steps])
    assert (x - nearer.left) / nearer.width == pytest.approx(across, abs=1e-6)
    assert (y - nearer.top) / nearer.height == pytest.approx(down, abs=1e-6)


@given(_cameras, _sizes, st.integers(-20, 20))
def test_zooming_has_ends(camera: Camera, size: tuple[int, int], steps: int) -> None:
    view = camera.viewport(LEVEL, *size)
    found = camera.zoomed(steps, view)
    assert 0 <= found.step < len(ZOOMS)
    assert math.isfinite(found.x + found.y)


def test_zooming_out_all_the_way_shows_the_whole_labyrinth_again() -> None:
    view = Camera().viewport(LEVEL, 80, 20)
    near = Camera().zoomed(2, view, (700, 300))
    assert near.sight is Sight.FREE
    assert near.zoomed(-2, near.viewport(LEVEL, 80, 20)) == Camera()


@given(_cameras, _sizes, st.floats(-1e4, 1e4), st.floats(-1e4, 1e4))
def test_panning_never_loses_the_map(
    camera: Camera, size: tuple[int, int], columns: float, rows: float
) -> None:
    view = camera.viewport(LEVEL, *size)
    found = camera.panned(columns, rows, view, LEVEL)
    if camera.sight is not Sight.SENSES:
        assert 0 <= found.x <= 800
        assert 0 <= found.y <= 400


def test_a_followed_robot_may_move_a_little_before_the_view_does() -> None:
    camera = Camera(Sight.FOLLOW, 3, 400, 200)
    view = camera.viewport(LEVEL, 80, 20)
    assert camera.following(405, 200, view) is camera
    moved = camera.following(400 + 0.4 * view.width, 200, view)
    assert (moved.x, moved.y) == (400 + 0.4 * view.width, 200)


def test_a_viewport_around_a_place_that_is_none_has_no_cell_for_it() -> None:
    assert Viewport(10, 10, 0, 0, 1).cell(math.nan, 1) is None


def looks_at(view: LabyrinthView, sight: Sight) -> bool:
    return view.camera.sight is sight


async def test_one_key_goes_through_the_views(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        view = game.main.labyrinth.view
        name = game.session.level.robots[0].name
        for sight in (Sight.FOLLOW, Sight.SENSES, Sight.WHOLE):
            await game.press("f")
            await game.until(partial(looks_at, view, sight))
        assert view.selected == name
        await game.press("f")
        await game.sees(f"Map · {name} 3")
        await game.press("z")
        await game.sees(f"{name} 4")
        await game.press("Z", "Z")
        await game.sees(f"{name} 2")


async def test_the_view_stays_with_a_robot_that_drives_away(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        view = game.main.labyrinth.view
        await game.press("f", "z", "z", "z")
        await game.press("space")
        await game.until(lambda: game.tick > 60)
        await game.press("space")
        await game.until(lambda: not game.session.busy)
        robot = game.session.frame.after.robots[0]
        assert view.view is not None
        assert view.view.cell(robot.x, robot.y) is not None


async def test_arrows_and_dragging_move_the_view(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        view = game.main.labyrinth.view
        await game.press("right", "down")
        await game.settled()
        assert view.camera.sight is Sight.FREE
        before = view.camera
        pilot = game.pilot
        await pilot.mouse_down(view, offset=(30, 10))
        await pilot.hover(view, offset=(20, 8))
        await pilot.mouse_up(view, offset=(20, 8))
        await game.until(lambda: view.camera != before)
        assert view.camera.x > before.x
        assert view.camera.y > before.y
        assert view.selected is None


async def test_the_wheel_zooms(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        view = game.main.labyrinth.view
        region = view.content_region

        def wheel(kind: type[events.MouseEvent]) -> None:
            x, y = region.x + 20, region.y + 5
            game.app.post_message(kind(view, 20, 5, 0, 0, 0, False, False, False, x, y))

        wheel(events.MouseScrollUp)
        await game.until(lambda: view.camera.sight is Sight.FREE)
        wheel(events.MouseScrollDown)
        await game.until(lambda: view.camera.sight is Sight.WHOLE)


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40), (300, 100)])
async def test_a_click_on_a_robot_shows_its_card(data_dir: Path, size: tuple[int, int]) -> None:
    async with opened(data_dir, size=size) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        view = game.main.labyrinth.view
        robot = game.session.frame.after.robots[0]
        assert view.view is not None
        cell = view.view.cell(robot.x, robot.y)
        assert cell is not None
        inset = view.content_region.offset - view.region.offset
        await game.click(view, offset=(cell[1] + inset.x, cell[0] + inset.y))
        await game.sees("battery needs none")
        await game.sees("I am a robot")
        await game.sees("engines +")
        await game.press("escape")
        await game.until(lambda: not game.shows("battery"))


async def test_a_robot_without_decision_says_so(data_dir: Path) -> None:
    text = 'Robot(robot_name: "nobody", desire: {left_engine: 1, right_engine: 1}, memory: 1);'
    async with opened(data_dir, text=text) as game:
        await game.ready()
        await game.press("n", "a")
        await game.until(lambda: game.tick == 1 and game.shows("undecided"))
