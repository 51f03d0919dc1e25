"""Keys of the editor, as hands know them from elsewhere."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest
from textual import events

from logical_robots_tui.tui.program.completion import Word, lines_of
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

LONG = "  Wanted(robot_name:, sensor:) :- " + "Sensor(robot_name:, sensor:), " * 5
THREE = "one\n  two\nthree"


async def put(game: Opened, text: str, row: int, column: int) -> None:
    await game.ready()
    await game.press("2")
    game.editor.load_text(text)
    game.editor.move_cursor((row, column))
    await game.settled()


def is_at(game: Opened, row: int, column: int) -> bool:
    return game.editor.cursor_location == (row, column)


async def test_end_and_home_go_to_the_row_first_and_then_to_the_line(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await put(game, f"{LONG}\nnext", 0, 10)
        await game.press("end")
        await game.until(lambda: 10 < game.editor.cursor_location[1] < 60)
        row_end = game.editor.cursor_location[1]
        await game.press("end")
        await game.until(partial(is_at, game, 0, len(LONG)))
        await game.press("home")
        await game.until(lambda: row_end < game.editor.cursor_location[1] < len(LONG))
        await game.press("home")
        await game.until(partial(is_at, game, 0, 2))
        await game.press("home")
        await game.until(partial(is_at, game, 0, 0))
        await game.press("shift+end", "shift+end")
        await game.until(lambda: game.editor.selected_text == LONG)


@pytest.mark.parametrize(
    ("row", "keys", "text", "place"),
    [
        (1, ["alt+up"], "  two\none\nthree", (0, 1)),
        (1, ["alt+down"], "one\nthree\n  two", (2, 1)),
        (0, ["alt+up"], THREE, (0, 1)),
        (2, ["alt+down"], THREE, (2, 1)),
        (0, ["ctrl+d"], "one\none\n  two\nthree", (1, 1)),
        (0, ["shift+down", "alt+down"], "three\none\n  two", (2, 1)),
        (0, ["shift+down", "ctrl+d"], "one\n  two\none\n  two\nthree", (3, 1)),
    ],
)
async def test_lines_are_moved_and_duplicated(
    data_dir: Path, row: int, keys: list[str], text: str, place: tuple[int, int]
) -> None:
    async with opened(data_dir, text="") as game:
        await put(game, THREE, row, 1)
        await game.press(*keys)
        await game.until(lambda: game.editor.text == text and is_at(game, *place))
        await game.press("ctrl+z")
        await game.until(lambda: game.editor.text == THREE)


async def test_ctrl_a_selects_all_and_alt_with_a_letter_types_nothing(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await put(game, THREE, 0, 0)
        game.app.post_message(events.Key("alt+x", "x"))
        await game.press("ctrl+a")
        await game.until(lambda: game.editor.selected_text == THREE)


async def slowly(game: Opened, key: str) -> None:
    """Press a key so long after the last one that it was not pasted."""
    await game.later(0.1)
    await game.press(key)


async def test_tab_completes_what_is_begun_and_indents_elsewhere(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await put(game, "R(x) :- x == sensor.forw", 0, 24)
        await slowly(game, "tab")
        await game.until(lambda: game.editor.completion.display)
        await slowly(game, "enter")
        await game.until(lambda: game.editor.text.startswith("R(x) :- x == sensor.forward_"))
        await put(game, "R(x) :- Weig", 0, 12)
        await slowly(game, "tab")
        await game.until(lambda: game.editor.text == "R(x) :- WeightedAverage")
        await put(game, "R(x) :- ", 0, 8)
        await slowly(game, "tab")
        await game.until(lambda: game.editor.text == "R(x) :-   ")
        await put(game, "R(x) :- zzz", 0, 11)
        await slowly(game, "tab")
        await game.until(lambda: game.editor.text == "R(x) :- zzz ")


async def test_words_are_offered_after_a_burst_of_keys(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await put(game, "", 0, 0)
        await game.press(*"x == sensor.")
        await game.until(lambda: game.editor.completion.display)
        assert game.editor.text == "x == sensor."
        await game.press("escape")
        await put(game, "", 0, 0)
        await game.press(*"S(x); y")
        await game.later(1)
        assert not game.editor.completion.display


@pytest.mark.parametrize("width", [34, 74, 90])
def test_nothing_that_is_said_of_a_word_is_cut(width: int) -> None:
    words = [
        Word("Least", "Least(x, y, ...)", "the least of its arguments"),
        Word("Long", f"Long({', '.join('abcdefghijklm')})", "what has a long shape " * 3),
    ]
    for word, line in zip(words, lines_of(words, width), strict=True):
        said = " ".join(line.plain.split())
        assert word.told.strip() in said
        assert all(len(row.rstrip()) <= width for row in line.plain.split("\n"))


async def test_wrapped_lines_keep_their_indentation(data_dir: Path) -> None:
    line = "    Wanted(robot_name:, sensor:), " + "Sensor(robot_name:, sensor:), " * 4
    async with opened(data_dir, text="") as game:
        await put(game, f"{line}\nnext", 0, 0)
        editor = game.editor
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
        await game.press("down", "down")
        await game.until(lambda: document.location_to_offset(editor.cursor_location).y == 2)
        await game.pilot.resize_terminal(80, 24)
        await game.until(lambda: document.location_to_offset((1, 0)).y < height)
        await game.press("home", *"xy")
        await game.until(lambda: "xy" in editor.text)
