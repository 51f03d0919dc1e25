"""Help while a program is written."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.player.settings import Settings
from logical_robots_tui.tui.program.completion import (
    Place,
    call_before,
    definitions,
    help_on,
    word_around,
    word_before,
    words_for,
)
from logical_robots_tui.tui.program.controller import edit_outside
from logical_robots_tui.tui.program.editor import find_after, rename
from tests.mind.hostile.bounds import bounded_work
from tests.terminal import Terminal
from tests.tui.conftest import PAPER, STILL, WRONG, opened
from tests.tui.program.test_warnings import ODD

if TYPE_CHECKING:
    from pathlib import Path


def names(text: str, before: str) -> list[str]:
    """The words offered after a line that is added to a text."""
    text = f"{text}\n{before}"
    return [word.name for word in words_for(text, Place(text.count("\n"), len(before)))]


def test_predicates_and_functions_that_fit_are_offered() -> None:
    assert "FreedomMotion" in names(PAPER, "  x = Fr")
    assert "Sqrt" in names(PAPER, "  x = Sq")
    assert "Sensor" in names("", "Se")
    assert word_before("  x = Fr") == "Fr"


def test_after_a_dot_fields_are_offered() -> None:
    assert {"forward_distance", "forward_object"} <= set(names("", "sensor.forw"))
    assert "Sqrt" not in names("", "sensor.")
    assert "angle" not in names("", "sensor.")
    assert "angle" in names("", "ray.")
    assert "goal_seen" in names("Robot(memory: {goal_seen: 1});", "memory.go")


def test_variables_of_the_rule_come_first_then_fields_predicates_and_functions() -> None:
    before = "Rays(x) = 1;\nF(radar, rag) = Min{ray.distance :- ray in ra"
    assert names("Other(rat) = 1;", before)[:4] == ["radar", "rag", "ray", "Rays"]
    assert "rat" not in names("Other(rat) = 1;", before)
    assert names("", "P(sensor) :- x == S")[0] == "Sensor"
    assert names("", "P(sensor) :- x == s")[0] == "sensor"
    assert names("", "P() :- Sensor(robot_name:, sensor:), sensor.radar == ra")[0] == "sensor.radar"


def test_comments_and_quotes_offer_nothing_and_are_not_offered() -> None:
    text = '# memory.secret, both sides alike: x\nRobot(memory: {here: "memory.quoted"});'
    assert names(text, "memory.") == names("Robot(memory: {here: 1});", "memory.")
    assert names(text, "# Sq") == []
    assert names(text, "# see ") == []
    assert names(text, 'x = "Sq') == []
    assert "Sqrt" in names(text, 'x = "Sq", Sq')


def test_fields_used_with_a_name_come_first() -> None:
    assert names("A(x) :- x.zeal > 1, y.able > 1;", "B(x) :- x.")[0] == "zeal"


def test_definitions_are_the_first_lines_that_begin_with_a_predicate() -> None:
    found = definitions("# C(c)\nA(x) :- B(x);\nB(y) :-\n  C(y);\nA(z);\nD := E(F: G);\nH")
    assert {name: place.line for name, (place, _) in found.items()} == {"A": 1, "B": 2, "D": 5}
    assert found["A"][1] == "A(x)"


@pytest.mark.parametrize(
    ("before", "name"),
    [
        ("x = Least(1, ", "Least"),
        ("x = Least(1, Sqrt(2), ", "Least"),
        ("x = Min{ray.distance :- ", "Min"),
        ("x = Least(1)", ""),
        ("x = (1 + ", ""),
        ("A(b: [c, {d: ", "A"),
    ],
)
def test_the_call_is_the_innermost_that_is_open(before: str, name: str) -> None:
    assert call_before(before) == name


@pytest.mark.parametrize(
    "text",
    ["(" * 150_000, "A" * 150_000, "A" * 150_000 + "!(", "x [ " * 40_000, " " * 150_000 + "{"],
)
def test_the_longest_line_is_looked_at_in_time(text: str) -> None:
    with bounded_work():
        call_before(text)
        word_before(text)
        words_for(text, Place(0, len(text)))
        word_around(text, len(text))


@given(st.text(), st.integers(0, 20))
def test_any_text_is_looked_at_without_harm(text: str, column: int) -> None:
    definitions(text)
    words_for(text, Place(0, column))
    call_before(text)
    assert word_around(text, column) in text


def test_help_is_on_own_predicates_before_the_game_s() -> None:
    own = help_on("Sensor(x);", "Sensor")
    given = help_on("", "Sensor")
    assert own is not None
    assert given is not None
    assert own.told == "defined in line 1"
    assert "sensor readings" in given.told
    assert help_on("", "Nothing") is None


async def test_a_word_is_completed_by_key(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2", *"Wei", "ctrl+space")
        await game.sees("WeightedAverage{")
        await game.press("enter")
        await game.until(lambda: game.editor.text == "WeightedAverage")
        assert not game.editor.completion.display


@pytest.mark.parametrize(("typed", "first"), [("sensor.", "clock"), ("S", "Sensor")])
async def test_a_dot_or_a_capital_letter_opens_the_list(
    typed: str, first: str, data_dir: Path
) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2")
        for key in typed:
            await game.later(0.1)  # what comes faster is a paste
            assert not game.editor.completion.display
            await game.press(key)
        await game.until(lambda: game.editor.completion.display)
        assert game.editor.completion.names[0] == first


async def test_a_number_opens_no_list_and_a_setting_turns_it_off(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2", "0", ".", "5")
        await game.until(lambda: game.editor.text == "0.5")
        assert not game.editor.completion.display
    other = data_dir / "other"
    async with opened(other, text="", settings=Settings(completion=False)) as game:
        await game.press("2", "S")
        await game.until(lambda: game.editor.text.endswith("S"))
        assert not game.editor.completion.display


async def test_the_list_follows_what_is_typed_and_escape_closes_it(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2", "S", "ctrl+space")
        await game.until(lambda: game.editor.completion.display)
        await game.press("q")
        await game.until(lambda: game.editor.completion.option_count == 1)
        await game.press("escape")
        await game.until(lambda: not game.editor.completion.display)
        assert game.main.focused is game.editor
        await game.press("tab")
        await game.until(lambda: game.editor.text == "Sq  ")
        await game.press(*"Sqr", "ctrl+space")
        await game.until(lambda: game.editor.completion.display)
        await game.press("t")
        await game.until(lambda: game.editor.text == "Sq  Sqrt")
        assert not game.editor.completion.display


async def test_how_a_function_is_called_is_told_while_typing(data_dir: Path) -> None:
    async with opened(data_dir, text="", size=(80, 24)) as game:
        await game.press("2", *"ArgMin{")
        await game.sees("ArgMin{")
        line = help_on("", "ArgMin")
        assert line is not None
        await game.sees(line.shape)


async def test_a_message_is_told_once_until_its_line_is_changed(data_dir: Path) -> None:
    async with opened(data_dir, text=WRONG, size=(80, 24)) as game:
        await game.ready()
        await game.press("ctrl+g")
        message = game.session.state.mistakes[0].message[:30]
        await game.until(lambda: game.screen().count(message) == 1)
        await game.press("x")
        await game.until(lambda: not game.shows(message))
        await game.press("backspace")
        await game.until(lambda: game.screen().count(message) == 1)


async def test_of_many_messages_that_of_the_cursors_line_comes_first(data_dir: Path) -> None:
    many = "".join(f"P{number}(x) :- Nowhere{number}(x);\n" for number in range(5))
    async with opened(data_dir, text=many + STILL, size=(80, 24)) as game:
        await game.ready()
        await game.press("2", "ctrl+home")
        await game.until(lambda: len(game.session.state.mistakes) > 3)
        line = game.session.state.mistakes[-1].line
        await game.until(lambda: not game.shows(f"line {line},"))
        game.editor.move_cursor((line - 1, 0))
        await game.sees(f"line {line},")


async def test_a_key_goes_to_the_definition(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2")
        row = PAPER.splitlines().index("  freedom = FreedomMotion(sensor.radar),")
        game.editor.move_cursor((row, 15))
        await game.press("f12")
        await game.until(lambda: game.editor.cursor_location == (0, 0))
        game.editor.move_cursor((0, 34))
        await game.press("f12")
        await game.sees("WeightedAverage is not defined in this program")


async def test_a_line_that_looks_odd_has_a_mark(data_dir: Path) -> None:
    async with opened(data_dir, text=ODD) as game:
        await game.ready()
        assert game.session.state.mistakes[0].severity == "warning"
        number = game.session.state.mistakes[0].line
        await game.sees(f"{number}! ")


async def test_a_file_that_changes_on_disk_is_applied(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        game.session.source.path.write_text(STILL)
        await game.until(lambda: game.editor.text == STILL)
        await game.until(lambda: game.session.state.applied == STILL)


async def test_typed_text_stays_when_its_file_changes_on_disk(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "x")
        await game.until(lambda: game.editor.text == "x" + PAPER)
        game.session.source.path.write_text(STILL)
        await game.sees("has changed on disk")
        assert game.editor.text == "x" + PAPER


async def test_a_file_in_which_the_typed_text_is_found_counts_as_saved(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "x")
        await game.until(lambda: game.editor.text == "x" + PAPER)
        game.session.source.path.write_text("x" + PAPER)
        await game.until(lambda: game.session.source.text == "x" + PAPER)
        await game.handled()
        await game.sees_no("has changed on disk")
        assert game.editor.text == "x" + PAPER


async def test_ten_thousand_lines_are_pasted_and_edited_without_a_hang(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2")
        text = "".join(f"P{number}(x) :- x in [{number}];\n" for number in range(10_000))
        game.editor.put(text)
        await game.until(lambda: game.editor.document.line_count == 10_001)
        await game.press("a")
        await game.until(lambda: game.editor.text == "a" + text)


def test_a_predicate_is_renamed_where_it_is_used_and_nowhere_else() -> None:
    text = 'A(x) :- B(x), x == "A";\n# A\nAB(x) :- ~A(x); /* A\nA */ C := A(B: A);\n'
    found, count = rename(text, "A", "New")
    assert count == 4
    assert found == (
        'New(x) :- B(x), x == "A";\n# A\nAB(x) :- ~New(x); /* A\nA */ C := New(B: New);\n'
    )


@pytest.mark.parametrize(
    ("wanted", "place", "found"),
    [
        ("b", (0, 0), (0, 2)),
        ("b", (0, 2), (1, 0)),
        ("b", (1, 0), (0, 2)),
        ("B", (0, 0), (1, 0)),
        ("", (0, 0), None),
        ("z", (0, 0), None),
    ],
)
def test_what_is_looked_for_is_found_again_from_the_top(
    wanted: str, place: tuple[int, int], found: tuple[int, int] | None
) -> None:
    assert find_after("a b c\nB", wanted, place) == found


async def test_the_first_place_may_be_right_at_the_cursor(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "f3")
        await game.sees("Find in the program")
        row = PAPER.splitlines().index("  speed = 0.5,")
        game.editor.move_cursor((row, 2))
        await game.press(*"speed", "enter")
        await game.until(lambda: game.editor.selected_text == "speed")
        assert game.editor.cursor_location == (row, 2)
        await game.press("f3")
        await game.until(lambda: game.editor.cursor_location > (row, 2))
        assert game.editor.selected_text == "speed"
        game.editor.move_cursor((row, 2))
        await game.press("f3")
        await game.until(lambda: game.editor.selected_text == "speed")
        assert game.editor.cursor_location == (row, 2)


async def test_a_text_is_found_and_replaced_as_one_edit(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "ctrl+o")
        await game.sees("Find in the program")
        await game.press(*"speed", "enter")
        row = PAPER.splitlines().index("  speed = 0.5,")
        await game.until(lambda: game.editor.cursor_location == (row, 2))
        assert game.editor.selected_text == "speed"
        await game.press("ctrl+o")
        await game.sees("Find in the program")
        await game.press("tab", *"pace", "enter")
        await game.until(lambda: game.editor.text == PAPER.replace("speed", "pace"))
        await game.sees("Replaced in 3 places")
        await game.press("ctrl+z")
        await game.until(lambda: game.editor.text == PAPER)
        await game.press("ctrl+o")
        await game.sees("Find in the program")
        await game.press("ctrl+u", *"freedommotion", "tab")
        await game.until(lambda: game.app.focused and game.app.focused.id == "instead")
        await game.press("enter")
        await game.sees("Nothing was replaced")


async def test_a_predicate_is_renamed_from_the_palette(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "ctrl+p")
        await game.sees("Find a command")
        await game.press(*"rename", "enter")
        await game.sees("Rename the predicate")
        await game.press("ctrl+u", *"Free", "enter")
        await game.until(lambda: game.editor.text == PAPER.replace("FreedomMotion", "Free"))
        game.main.action_command("rename")
        await game.sees("Rename the predicate")
        await game.press("ctrl+u", *"Robot", "enter")
        await game.sees("is the name of another predicate")
        game.editor.move_cursor(game.editor.document.end)
        game.main.action_command("rename")
        await game.sees("Put the cursor on a predicate of this program")


def test_the_player_s_own_editor_gets_the_terminal_and_gives_it_back(tmp_path: Path) -> None:
    script = tmp_path / "editor.sh"
    script.write_text('#!/bin/sh\necho elsewhere\nread answer\nsed -i "1s/^/# $answer /" "$2"\n')
    script.chmod(0o755)
    env = {"EDITOR": f"{script} --wait", "VISUAL": ""}
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "first-steps"]
    with Terminal([*game, "--data-dir", tmp_path], size=(120, 40), env=env) as terminal:
        terminal.wait_for("· applied")
        terminal.send("E")
        terminal.wait_for("elsewhere")
        terminal.send("hello\n")
        terminal.wait_for("1  # hello")
        terminal.wait_for("PAUSED")
        terminal.send("n")
        terminal.wait_for("tick 1")


@pytest.mark.parametrize(
    ("editor", "error"),
    [("false", subprocess.CalledProcessError), ("/no/such", OSError), ("'", ValueError)],
)
def test_an_editor_that_fails_says_how(editor: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        edit_outside("text", {"EDITOR": editor})


@pytest.mark.parametrize(
    ("editor", "left"),
    [
        ("sh -c 'echo mine > $0; exit 3'", "mine\n"),
        ("sh -c 'echo mine > $0; kill -9 $$'", "mine\n"),
        (r"sh -c 'printf caf\\351 > $0'", "caf\ufffd"),
    ],
    ids=["ended badly", "killed", "no UTF-8"],
)
def test_what_an_editor_has_written_is_taken_however_it_ends(editor: str, left: str) -> None:
    assert edit_outside("text", {"EDITOR": editor}) == left
