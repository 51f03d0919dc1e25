"""The game does as the configuration file sets it, and names the keys that it sets."""

from __future__ import annotations

from asyncio import Event, gather
from typing import TYPE_CHECKING, get_args

from textual.theme import BUILTIN_THEMES
from textual.widgets import Static

from logical_robots_tui.player.settings import DrawingStyle, Settings, Theme
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.theme.themes import NIGHT
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from pathlib import Path


def test_the_choices_are_what_the_screen_can_do() -> None:
    assert get_args(Theme) == (NIGHT.name, *BUILTIN_THEMES)
    assert get_args(DrawingStyle) == tuple(style.value for style in Drawing)


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
