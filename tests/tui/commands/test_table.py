"""Commands: declared once, reachable by key, bar, palette and help."""

from __future__ import annotations

import subprocess
import sys
from functools import partial
from typing import TYPE_CHECKING

import pytest
from textual.binding import Binding
from textual.content import Content
from textual.events import Click
from textual.widgets import OptionList, TextArea
from textual.widgets.text_area import Selection

from logical_robots_tui.tui.commands.command import key_name
from logical_robots_tui.tui.commands.help import Palette
from logical_robots_tui.tui.commands.keymap import key_bindings
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.theme.themes import INK
from tests.tui.conftest import PAPER, opened
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.tui.commands.command import Command

ONLY_IN_THE_PALETTE = {
    *(
        "copy_result",
        "daily",
        "diagnose",
        "find_next",
        "hide_teams",
        "next_team",
        "open_replay",
        "questions",
        "race_replay",
        "rename",
        "revert",
        "save_replay",
        "screenshot",
        "settings",
        "select_all",
        "stop_measuring",
        "theme",
        "tour",
        "wrap",
    )
}
SCREEN = [entry for entry in COMMANDS if entry.scope == "screen"]
WRITING = [entry for entry in COMMANDS if entry.scope == "text"]
TAKEN_BY_OTHERS = {"ctrl+a", "ctrl+b", "ctrl+q", "ctrl+z", "ctrl+c"}


def test_no_two_commands_share_a_key_in_one_place() -> None:
    keys = [(entry.scope, key) for entry in COMMANDS for key in entry.keys]
    assert len(keys) == len(set(keys))


def test_keys_that_others_take_are_not_used() -> None:
    keys = {key for entry in SCREEN for key in entry.keys}
    assert not keys & TAKEN_BY_OTHERS
    assert not any(key.startswith("shift+") for key in keys)


@pytest.mark.parametrize("entry", COMMANDS, ids=lambda entry: entry.id)
def test_a_command_has_a_title_one_sentence_of_help_and_does_something(entry: Command) -> None:
    assert entry.title[0].isupper()
    assert len(entry.title) <= 25  # the help has no room for more
    assert entry.help[0].isupper()
    assert entry.help.endswith(".")
    assert "\n" not in entry.help
    assert callable(entry.act)


def test_each_id_and_each_title_belongs_to_one_command() -> None:
    assert len({entry.id for entry in COMMANDS}) == len(COMMANDS)
    for scopes in (("screen", "text"), ("level",)):
        titles = [entry.title for entry in COMMANDS if entry.scope in scopes]
        assert len(titles) == len(set(titles))


def test_the_table_is_read_without_loading_the_screen_or_the_game() -> None:
    script = "import sys, logical_robots_tui.tui.commands.table; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], check=True, capture_output=True, text=True, timeout=PATIENCE
    )
    loaded = set(done.stdout.split())
    assert "logical_robots_tui.tui.commands.rows" in loaded
    heavy = ("game", "mind", "world", "editing", "tui.app", "tui.inspector", "tui.level_editor")
    assert not loaded & {"numpy", "sqlite3", "textual.app", "textual.widget"}
    assert not loaded & {f"logical_robots_tui.{part}" for part in heavy}


def test_each_command_can_be_asked_for_without_function_keys() -> None:
    for entry in SCREEN:
        plain = [key for key in entry.keys if not (key[0] == "f" and key[1:].isdigit())]
        assert plain or entry.id in ONLY_IN_THE_PALETTE, entry


def test_bindings_name_every_key_once() -> None:
    bindings = key_bindings(*SCREEN).key_to_bindings
    assert sorted(bindings) == sorted(key for entry in SCREEN for key in entry.keys)
    assert all(len(bound) == 1 for bound in bindings.values())


@pytest.mark.parametrize(
    ("key", "name"),
    [("ctrl+r", "^R"), ("f5", "F5"), ("space", "space"), ("comma", ","), ("ctrl+space", "^space")],
)
def test_keys_are_named_as_on_a_keyboard(key: str, name: str) -> None:
    assert key_name(key) == name


async def test_a_click_on_the_bar_is_the_command(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        bar = game.main.query_one(CommandBar)
        column = bar.render().plain.index("Step")
        await game.click(CommandBar, offset=(column, 0))
        await game.until(lambda: game.tick == 1)


async def test_the_bar_fits_in_80_columns_and_offers_the_way_out(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        line = game.main.query_one(CommandBar).render()
        assert line.cell_length <= 80
        for words in ("space Run", "r Restart", "^R Apply", "w Why", "h Hint", "? Help", "q Quit"):
            assert words in line.plain


async def test_the_bar_in_the_editor_names_only_keys_that_work_there(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.press("2")
        await game.until(lambda: "Leave" in game.main.query_one(CommandBar).render().plain)
        line = game.main.query_one(CommandBar).render().plain
        assert "^R Apply" in line
        assert "F5 Run" in line
        assert "^S Save" in line
        assert "Quit" not in line


async def test_the_palette_finds_a_command_and_does_it(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "ctrl+p")
        await game.sees("Find a command")
        await game.press(*"half", "enter")
        view = game.main.query_one(LabyrinthView)
        await game.until(lambda: view.drawing is Drawing.HALVES)
        assert game.app.screen is game.main


def test_the_keys_for_writing_are_those_of_the_editor() -> None:
    owned = {
        key
        for binding in Binding.make_bindings([*TextArea.BINDINGS, *Editor.BINDINGS])
        for key in binding.key.split(",")
    }
    keys = [key for entry in WRITING for key in entry.keys]
    assert set(keys) <= owned


@pytest.mark.slow
async def test_what_keys_do_in_the_editor_the_palette_does_from_anywhere(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()

        async def ask_for(words: str, shown: str) -> None:
            await game.press("ctrl+p")
            await game.sees("Find a command")
            await game.press(*words)
            await game.until(lambda: shown in " ".join(game.screen().split()))
            await game.press("enter")
            await game.until(lambda: game.app.screen is game.main)

        await ask_for("commentlines", "Comment lines ^_")
        await game.until(lambda: game.editor.text == f"# {PAPER}")
        assert game.editor.has_focus
        await ask_for("undointhe", "Undo in the program ^Z")
        await game.until(lambda: game.editor.text == PAPER)
        await game.press("escape")
        await ask_for("redointhe", "Redo in the program ^Y")
        await game.until(lambda: game.editor.text == f"# {PAPER}")
        game.editor.put(f"Fr\n{PAPER}")
        game.editor.move_cursor((0, 2))
        await game.press("escape")
        await ask_for("completethe", "Complete the word ^space")
        await game.until(lambda: game.editor.completion.display)
        assert "FreedomMotion" in game.editor.completion.names
        await game.press("escape")
        await game.until(lambda: not game.editor.completion.display)
        await ask_for("copy", "Copy ^C")
        await game.sees("Select something to copy first.")


@pytest.mark.slow
async def test_each_command_for_writing_does_what_its_key_does(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        editor = game.editor

        def state() -> tuple[object, ...]:
            return editor.text, editor.selection, editor.completion.display, game.app.clipboard

        def differs(before: object) -> bool:
            return state() != before

        def is_like(by_key: object) -> bool:
            return state() == by_key

        async def begin(entry: Command) -> tuple[object, ...]:
            await game.press("2")
            await game.until(lambda: editor.has_focus)
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
            await game.press(*entry.keys)
            await game.until(partial(differs, before))
            by_key = state()
            await game.press("escape", "escape")
            await game.until(lambda: not editor.has_focus)
            await begin(entry)
            await game.press("escape")
            await game.until(lambda: not editor.has_focus)
            game.main.action_command(entry.id)
            await game.until(partial(is_like, by_key))
            assert editor.has_focus
            editor.completion.close()
            await game.press("escape")
            await game.until(lambda: not editor.has_focus)


async def test_the_help_begins_with_what_the_player_works_in(data_dir: Path) -> None:
    async with opened(data_dir) as game:

        async def headings(about: str) -> list[str]:
            await game.press("f1")
            await game.sees(f"Help · {about}")
            shown = game.app.screen.query_one("#help", LinesView)
            await game.until(lambda: "Restart" in shown.plain)
            await game.press("escape")
            await game.until(lambda: game.app.screen is game.main)
            return [line for line in shown.plain.splitlines() if line[:1].isalpha()][:5]

        assert "Running" in await headings("map")
        await game.press("2")
        assert "In the program" in await headings("editor")
        await game.press("escape", "3")
        assert "In the inspector" in await headings("inspector")
        await game.press("T")
        await game.until(lambda: game.main.focused is game.main.timeline)
        assert "In the timeline" in await headings("timeline")
        await game.press("M")
        await game.until(lambda: game.main.editing.is_on)
        assert "In the level editor" in await headings("editing")


async def test_the_help_shows_what_matches_the_typed_words(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.press("question_mark", *"watch pin")
        shown = game.app.screen.query_one("#help", LinesView)
        await game.until(lambda: "Restart" not in shown.plain and "Watch" in shown.plain)
        await game.press(*"qqq")
        await game.sees("No matches.")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)


async def test_a_click_where_the_window_has_been_is_none_on_the_palette(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("ctrl+p")
        await game.until(lambda: isinstance(game.app.screen, Palette))
        palette = game.app.screen
        palette.post_message(Click(palette, 500, 200, 0, 0, 1, False, False, False, 500, 200))
        await game.handled()
        assert game.app._exception is None
        assert game.app.screen is palette


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=["80x24", "120x40"])
async def test_the_palette_shows_keys_at_the_right_in_their_colour(
    data_dir: Path, size: tuple[int, int]
) -> None:
    async with opened(data_dir, size=size) as game:
        await game.press("ctrl+p")
        both = ("space · F5", "n · . · F8")
        await game.until(lambda: all(game.shows(keys) for keys in both))
        # To the right of the palette the game may shine through.
        lines = game.screen().splitlines()
        (run,), (step,) = ([each for each in lines if keys in each] for keys in both)
        end = run.index(both[0]) + len(both[0])
        assert step.index(both[1]) + len(both[1]) == end > 0.8 * size[0]
        options = game.app.screen.query_one(OptionList)
        prompt = options.get_option_at_index(0).prompt
        assert isinstance(prompt, Content)
        assert prompt.plain.startswith("Run or pause ")
        inks = [span.style for span in prompt.spans if prompt.plain[span.start : span.end] == "F5"]
        assert inks == [INK.key]


async def test_the_help_lists_every_command_with_its_keys(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("question_mark")
        await game.until(lambda: len(game.app.screen_stack) == 2)
        shown = game.app.screen.query_one("#help", LinesView)
        await game.until(lambda: "Restart" in shown.plain)
        for entry in COMMANDS:
            assert entry.title in shown.plain
            assert " · ".join(map(key_name, entry.keys)) in shown.plain
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)


async def test_rays_and_the_way_of_drawing_change_by_key(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        view = game.main.query_one(LabyrinthView)
        await game.press("y", "d")
        await game.until(lambda: not view.rays and view.drawing is Drawing.HALVES)
        await game.press("d")
        await game.until(lambda: view.drawing is Drawing.SEXTANTS)
        await game.press("d")
        await game.until(lambda: view.drawing is Drawing.ASCII)
        await game.press("y", "d")
        await game.until(lambda: view.rays and view.drawing is Drawing.QUADRANTS)


async def test_q_leaves_and_so_does_a_second_ctrl_c_but_not_ctrl_q(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("ctrl+q", "ctrl+c")
        await game.sees("^C again to quit, or q")
        assert game.app.is_running
        await game.press("ctrl+c")
        await game.until(lambda: not game.app.is_running)
    async with opened(data_dir) as game:
        await game.press("q")
        await game.until(lambda: not game.app.is_running)


async def test_a_robot_is_chosen_by_click_in_the_labyrinth_and_in_the_inspector(
    data_dir: Path,
) -> None:
    async with opened(data_dir, level="team_goal") as game:
        view = game.main.query_one(LabyrinthView)
        await game.sees("robot  ")
        place = next(
            (column, row)
            for row in range(view.size.height)
            for column in range(view.size.width)
            if view.robot_at(column, row) == "R"
        )
        await game.click(LabyrinthView, offset=place)
        await game.until(lambda: view.selected == "R")
        await game.sees('R remembers ""')
        await game.click("#robots", offset=(3, 2))
        await game.until(lambda: view.selected == "Q")


@pytest.mark.parametrize(
    ("typed", "first"),
    [
        ("daily", "daily"),
        ("replay", "save_replay"),
        ("theme", "theme"),
        ("settings", "settings"),
        ("speed", "slower"),
        ("export", "copy_rows"),
        ("colours", "theme"),
        ("next lev", "next_level"),
        ("why", "why"),
        ("step", "step"),
    ],
)
def test_the_palette_finds_by_words_the_best_first(typed: str, first: str) -> None:
    found = [(entry.match(typed.split()), entry.id) for entry in COMMANDS]
    best = max(score for score, _ in found)
    assert next(name for score, name in found if score == best) == first


def test_scattered_letters_find_nothing() -> None:
    assert not [entry.id for entry in COMMANDS if entry.match(["rpl"]) or entry.match(["ettings"])]
