"""The widget, in an app."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from textual.app import App, ComposeResult

from logical_robots_tui.tui.labyrinth.drawing import LIGHT, Drawing
from logical_robots_tui.tui.labyrinth.drawing.viewport import Camera, Sight
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.world import Beacon, Level, Robot
from tests.tui.labyrinth.drawing.scenes import room, run, start, with_robot
from tests.virtual_time import virtual_loop

if TYPE_CHECKING:
    from textual.geometry import Region


class Recorder(LabyrinthView):
    """Remembers which regions were refreshed."""

    def __init__(self) -> None:
        super().__init__()
        self.regions: list[Region] = []

    def refresh(self, *regions: Region, **how: bool) -> Recorder:
        self.regions += regions
        return super().refresh(*regions, **how)


class Bench(App[None]):
    """An app with nothing but a labyrinth."""

    CSS = "LabyrinthView { border: round white; }"

    def __init__(self) -> None:
        super().__init__()
        self.view = Recorder()
        self.picked: list[str] = []

    def compose(self) -> ComposeResult:
        yield self.view

    def on_labyrinth_view_robot_picked(self, message: LabyrinthView.RobotPicked) -> None:
        self.picked.append(message.name)


def level() -> Level:
    return room(
        1000,
        500,
        20,
        robots=(Robot("Ann", 300, 200, 0.3, "red"), Robot("Bob", 700, 300, 2.0)),
        beacons=(Beacon("lamp", 500, 100),),
    )


def text(view: LabyrinthView) -> str:
    return "\n".join(view.render_line(row).text for row in range(view.size.height))


async def test_a_frame_is_shown() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        assert app.view.render_line(0).cell_length == 78
        app.view.show(level(), start(level()))
        await pilot.pause()
        shown = text(app.view)
        for sign in ("Ann", "Bob", "lamp", "◆"):
            assert sign in shown


async def test_a_frame_given_before_mounting_is_shown() -> None:
    app = Bench()
    app.view.show(level(), start(level()))
    async with app.run_test(size=(80, 24)):
        assert "Ann" in text(app.view)


async def test_only_changed_rows_are_refreshed() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.rays = app.view.marks = False
        one = level()
        frames = run(one, 30)
        app.view.show(one, frames[0])
        await pilot.pause()
        app.view.regions.clear()
        app.view.show(one, frames[0])
        assert app.view.regions == []
        app.view.show(one, frames[30])
        rows = {region.y for region in app.view.regions}
        assert 0 < len(rows) < 12
        assert all(region.height == 1 for region in app.view.regions)


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (4, 3), (5, 4), (24, 8), (200, 60)])
async def test_any_size_is_drawn(size: tuple[int, int]) -> None:
    app = Bench()
    async with app.run_test(size=size) as pilot:
        app.view.show(level(), start(level()))
        await pilot.pause()
        width, height = app.view.size
        for row in range(height):
            assert app.view.render_line(row).cell_length == width


async def test_a_resize_fits_the_picture_anew() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.show(level(), start(level()))
        for size in ((120, 40), (3, 2), (1, 1), (60, 20)):
            await pilot.resize_terminal(*size)
            await pilot.pause()
            width, height = app.view.size
            assert [app.view.render_line(row).cell_length for row in range(height)] == (
                [width] * height
            )
        assert "Ann" in text(app.view)


async def test_a_click_picks_the_nearest_robot() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.show(level(), start(level()))
        await pilot.pause()
        view = app.view.view
        assert view is not None
        for name, x, y, off in (("Ann", 300, 200, 2), ("Bob", 700, 300, -1)):
            cell = view.cell(x, y)
            assert cell is not None
            # The border is one cell.
            await pilot.click(app.view, offset=(cell[1] + 1 + off, cell[0] + 1))
            await virtual_loop().settled()
            assert app.picked.pop() == name
        await pilot.click(app.view, offset=(20, 20))
        await pilot.click(app.view, offset=(0, 0))
        await virtual_loop().settled()
        assert app.picked == []


async def test_switches_change_the_picture() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.show(level(), start(level()))
        await pilot.pause()

        def picture() -> str:
            return str([list(app.view.render_line(row)) for row in range(app.view.size.height)])

        seen = {picture()}
        app.view.rays = False
        seen.add(picture())
        app.view.marks = False
        seen.add(picture())
        app.view.selected = "Bob"
        seen.add(picture())
        app.view.palette = LIGHT
        seen.add(picture())
        app.view.drawing = Drawing.HALVES
        seen.add(picture())
        app.view.drawing = Drawing.ASCII
        seen.add(picture())
        assert len(seen) == 7
        assert text(app.view).isascii()


async def test_the_colours_follow_the_theme() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.show(level(), start(level()))
        app.theme = "textual-dark"
        await pilot.pause()
        dark = str(list(app.view.render_line(10)))
        app.theme = "textual-light"
        await pilot.pause()
        assert str(list(app.view.render_line(10))) != dark


async def test_a_camera_shows_part_of_the_map() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        one = level()
        app.view.show(one, start(one))
        app.view.camera = Camera(Sight.FREE, 5, 300, 200)
        await pilot.pause()
        shown = text(app.view)
        assert "Ann" in shown
        assert "Bob" not in shown
        assert app.view.robot_at(39, 11) == "Ann"


async def test_names_are_not_markup() -> None:
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        one = level()
        name = "[b]x[/b]"
        one = replace(one, robots=(replace(one.robots[0], name=name),))
        app.view.show(one, with_robot(start(one), x=500.0))
        await pilot.pause()
        assert name in text(app.view)


async def test_without_colour_nothing_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = Bench()
    async with app.run_test(size=(80, 24)) as pilot:
        app.view.drawing = Drawing.ASCII
        app.view.show(level(), start(level()))
        await pilot.pause()
        assert "Ann" in text(app.view)
