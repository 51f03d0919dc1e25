"""The widget, in an app, and pictures of the screen."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from textual.app import App, ComposeResult
from textual.geometry import Region
from textual.pilot import Pilot

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing
from logical_robots_tui.tui.labyrinth.drawing.viewport import Camera, Sight
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.world import Beacon, Robot
from tests.tui.conftest import STILL, Size, opened
from tests.tui.labyrinth.drawing.scenes import room, run, start, with_robot
from tests.virtual_time import later, virtual_loop


class Recorder(LabyrinthView):
    def __init__(self) -> None:
        super().__init__()
        self.regions: list[Region] = []

    def refresh(self, *regions: Region, **how: bool) -> Recorder:
        self.regions += regions
        return super().refresh(*regions, **how)


class Bench(App[None]):
    CSS = "LabyrinthView { border: round white; }"

    def __init__(self) -> None:
        super().__init__()
        self.view = Recorder()
        self.picked: list[str] = []

    def compose(self) -> ComposeResult:
        yield self.view

    def on_labyrinth_view_robot_picked(self, message: LabyrinthView.RobotPicked) -> None:
        self.picked.append(message.name)


ROBOTS = (Robot("Ann", 300, 200, 0.3, "red"), Robot("Bob", 700, 300, 2.0))
LEVEL = room(1000, 500, 20, robots=ROBOTS, beacons=(Beacon("lamp", 500, 100),))


def text(view: LabyrinthView) -> str:
    return "\n".join(view.render_line(row).text for row in range(view.size.height))


def widths(view: LabyrinthView) -> list[int]:
    return [view.render_line(row).cell_length for row in range(view.size.height)]


@asynccontextmanager
async def bench(size: Size = (80, 24)) -> AsyncIterator[tuple[Bench, Recorder, Pilot[None]]]:
    app = Bench()
    async with app.run_test(size=size) as pilot:
        assert widths(app.view) == [app.view.size.width] * app.view.size.height
        app.view.show(LEVEL, start(LEVEL))
        await pilot.pause()
        yield app, app.view, pilot


async def test_a_frame_is_shown_whole_or_in_part_also_if_it_came_before_mounting() -> None:
    async with bench() as (_, view, pilot):
        assert all(sign in text(view) for sign in ("Ann", "Bob", "lamp", "◆"))
        view.camera = Camera(Sight.FREE, 5, 300, 200)
        await pilot.pause()
        assert "Ann" in text(view)
        assert "Bob" not in text(view)
        assert view.robot_at(39, 11) == "Ann"
        name = "[b]x[/b]"  # which is no markup
        renamed = replace(LEVEL, robots=(replace(ROBOTS[0], name=name),))
        view.show(renamed, with_robot(start(renamed), x=500.0))
        view.camera = Camera()
        await pilot.pause()
        assert name in text(view)
    app = Bench()
    app.view.show(LEVEL, start(LEVEL))
    async with app.run_test(size=(80, 24)):
        assert "Ann" in text(app.view)


async def test_only_changed_rows_are_refreshed() -> None:
    async with bench() as (_, view, pilot):
        view.rays = view.marks = False
        frames = run(LEVEL, 30)
        view.show(LEVEL, frames[0])
        await pilot.pause()
        view.regions.clear()
        view.show(LEVEL, frames[0])
        assert view.regions == []
        view.show(LEVEL, frames[30])
        assert 0 < len({region.y for region in view.regions}) < 12
        assert all(region.height == 1 for region in view.regions)


@pytest.mark.parametrize("first", [(1, 1), pytest.param((200, 60), marks=pytest.mark.slow)])
async def test_any_size_is_drawn_at_first_and_after_another(first: Size) -> None:
    async with bench(first) as (app, view, pilot):
        sizes = ((3, 2), (4, 3), (120, 40), (5, 4), (1, 1), (24, 8), (200, 60), (60, 20))
        for size in (first, *sizes):
            await pilot.resize_terminal(*size)
            await later(0.1)
            assert app.size == size
            assert view.outer_size.height == max(size[1], 2), "the border"
            assert widths(view) == [view.size.width] * view.size.height
        assert "Ann" in text(view)


async def test_a_click_picks_the_nearest_robot() -> None:
    async with bench() as (app, view, pilot):
        assert view.view is not None
        for name, x, y, off in (("Ann", 300, 200, 2), ("Bob", 700, 300, -1)):
            cell = view.view.cell(x, y)
            assert cell is not None
            # The border is one cell.
            await pilot.click(view, offset=(cell[1] + 1 + off, cell[0] + 1))
            await virtual_loop().settled()
            assert app.picked.pop() == name
        await pilot.click(view, offset=(20, 20))
        await pilot.click(view, offset=(0, 0))
        await virtual_loop().settled()
        assert app.picked == []


async def test_switches_and_the_theme_change_the_picture() -> None:
    async with bench() as (app, view, pilot):

        def picture() -> str:
            return str([list(view.render_line(row)) for row in range(view.size.height)])

        pictures = [picture()]
        for theme in ("textual-dark", "textual-light"):
            app.theme = theme
            await pilot.pause()
            pictures.append(str(list(view.render_line(10))))
        for name, value in (
            *(("palette", DARK), ("rays", False), ("marks", False), ("selected", "Bob")),
            *(("drawing", Drawing.HALVES), ("palette", LIGHT), ("drawing", Drawing.ASCII)),
        ):
            setattr(view, name, value)
            pictures.append(picture())
        assert len(set(pictures)) == len(pictures)
        assert text(view).isascii()


async def test_without_colour_nothing_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with bench() as (_, view, pilot):
        view.drawing = Drawing.ASCII
        await pilot.pause()
        assert "Ann" in text(view)


async def test_a_screenshot_is_a_picture_and_a_text_or_says_why_not(data_dir: Path) -> None:
    folder = data_dir / "screens"
    async with opened(data_dir, text=STILL, size=(100, 30), ready=True) as game:
        folder.write_text("in the way")
        await game.app.run_action("screen.command('screenshot')")
        await game.sees("The picture could not be saved: File exists.")
        folder.unlink()
        await game.press("ctrl+p", sees="Find a command")
        await game.press(*"screens", "enter", until=lambda: len(list(folder.glob("*"))) == 2)
        (text,) = folder.glob("*.txt")
        assert "LOGICAL ROBOTS" in text.read_text("utf-8")
        assert "Find a command" not in text.read_text("utf-8")
        (picture,) = folder.glob("*.svg")
        svg = ElementTree.fromstring(picture.read_text("utf-8"))
        assert svg.tag.endswith("}svg")
        assert svg.attrib["{http://www.w3.org/XML/1998/namespace}space"] == "preserve"
