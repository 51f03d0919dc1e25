"""Editing while the robots run, playing what is edited, and what becomes of it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from textual.widgets import Input, Select

from logical_robots_tui.editing.files import save_level
from logical_robots_tui.game.victory import is_by_the_book
from logical_robots_tui.tui.labyrinth.results import Results
from logical_robots_tui.tui.level_editor.forms import FindingList
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.world import load_level
from tests.tui.conftest import STILL, opened
from tests.tui.level_editor.conftest import ROOM, studio
from tests.virtual_time import Hold

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.world import Level


def said(file: Path) -> str:
    return file.read_text("utf-8")


def say(file: Path, text: str) -> None:
    file.write_text(text, "utf-8")


class SlowSaving:
    """Saves a level when it is told to go on."""

    def __init__(self) -> None:
        self.hold = Hold()

    def __call__(self, level: Level, path: Path) -> Level:
        self.hold.here()
        return save_level(level, path)


@pytest.mark.slow
async def test_a_robot_is_stopped_by_a_wall_and_taken_elsewhere_under_way(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game, session = s.game, s.game.session
        await s.press("N")
        await game.until(lambda: game.tick == 10)
        before = session.frame
        await s.press("b")
        await s.drag((85, 20), (85, 80))
        await game.until(lambda: session.level.walls[50, 85])
        marks = session.game.history.marks if session.game else None
        assert marks is not None
        assert marks.at(10)[0].kind == "edit"
        await s.press("space")
        await game.until(lambda: session.frame.after.robots[0].blocked)
        tick = game.tick
        await s.press("h")
        body = session.frame.after.robots[0]
        await s.drag((body.x, body.y), (150, 50))
        await game.until(lambda: session.frame.after.robots[0].x > 140)
        await s.press("space")
        await game.until(lambda: not session.running)
        assert game.tick >= tick
        last = session.frame
        session.go_to(9)
        await game.until(lambda: game.tick == 9)
        assert session.frame.after.robots == before.before.robots
        assert not session.level.walls[50, 85]
        await game.until(lambda: not s.level.walls[50, 85])
        assert s.editor.edits.can_undo == "go to tick 9"
        session.go_to(last.tick)
        await game.until(lambda: game.tick == last.tick)
        assert session.frame == last
        assert session.history is not None
        assert not is_by_the_book(session.history, session.opened, game.tick)
        await s.press("u", "u", "u")
        await s.press("escape")
        await game.sees("What should happen to your changes")
        await s.press("t")
        await game.until(lambda: not game.main.editing.is_on)
        assert np.array_equal(session.level.walls, s.controller.levels.saved.walls)


async def test_undoing_brings_a_robot_back_to_where_it_was_taken(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("N")
        await s.game.until(lambda: s.game.tick == 10)
        x = s.game.session.frame.after.robots[0].x
        assert x > 44
        await s.drag((x, 50), (180, 60))
        await s.settled()
        assert s.game.session.frame.after.robots[0].x > 170
        await s.press("u")
        await s.settled()
        assert s.game.session.frame.after.robots[0].x == x
        assert s.level.robots[0].x == 40
        await s.press("U")
        await s.settled()
        assert s.game.session.frame.after.robots[0].x > 170


async def test_playing_what_is_edited_loses_no_stroke_and_counts_for_nothing(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.drag((240, 50), (80, 50))
        await s.press("t")
        await game.sees("Again")
        assert not game.main.editing.is_on
        assert game.main.recorder.record.state != "won"
        await s.press("t")
        await game.until(lambda: game.main.editing.is_on and game.tick == 0)
        assert s.editor.edits.can_undo == "move"
        assert game.session.frame.after.robots[0].x == 40


async def test_a_victory_while_the_level_is_edited_is_kept_at_once_and_told_afterwards(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game = s.game
        game.session.pace.speed = None
        await s.press("space")
        await game.until(lambda: game.main.recorder.record.state == "won")
        assert game.main.editing.is_on
        assert not isinstance(game.app.screen, Results)
        await s.press("escape")
        await game.until(lambda: isinstance(game.app.screen, Results))
        assert not game.main.editing.is_on


async def test_findings_are_listed_and_lead_to_their_place(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        game = s.game
        await game.until(lambda: s.controller.findings == [])
        await s.press("b", "right_square_bracket", "right_square_bracket")
        await s.drag((200, 30))
        await game.until(lambda: s.controller.findings)
        await s.press("j")
        await game.until(lambda: isinstance(game.app.screen, FindingList))
        await game.sees("is inside a wall")
        await s.press("enter")
        await game.until(lambda: s.editor.cursor == (200, 30))


async def test_a_save_changes_little_and_one_without_a_change_nothing(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.press("s")
        await game.sees("It is already saved")
        assert said(room_file) == ROOM
        await s.drag((200, 30), (180, 30))
        await s.press("s")
        await game.sees("Saved as room")
        x = s.level.beacons[0].x
        assert said(room_file) == ROOM.replace("x = 200", f"x = {x:g}")
        assert s.controller.levels.is_saved
        say(room_file, ROOM.replace("A room", "Another room", 1))
        await s.press("b")
        await s.drag((100, 50))
        await s.press("s")
        await game.sees("was changed by another program")
        await s.press("escape")
        await s.settled()
        assert "Another room" in said(room_file)


async def test_a_save_is_finished_whatever_is_asked_for_meanwhile(
    data_dir: Path, room_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saving = SlowSaving()
    monkeypatch.setattr("logical_robots_tui.editing.files.save_level", saving)
    async with studio(data_dir, room_file) as s:
        game = s.game
        await game.until(lambda: s.controller.findings == [])
        await s.drag((200, 30), (180, 30))
        await s.press("s")
        await game.until(lambda: saving.hold.has_begun)
        await s.press("j", "s", "M")  # the findings, another save, and back to playing
        await s.settled()
        assert game.main.editing.is_on
        saving.hold.release()
        await game.until(lambda: not game.main.editing.is_on)
        assert game.app.screen is game.main
        assert s.controller.levels.is_saved
        assert load_level(room_file).beacons == s.level.beacons


async def test_a_save_under_way_when_the_level_is_left_keeps_what_was_done_since(
    data_dir: Path, room_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saving = SlowSaving()
    monkeypatch.setattr("logical_robots_tui.editing.files.save_level", saving)
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.drag((200, 30), (180, 30))
        await s.press("s")
        await game.until(lambda: saving.hold.has_begun)
        await s.drag((180, 30), (120, 30))
        newest = s.level.beacons
        await s.press("greater_than_sign")
        await game.until(lambda: not game.main.editing.is_on)
        saving.hold.release()
        await game.sees("Saved as room")
        assert game.session.opened.name != "room"
        game.main.session.open_level(load_level(room_file), {"": game.session.source}, STILL)
        await s.press("M")
        await game.sees("unsaved changes to the level have been restored")
        assert s.level.beacons == newest


async def test_changes_are_kept_as_a_new_level_that_the_chooser_shows(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.press("b")
        await s.drag((100, 20), (100, 60))
        await s.press("M")
        await game.sees("What should happen to your changes")
        await s.press("k")
        await game.sees("Save the level as")
        await game.until(lambda: game.app.screen.query("#name"))
        game.app.screen.query_one("#name", Input).value = "mine"
        game.app.screen.query_one("#title", Input).value = "Mine"
        await s.press("enter")
        await game.until(lambda: not game.main.editing.is_on)
        kept = load_level(data_dir / "levels" / "mine.toml")
        assert kept.title == "Mine"
        assert kept.walls[40, 100]
        assert said(room_file) == ROOM
        assert game.session.opened.source == kept.source
        await s.press("l")
        await game.until(lambda: isinstance(game.app.screen, LevelScreen))
        await s.press(*"mine")
        await game.sees("▸ Mine")
        await s.press("ctrl+n")
        await game.until(lambda: game.app.screen.query("#kind"))
        form = game.app.screen
        form.query_one("#kind", Select).value = "copy"
        form.query_one("#original", Select).value = "mine"
        await s.press("f2")
        await game.until(lambda: game.main.editing.is_on)
        assert game.session.level.title == "Mine (copy)"
        assert game.session.level.walls[40, 100]


@pytest.fixture
def web_file(room_file: Path) -> Path:
    """The room in the web platform's format, as another program would write it."""
    file = room_file.with_name("garden.json")
    save_level(load_level(room_file), file)
    say(file, json.dumps(json.loads(said(file))))
    return file


async def test_a_file_of_the_platform_is_replaced_only_if_the_player_says_so(
    data_dir: Path, web_file: Path
) -> None:
    before = said(web_file)
    async with studio(data_dir, web_file) as s:
        game = s.game
        await s.drag((200, 30), (180, 30))
        await s.press("s")
        await game.sees("was not made by this game")
        await s.press("escape")
        await game.sees_no("was not made by this game")
        assert said(web_file) == before
        await s.press("s")
        await game.sees("was not made by this game")
        await s.press("r")
        await game.sees("Saved as garden.json")
        assert load_level(web_file).beacons[0].x == s.level.beacons[0].x
        assert s.controller.levels.is_saved
        await s.drag((180, 30), (120, 30))
        await s.press("s")  # by now it was made here
        await game.until(lambda: s.controller.levels.is_saved)
        assert load_level(web_file).beacons[0].x == s.level.beacons[0].x


async def test_a_level_of_the_platform_can_be_saved_under_another_name_instead(
    data_dir: Path, web_file: Path
) -> None:
    before = said(web_file)
    async with studio(data_dir, web_file) as s:
        game = s.game
        await s.drag((200, 30), (180, 30))
        await s.press("s")
        await game.sees("was not made by this game")
        await s.press("s")
        await game.sees("Save the level as")
        await s.press("enter")
        await game.sees("Saved as garden-2.json")
        assert said(web_file) == before


async def test_a_new_level_is_made_from_a_labyrinth_drawn_by_lot(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("H")
        await game.sees("New level")
        form = game.app.screen
        await game.until(lambda: form.query("#kind"))
        form.query_one("#kind", Select).value = "labyrinth"
        form.query_one("#columns", Input).value = "0"
        await game.press("f2")
        await game.sees("A labyrinth needs at least 2 cells")
        form.query_one("#columns", Input).value = "3"
        form.query_one("#rows", Input).value = "2"
        form.query_one("#seed", Input).value = "7"
        form.query_one("#title", Input).value = "Short cut"
        await game.press("f2")
        await game.until(lambda: game.main.editing.is_on)
        assert game.session.level.title == "Short cut"
        assert (game.session.level.width, game.session.level.height) == (220, 150)
        await game.sees("not saved")
        await game.press("s")
        await game.sees("Save the level as")
        await game.press("enter")
        await game.sees("Saved as short-cut")
        assert (data_dir / "levels" / "short-cut.toml").exists()
        await game.press("escape")
        await game.until(lambda: not game.main.editing.is_on)


@pytest.mark.slow
async def test_what_was_edited_is_offered_after_a_hangup(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("b")
        await s.drag((100, 20), (100, 60))
        await s.settled()
    assert said(room_file) == ROOM
    async with opened(data_dir) as game:
        await game.sees("Continue editing the level “A room”")
        await game.sees("Yes, continue")
        await game.press("y")
        await game.until(lambda: game.main.editing.is_on and game.session.level.width == 280)
        await game.until(lambda: game.session.level.walls[40, 100])
        await game.press("u")
        await game.until(lambda: not game.session.level.walls[40, 100])
    async with opened(data_dir) as game:
        await game.ready()
        await game.until(lambda: game.main.recorder.record)
        await game.sees_no("Continue editing")


async def test_what_was_placed_with_keys_stays_when_something_else_is_begun(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game, areas, beacons = s.game, len(s.level.areas), len(s.level.beacons)
        await s.press("c", "enter", "a", "enter", "s")
        await game.until(lambda: s.controller.levels.is_saved)
        await s.press("t")
        await game.until(lambda: game.tick > 1)
        await s.press("t")
        await game.until(lambda: game.main.editing.is_on and game.tick == 0)
        assert (len(s.level.areas), len(s.level.beacons)) == (areas + 1, beacons + 1)
        assert s.controller.levels.is_saved
        await s.press("a", "enter", "escape")
        await s.settled()
        assert len(s.level.areas) == areas + 1


async def test_all_that_can_become_of_the_changes_is_in_sight(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("a", "enter", "s")
        await s.game.until(lambda: s.controller.levels.is_saved)
        await s.press("c", "enter", "h", "M")
        await s.game.sees("What should happen to your changes")
        answers = ("Save", "Keep as a level", "Just for this game", "Throw away")
        await s.game.until(lambda: all(s.game.shows(f" {answer} ") for answer in answers))
