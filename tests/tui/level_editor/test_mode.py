"""Editing on the screen: playing what is edited, and what becomes of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from logical_robots_tui.tui.labyrinth.results import Results
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.world import load_level
from tests.tui.conftest import opened
from tests.tui.level_editor.conftest import ROOM, fill, replace_in, said, studio


async def test_playing_what_is_edited_loses_no_stroke_and_counts_for_nothing(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game, areas, beacons = s.game, len(s.level.areas), len(s.level.beacons)
        game.session.pace.speed = None
        await s.press("c", "enter", "a", "enter", "s")
        await game.sees("Saved as room")
        assert s.controller.levels.is_saved
        await s.press("t")
        await game.until(lambda: game.tick > 1)
        await s.press("t")
        await game.until(lambda: game.main.editing.is_on and game.tick == 0)
        assert (len(s.level.areas), len(s.level.beacons)) == (areas + 1, beacons + 1)
        assert s.controller.levels.is_saved
        await s.do("a", "enter", "escape", "h")
        assert len(s.level.areas) == areas + 1
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
    replace_in(room_file, "x = 40", "x = 215")
    async with studio(data_dir, room_file) as s:
        game = s.game
        await s.press("space")
        await game.until(lambda: game.main.recorder.record.state == "won")
        assert game.main.editing.is_on
        assert not isinstance(game.app.screen, Results)
        await s.press("escape")
        await game.until(lambda: isinstance(game.app.screen, Results))
        assert not game.main.editing.is_on


async def test_changes_are_kept_as_a_new_level_that_the_chooser_shows(
    data_dir: Path, web_file: Path
) -> None:
    before = said(web_file)
    async with studio(data_dir, web_file) as s:
        game = s.game
        await s.drag((200, 30), (180, 30))
        for answer in ("escape", "s"):  # not to replace it, or to save it under another name
            await s.press("s")
            await game.sees("was not made by this game")
            await s.press(answer)
            await game.sees_no("was not made by this game")
        await game.sees("Save the level as")
        await s.press("enter")
        await game.sees("Saved as garden-2.json")
        await s.press("b")
        await s.drag((100, 20), (100, 60))
        await s.press("M")
        await game.sees("What should happen to your changes")
        await s.press("k")
        await game.sees("Save the level as")
        await game.until(lambda: game.app.screen.query("#name"))
        fill(game.app.screen, name="mine", title="Mine")
        await s.press("enter")
        await game.until(lambda: not game.main.editing.is_on)
        kept = load_level(data_dir / "levels" / "mine.toml")
        assert (kept.title, kept.walls[40, 100]) == ("Mine", True)
        assert said(web_file) == before
        assert game.session.opened.source == kept.source
        await s.press("l")
        await game.until(lambda: isinstance(game.app.screen, LevelScreen))
        await s.press(*"mine")
        await game.sees("▸ Mine")
        await s.press("ctrl+n")
        await game.until(lambda: game.app.screen.query("#kind"))
        fill(game.app.screen, kind="copy", original="mine")
        await s.press("f2")
        await game.until(lambda: game.main.editing.is_on)
        assert game.session.level.title == "Mine (copy)"
        assert game.session.level.walls[40, 100]


@pytest.mark.slow
async def test_what_was_edited_is_offered_after_a_hangup(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        await s.press("b")
        await s.drag((100, 20), (100, 60))
        await s.game.settled()
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
