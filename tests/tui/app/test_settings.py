"""The game does as the configuration file sets it, and names the keys that it sets."""

from asyncio import Event, gather
from pathlib import Path
from typing import get_args

import pytest
from textual.theme import BUILTIN_THEMES

from logical_robots_tui.errors import InputError
from logical_robots_tui.player import settings
from logical_robots_tui.player.recorder import THEME, ProgressRecorder
from logical_robots_tui.player.settings import Setting, Settings, read_settings, rows, write_setting
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.app.settings_screen import SettingsScreen, ThemeList, next_value
from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.theme.themes import NIGHT
from tests.tui.conftest import STILL, Opened, Size, at_both_sizes, opened


def test_the_choices_are_what_the_screen_can_do() -> None:
    assert get_args(settings.Theme) == (NIGHT.name, *BUILTIN_THEMES)
    assert get_args(settings.DrawingStyle) == tuple(style.value for style in Drawing)


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


async def test_the_game_and_the_level_editor_do_as_they_are_set(data_dir: Path) -> None:
    keys = {"step": ("percent_sign",), "restart": (), "editor": ("tilde",)}
    keys |= {"brush": ("percent_sign",), "line": (), "edit_level": ("f9",)}
    wanted = Settings("textual-light", cones=False, keys=keys, complaints=("run: odd",))
    async with opened(data_dir, text=STILL, settings=wanted, ready=True) as game:
        await game.sees("run: odd")
        assert game.app.theme == "textual-light"
        assert not game.main.labyrinth.view.rays
        assert "% Step" in game.main.query_one(CommandBar).render().plain
        await game.press("percent_sign", tick=1)
        await game.press("n", "r", "percent_sign", tick=2)
        await game.press("question_mark", until=lambda: len(game.app.screen_stack) == 2)
        shown = game.app.screen.query_one("#help", LinesView)
        await game.until(lambda: "%            Step" in shown.plain)
        assert "palette      Restart" in shown.plain
        await game.press("escape", "tilde", until=lambda: game.editor.has_focus)

        await game.press("escape", "f9", until=lambda: game.main.editing.is_on)
        await game.sees("% Brush", "^P Line")
        await game.press("percent_sign", sees="units wide")
        await game.press("M", "percent_sign")  # the former is no key of anything now
        await game.settled()
        assert game.main.editing.is_on
        await game.press("f9", until=lambda: not game.main.editing.is_on)


async def test_what_is_said_names_the_keys_that_are_set(data_dir: Path, short: Path) -> None:
    keys = {"editor": ("tilde",), "apply": ("f9",), "hint": (), "watch": ("percent_sign",)}
    wanted = Settings(keys=keys)
    async with opened(data_dir, level=short, text=STILL, welcome=True, settings=wanted) as game:
        await game.sees("1 of 4")
        await game.press("enter", sees="tick. ~ goes there; edit it, F9 applies")
        await game.press("enter", "enter", sees="gives a hint")
        await game.press("enter")
        await game.ready()
        await game.press("at", sees="% shows what is pinned")
        await game.press("W", sees="A hint (^P)")


async def change(game: Opened, name: str, *keys: str) -> None:
    await game.press("ctrl+p", sees="Find a command")
    await game.press(*"settings", "enter")
    await game.until(lambda: isinstance(game.app.screen, SettingsScreen))
    await game.press(*name, *keys, "escape")  # typing filters
    await game.until(lambda: game.app.screen is game.main)


@at_both_sizes
async def test_a_theme_is_previewed_and_it_and_settings_are_kept(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch, size: Size
) -> None:
    settings_file = data_dir / "config" / "config.toml"
    monkeypatch.setattr("logical_robots_tui.tui.app.app.settings_path", lambda: settings_file)
    async with opened(data_dir, text=STILL, size=size, ready=True) as game:
        before, screen = game.app.theme, game.main
        command("theme").run(screen, screen.ui.spawn)
        await game.until(lambda: isinstance(game.app.screen, ThemeList))
        assert game.shows(f"▸ {before}")
        await game.press("down", until=lambda: game.app.theme != before)
        await game.press(*"monok", until=lambda: game.app.theme == "monokai")
        await game.until(lambda: not game.shows("gruvbox"))
        await game.press(*["backspace"] * 5, sees="gruvbox")
        await game.press(*"xyzzy", "enter", "escape")
        await game.until(lambda: game.app.theme == before and game.app.screen is screen)
        command("theme").run(screen, screen.ui.spawn)
        await game.until(lambda: isinstance(game.app.screen, ThemeList))
        await game.press("down", "enter", until=lambda: game.app.screen is screen)
        chosen = game.app.theme
        assert chosen != before
        await game.settled()
        assert not [*settings_file.parent.glob("*")]

        await change(game, "cones", "right")
        assert not game.main.labyrinth.view.rays
        await game.until(settings_file.exists)
        game.main.labyrinth.view.trails = False  # by its key: other settings leave it so
        await change(game, "frames", "left", "left")
        assert game.main.scheduler.rate.frames == 28
        await change(game, "drawing", "right")
        assert game.main.labyrinth.view.drawing is Drawing.QUADRANTS
        await game.until(lambda: "drawing" in settings_file.read_text())
        assert not game.main.labyrinth.view.trails
    kept = read_settings(settings_file, lambda *_: {})
    assert kept[:-1] == Settings(cones=False, frames=28, drawing="quadrants")[:-1]
    assert not kept.complaints
    recorder = ProgressRecorder(data_dir / FILE_NAME)
    assert recorder.progress.fact(THEME) == chosen
    recorder.progress.close()


def test_writing_a_setting_keeps_the_rest_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "config.toml"
    file.write_text('# mine\nframes = 10 # few\n\n[keys]\nrun = ["space"]\n')
    write_setting(file, "frames", 20)
    write_setting(file, "theme", "nord")
    assert file.read_text() == (
        '# mine\nframes = 20 # few\ntheme = "nord"\n\n[keys]\nrun = ["space"]\n'
    )
    write_setting(file, "theme", None)
    assert "theme" not in file.read_text()
    file.write_text("frames = = 3")
    with pytest.raises(InputError, match=r"can't be saved in .*config.toml.*not valid TOML"):
        write_setting(file, "frames", 20)
    assert file.read_text() == "frames = = 3"


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.name)
def test_changing_a_setting_goes_through_all_its_values(row: Setting) -> None:
    value, seen = row.default, []
    for _ in range(30):
        value = next_value(row, value, 1)
        assert value is None or row.kind.allows(value)
        seen.append(value)
    assert next_value(row, next_value(row, row.default, 1), -1) == row.default
    assert {*row.kind.choices} <= {*seen}
