"""The configuration file: what it sets, and what is said about what it can't."""

from __future__ import annotations

from asyncio import Event, gather
from typing import TYPE_CHECKING

import pytest
from textual.widgets import Static

from logical_robots_tui.tui.app.settings import Settings, as_toml, read_settings
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap, key_from, with_keys
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.layout.command_bar import CommandBar
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from pathlib import Path


def settings(folder: Path, text: str) -> Settings:
    path = folder / "config.toml"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    return read_settings(path)


def test_a_missing_file_sets_nothing(tmp_path: Path) -> None:
    assert read_settings(tmp_path / "none.toml") == Settings()


def test_everything_can_be_set(tmp_path: Path) -> None:
    found = settings(
        tmp_path,
        'theme = "gruvbox"\ndrawing = "sextants"\nframes = 10\ncones = false\ntrails = false\n'
        "completion = false\nwrap = false\ndrag_robots = false\n"
        '[keys]\nrun = ["%", "F9"]\nrestart = []\ndefinition = "^]"\n',
    )
    keys = {"run": ("percent_sign", "f9"), "restart": ()}
    keys["definition"] = ("ctrl+right_square_bracket",)
    off = (False,) * 5
    assert found == ("gruvbox", Drawing.SEXTANTS, 10, *off, keys, ())


def test_a_command_without_a_key_is_found_where_the_palette_is() -> None:
    def said(text: str, keys: dict[str, tuple[str, ...]]) -> str:
        KEY_MAP.set(KeyMap(COMMANDS, keys))
        return with_keys(text)

    wanted = {"palette": ("f9",), "hint": (), "brush": ()}
    assert said("{rename} {hint} {brush} {step}", wanted) == "F9 F9 F9 n"
    assert said("{rename} {palette}", {"palette": ()}) == "Commands Commands"
    assert said("{rename} {step}", {}) == "^P n"


async def test_two_games_in_one_process_have_keys_of_their_own(data_dir: Path) -> None:
    async def bar(keys: dict[str, tuple[str, ...]], begun: Event, go_on: Event) -> str:
        async with opened(data_dir / str(len(keys)), settings=Settings(keys=keys)) as game:
            await game.ready()
            begun.set()
            await go_on.wait()
            await game.press("2", "escape")
            await game.until(lambda: "Leave" not in game.main.query_one(CommandBar).render().plain)
            return game.main.query_one(CommandBar).render().plain

    one, other = Event(), Event()
    with_another, with_the_usual = await gather(
        bar({"step": ("percent_sign",)}, one, other), bar({}, other, one)
    )
    assert "% Step" in with_another
    assert "n Step" in with_the_usual


@pytest.mark.parametrize("given", [Settings(), Settings("nord", Drawing.ASCII, 5, False, True)])
def test_what_is_printed_sets_the_same(tmp_path: Path, given: Settings) -> None:
    found = settings(tmp_path, as_toml(given))
    assert not found.complaints
    assert found.keys == {entry.id: entry.keys for entry in COMMANDS if entry.scope != "text"}
    assert as_toml(found) == as_toml(given)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("theme = 'nigth'", ":1: theme: 'nigth' is not known. Did you mean \"night\"?"),
        ("\nframes = 90", ":2: frames: 90 is not an integer from 1 to 60."),
        ("cones = 1", ":1: cones: 1 is neither true nor false."),
        ("thema = 'night'", ':1: there is no setting "thema". Did you mean "theme"?'),
        ("keys = 3", ":1: keys: this must be a table, [keys]."),
        ("[keys]\nrum = 'n'", ':2: keys: there is no command "rum". Did you mean "run"?'),
        ("[keys]\nrun = 7", ":2: keys.run: 7 is not a key; write it as a string."),
        ("[keys]\nrun = 'F13'", ':2: keys.run: there is no key "F13"; write n, ?, F5, ^R or'),
        ("[keys]\nrun = '^B'", ":2: keys.run: ^B can't be used: tmux uses it."),
        ("[keys]\nrun = 'enter'", "enter can't be used: it moves within a pane, or types."),
        ("[keys]\nrun = 'alt+x'", "many terminals can't tell it from the key without Shift or"),
        ("[keys]\nrun = 'ctrl+5'", "many terminals can't tell it from the key without Ctrl."),
        ("trails = true\n[keys]\ntrails = '^A'", ":3: keys.trails: ^A can't be used: GNU screen"),
        ("[keys]\nrun = 'n'", ":2: keys.run: n is the key of step. Give that another key, or"),
        ("[keys]\nrun = 'F9'\nstep = 'f9'", ":3: keys.step: F9 is the key of run. Give that"),
        ("theme = x", "Invalid value (at line 1, column 9). The file is ignored."),
        ("theme = " + "[" * 20_000, "it is nested too deeply. The file is ignored."),
        ("theme = '\udcff'", "it is not UTF-8 text. The file is ignored."),
    ],
)
def test_what_is_wrong_is_named_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    (complaint,) = settings(tmp_path, text).complaints
    assert complaint.startswith(str(tmp_path / "config.toml"))
    assert said in complaint


def test_a_byte_order_mark_is_no_mistake(tmp_path: Path) -> None:
    assert settings(tmp_path, "\ufeffframes = 10").frames == 10


def test_one_wrong_key_leaves_the_others(tmp_path: Path) -> None:
    found = settings(tmp_path, '[keys]\nrun = ["^B", "%"]\nrestart = "^Q"\n')
    assert found.keys == {"run": ("percent_sign",), "restart": ("r",)}


def test_editing_has_keys_of_its_own(tmp_path: Path) -> None:
    found = settings(tmp_path, '[keys]\nbrush = "n"\nuse = ["%", "enter"]\nundo = "r"\n')
    assert found.keys == {
        "brush": ("n",),
        "use": ("percent_sign", "enter"),
        "undo": ("u",),
    }
    (complaint,) = found.complaints
    assert "keys.undo: r is the key of rectangle." in complaint


def test_a_key_that_was_given_away_does_not_come_back(tmp_path: Path) -> None:
    found = settings(tmp_path, '[keys]\nrun = "n"\nstep = "^B"\n')
    assert found.keys == {"run": ("n",), "step": ("full_stop", "f8")}


@pytest.mark.parametrize(("text", "key"), [("^]", "ctrl+right_square_bracket"), (" ", "space")])
def test_keys_are_written_as_the_keyboard_names_them(text: str, key: str) -> None:
    assert key_from(text) == key


async def test_the_game_does_as_it_is_set(data_dir: Path) -> None:
    keys = {"step": ("percent_sign",), "restart": (), "editor": ("tilde",)}
    wanted = Settings("textual-light", cones=False, keys=keys, complaints=("run: odd",))
    async with opened(data_dir, text=STILL, settings=wanted) as game:
        await game.ready()
        await game.sees("run: odd")
        assert game.app.theme == "textual-light"
        assert not game.main.labyrinth.view.rays
        assert "% Step" in game.main.query_one(CommandBar).render().plain
        await game.press("percent_sign")
        await game.until(lambda: game.tick == 1)
        await game.press("n", "r", "percent_sign")
        await game.until(lambda: game.tick == 2)
        await game.press("question_mark")
        await game.until(lambda: len(game.app.screen_stack) == 2)
        shown = game.app.screen.query_one("#help", Static)
        await game.until(lambda: "%            Step" in str(shown.visual))
        assert "^P           Restart" in str(shown.visual)
        await game.press("escape", "tilde")
        await game.until(lambda: game.editor.has_focus)


async def test_what_is_said_names_the_keys_that_are_set(data_dir: Path, short: Path) -> None:
    keys = {"editor": ("tilde",), "apply": ("f9",), "hint": (), "watch": ("percent_sign",)}
    wanted = Settings(keys=keys)
    async with opened(data_dir, level=short, text=STILL, welcome=True, settings=wanted) as game:
        await game.sees("1 of 4")
        await game.press("enter")
        await game.sees("tick. ~ goes there; edit it, F9 applies")
        await game.press("enter", "enter")
        await game.sees("^P gives a")
        await game.press("enter")
        await game.ready()
        await game.press("at")
        await game.sees("% shows what is pinned")
        await game.press("W")
        await game.until(lambda: game.shows("A hint (^P)"))


async def test_a_level_is_edited_with_the_keys_that_are_set(data_dir: Path) -> None:
    keys = {"brush": ("percent_sign",), "line": (), "edit_level": ("f9",)}
    async with opened(data_dir, text=STILL, settings=Settings(keys=keys)) as game:
        await game.ready()
        await game.press("f9")
        await game.until(lambda: game.main.editing.is_on)
        await game.sees("% Brush")
        await game.sees("^P Line")
        await game.press("percent_sign")
        await game.sees("units wide")
        await game.press("M", "percent_sign")  # the former is no key of anything now
        await game.settled()
        assert game.main.editing.is_on
        await game.press("f9")
        await game.until(lambda: not game.main.editing.is_on)
