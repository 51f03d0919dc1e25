"""Choosing levels and programs, saving, and what happens to unsaved text meanwhile."""

import asyncio
from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from urllib.parse import quote

import pytest
from textual import events
from textual.content import Content
from textual.widgets import Input, OptionList, Static

from logical_robots_tui.game import list_programs, load_program, save_program
from logical_robots_tui.game.victory import Victory
from logical_robots_tui.paths import ARENAS, shipped_folder
from logical_robots_tui.player.learning import is_spoiler
from logical_robots_tui.progress import Version
from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.tui.library.save_dialog import SaveAs
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import list_arenas, list_levels, load_level
from tests.tui.conftest import LEVELS, PAPER, STILL, Opened, opened, source_of
from tests.virtual_time import Hold

FIRST = list_levels()[0]


def is_at(game: Opened, level: str) -> bool:
    return game.session.level.name == level


async def complains(game: Opened, text: str, why: str) -> None:
    await game.fill(text)
    complaint = game.app.screen.query_one("#complaint", Static)
    await game.press("enter", until=lambda: complaint.display and why in str(complaint.visual))


OUT_OF_REACH = (("/" + "x" * 300 + ".toml", "can't be read"), ("~no-one/x.toml", "no such home"))
AS_PASTED = ("{}", " {} ", "'{}'", "'{}' ", "{escaped}"), ("{escaped} ", '"{}"', "file://{url}")


async def drop(game: Opened, form: str, file: Path, until: Callable[[], bool]) -> None:
    path = str(file)
    pasted = form.format(path, escaped=path.replace(" ", "\\ "), url=quote(path))
    game.app.post_message(events.Paste(pasted))
    await game.sees("Open the file")
    await game.press("enter", until=until)


async def test_levels_are_dropped_named_picked_or_come_next(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("l", on=LevelScreen)
        for number, content in enumerate((None, b"", b"\xff\x00rubbish", b"{}", b"cell = 'x'")):
            bad = tmp_path / f"bad{number}.toml"
            if content is not None:
                bad.write_bytes(content)
            await complains(game, str(bad), bad.name)
        for path, why in OUT_OF_REACH:
            await complains(game, path, why)
        await game.fill(str(LEVELS / "team_goal.json"))
        await game.sees("Open the file")
        await game.press("enter", until=lambda: is_at(game, "team_goal"))
        assert game.editor.text == PAPER
        await game.press("n", tick=1)
        for number, form in enumerate(AS_PASTED[0]):  # the dialog for programs takes the others
            file = tmp_path / f"from the web {number}.json"
            file.write_bytes((LEVELS / "team_goal.json").read_bytes())
            await game.press("l", on=LevelScreen)
            await drop(game, form, file, partial(is_at, game, file.stem))

        # One that is picked from the list brings its starter.
        await game.press("n", tick=1)
        await game.press("l", on=LevelScreen)
        level = load_level(FIRST)
        await game.sees(level.title)
        await game.fill(FIRST)
        await game.sees(level.idea)
        await game.press("enter", until=lambda: is_at(game, FIRST))
        assert game.app.screen is game.main
        assert game.tick == 0
        starter = load_program(level.starter)
        assert game.editor.text == starter.text
        await game.until(lambda: game.session.state.applied == starter.text)
        await game.sees(level.briefing[:14])
        await game.press("space", until=lambda: game.tick > 0, sees_no="hides this")

        # Another one begins at rest, the first arena follows the last level, and none the last one.
        await game.press(*["plus"] * 6, until=lambda: game.tick > 5)
        await game.press("greater_than_sign", until=lambda: is_at(game, list_levels()[1]))
        await game.until(lambda: game.session.state.phase == "applied")
        assert game.tick == 0
        assert not game.session.busy
        last = await asyncio.to_thread(load_level, list_levels()[-1])
        await game.main.library.open_level(last)
        await game.until(lambda: game.session.program is not None)
        assert game.session.program is not None
        game.main.announcer.won(Victory(last, game.session.program, 641, "counts", None))
        await game.sees("First arena", "Daily", "Own swarm", "This was the last level.")
        await game.press("f", until=partial(is_at, game, list_arenas()[0]))
        file = shipped_folder("levels") / ARENAS / f"{list_arenas()[-1]}.toml"
        await game.main.library.open_level(await asyncio.to_thread(load_level, file))
        await game.press("greater_than_sign", sees="the last level")


async def test_programs_are_picked_or_dropped_and_text_kept(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("o", on=Chooser)
        await complains(game, f"{tmp_path}/", "folder")
        await game.fill("solution")
        await game.sees("solutions, shown after W")
        assert not game.shows("lighthouse")
        await complains(game, "shown after", "when you have won the level")
        for name in ("first-steps", "lighthouse"):  # one won, one asked for
            assert is_spoiler(name, game.main.recorder.progress)
        game.main.recorder.progress.win(FIRST, "")
        game.main.recorder.progress.set_fact("shown lighthouse", "yes")
        await game.press("escape")
        await game.press("o", on=Chooser)
        await game.until(lambda: game.shows("first-steps ") and game.shows("lighthouse "))
        for path, why in OUT_OF_REACH:
            await complains(game, path, why)
        await game.press("escape", "2", *"hello", "escape", "space", until=lambda: game.tick > 2)
        await game.press("o", on=Chooser)
        await game.fill("obstacle")
        source = load_program("obstacle-avoider")
        await game.until(lambda: game.shows(source.text.splitlines()[0].lstrip("# ")[:20]))
        await game.press("enter", until=lambda: game.session.state.applied == source.text)
        assert game.editor.text == source.text
        assert game.tick > 2  # the world stays, only the program is another one
        await game.press("space")

        await game.press("o", on=Chooser)
        await game.until(lambda: game.app.screen.query_one(OptionList).option_count > 1)
        await game.fill("mine")
        await game.press("enter", until=lambda: game.session.source.name == "mine")
        assert game.editor.text == "hello" + PAPER
        await game.sees("unsaved text of mine has been restored")

        for number, form in enumerate(AS_PASTED[1]):
            file = tmp_path / f"from the web {number}.l"
            file.write_text(STILL, encoding="utf-8")
            await game.press("o", on=Chooser)
            await drop(game, form, file, partial(is_open, game, file))
            assert game.editor.text == STILL


def is_open(game: Opened, file: Path) -> bool:
    return game.session.source.path == file


@pytest.mark.slow
async def test_the_next_level_follows_and_so_does_the_next_arena(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        for name in list_levels():
            await game.press("greater_than_sign", until=partial(is_at, game, name))
        for name in list_arenas():
            await game.press("greater_than_sign", until=partial(is_at, game, name))


async def test_hurried_keys_save_just_once(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[Path] = []
    hold = Hold()

    def save_slowly(path: Path, text: str) -> None:
        save_program(path, text)
        begun.append(path)
        hold.here()

    monkeypatch.setattr("logical_robots_tui.tui.library.save_dialog.save_program", save_slowly)
    async with opened(data_dir) as game:
        await game.press("2", "x", "f2", on=SaveAs)
        assert game.app.screen.query_one(Input).value == "mine"
        await game.fill("other")
        await game.press("enter", until=lambda: begun)
        await game.press("enter", "escape")
        await game.settled()
        assert isinstance(game.app.screen, SaveAs)
        hold.release()
        await game.until(lambda: game.app.screen is game.main)
        assert (game.session.source.name, len(begun)) == ("other", 1)
        assert (data_dir / "programs" / "other.l").read_text() == "x" + PAPER
        assert (data_dir / "programs" / "mine.l").read_text() == PAPER
        assert "other" in list_programs(data_dir / "programs")
        await game.until(lambda: not list((data_dir / "drafts").glob("*.json")))


async def test_saving_asks_to_replace_and_refuses_odd_names(data_dir: Path, tmp_path: Path) -> None:
    (tmp_path / "up.l").mkdir()
    source_of(STILL, data_dir / "programs", "other")
    async with opened(data_dir) as game:
        await game.press("2", "x", "f2", on=SaveAs)
        await game.press("enter", until=lambda: game.app.screen is game.main)
        assert (data_dir / "programs" / "mine.l").read_text() == "x" + PAPER

        await game.press("f2", on=SaveAs)
        for name, why in (
            ("", "needs a name"),
            ("obstacle-avoider", "is part of the game"),
            ("a\tb", "letters"),
            (f"{tmp_path}/up", "is a folder"),
            (".hidden", "letters"),
            ("/dev/null/x", "can't be written"),
            ("~nobody-of-that-name/x", "no such home"),
            ("x" * 300, "can't be written"),
        ):
            await complains(game, name, why)
        await complains(game, "other", "enter again")
        assert (data_dir / "programs" / "other.l").read_text() == STILL
        await game.press("enter", until=lambda: game.app.screen is game.main)
        assert (data_dir / "programs" / "other.l").read_text() == "x" + PAPER


async def test_a_key_saves_one_s_own_and_asks_for_new_names(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir, text=STILL, ready=True) as game:
        mine = game.session.source.path
        await game.press("2", *"# so", "ctrl+s", until=lambda: mine.read_text() == f"# so{STILL}")
        await game.sees("Saved as mine in")
        assert game.app.screen is game.main
        game.session.saved_as(load_program("obstacle-avoider"))
        await game.press("ctrl+s", on=SaveAs)
        await game.press("escape", "escape", until=lambda: game.app.screen is game.main)
        for number, sign in enumerate("\udcff\x1b"):
            path = tmp_path / f"o{sign}n.l"  # which can't be shown, and is not proposed
            path.write_text(STILL)
            game.main.library.open_program(load_program(path))
            await game.until(partial(is_open, game, path))
            await game.press("s", on=SaveAs)
            assert game.app.screen.query_one(Input).value == ""
            await game.fill(f"own{number}")
            own = data_dir / "programs" / f"own{number}.l"
            await game.press("enter", until=partial(is_open, game, own))


def test_a_version_shows_what_would_change() -> None:
    then = Version(1, "a\nb\nc\nold\ne\n", datetime(2026, 1, 1, tzinfo=UTC), won=True)
    (name,) = (shelf := VersionShelf([then], "a\nb\nc\nd\nnew\ne\n")).names()
    card = shelf.card(name)
    assert card.headline == "★ won   +1 -2"
    assert isinstance(card.preview, Content)
    assert card.preview.plain.split("\n") == ["@ line 2", " b", " c", "-d", "-new", "+old", " e"]
    assert {INK.good, INK.bad} <= {span.style for span in card.preview.spans}
    same = VersionShelf([then], then.text).card(name)
    assert (same.headline, same.preview) == ("as it is now", then.text)
