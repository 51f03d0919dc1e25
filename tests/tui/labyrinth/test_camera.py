"""Looking around in the labyrinth."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual import events

from logical_robots_tui.tui.labyrinth.drawing import Viewport
from logical_robots_tui.tui.labyrinth.drawing.viewport import ZOOMS, Camera, Sight
from logical_robots_tui.world import load_level
from tests.tui.conftest import Size, opened
from tests.tui.labyrinth.drawing.scenes import room

SIGHTS = (Sight.FOLLOW, Sight.SENSES, Sight.WHOLE)
LEVEL = room(800, 400)
_steps = st.integers(0, len(ZOOMS) - 1)
_cameras = st.builds(Camera, st.sampled_from(Sight), _steps, st.floats(0, 800), st.floats(0, 400))
_sizes = st.tuples(st.integers(1, 300), st.integers(1, 100))


@given(_cameras, _sizes, st.integers(0, 99), st.integers(0, 299))
def test_cells_show_places_undistorted(camera: Camera, size: Size, row: int, column: int) -> None:
    view = camera.viewport(LEVEL, *size)
    x, y = view.position(0, 0)
    assert view.position(0, 2)[0] - x == pytest.approx(view.position(1, 0)[1] - y)
    cell = view.cell(*view.position(row, column))
    inside = row < size[1] and column < size[0]
    assert cell == ((row, column) if inside else None)


@given(_sizes, st.integers(1, 3), st.floats(0, 1), st.floats(0, 1))
def test_zooming_keeps_the_pointed_spot(size: Size, steps: int, across: float, down: float) -> None:
    view = Camera().viewport(LEVEL, *size)
    x, y = view.left + across * view.width, view.top + down * view.height
    nearer = Camera().zoomed(steps, view, (x, y)).viewport(LEVEL, *size)
    assert nearer.units == pytest.approx(view.units / ZOOMS[steps])
    assert (x - nearer.left) / nearer.width == pytest.approx(across, abs=1e-6)
    assert (y - nearer.top) / nearer.height == pytest.approx(down, abs=1e-6)


@given(_cameras, _sizes, st.integers(-20, 20), st.floats(-1e4, 1e4), st.floats(-1e4, 1e4))
def test_zooming_has_ends_and_panning_never_loses_the_map(
    camera: Camera, size: Size, steps: int, columns: float, rows: float
) -> None:
    view = camera.viewport(LEVEL, *size)
    zoomed, panned = camera.zoomed(steps, view), camera.panned(columns, rows, view, LEVEL)
    assert 0 <= zoomed.step < len(ZOOMS)
    assert math.isfinite(zoomed.x + zoomed.y)
    if camera.sight is not Sight.SENSES:
        assert 0 <= panned.x <= 800
        assert 0 <= panned.y <= 400


def test_zooming_out_all_the_way_shows_the_whole_labyrinth_and_following_is_calm() -> None:
    view = Camera().viewport(LEVEL, 80, 20)
    near = Camera().zoomed(2, view, (700, 300))
    assert near.sight is Sight.FREE
    assert near.zoomed(-2, near.viewport(LEVEL, 80, 20)) == Camera()
    # A followed robot may move a little before the view does.
    camera = Camera(Sight.FOLLOW, 3, 400, 200)
    view = camera.viewport(LEVEL, 80, 20)
    assert camera.following(405, 200, view) is camera
    moved = camera.following(400 + 0.4 * view.width, 200, view)
    assert (moved.x, moved.y) == (400 + 0.4 * view.width, 200)


def test_the_fit_is_in_the_middle_and_as_large_as_it_goes_and_outside_of_it_is_no_cell() -> None:
    view = Viewport.fit(400, 100, 80, 30)
    assert (view.units, view.left, view.top) == (5, 0, -100)
    assert Viewport.fit(100, 400, 80, 30).height == 400
    view = Viewport.fit(100, 100, 40, 20)
    for x, y in ((-0.1, 50), (50, 100.1), (math.nan, 50), (math.inf, 50)):
        assert view.cell(x, y) is None
    assert Viewport(10, 10, 0, 0, 1).cell(math.nan, 1) is None
    # Zooming keeps the middle, and centring the length of a unit.
    view = Viewport.fit(300, 200, 90, 30)
    near = view.zoomed(3)
    assert near.units == pytest.approx(view.units / 3)
    assert near.position(14.5, 44.5) == pytest.approx(view.position(14.5, 44.5))
    moved = near.centred(10, 20)
    assert moved.position(14.5, 44.5) == pytest.approx((10, 20))
    assert moved.units == near.units


SLOWER = [pytest.param(size, marks=pytest.mark.slow) for size in ((80, 24), (300, 100))]


@pytest.mark.parametrize("size", [(120, 40), *SLOWER])
async def test_keys_and_mouse_look_around(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, size=size, ready=True) as game:
        view, pilot = game.main.labyrinth.view, game.pilot
        name = game.session.level.robots[0].name

        async def looks(sight: Sight) -> None:
            await game.until(lambda: view.camera.sight is sight)

        # The wheel zooms.
        region = view.content_region
        x, y = region.x + 20, region.y + 5
        up, down = events.MouseScrollUp, events.MouseScrollDown
        for kind, sight in ((up, Sight.FREE), (down, Sight.WHOLE)):
            game.app.post_message(kind(view, 20, 5, 0, 0, 0, False, False, False, x, y))
            await looks(sight)

        # One key goes through the views.
        for key, sight in zip("fff", SIGHTS, strict=True):
            await game.press(key)
            await looks(sight)
        assert view.selected == name

        # The keys zoom, and the view stays with a robot that drives away.
        await game.press("f", sees=f"{name} 3" if size == (80, 24) else f"Map · {name} 3")
        for keys, zoom in (("z", 4), ("ZZ", 2), ("zzzz", 8)):
            await game.press(*keys, sees=f"{name} {zoom}")
        whence = view.view
        assert whence is not None

        def cell_in(viewport: Viewport | None) -> tuple[int, int] | None:
            robot = game.session.frame.after.robots[0]
            assert viewport is not None
            return viewport.cell(robot.x, robot.y)

        game.session.run_until(60)
        await game.until(lambda: game.tick == 60 and view._frame is game.session.frame)
        assert cell_in(whence) is None
        assert cell_in(view.view) is not None

        # A click on a robot shows its card.
        await game.press("escape", "f", "f")
        await looks(Sight.WHOLE)
        view.selected = None
        await game.sees_no("battery")
        cell = cell_in(view.view)
        assert cell is not None
        inset = view.content_region.offset - view.region.offset
        await game.click(view, offset=(cell[1] + inset.x, cell[0] + inset.y))
        await game.sees("battery needs none", "I am a robot", "engines +")
        await game.press("escape", sees_no="battery")

        # Arrows and dragging move the view, and select nothing.
        await game.press("right", "down", sees=", moved · f shows all")
        await looks(Sight.FREE)
        before = view.camera
        await pilot.mouse_down(view, offset=(30, 10))
        await pilot.hover(view, offset=(20, 8))
        await pilot.mouse_up(view, offset=(20, 8))
        await game.until(lambda: view.camera.x > before.x and view.camera.y > before.y)
        assert view.selected is None

        # Another level is shown as a whole, and titled so.
        await game.main.player.library.open_level(load_level("09-doors"))
        await game.sees_no(", moved")
        assert view.camera == Camera()


async def test_a_robot_without_decision_says_so(data_dir: Path) -> None:
    text = 'Robot(robot_name: "nobody", desire: {left_engine: 1, right_engine: 1}, memory: 1);'
    async with opened(data_dir, text=text, ready=True) as game:
        await game.press("n", "a", tick=1, sees="undecided")
