"""Help while a program is written: words that fit, and what is said of them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.language.services.completion import (
    WordHelp,
    call_before,
    definitions,
    help_on,
    word_around,
    word_before,
    words_for,
)
from logical_robots_tui.tui.program.completion import lines_of
from tests.tui.conftest import PAPER
from tests.tui.program.conftest import writing
from tests.virtual_time import later


def names(text: str, before: str) -> list[str]:
    text = f"{text}\n{before}"
    return [word.name for word in words_for(text, (text.count("\n"), len(before)))]


def test_words_that_fit_are_offered_and_after_a_dot_fields() -> None:
    assert "FreedomMotion" in names(PAPER, "  x = Fr")
    assert "Sqrt" in names(PAPER, "  x = Sq")
    assert "Sensor" in names("", "Se")
    assert word_before("  x = Fr") == ("", "Fr")
    assert {"forward_distance", "forward_object"} <= set(names("", "sensor.forw"))
    assert "Sqrt" not in names("", "sensor.")
    assert "angle" not in names("", "sensor.")
    assert "angle" in names("", "ray.")
    assert "goal_seen" in names("Robot(memory: {goal_seen: 1});", "memory.go")
    assert names("A(x) :- x.zeal > 1, y.able > 1;", "B(x) :- x.")[0] == "zeal"
    # Variables of the rule come first, then fields, predicates and functions.
    before = "Rays(x) = 1;\nF(radar, rag) = Min{ray.distance :- ray in ra"
    words = names("Other(rat) = 1;", before)
    assert words[:4] == ["radar", "rag", "ray", "Rays"]
    assert "rat" not in words
    assert names("", "P(sensor) :- x == S")[0] == "Sensor"
    assert names("", "P(sensor) :- x == s")[0] == "sensor"
    assert names("", "P() :- Sensor(robot_name:, sensor:), sensor.radar == ra")[0] == "sensor.radar"


def test_in_a_long_program_predicates_of_all_of_it_are_offered() -> None:
    text = f'Far(x) :- x = """a""";\n{"A(1);  # (" * 20_000}\n'
    assert names(text, "B(near) :- Fa")[0] == "Far"
    assert names(text, "B(near) :- nea")[0] == "near"


def test_comments_and_quotes_offer_nothing_and_are_not_offered() -> None:
    text = '# memory.secret, both sides alike: x\nRobot(memory: {here: "memory.quoted"});'
    assert names(text, "memory.") == names("Robot(memory: {here: 1});", "memory.")
    for before in ("# Sq", "# see ", 'x = "Sq'):
        assert names(text, before) == []
    assert "Sqrt" in names(text, 'x = "Sq", Sq')


def test_definitions_are_first_lines_that_begin_with_a_predicate_and_come_first_in_help() -> None:
    defined = definitions("# C(c)\nA(x) :- B(x);\nB(y) :-\n  C(y);\nA(z);\nD := E(F: G);\nH")
    assert {name: line for name, (line, _) in defined.items()} == {"A": 1, "B": 2, "D": 5}
    assert defined["A"][1] == "A(x)"
    own, of_the_game = help_on("Sensor(x);", "Sensor"), help_on("", "Sensor")
    assert own
    assert of_the_game
    assert own.meaning == "defined in line 1"
    assert "sensor readings" in of_the_game.meaning
    assert help_on("", "Nothing") is None


def test_the_call_is_the_innermost_that_is_open() -> None:
    for before, name in [
        ("x = Least(1, ", "Least"),
        ("x = Least(1, Sqrt(2), ", "Least"),
        ("x = Min{ray.distance :- ", "Min"),
        ("x = Least(1)", ""),
        ("x = (1 + ", ""),
        ("A(b: [c, {d: ", "A"),
    ]:
        assert call_before(before)[0] == name


@given(st.text(), st.integers(0, 20))
def test_any_text_is_looked_at_without_harm(text: str, column: int) -> None:
    definitions(text)
    words_for(text, (0, column))
    call_before(text)
    assert word_around(text, column) in text


@pytest.mark.parametrize("width", [34, 74, 90])
def test_nothing_that_is_said_of_a_word_is_cut(width: int) -> None:
    words = [
        WordHelp("Least", "Least(x, y, ...)", "the least of its arguments"),
        WordHelp("Long", f"Long({', '.join('abcdefghijklm')})", "what has a long shape " * 3),
    ]
    for word, line in zip(words, lines_of(words, width), strict=True):
        assert word.meaning.strip() in " ".join(line.plain.split())
        assert all(len(row.rstrip()) <= width for row in line.plain.split("\n"))


async def test_the_list_of_words_opens_by_key_follows_what_is_typed_and_closes() -> None:
    async with writing() as desk:
        editor, completion = desk.editor, desk.completion
        await desk.at_once(*"Wei", "ctrl+space")
        assert completion.display
        await desk.until(lambda: "WeightedAverage{" in desk.screen())
        await desk.type("enter")
        assert editor.text == "WeightedAverage"
        assert not completion.display
        await desk.load("")
        await desk.at_once("S", "ctrl+space")
        assert completion.option_count > 1
        await desk.type("q")
        await desk.until(lambda: completion.option_count == 1)
        await desk.type("escape")
        assert not completion.display
        assert desk.app.focused is editor
        await desk.at_once("tab")
        assert editor.text == "Sq  "
        await desk.at_once(*"Sqr", "ctrl+space")
        assert completion.display
        await desk.type("t")
        assert editor.text == "Sq  Sqrt"
        assert not completion.display
        await desk.load("")
        await desk.at_once(*"ArgMin{")  # how it is called is told
        line = help_on("", "ArgMin")
        assert line is not None
        await desk.until(lambda: line.shape in desk.screen())


async def test_a_dot_or_a_capital_letter_opens_the_list_and_a_number_does_not() -> None:
    async with writing() as desk:
        for typed, first in [("sensor.", "clock"), ("S", "Sensor")]:
            await desk.load("")
            await desk.type(*typed[:-1])
            assert not desk.completion.display
            await desk.type(typed[-1])
            assert desk.completion.display
            assert desk.completion.names[0] == first
            await desk.type("escape")
        await desk.load("")
        await desk.type(*"0.5")
        assert (desk.editor.text, desk.completion.display) == ("0.5", False)
        await desk.load("")
        await desk.at_once(*"x == sensor.")
        await desk.until(lambda: desk.completion.display)
        assert desk.editor.text == "x == sensor."
        await desk.type("escape")
        await desk.load("")
        await desk.at_once(*"S(x); y")
        await later(1)
        assert not desk.completion.display
        desk.editor.completes = False
        await desk.load("")
        await desk.type("S")
        assert (desk.editor.text, desk.completion.display) == ("S", False)


async def test_tab_completes_what_is_begun_and_indents_elsewhere() -> None:
    async with writing() as desk:
        for text, keys, completed in [
            ("R(x) :- x == sensor.forw", ["enter"], "R(x) :- x == sensor.forward_"),
            ("R(x) :- Weig", [], "R(x) :- WeightedAverage"),
            ("R(x) :- ", [], "R(x) :-   "),
            ("R(x) :- zzz", [], "R(x) :- zzz "),
        ]:
            await desk.load(text, 0, len(text))
            await desk.type("tab")
            assert desk.completion.display == bool(keys)
            await desk.type(*keys)
            assert desk.editor.text.startswith(completed)
            assert keys or desk.editor.text == completed
