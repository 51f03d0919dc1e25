"""Editing a level: each tool, by mouse and by keys, and what becomes of it."""

import math
from pathlib import Path

import numpy as np
import pytest

from logical_robots_tui.editing.editor import Tool
from logical_robots_tui.editing.entities import Ref
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.tui.labyrinth.results import ResultsDialog
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.level_editor.forms import FindingList
from logical_robots_tui.tui.level_editor.panel import ToolLine
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.world import load_level
from logical_robots_tui.world.dynamics import RobotState
from tests.tui.conftest import ROOM, cell_of, opened
from tests.tui.level_editor.conftest import bench, fill, replace_in, said, studio


async def test_walls_are_painted_with_each_tool(data_dir: Path, room_file: Path) -> None:
    along = [(x, 75) for x in range(65, 175)]
    async with bench(data_dir, room_file) as b:
        for commands, points, walls, floors in [
            ("brush", [(100, 30), (100, 70)], [(100, 50)], []),
            ("eraser", [(100, 48), (100, 52)], [(100, 35)], [(100, 50)]),
            ("undo undo", [], [], [(100, 35)]),
            ("line", [(60, 75), (180, 75)], along, [(100, 50)]),
            ("undo rectangle wider_brush", [(105, 25), (175, 65)], [(105, 45)], [(145, 45)]),
            ("fill", [(145, 45)], [(145, 45)], [(60, 60)]),
            ("ink", [(145, 45)], [(5, 5)], [(145, 45)]),  # the rim is another wall
            ("undo undo undo", [], [], [(105, 45)]),
        ]:
            b.command(*commands.split())
            if points:
                await b.stroke(*points)
            assert all(b.level.walls[y, x] for x, y in walls), commands
            assert not any(b.level.walls[y, x] for x, y in floors), commands
            await b.until(lambda: np.array_equal(b.session.level.walls, b.level.walls))
            assert bool(b.editor.edits.can_undo) != commands.startswith("undo undo")


async def test_things_are_placed_moved_deleted_and_undone(data_dir: Path, room_file: Path) -> None:
    async with bench(data_dir, room_file) as b:

        def bodies() -> tuple[RobotState, ...]:
            return b.session.frame.after.robots

        await b.stroke((40, 50), (100, 60))
        pip = b.level.robots[0]
        assert pip.x == pytest.approx(100, abs=1)
        assert (b.editor.selected, bodies()[0].x) == (Ref("robots", 0), pip.x)
        await b.stroke((pip.x + 18, pip.y), (pip.x, pip.y + 30))
        angle = b.level.robots[0].angle
        assert angle == pytest.approx(math.pi / 2, abs=0.4)
        b.command("turn_right", "turn_left", "turn_left")
        assert b.level.robots[0].angle < angle
        await b.stroke((200, 30), (180, 30))
        assert b.level.beacons[0].x == pytest.approx(180, abs=1)
        area = b.level.areas[0]
        await b.stroke((area.x, area.y + 5), (area.x - 30, area.y + 5))
        area = b.level.areas[0]
        assert area.x == pytest.approx(210, abs=1)
        await b.stroke((area.x + area.radius, area.y), (area.x + 30, area.y))
        assert b.level.areas[0].radius == pytest.approx(30, abs=1)
        b.command("robot")
        await b.stroke((60, 30))
        assert [robot.name for robot in b.level.robots] == ["Pip", "Robot 1"]
        assert [robot.name for robot in bodies()] == ["Pip", "Robot 1"]
        b.command("beacon")
        await b.stroke((60, 70))
        b.command("area")
        await b.stroke((140, 50), (160, 50))
        assert b.level.beacons[1].name == "Beacon 1"
        assert b.level.areas[1].radius == pytest.approx(20, abs=1)
        b.command("duplicate")
        assert len(b.level.areas) == 3
        b.command("delete", "next_object", "delete")
        assert (len(b.level.areas), len(b.level.robots)) == (2, 1)
        b.command("next_object", "delete")
        await b.says("A level needs at least one robot")
        while b.editor.edits.can_undo:
            b.command("undo")
        saved = b.controller.levels.saved
        assert (b.level.robots, b.level.beacons) == (saved.robots, saved.beacons)
        assert bodies()[0].x == 40
        await b.run_to(10)
        x = bodies()[0].x
        assert x > 44
        b.command("hand")
        await b.stroke((x, 50), (180, 60))
        assert bodies()[0].x > 170
        b.command("undo")  # it is back where it was taken
        assert (bodies()[0].x, b.level.robots[0].x) == (x, 40)
        b.command("redo")
        assert bodies()[0].x > 170


async def test_the_mouse_draws_and_keys_alone_do_as_well(data_dir: Path, room_file: Path) -> None:
    name = "Door to the other"  # there is no room for its place as well
    replace_in(room_file, "Door", name)
    async with studio(data_dir, room_file) as s:
        await s.game.drag((40, 50), (60, 50))
        await s.game.settled()
        view = s.game.main.labyrinth.view.view
        assert view
        assert s.level.robots[0].x == pytest.approx(60, abs=view.units * CELL_ASPECT)
        await s.press("u", "b")
        await s.game.drag((100, 30), (100, 70))
        await s.game.until(lambda: s.live.walls[50, 100])
        assert s.level.walls[50, 100]
        await s.press("u", until=lambda: s.controller.findings == [])
        await s.game.drag((200, 30), (205, 30), (200, 40))
        await s.game.until(lambda: s.controller.findings)
        await s.press("j", on=FindingList, sees="is inside a wall")
        s.editor.cursor = (0, 0)
        await s.press("enter", until=lambda: s.editor.cursor == (200, 30))
        await s.do("u")
        s.editor.cursor = (140, 50)
        await s.do("enter", "right", "right", "down", "enter", "right")
        walls = s.level.walls
        assert walls[50, 140]
        assert walls[50:60, 140:170].any()
        await s.do("r", "v", "enter", "shift+left", "down", "enter")
        assert s.level.walls.sum() > walls.sum()
        await s.do("u")
        assert np.array_equal(s.level.walls, walls)
        await s.do("l", "enter", "right", "escape")
        assert s.editor.stroke is None
        assert s.controller.is_on
        await s.do("U")
        assert s.level.walls.sum() > walls.sum()
        await s.do("shift+left", "shift+left")
        assert s.editor.cursor[0] == 0
        line = s.game.main.query_one(CommandBar).render().plain
        assert all(words in line for words in ("enter Use", "esc Leave", "space Run"))
        await s.press("u", "u", "h")
        s.editor.selected = None
        await s.do("tab")
        assert s.editor.cursor == (40, 50)
        await s.do("enter", "right", "right", "enter", "right")
        assert (s.level.robots[0].x, s.editor.edits.can_undo) == (60, "move")
        await s.do("c", "shift+right", "enter", "enter")
        assert len(s.level.beacons) == 2
        await s.press("tab", sees=f"Area {name}")
        await s.press("tab", "x", sees="A level needs at least one robot")
        lines = s.game.main.query_one(ToolLine).render().plain.splitlines()
        row = next(row for row, line in enumerate(lines) if "Fill" in line)
        await s.game.click(ToolLine, offset=(lines[row].index("Fill"), row))
        await s.game.until(lambda: s.editor.settings.tool is Tool.FILL)
        await s.do("g", "G")
        settings = s.editor.settings
        assert (settings.is_grid_shown, settings.grid) == (False, 20)
        await s.do("z", "z")
        assert s.game.main.labyrinth.view.camera.zoom > 1
        await s.do(*["shift+right"] * 4)
        assert cell_of(s.game.main.labyrinth.view, s.editor.cursor)
        await s.press("o", "enter", "M")  # the key that ends editing keeps what was just placed
        await s.game.sees("Leave editing")
        assert len(s.level.robots) == 2


async def test_what_marks_a_thing_covers_no_name(data_dir: Path) -> None:
    level = shipped_folder("levels") / "10-distributed-mapping.toml"
    async with opened(data_dir, level=level, size=(80, 24), ready=True) as game:
        await game.press("M", "tab", sees="Robot Atlas at 110, 150")
        assert all(game.shows(f"B{number:02}") for number in (5, 15, 21, 22))
        assert game.shows("┌")


async def test_play_while_editing_loses_and_wins_nothing(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        game, areas, beacons = s.game, len(s.level.areas), len(s.level.beacons)
        game.session.pace.speed = None
        await s.press("c", "enter", "a", "enter", "s", sees="Saved as room")
        assert s.controller.levels.is_saved
        await s.press("t", until=lambda: game.tick > 1)
        await s.press("t", until=lambda: game.main.editing.is_on and game.tick == 0)
        assert (len(s.level.areas), len(s.level.beacons)) == (areas + 1, beacons + 1)
        assert s.controller.levels.is_saved
        await s.do("a", "enter", "escape", "h")
        assert len(s.level.areas) == areas + 1
        await s.game.drag((240, 50), (80, 50))
        await s.press("t", sees="Again")
        assert not game.main.editing.is_on
        assert game.main.recorder.record.state != "won"
        await s.press("t", until=lambda: game.main.editing.is_on and game.tick == 0)
        assert (s.editor.edits.can_undo, game.session.frame.after.robots[0].x) == ("move", 40)


async def test_a_victory_while_editing_is_told_afterwards(data_dir: Path, room_file: Path) -> None:
    replace_in(room_file, "x = 40", "x = 215")
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.press("space", until=lambda: game.main.recorder.record.state == "won")
        assert game.main.editing.is_on
        assert not isinstance(game.app.screen, ResultsDialog)
        await s.press("escape", on=ResultsDialog)
        assert not game.main.editing.is_on


async def test_changes_are_kept_as_a_level_in_the_chooser(data_dir: Path, web_file: Path) -> None:
    before = said(web_file)
    async with studio(data_dir, web_file, size=(80, 24)) as s:
        game = s.game
        await s.game.drag((200, 30), (180, 30))
        for answer in ("escape", "s"):  # not to replace it, or to save it under another name
            await s.press("s", sees="was not made by this game")
            await s.press(answer, sees_no="was not made by this game")
        await game.sees("Save the level as")
        await s.press("enter", sees="Saved as garden-2.json")
        await s.press("b")
        await s.game.drag((100, 20), (100, 60))
        await s.press("M", sees="What should happen to your changes")
        await s.press("k", sees="Save the level as", until=lambda: game.app.screen.query("#name"))
        fill(game.app.screen, name="mine", title="Mine")
        await s.press("enter", until=lambda: not game.main.editing.is_on)
        kept = load_level(data_dir / "levels" / "mine.toml")
        assert kept.title == "Mine"
        assert kept.walls[40, 90:110].any()
        assert (said(web_file), game.session.opened.source) == (before, kept.source)
        await s.press("l", on=LevelScreen)
        await s.press(*"mine", sees="▸ Mine")
        await s.press("ctrl+n", until=lambda: game.app.screen.query("#kind"))
        fill(game.app.screen, kind="copy", original="mine")
        await s.press("f2", until=lambda: game.main.editing.is_on)
        assert game.session.level.title == "Mine (copy)"
        assert np.array_equal(game.session.level.walls, kept.walls)


@pytest.mark.slow
async def test_what_was_edited_is_offered_after_a_hangup(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("b")
        await s.game.drag((100, 20), (100, 60))
        await s.game.settled()
    assert said(room_file) == ROOM
    async with opened(data_dir) as game:
        await game.sees("Continue editing the level “A room”", "Yes, continue")
        await game.press("y")
        await game.until(lambda: game.main.editing.is_on and game.session.level.width == 280)
        await game.until(lambda: game.session.level.walls[40, 100])
        await game.press("u", until=lambda: not game.session.level.walls[40, 100])
    async with opened(data_dir, ready=True) as game:
        await game.until(lambda: game.main.recorder.record)
        await game.sees_no("Continue editing")
