"""Commands: declared once, reachable by key, bar, palette and help."""

import sys
from collections import Counter
from functools import partial
from itertools import product
from pathlib import Path

import pytest
from textual.binding import Binding
from textual.content import Content
from textual.events import Click
from textual.widgets import OptionList, TextArea
from textual.widgets.text_area import Selection

from logical_robots_tui.tui.commands.command import Command, key_name
from logical_robots_tui.tui.commands.help import PaletteScreen
from logical_robots_tui.tui.commands.keymap import KeyMap, key_bindings
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.theme.themes import INK
from tests.processes import run_command
from tests.tui.conftest import Size, at_both_sizes, opened

SCREEN = [entry for entry in COMMANDS if entry.scope == "screen" and not entry.needs]
WRITING = [entry for entry in COMMANDS if entry.scope == "text"]
TAKEN_BY_OTHERS = {"ctrl+a", "ctrl+b", "ctrl+q", "ctrl+z", "ctrl+c"}


def test_no_two_commands_share_an_id_or_a_key_or_a_title_in_one_place() -> None:
    assert len({entry.id for entry in COMMANDS}) == len(COMMANDS)
    keys = Counter((entry.scope, key) for entry in COMMANDS for key in entry.keys)
    titles = Counter((entry.scope == "level", entry.title) for entry in COMMANDS)
    assert not [shared for shared, count in (keys | titles).items() if count > 1]


def test_bindings_name_every_key_once_and_none_that_others_take() -> None:
    bindings = key_bindings(*SCREEN).key_to_bindings
    assert sorted(bindings) == sorted(key for entry in SCREEN for key in entry.keys)
    assert all(len(bound) == 1 for bound in bindings.values())
    assert not bindings.keys() & TAKEN_BY_OTHERS
    assert not any(key.startswith("shift+") for key in bindings)
    keys = ("ctrl+r", "f5", "space", "comma", "ctrl+space")
    assert [key_name(key) for key in keys] == ["^R", "F5", "space", ",", "^space"]


def test_a_command_has_a_title_one_sentence_of_help_and_does_something() -> None:
    for entry in COMMANDS:
        assert entry.title[0].isupper(), entry
        assert len(entry.title) <= 25, entry  # the help has no room for more
        assert entry.help[0].isupper(), entry
        assert entry.help.endswith("."), entry
        assert "\n" not in entry.help, entry
        assert callable(entry.act), entry


def test_the_table_is_read_without_loading_the_screen_or_the_game() -> None:
    script = "import sys, logical_robots_tui.tui.commands.table; print(*sys.modules)"
    loaded = set(run_command([sys.executable, "-c", script], check=True).stdout.split())
    assert "logical_robots_tui.tui.commands.general" in loaded
    heavy = ("game", "mind", "world", "editing", "tui.app", "tui.inspector", "tui.level_editor")
    assert not loaded & {"numpy", "sqlite3", "textual.app", "textual.widget"}
    assert not loaded & {f"logical_robots_tui.{part}" for part in heavy}


def test_the_keys_for_writing_are_those_of_the_editor() -> None:
    bindings = Binding.make_bindings([*TextArea.BINDINGS, *Editor.BINDINGS])
    owned = ",".join(binding.key for binding in bindings).split(",")
    assert {key for entry in WRITING for key in entry.keys} <= set(owned)


def test_the_palette_finds_by_words_the_best_first_and_nothing_by_scattered_letters() -> None:
    def best(typed: str) -> str | None:
        scores = {entry.id: entry.match(typed.split()) for entry in COMMANDS}
        name = max(scores, key=lambda name: scores[name])
        return name if scores[name] else None

    ids = ["daily", "theme", "settings", "why", "step"]
    assert [best(typed) for typed in ids] == ids
    words = {"replay": "save_replay", "speed": "slower", "export": "copy_rows", "colours": "theme"}
    assert ({typed: best(typed) for typed in words}, best("next lev")) == (words, "next_level")
    assert best("rpl") is best("ettings") is None


async def test_the_bar_fits_in_80_columns_and_a_click_on_it_is_the_command(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24), ready=True) as game:
        bar = game.main.query_one(CommandBar)
        line = bar.render()
        assert line.cell_length <= 80
        for words in ("space Run", "r Restart", "^R Apply", "w Why", "h Hint", "? Help", "q Quit"):
            assert words in line.plain
        await game.click(CommandBar, offset=(line.plain.index("Step"), 0))
        await game.until(lambda: game.tick == 1)
        view = game.main.query_one(LabyrinthView)
        await game.press("y", "d", until=lambda: not view.rays and view.drawing is Drawing.HALVES)
        for key, drawing in [("d", Drawing.SEXTANTS), ("d", Drawing.ASCII)]:
            await game.press(key, until=partial(lambda drawing: view.drawing is drawing, drawing))
        await game.press("y", "d", until=lambda: view.rays and view.drawing is Drawing.QUADRANTS)
        await game.press("2", until=lambda: "Leave" in bar.render().plain)
        assert all(words in bar.render().plain for words in ("^R Apply", "F5 Run", "^S Save"))
        assert "Quit" not in bar.render().plain


@at_both_sizes
async def test_the_palette_colours_keys_and_finds_commands(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, size=size, ready=True) as game:
        await game.press("2", "ctrl+p", sees="Find a command")
        both = ("space · F5", "n · . · F8")
        await game.until(lambda: all(game.shows(keys) for keys in both))
        # To the right of the palette the game may shine through.
        lines = game.screen().splitlines()
        (run,), (step,) = ([line for line in lines if keys in line] for keys in both)
        end = run.index(both[0]) + len(both[0])
        assert step.index(both[1]) + len(both[1]) == end > 0.8 * size[0]
        palette = game.app.screen
        assert isinstance(palette, PaletteScreen)
        prompts = [option.prompt for option in palette.query_one(OptionList).options]
        prompt = prompts[0]
        assert isinstance(prompt, Content)
        assert prompt.plain.startswith("Run or pause ")
        inks = [span.style for span in prompt.spans if prompt.plain[span.start : span.end] == "F5"]
        assert inks == [INK.key]
        # Each command can be asked for without function keys: here, if not with a key of its own.
        offered = [str(prompt).partition("  ")[0] for prompt in prompts]
        (by_key,) = (entry for entry in SCREEN if entry.id == "palette")
        assert "ctrl+p" in by_key.keys
        assert {entry.title for entry in (*SCREEN, *WRITING)} == {by_key.title, *offered}
        await game.press(*"half", "enter")
        await game.until(lambda: game.main.labyrinth.view.drawing is Drawing.HALVES)
        assert game.main.is_active
        await game.press("ctrl+p", on=PaletteScreen)
        palette = game.app.screen
        # A click where the window has been is none on the palette.
        palette.post_message(Click(palette, 500, 200, 0, 0, 1, False, False, False, 500, 200))
        await game.handled()
        assert game.app._exception is None
        assert game.app.screen is palette


@pytest.mark.slow
async def test_each_command_for_writing_does_what_its_key_does(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        editor = game.editor

        def state() -> tuple[object, ...]:
            return editor.text, editor.selection, editor.completion.display, game.app.clipboard

        async def leave() -> None:
            game.main.set_focus(game.main.labyrinth)  # the selection stays
            await game.until(lambda: not editor.has_focus)

        async def begin(entry: Command) -> tuple[object, ...]:
            await game.press("2", until=lambda: editor.has_focus)
            editor.load_text("  one\n")
            editor.put("  one,Sq\nthree\n")
            if entry.id == "redo_edit":
                editor.undo()
            editor.move_cursor({"redo_edit": (0, 6), "move_up": (1, 0)}.get(entry.id, (0, 8)))
            if entry.id == "copy":
                editor.selection = Selection((0, 2), (0, 5))
            game.app.copy_to_clipboard("before")
            return state()

        for entry in WRITING:
            before = await begin(entry)
            await game.press(entry.keys[0], until=partial(lambda before: state() != before, before))
            by_key = state()
            await game.press("escape")
            await leave()
            await begin(entry)
            await leave()
            await game.command(entry.id, until=partial(lambda by_key: state() == by_key, by_key))
            assert editor.has_focus
            editor.completion.close()
            await leave()
        await game.command("copy", sees="Select something to copy first.")


async def test_the_help_lists_every_command_and_begins_with_what_is_in_use(data_dir: Path) -> None:
    async with opened(data_dir) as game:

        async def help_about(about: str, key: str = "f1") -> LinesView:
            await game.press(key, sees=f"Help · {about}")
            shown = game.app.screen.query_one("#help", LinesView)
            await game.until(lambda: "Restart" in shown.plain)
            return shown

        def begins_with(shown: LinesView, heading: str) -> bool:
            return heading in [line for line in shown.plain.splitlines() if line[:1].isalpha()][:5]

        async def leave_dialog() -> None:
            await game.press("escape", until=lambda: game.app.screen is game.main)

        shown = await help_about("map", "question_mark")
        for entry in KeyMap(COMMANDS).available:
            assert entry.title in shown.plain
            assert " · ".join(map(key_name, entry.keys)) in shown.plain
        assert begins_with(shown, "Running")
        await game.press(*"watch pin")
        await game.until(lambda: "Restart" not in shown.plain and "Watch" in shown.plain)
        await game.press(*"qqq", sees="No matches.")
        await leave_dialog()
        for keys, about, heading in [
            ("2", "editor", "In the program"),
            ("escape 3", "inspector", "In the inspector"),
            ("T", "timeline", "In the timeline"),
            ("M", "editing", "In the level editor"),
        ]:
            await game.press(*keys.split())
            await game.settled()
            assert begins_with(await help_about(about), heading)
            await leave_dialog()
        await game.resize(80, 24, until=lambda: game.app.size == (80, 24))
        shown = await help_about("editing")
        assert shown.size.width >= 75, "it takes the whole screen"
        assert max(map(len, shown.plain.splitlines())) <= shown.size.width


async def test_a_click_chooses_a_robot_and_q_or_two_ctrl_c_leave_the_game(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        view = game.main.query_one(LabyrinthView)
        await game.sees("robot  ")
        places = product(range(view.size.width), range(view.size.height))
        place = next(place for place in places if view.robot_at(*place) == "R")
        await game.click(LabyrinthView, offset=place, until=lambda: view.selected == "R")
        await game.sees('R remembers ""')
        await game.click("#robots", offset=(3, 2), until=lambda: view.selected == "Q")
        await game.press("ctrl+q", "ctrl+c", sees="^C again to quit, or q")
        assert game.app.is_running
        await game.press("ctrl+c", until=lambda: not game.app.is_running)
