"""Keys of the editor, as hands know them from elsewhere, and what they do to a text."""

import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.strip import Strip
from textual.widgets.text_area import Selection

from logical_robots_tui.language.services.editing import (
    find_after,
    follow_rows,
    indentation_after,
    shift_lines,
)
from logical_robots_tui.language.services.symbols import changed, renaming
from logical_robots_tui.mind import Diagnostic
from logical_robots_tui.player.settings import Settings
from logical_robots_tui.tui.program.controller import edit_outside
from logical_robots_tui.tui.program.mistakes import sign, underline_of
from tests.mind.hostile.bounds import bounded_work
from tests.terminal import Terminal
from tests.tui.conftest import PAPER, opened
from tests.tui.program.conftest import writing

THREE = "one\n  two\nthree"
LINES = st.lists(st.sampled_from("abc"), max_size=6)


async def test_lines_are_moved_duplicated_indented_and_commented_as_one_edit() -> None:
    async with writing(THREE) as desk:
        editor = desk.editor
        desk.app.post_message(events.Key("alt+x", "x"))  # it types nothing
        await desk.type("ctrl+a")
        assert editor.selected_text == THREE
        for row, keys, text, place in [
            (1, ["alt+up"], "  two\none\nthree", (0, 1)),
            (1, ["alt+down"], "one\nthree\n  two", (2, 1)),
            (0, ["alt+up"], THREE, (0, 1)),
            (2, ["alt+down"], THREE, (2, 1)),
            (0, ["ctrl+d"], "one\none\n  two\nthree", (1, 1)),
            (0, ["shift+down", "alt+down"], "three\none\n  two", (2, 1)),
            (0, ["shift+down", "ctrl+d"], "one\n  two\none\n  two\nthree", (3, 1)),
        ]:
            await desk.load(THREE, row, 1)
            await desk.type(*keys)
            assert (editor.text, editor.cursor_location) == (text, place)
            await desk.type("ctrl+z")
            assert editor.text == THREE
        await desk.load("A(x) :-\n  B(x),")
        await desk.type("ctrl+end")
        assert editor.cursor_location == (1, 7)
        await desk.type("enter", "c", "enter", "d")
        assert editor.text == "A(x) :-\n  B(x),\n  c\n  d"
        editor.selection = Selection((1, 3), (3, 0))
        await desk.type("tab")
        assert editor.text == "A(x) :-\n    B(x),\n    c\n  d"
        assert editor.selection == Selection((1, 5), (3, 0))
        await desk.type("shift+tab", "shift+tab")
        assert editor.text == "A(x) :-\nB(x),\nc\n  d"
        assert desk.app.focused is editor
        plain, commented = "a\n  b\n\nc\n", "# a\n#   b\n\nc\n"
        await desk.load(plain)
        toggle = "ctrl+underscore"
        for key in (toggle, "ctrl+z", "ctrl+y", toggle):
            expected = commented if editor.text == plain else plain
            editor.selection = Selection((0, 0), (3, 0))
            await desk.type(key)
            assert editor.text == expected


async def test_keys_that_come_at_once_are_obeyed_in_order_as_a_paste_with_brackets() -> None:
    async with writing(PAPER) as desk:
        keys = ["down", "down", "end", *["backspace"] * 2, *"abc", "left", "x", "enter", "y"]
        await desk.at_once(*keys)
        assert desk.editor.document.get_line(2) == PAPER.splitlines()[2][:-2] + "abx"
        assert desk.editor.document.get_line(3) == "yc"
        await desk.load("")
        await desk.at_once(*("ctrl+j" if letter == "\n" else letter for letter in PAPER))
        assert desk.editor.text == PAPER
        await desk.load("")
        desk.app.post_message(events.Paste(PAPER.replace("\n", "\r\n")))
        await desk.until(lambda: desk.editor.text == PAPER)


@pytest.mark.parametrize("count", [1_000, pytest.param(7_000, marks=pytest.mark.slow)])
async def test_thousands_of_lines_are_pasted_undone_and_edited_without_a_hang(count: int) -> None:
    text = "".join(f"P{number}(x) :- x in [{number}];\n" for number in range(count))
    async with writing(PAPER) as desk:
        desk.app.post_message(events.Paste(text))
        await desk.until(lambda: desk.editor.text == text + PAPER)
        for keys, edited in [
            (["ctrl+z"], PAPER),
            (["ctrl+y"], text + PAPER),
            (["ctrl+home", "a"], f"a{text}{PAPER}"),
        ]:
            await desk.type(*keys)
            assert desk.editor.text == edited


async def test_a_key_steps_over_and_deletes_what_is_seen_as_one_character() -> None:
    async with writing("") as desk:
        for cluster in ("〽️", "👨‍👩‍👧", "🇩🇪", "👍🏽", "e\u0301", "a"):
            await desk.load(f"é{cluster}🇫🇷\nx", 0, 1)
            await desk.type("right")
            assert desk.editor.cursor_location == (0, 1 + len(cluster))
            await desk.type("left")
            assert desk.editor.cursor_location == (0, 1)
            await desk.type("delete", "right", "backspace")
            assert desk.editor.text == "é\nx"
            await desk.type("right", "left", "backspace", "backspace", "backspace")
            assert desk.editor.text == "\nx"


async def test_what_is_odd_in_a_text_is_shown_as_it_is() -> None:
    async with writing("a\x1b[2Jb\x07[bold]c\n") as desk:
        assert "a␛[2Jb␇[bold]c" in desk.screen()
        assert "\x1b" not in desk.screen()
        editor = desk.editor
        await desk.load("A(1);\nB(2);\n")
        assert len(editor.get_line(1).spans) > 1
        await desk.at_once("slash", "*")  # a comment over several lines is coloured as it grows
        assert editor.text.startswith("/*")
        assert len(editor.get_line(1).spans) == 1
        await desk.type("ctrl+z")
        assert editor.text.startswith("A")
        assert len(editor.get_line(1).spans) > 1


async def test_wrapped_lines_keep_their_indentation_and_end_and_home_know_their_rows() -> None:
    line = "    Wanted(robot_name:, sensor:), " + "Sensor(robot_name:, sensor:), " * 4
    async with writing(f"{line}\nnext", size=(60, 24)) as desk:
        editor = desk.editor
        document = editor.wrapped_document
        height = document.location_to_offset((1, 0)).y
        assert height > 2
        gutter = editor.gutter_width
        rows = [editor.render_line(y).text for y in range(height)]
        assert all(row[gutter:].startswith("    ") and row[gutter + 4] != " " for row in rows)
        assert "".join(row[gutter + 4 :].rstrip() + " " for row in rows).split() == line.split()
        for column in range(len(line)):
            offset = document.location_to_offset((0, column))
            assert document.offset_to_location(offset) == (0, column)
            x = gutter + offset.x
            assert rows[offset.y][x : x + 1].strip() == line[column].strip()
        await desk.type("down", "down")
        assert document.location_to_offset(editor.cursor_location).y == 2
        editor.move_cursor((0, 10))
        columns = []
        for key in ("end", "end", "home", "home", "home"):
            await desk.type(key)
            row, column = editor.cursor_location
            assert row == 0
            columns.append(column)
        assert 10 < columns[0] < 60
        assert columns[0] < columns[2] < len(line)
        assert columns[1:2] + columns[3:] == [len(line), 4, 0]
        await desk.type("shift+end", "shift+end")
        assert editor.selected_text == line
        await desk.pilot.resize_terminal(90, 24)
        await desk.until(lambda: document.location_to_offset((1, 0)).y < height)
        await desk.type("home", *"xy")
        assert "xy" in editor.text


async def test_a_text_is_found_replaced_and_renamed_as_one_edit(data_dir: Path) -> None:
    row = PAPER.splitlines().index("  speed = 0.5,")
    async with opened(data_dir, settings=Settings(completion=False)) as game:
        editor = game.editor

        async def ask(command: str, shown: str, *keys: str) -> None:
            await game.command(command, sees=shown)
            await game.press(*keys)

        await game.press("2", "f3", sees="Find in the program")
        for keys in ([*"speed", "enter"], ["f3"]):
            editor.move_cursor((row, 2))  # the first place may be right at the cursor
            await game.press(*keys, until=lambda: editor.selected_text == "speed")
            assert editor.cursor_location == (row, 2)
        await game.press("f3", until=lambda: editor.cursor_location > (row, 2))
        assert editor.selected_text == "speed"
        await game.press("escape", until=lambda: editor.selection.is_empty)
        assert game.app.focused is editor
        await game.press("ctrl+o", sees="Find in the program")
        await game.press("tab", *"other", "ctrl+a", *"pace", "enter")
        await game.until(lambda: editor.text == PAPER.replace("speed", "pace"))
        await game.sees("Replaced in 3 places")
        await game.press("ctrl+z", until=lambda: editor.text == PAPER)
        await ask("find", "Find in the program", "ctrl+u", *"freedommotion", "tab")
        await game.until(lambda: game.app.focused and game.app.focused.id == "instead")
        await game.press("enter", sees="Nothing was replaced")
        editor.move_cursor((0, 0))
        await ask("rename", "Rename FreedomMotion", "ctrl+u", *"Free", "enter")
        await game.until(lambda: editor.text == PAPER.replace("FreedomMotion", "Free"))
        await ask("rename", "Rename Free", "ctrl+u", *"Robot", "enter")
        await game.sees("is the name of another predicate here")
        editor.move_cursor(editor.document.end)
        await ask("rename", "Put the cursor on a predicate of this program")
        editor.move_cursor((5, 15))
        await game.press("f12", until=lambda: editor.cursor_location == (0, 0))
        editor.move_cursor((0, 24))
        await game.press("f12", sees="WeightedAverage is not defined in this program")
        await game.press("S", until=lambda: "S" in editor.word)
        assert not editor.completion.display  # as it was set


@pytest.mark.slow
def test_the_player_s_own_editor_gets_the_terminal_and_gives_it_back(tmp_path: Path) -> None:
    script = tmp_path / "editor.sh"
    script.write_text('#!/bin/sh\necho elsewhere\nread answer\nsed -i "1s/^/# $answer /" "$2"\n')
    script.chmod(0o755)
    env = {"EDITOR": f"{script} --wait", "VISUAL": ""}
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "first-steps"]
    with Terminal([*game, "--data-dir", tmp_path], size=(120, 40), env=env) as terminal:
        terminal.wait_for("· applied")
        terminal.send("E", sees="elsewhere")
        terminal.send("hello\n", sees="1  # hello")
        terminal.wait_for("PAUSED")
        terminal.send("n", sees="tick 1")


@pytest.mark.parametrize(
    ("editor", "left"),
    [
        ("false", subprocess.CalledProcessError),
        ("/no/such", OSError),
        ("'", ValueError),
        ("sh -c 'echo mine > $0; exit 3'", "mine\n"),
        ("sh -c 'echo mine > $0; kill -9 $$'", "mine\n"),
        (r"sh -c 'printf caf\\351 > $0'", "caf\ufffd"),
    ],
    ids=["fails", "is missing", "has no name", "ended badly", "killed", "no UTF-8"],
)
def test_an_editor_s_text_is_taken_or_it_fails(editor: str, left: str | type[Exception]) -> None:
    with nullcontext() if isinstance(left, str) else pytest.raises(left):
        assert edit_outside("text", {"EDITOR": editor}) == left


def test_a_new_line_is_indented_as_what_is_before_it_asks() -> None:
    lines = ["", "A(x) :-", "A(x) :-  # why", "  B(x),", "  desire = {", "    f(", "  C(x);", "  "]
    assert [len(indentation_after(line)) for line in lines] == [0, 2, 2, 2, 4, 6, 0, 2]
    assert indentation_after("\tB(x),") == "\t"
    with bounded_work(2.0):
        assert indentation_after(" " * 300_000) == " " * 300_000
    # Lines go a step to the right, and back as far as they can.
    lines = ["a", "", "  b", " c", "\td"]
    assert shift_lines(lines, back=False) == ["  a", "", "    b", "   c", "  \td"]
    assert shift_lines(lines, back=True) == ["a", "", "b", "c", "d"]
    assert shift_lines(shift_lines(lines, back=False), back=True) == lines


def test_lines_are_found_again_after_a_change() -> None:
    for after, rows in (
        *(("new a b c", [1, 2, 3]), ("a new b c", [0, 2, 3]), ("a b2 c", [0, 1, 2])),
        *(("a b1 b2 c", [0, 1, 3]), ("a c", [0, None, 1]), ("a bc", [0, 1, 1])),
        *(("x y", [None, None, None]), ("", [None, None, None])),
    ):
        assert follow_rows(range(3), ["a", "b", "c"], after.split()) == rows, after


@given(LINES, LINES)
def test_a_line_beside_a_change_is_found_as_it_was(before: list[str], after: list[str]) -> None:
    places = list(range(len(before)))
    rows = [row for row in follow_rows(places, before, after) if row is not None]
    assert all(0 <= row < len(after) for row in rows)
    assert rows == sorted(rows)
    assert list(follow_rows(places, before, [*before, *after]))[: len(before)] == places


@pytest.mark.parametrize(("row", "told"), [(11, "12✗ A(x)"), (None, "    A(x)")])
def test_a_wrapped_line_has_its_sign_only_where_it_begins(row: int | None, told: str) -> None:
    line = Strip([Segment("12  "), Segment("A(x)")])
    styles = dict.fromkeys(("mistake", "mistake-gutter"), Style())
    found = sign(line, row, 4, styles, is_wrong=True)
    assert (found.text, found.cell_length) == (told, line.cell_length)


def test_what_is_wrong_is_underlined() -> None:
    line = "a Bat(x)"
    for column, text, marked in ((3, "Bat", "Bat"), (3, "", "Bat"), (6, "gone", "("), (9, "", ")")):
        underline = underline_of(Diagnostic(1, column, "wrong", excerpt=text), line)
        assert line[underline.start : underline.stop] == marked
        assert underline.is_wrong


def test_a_predicate_is_renamed_where_it_is_used_and_nowhere_else() -> None:
    text = 'A(x) :- B(x), x == "A";\n# A\nAB(x) :- ~A(x); /* A\nA */ C := A(B: A);\n'
    assert changed(text, renaming(text, 0, "New")) == (
        'New(x) :- B(x), x == "A";\n# A\nAB(x) :- ~New(x); /* A\nA */ C := New(B: New);\n'
    )


def test_what_is_looked_for_is_found_again_from_the_top() -> None:
    for wanted, place, expected in (
        *(("b", (0, 0), (0, 2)), ("b", (0, 2), (1, 0)), ("b", (1, 0), (0, 2))),
        *(("B", (0, 0), (1, 0)), ("", (0, 0), None), ("z", (0, 0), None)),
    ):
        assert find_after("a b c\nB", wanted, place) == expected
