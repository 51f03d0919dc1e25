"""Each tool, by mouse and by keys."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from logical_robots_tui.editing.editor import Tool
from logical_robots_tui.editing.things import Ref
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.level_editor.panel import InfoLine, ToolLine
from tests.tui.conftest import opened
from tests.tui.level_editor.conftest import replace_in, studio

if TYPE_CHECKING:
    from pathlib import Path


async def test_walls_are_painted_with_the_mouse(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("b")
        await s.drag((100, 30), (100, 70))
        await s.settled()
        assert s.is_wall(100, 50)
        assert s.live.walls[50, 100]
        await s.press("e")
        await s.drag((100, 48), (100, 52))
        await s.settled()
        assert not s.is_wall(100, 50)
        assert s.is_wall(100, 35)
        await s.press("u", "u")
        await s.settled()
        assert not s.is_wall(100, 35)
        assert not s.editor.edits.can_undo
        await s.press("l")
        await s.drag((60, 75), (180, 75))
        await s.settled()
        assert s.level.walls[70:80, 65:175].any(axis=0).all()
        await s.press("u", "r", "right_square_bracket")
        await s.drag((105, 25), (175, 65))
        await s.settled()
        assert s.is_wall(105, 45)
        assert not s.is_wall(145, 45)
        await s.press("f")
        await s.drag((145, 45))
        await s.settled()
        assert s.is_wall(145, 45)
        assert not s.is_wall(60, 60)
        await s.press("k")
        await s.drag((145, 45))
        await s.settled()
        assert not s.is_wall(145, 45)
        assert s.is_wall(5, 5), "the rim is another wall"
        await s.press("u", "u", "u")
        await s.settled()
        assert not s.editor.edits.can_undo
        await s.game.sees("A room")


async def test_walls_are_painted_with_keys_alone(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("b", "enter", "right", "right", "down", "enter", "right")
        await s.settled()
        walls = s.level.walls
        before = walls.sum()
        assert s.is_wall(140, 50)
        assert walls[50:60, 140:170].any()
        await s.press("r", "v", "enter", "shift+left", "down", "enter")
        await s.settled()
        assert s.level.walls.sum() > before
        await s.press("u")
        await s.settled()
        assert np.array_equal(s.level.walls, walls)
        await s.press("l", "enter", "right", "escape")
        await s.settled()
        assert s.editor.stroke is None
        assert s.controller.is_on
        await s.press("U")
        await s.settled()
        assert s.level.walls.sum() > before
        await s.press("shift+left", "shift+left")
        await s.settled()
        assert s.editor.cursor[0] == 0
        await s.press("g", "G")
        await s.settled()
        assert not s.editor.settings.is_grid_shown
        assert s.editor.settings.grid == 20
        line = s.game.main.query_one(CommandBar).render().plain
        assert "enter Use" in line
        assert "esc Leave" in line
        assert "space Run" in line


async def test_things_are_placed_dragged_turned_and_deleted(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        await s.drag((40, 50), (100, 60))
        await s.settled()
        pip = s.level.robots[0]
        assert pip.x == pytest.approx(100, abs=s.units)
        assert s.editor.selected == Ref("robots", 0)
        assert s.game.session.frame.after.robots[0].x == pip.x
        await s.drag((pip.x + 18, pip.y), (pip.x, pip.y + 30))
        await s.settled()
        assert s.level.robots[0].angle == pytest.approx(math.pi / 2, abs=0.4)
        angle = s.level.robots[0].angle
        await s.press("full_stop", "comma", "comma")
        await s.settled()
        assert s.level.robots[0].angle < angle
        await s.drag((200, 30), (180, 30))
        await s.settled()
        assert s.level.beacons[0].x == pytest.approx(180, abs=s.units)
        area = s.level.areas[0]
        await s.drag((area.x, area.y + 5), (area.x - 30, area.y + 5))
        await s.settled()
        area = s.level.areas[0]
        assert area.x == pytest.approx(210, abs=s.units)
        await s.drag((area.x + area.radius, area.y), (area.x + 30, area.y))
        await s.settled()
        assert s.level.areas[0].radius == pytest.approx(30, abs=s.units)
        await s.press("o")
        await s.drag((60, 30))
        await s.settled()
        assert [robot.name for robot in s.level.robots] == ["Pip", "Robot 1"]
        assert [robot.name for robot in s.game.session.frame.after.robots] == ["Pip", "Robot 1"]
        await s.press("c")
        await s.drag((60, 70))
        await s.press("a")
        await s.drag((140, 50), (160, 50))
        await s.settled()
        assert s.level.beacons[1].name == "Beacon 1"
        assert s.level.areas[1].radius == pytest.approx(20, abs=s.units)
        await s.press("d")
        await s.settled()
        assert len(s.level.areas) == 3
        await s.press("x", "tab", "delete")
        await s.settled()
        assert len(s.level.areas) == 2
        assert len(s.level.robots) == 1
        await s.press("tab")
        await s.settled()
        info = s.game.main.query_one(InfoLine)
        assert "Robot 1" in info.render().plain
        await s.press("x")
        await s.game.sees("A level needs at least one robot")
        while s.editor.edits.can_undo:
            await s.press("u")
            await s.settled()
        assert (s.level.robots, s.level.beacons) == (
            s.controller.levels.saved.robots,
            s.controller.levels.saved.beacons,
        )
        assert s.game.session.frame.after.robots[0].x == 40


async def test_keys_take_a_thing_along_and_the_lines_tell_of_it(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("tab")
        await s.settled()
        assert s.editor.cursor == (40, 50)
        await s.press("enter", "right", "right", "enter", "right")
        await s.settled()
        assert s.level.robots[0].x == 60
        assert s.editor.edits.can_undo == "move"
        await s.press("c", "shift+right", "enter", "enter")
        await s.settled()
        assert len(s.level.beacons) == 2
        tools = s.game.main.query_one(ToolLine)
        await s.game.later(0.1)
        lines = tools.render().plain.splitlines()
        row = next(i for i, line in enumerate(lines) if "Fill" in line)
        await s.game.click(ToolLine, offset=(lines[row].index("Fill"), row))
        await s.game.until(lambda: s.editor.settings.tool is Tool.FILL)
        await s.press("z", "z")
        await s.settled()
        assert s.game.main.labyrinth.view.camera.zoom > 1
        for _ in range(4):
            await s.press("shift+right")
            await s.settled()
        view = s.game.main.labyrinth.view.view
        assert view is not None
        assert view.cell(*s.editor.cursor) is not None


async def test_the_key_that_ends_editing_keeps_what_was_just_placed(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        before = len(s.level.robots)
        await s.press("o", "enter", "M")
        await s.game.sees("Leave editing")
        assert len(s.level.robots) == before + 1


async def test_what_marks_a_thing_covers_no_name(data_dir: Path) -> None:
    level = shipped_folder("levels") / "10-distributed-mapping.toml"
    async with opened(data_dir, level=level, size=(80, 24)) as game:
        await game.ready()
        await game.press("M", "tab")
        await game.sees("Robot Atlas at 110, 150")
        assert all(game.shows(f"B{number:02}") for number in (5, 15, 21, 22))
        assert game.shows("┌")


async def test_a_long_name_is_told_in_full(data_dir: Path, room_file: Path) -> None:
    name = "Door to the other side"
    replace_in(room_file, "Door", name)
    async with studio(data_dir, room_file) as s:
        await s.press("c")
        await s.drag((60, 30))
        await s.press("tab")
        await s.game.sees(f"Area {name}")
