"""What is written on the screen, letter by letter."""

import unicodedata
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.language.services.lexer import LineStates, pieces, state_after
from logical_robots_tui.tui.inspector.pages.robots import radar_strip
from logical_robots_tui.tui.inspector.plots import cell, format_value
from logical_robots_tui.values import Value
from logical_robots_tui.wording import clip, one_line, visible

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(st.text(), st.integers(0, 30))
def test_visible_text_moves_no_terminal_and_clipped_is_never_longer(text: str, width: int) -> None:
    assert len(clip(text, width)) <= width
    shown = visible(text)
    assert len(shown) == len(text)
    assert not {unicodedata.category(c) for c in shown} & {"Cc", "Cf", "Cs", "Zl", "Zp"}


def test_control_characters_have_pictures() -> None:
    assert visible("a\x1b[31m\x00\x7f\t\u202e") == "a␛[31m␀␡␉\ufffd"
    assert (visible("a\tb\n", tabs=True), one_line("  a\n\n b\t c ")) == ("a\tb␊", "a b c")


def test_values_are_written_as_a_program_would_and_large_ones_cut_at_once() -> None:
    values: list[tuple[Value, str]] = [
        *((None, "null"), (True, "true"), (3, "3"), (3.0, "3.0"), (0.1 + 0.2, "0.3")),
        *((1234567.891, "1.23457e+06"), (float("nan"), "nan"), (float("-inf"), "-inf")),
        ("wall", '"wall"'),
        ({"a": 1, "b": [1, None]}, "{a: 1, b: [1, null]}"),
        *(({}, "{}"), ([], "[]"), (10**400, f"{10**400:#x}")),
    ]
    assert [format_value(value) for value, _ in values] == [text for _, text in values]
    # Text in a table has quotes only where it could be something else.
    texts = {"wall": "wall", "": '""', "1": '"1"', "null": '"null"', " a": '" a"', "{": '"{"'}
    assert {value: cell(value)[0] for value in texts} == texts
    endless: Value = {"a": "x" * 10_000_000, "b": list(range(1_000_000))}
    assert len(format_value(endless, 100)) == 100


@given(VALUES, st.integers(1, 50))
def test_any_value_can_be_written_in_any_room(value: object, limit: int) -> None:
    assert len(format_value(value, limit)) <= limit  # type: ignore[arg-type] # any value will do
    assert len(cell(value, limit)[0]) <= limit  # type: ignore[arg-type] # any value will do


def test_the_radar_is_31_bars_of_the_objects_colours() -> None:
    far, near = (
        {"angle": 0.0, "label": "x", "distance": distance, "object": kind}
        for distance, kind in ((200, "none"), (1, "wall"))
    )
    strip = radar_strip([far] * 30 + [near])
    assert (strip.plain, len({str(span.style) for span in strip.spans})) == ("█" * 30 + "▁", 2)


def kinds(line: str, state: str = "") -> list[tuple[str, str]]:
    return [(line[start:end], kind) for start, end, kind in pieces(line, state)]


def test_the_words_of_logica_are_told_apart() -> None:
    assert kinds('@Visible(Memory, "all"); # so') == [
        *(("@Visible", "annotation"), ("Memory", "predicate"), ('"all"', "string")),
        ("# so", "comment"),
    ]
    assert kinds("A(x: 1.5) :- y in b, x -> y;") == [
        *(("A", "predicate"), ("x", "field"), ("1.5", "number"), (":-", "operator")),
        *(("in", "keyword"), ("->", "operator")),
    ]
    names = kinds("Robot(robot_name:, desire:)")[1:]
    assert names == [("robot_name", "field"), ("desire", "field")]


def test_comments_and_strings_go_on_over_lines() -> None:
    for line, before, after in (
        *(("a /* b", "", "/*"), ("a =/* b", "", "/*"), ("b */ c", "/*", "")),
        *(("b */ c /* d", "/*", "/*"), ("", "/*", "/*"), ("# /* no", "", ""), ('"/*" a', "", "")),
        *(('x = """ a', "", '"""'), ('a """;', '"""', "")),
        ('"a\\"/*" a', "", "/*"),  # a backslash in double quotes is one
        ("'a\\'/*' a", "", ""),
    ):
        assert state_after(line, before) == after, line
        found = pieces(line, before)
        assert all(one.end <= two.start for one, two in pairwise(found)), line


@given(st.lists(st.text(st.sampled_from("ab\"'`/*#\\ (){}:-")), max_size=8), st.integers(0, 7))
def test_states_found_late_are_those_found_in_order(lines: list[str], changed: int) -> None:
    states = LineStates()
    for number in range(len(lines)):
        states.at(number, lines.__getitem__)
    if changed < len(lines):
        lines[changed] = "/*"
        states.forget(changed)
    fresh, expected = LineStates(), ""
    for number, line in enumerate(lines):
        assert states.at(number, lines.__getitem__) == expected
        found = pieces(line, expected)
        assert all(0 <= one.start < one.end <= len(line) for one in found)
        expected = state_after(line, expected)
    if lines:
        last = len(lines) - 1
        assert fresh.at(last, lines.__getitem__) == states.at(last, lines.__getitem__)
