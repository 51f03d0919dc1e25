"""Choosing levels and programs, saving, and what happens to unsaved text meanwhile."""

from __future__ import annotations

from datetime import UTC, datetime
from functools import partial
from typing import TYPE_CHECKING
from urllib.parse import quote

import pytest
from textual import events
from textual.content import Content
from textual.widgets import Input, OptionList

from logical_robots_tui.game import list_programs, load_program, save_program
from logical_robots_tui.paths import ARENAS, shipped_folder
from logical_robots_tui.progress import Version
from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.tui.library.save_dialog import SaveAs
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import list_arenas, list_levels, load_level
from tests.tui.conftest import LEVELS, PAPER, STILL, opened, source_of
from tests.tui.dialogs import complaint, dialog, fill
from tests.virtual_time import Hold

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

FIRST = list_levels()[0]


def is_at(game: Opened, level: str) -> bool:
    return game.session.level.name == level


async def test_a_level_is_picked_from_the_list_and_brings_its_starter(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await dialog(game, "l", LevelScreen)
        level = load_level(FIRST)
        await game.sees(level.title)
        await fill(game, FIRST)
        await game.sees(level.idea)
        await game.press("enter")
        await game.until(lambda: game.session.level.name == FIRST)
        assert game.app.screen is game.main
        assert game.tick == 0
        starter = load_program(level.starter)
        assert game.editor.text == starter.text
        await game.until(lambda: game.session.state.applied == starter.text)
        await game.sees(level.briefing[:14])
        await game.press("space")
        await game.until(lambda: game.tick > 0)
        await game.sees_no("hides this")


async def test_a_level_file_is_opened_by_its_path_and_keeps_the_program(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "l", LevelScreen)
        await fill(game, str(LEVELS / "team_goal.json"))
        await game.sees("Open the file")
        await game.press("enter")
        await game.until(lambda: game.session.level.name == "team_goal")
        assert game.editor.text == PAPER
        await game.press("n")
        await game.until(lambda: game.tick == 1)


AS_PASTED = ("{}", " {} ", "'{}'", '"{}"', "'{}' ", "{escaped}", "{escaped} ", "file://{url}")


def as_pasted(form: str, file: Path) -> str:
    path = str(file)
    return form.format(path, escaped=path.replace(" ", "\\ "), url=quote(path))


@pytest.mark.parametrize("form", AS_PASTED)
async def test_a_level_is_opened_by_dropping_its_file_into_the_terminal(
    data_dir: Path, tmp_path: Path, form: str
) -> None:
    file = tmp_path / "from the web.json"
    file.write_bytes((LEVELS / "team_goal.json").read_bytes())
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "l", LevelScreen)
        game.app.post_message(events.Paste(as_pasted(form, file)))
        await game.sees("Open the file")
        await game.press("enter")
        await game.until(lambda: is_at(game, "from the web"))


@pytest.mark.parametrize("form", AS_PASTED)
async def test_a_program_is_opened_by_dropping_its_file_into_the_terminal(
    data_dir: Path, tmp_path: Path, form: str
) -> None:
    file = tmp_path / "from the web.l"
    file.write_text(STILL, encoding="utf-8")
    async with opened(data_dir) as game:
        await game.ready()
        await dialog(game, "o", Chooser)
        game.app.post_message(events.Paste(as_pasted(form, file)))
        await game.sees("Open the file")
        await game.press("enter")
        await game.until(lambda: game.editor.text == STILL)
        assert game.session.source.path == file


@pytest.mark.sampled
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


@pytest.mark.slow
async def test_the_next_level_follows_and_the_last_one_says_so(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        for name in list_levels():
            await game.press("greater_than_sign")
            await game.until(partial(is_at, game, name))
        await game.press("greater_than_sign")
        await game.sees("the last level")


async def test_an_arena_is_followed_by_the_next_one(data_dir: Path) -> None:
    *_, last_but_one, last = list_arenas()
    file = shipped_folder("levels") / ARENAS / f"{last_but_one}.toml"
    async with opened(data_dir, level=file) as game:
        await game.ready()
        await game.press("greater_than_sign")
        await game.until(partial(is_at, game, last))
        await game.press("greater_than_sign")
        await game.sees("the last level")


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


@pytest.mark.slow
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
    hold = Hold()

    def save_slowly(path: Path, text: str) -> None:
        save_program(path, text)
        begun.append(path)
        hold.here()

    monkeypatch.setattr("logical_robots_tui.tui.library.save_dialog.save_program", save_slowly)
    async with opened(data_dir) as game:
        await game.press("2", "x", "f2")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))
        await fill(game, "other")
        await game.press("enter")
        await game.until(lambda: begun)
        await game.press("enter", "escape")
        await game.settled()
        assert isinstance(game.app.screen, SaveAs)
        hold.release()
        await game.until(lambda: game.app.screen is game.main)
        assert game.session.source.name == "other"
        assert len(begun) == 1


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


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("", "needs a name"),
        ("obstacle-avoider", "is part of the game"),
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


@pytest.mark.slow
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
        await game.sees("unsaved text of mine has been restored")


@pytest.mark.sampled
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


async def test_the_key_in_the_editor_saves_what_is_the_players_and_asks_for_what_is_ours(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        path = game.session.source.path
        await game.press("2", *"# so", "ctrl+s")
        await game.until(lambda: path.read_text() == f"# so{STILL}")
        await game.sees("Saved as mine in")
        assert game.app.screen is game.main
        game.session.saved_as(load_program("obstacle-avoider"))
        await game.press("ctrl+s")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))


def test_a_version_shows_what_would_change() -> None:
    then = Version(1, "a\nb\nc\nold\ne\n", datetime(2026, 1, 1, tzinfo=UTC), won=True)
    (name,) = (shelf := VersionShelf([then], "a\nb\nc\nd\nnew\ne\n")).names()
    card = shelf.card(name)
    assert card.headline == "★ won   +1 -2"
    assert isinstance(card.preview, Content)
    assert card.preview.plain.split("\n") == ["@ line 2", " b", " c", "-d", "-new", "+old", " e"]
    inks = {span.style for span in card.preview.spans}
    assert {INK.good, INK.bad} <= inks
    same = VersionShelf([then], then.text).card(name)
    assert (same.headline, same.preview) == ("as it is now", then.text)
