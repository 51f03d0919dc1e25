"""Choosing levels and programs, saving, and what happens to unsaved text meanwhile."""

from __future__ import annotations

import threading
from functools import partial
from typing import TYPE_CHECKING

import pytest
from rich.style import Style
from textual import events
from textual.widgets import Input, OptionList, Static

from logical_robots_tui.game import list_programs, load_program, save_program
from logical_robots_tui.tui.dialogs.chooser import Chooser
from logical_robots_tui.tui.dialogs.hints import Hints
from logical_robots_tui.tui.dialogs.question import Question
from logical_robots_tui.tui.dialogs.save import SaveAs
from logical_robots_tui.tui.dialogs.shelves import ProgramShelf
from logical_robots_tui.tui.levels.screen import LevelScreen
from logical_robots_tui.tui.listing import Listing
from logical_robots_tui.tui.palette import Palette
from logical_robots_tui.world import list_levels, load_level
from tests.tui.conftest import LEVELS, PAPER, PATIENCE, STILL, opened, source_of

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.game import Source
    from tests.tui.conftest import Opened

FIRST = list_levels()[0]


async def dialog(game: Opened, key: str, kind: type) -> None:
    await game.press(key)
    await game.until(lambda: isinstance(game.app.screen, kind))


async def fill(game: Opened, text: str) -> None:
    game.app.screen.query_one(Input).value = text
    await game.pilot.pause(0.05)


def is_at(game: Opened, level: str) -> bool:
    return game.session.level.name == level


def complaint(game: Opened) -> str:
    said = game.app.screen.query_one("#complaint", Static)
    return str(said.visual) if said.display else ""


async def test_a_level_is_picked_from_the_list_and_brings_its_starter(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await dialog(game, "l", LevelScreen)
        level = load_level(FIRST)
        await game.until(lambda: game.shows(level.title))
        await fill(game, FIRST)
        await game.until(lambda: game.shows(level.idea))
        await game.press("enter")
        await game.until(lambda: game.session.level.name == FIRST)
        assert game.app.screen is game.main
        assert game.tick == 0
        starter = load_program(level.starter)
        assert game.editor.text == starter.text
        await game.until(lambda: game.session.state.applied == starter.text)
        await game.until(lambda: game.shows(level.briefing.splitlines()[0]))
        await game.press("space")
        await game.until(lambda: game.tick > 0)
        assert not game.shows("hides this")


async def test_a_level_file_is_opened_by_its_path_and_keeps_the_program(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "l", LevelScreen)
        await fill(game, str(LEVELS / "team_goal.json"))
        await game.until(lambda: game.shows("Open the file"))
        await game.press("enter")
        await game.until(lambda: game.session.level.name == "team_goal")
        assert game.editor.text == PAPER
        await game.press("n")
        await game.until(lambda: game.tick == 1)


@pytest.mark.parametrize("content", [None, b"", b"\xff\x00rubbish", b"{}", b"cell = 'x'"])
async def test_a_level_that_cannot_be_used_says_why_and_the_game_goes_on(
    data_dir: Path, tmp_path: Path, content: bytes | None
) -> None:
    bad = tmp_path / "bad.toml"
    if content is not None:
        bad.write_bytes(content)
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "l", LevelScreen)
        await fill(game, str(bad))
        await game.press("enter")
        await game.until(lambda: "bad.toml" in complaint(game))
        await game.press("escape", "n")
        await game.until(lambda: game.tick == 1)


async def test_the_next_level_follows_and_the_last_one_says_so(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        for name in list_levels():
            await game.press("greater_than_sign")
            await game.until(partial(is_at, game, name))
        await game.press("greater_than_sign")
        await game.until(lambda: game.shows("the last level"))


async def test_a_level_change_while_running_stands_still_at_its_start(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("plus", "plus", "plus", "plus", "plus", "plus", "space")
        await game.until(lambda: game.tick > 5)
        await game.press("greater_than_sign")
        await game.until(lambda: game.session.level.name == FIRST)
        await game.until(lambda: game.session.state.phase == "applied")
        assert game.tick == 0
        assert not game.session.busy


async def test_a_program_is_picked_with_its_first_comment_in_view(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 2)
        await dialog(game, "o", Chooser)
        await fill(game, "obstacle")
        source = load_program("obstacle-avoider")
        await game.until(lambda: game.shows(source.text.splitlines()[0].lstrip("# ")[:20]))
        await game.press("enter")
        await game.until(lambda: game.session.state.applied == source.text)
        assert game.editor.text == source.text
        assert game.tick > 2  # the world stays, only the program is another one


async def test_a_program_that_cannot_be_read_says_why(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir) as game:
        await dialog(game, "o", Chooser)
        await fill(game, f"{tmp_path}/")
        await game.press("enter")
        await game.until(lambda: "folder" in complaint(game))


async def test_saving_under_a_new_name_makes_it_the_program_at_hand(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "x", "f2")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))
        assert game.app.screen.query_one(Input).value == "mine"
        await fill(game, "other")
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main)
        assert (data_dir / "programs" / "other.l").read_text() == "x" + PAPER
        assert (data_dir / "programs" / "mine.l").read_text() == PAPER
        assert game.session.source.name == "other"
        assert "other" in list_programs(data_dir / "programs")
        await game.until(lambda: not list((data_dir / "drafts").glob("*.json")))


async def test_who_is_in_a_hurry_saves_once_and_takes_nothing_back(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Path] = []
    go_on = threading.Event()

    def save_slowly(path: Path, text: str) -> None:
        save_program(path, text)
        begun.append(path)
        assert go_on.wait(PATIENCE)

    monkeypatch.setattr("logical_robots_tui.tui.dialogs.save.save_program", save_slowly)
    async with opened(data_dir) as game:
        await game.press("2", "x", "f2")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))
        await fill(game, "other")
        await game.press("enter")
        await game.until(lambda: begun)
        await game.press("enter", "escape")
        await game.pilot.pause(0)
        assert isinstance(game.app.screen, SaveAs)
        go_on.set()
        await game.until(lambda: game.app.screen is game.main)
        assert game.session.source.name == "other"
        assert len(begun) == 1


async def test_a_save_that_ends_under_another_dialog_leaves_no_dialog_that_stays(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, go_on = threading.Event(), threading.Event()

    def save_slowly(path: Path, text: str) -> None:
        begun.set()
        assert go_on.wait(PATIENCE)
        path.write_text(text)

    monkeypatch.setattr("logical_robots_tui.tui.dialogs.save.save_program", save_slowly)
    async with opened(data_dir) as game:
        await dialog(game, "s", SaveAs)
        await fill(game, "other")
        saving = game.app.screen
        await game.press("enter")
        await game.until(begun.is_set)
        try:
            game.app.push_screen(Question("Above", "All of it?", [("yes", "Yes")]))
            await game.until(lambda: isinstance(game.app.screen, Question))
        finally:
            go_on.set()
        save = next(worker for worker in game.app.workers if worker.group == "save")
        await save.wait()
        await game.press("y")
        await game.until(lambda: game.app.screen is saving)
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
    assert (data_dir / "programs" / "other.l").read_text() == PAPER


async def test_saving_over_the_program_at_hand_does_not_ask(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2", "x", "f2")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main)
        assert (data_dir / "programs" / "mine.l").read_text() == "x" + PAPER


async def test_saving_over_another_program_asks_first(data_dir: Path) -> None:
    source_of(STILL, data_dir / "programs", "other")
    async with opened(data_dir) as game:
        await dialog(game, "s", SaveAs)
        await fill(game, "other")
        await game.press("enter")
        await game.until(lambda: "enter again" in complaint(game))
        assert (data_dir / "programs" / "other.l").read_text() == STILL
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main)
        assert (data_dir / "programs" / "other.l").read_text() == PAPER


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("", "needs a name"),
        ("obstacle-avoider", "stays as it is"),
        ("a\tb", "letters"),
        (".hidden", "letters"),
        ("../up", "is a folder"),
        ("/dev/null/x", "can't be written"),
        ("x" * 300, "can't be written"),
        ("~nobody-of-that-name/x", "no such home"),
    ],
)
async def test_a_name_that_does_not_do_is_refused(
    data_dir: Path, tmp_path: Path, name: str, why: str
) -> None:
    (tmp_path / "up.l").mkdir()
    async with opened(data_dir) as game:
        await dialog(game, "s", SaveAs)
        await fill(game, name.replace("..", str(tmp_path)))
        await game.press("enter")
        await game.until(lambda: why in complaint(game))


async def test_unsaved_text_comes_back_with_its_program(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", *"hello", "escape")
        await dialog(game, "o", Chooser)
        await fill(game, "obstacle")
        await game.press("enter")
        await game.until(lambda: game.session.source.name == "obstacle-avoider")
        assert "hello" not in game.editor.text
        await dialog(game, "o", Chooser)
        await game.until(lambda: game.app.screen.query_one(OptionList).option_count > 1)
        await fill(game, "mine")
        await game.press("enter")
        await game.until(lambda: game.session.source.name == "mine")
        assert game.editor.text == "hello" + PAPER
        await game.until(lambda: game.shows("unsaved text of mine is back"))


async def test_what_is_longer_than_its_line_is_seen_at_its_end(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("s")
        await game.until(lambda: game.shows("Save the program as"))
        await game.press(*"abcdefghij" * 10, *"-end")
        await game.until(lambda: game.shows("efghij-end"))


async def test_a_click_at_an_entry_that_has_just_gone_chooses_nothing(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "o", Chooser)
        entries = game.app.screen.query_one("#entries", OptionList)
        await game.until(lambda: entries.option_count)
        stale = Style(meta={"option": entries.option_count})
        click = events.Click(entries, 2, 2, 0, 0, 1, False, False, False, 2, 2, stale)
        entries.post_message(click)
        await game.press("m")
        await game.until(lambda: game.app.screen.query_one(Input).value == "m")
        assert isinstance(game.app.screen, Chooser)


async def test_a_double_click_closes_the_palette_once(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "ctrl+p", Palette)
        for kind in 2 * (events.MouseDown, events.MouseUp):
            game.app.post_message(kind(None, 1, 1, 0, 0, 1, False, False, False, 1, 1))
        await game.until(lambda: game.app.screen is game.main)
        await game.press("n")
        await game.until(lambda: game.tick == 1)


async def test_a_list_without_room_has_no_pages(data_dir: Path) -> None:
    async with opened(data_dir, size=(20, 5)) as game:
        await game.ready()
        choice = game.inspector.query_one(Listing)
        choice.highlighted = 2
        choice.action_page_up()
        choice.action_page_down()
        assert choice.highlighted == 2


async def test_a_dialog_that_is_closed_does_nothing_any_more(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short) as game:
        await game.ready()
        await dialog(game, "h", Hints)
        hints = game.app.screen
        hints.dismiss()
        await game.until(lambda: not hints.query("#hints"))
        await game.app.run_action("more", hints)
        await hints.run_action("more")
        assert game.app.screen is game.main
        assert game.main.journal.record.hints == 1


@pytest.mark.parametrize(("key", "kind"), [("o", Chooser), ("l", LevelScreen)])
@pytest.mark.parametrize(
    ("path", "why"),
    [("/tmp/" + "x" * 300 + ".toml", "can't be read"), ("~nobody-here/x.toml", "no such home")],
)
async def test_a_path_that_is_out_of_reach_is_refused(
    data_dir: Path, key: str, kind: type, path: str, why: str
) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, key, kind)
        await fill(game, path)
        await game.press("enter")
        await game.until(lambda: why in complaint(game))


async def test_a_choice_that_comes_when_the_dialog_is_left_already_is_too_late(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, told = threading.Event(), threading.Event()

    def take(shelf: ProgramShelf, name: str) -> Source:
        asked.set()
        assert told.wait(PATIENCE)
        return load_program(name, shelf.own)

    monkeypatch.setattr(ProgramShelf, "take", take)
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "o", Chooser)
        chooser = game.app.screen
        await fill(game, "herd")
        await game.press("enter")
        await game.until(asked.is_set)
        assert isinstance(chooser, Chooser)
        chooser.action_leave()
        told.set()
        await game.until(lambda: game.app.screen is game.main and not chooser.is_attached)
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        assert game.session.source.name == "mine"


@pytest.mark.parametrize("sign", ["\udcff", "\x1b"])
async def test_a_path_that_can_not_be_shown_is_not_proposed(
    data_dir: Path, tmp_path: Path, sign: str
) -> None:
    path = tmp_path / f"o{sign}n.l"
    path.write_text(STILL)
    async with opened(data_dir) as game:
        await game.ready()
        game.main.library.open_program(load_program(path))
        await game.until(lambda: game.session.source.path == path)
        await dialog(game, "s", SaveAs)
        assert game.app.screen.query_one(Input).value == ""
        await fill(game, "own")
        await game.press("enter")
        await game.until(lambda: game.session.source.name == "own")
