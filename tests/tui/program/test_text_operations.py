"""The text of a program: indentation, lines found again, what they tell, looking and renaming."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from logical_robots_tui.mind import Diagnostic
from logical_robots_tui.tui.program.editor import find_after, indentation_after, rename, shift_lines
from logical_robots_tui.tui.program.mistakes import follow_rows, mark_of, sign
from tests.mind.hostile.bounds import bounded_work

LINES = st.lists(st.sampled_from("abc"), max_size=6)


@pytest.mark.parametrize(
    ("before", "indentation"),
    [
        ("", ""),
        ("A(x) :-", "  "),
        ("A(x) :-  # why", "  "),
        ("  B(x),", "  "),
        ("  desire = {", "    "),
        ("    f(", "      "),
        ("  C(x);", ""),
        ("  ", "  "),
        ("\tB(x),", "\t"),
    ],
)
def test_a_new_line_is_indented_as_what_is_before_it_asks(before: str, indentation: str) -> None:
    assert indentation_after(before) == indentation


def test_a_line_of_spaces_is_looked_at_in_time() -> None:
    with bounded_work(2.0):
        assert indentation_after(" " * 300_000) == " " * 300_000


def test_lines_go_a_step_to_the_right_and_back_as_far_as_they_can() -> None:
    lines = ["a", "", "  b", " c", "\td"]
    assert shift_lines(lines, back=False) == ["  a", "", "    b", "   c", "  \td"]
    assert shift_lines(lines, back=True) == ["a", "", "b", "c", "d"]
    assert shift_lines(shift_lines(lines, back=False), back=True) == lines


@pytest.mark.parametrize(
    ("after", "rows"),
    [
        ("new a b c", [1, 2, 3]),
        ("a new b c", [0, 2, 3]),
        ("a b2 c", [0, 1, 2]),
        ("a b1 b2 c", [0, 1, 3]),
        ("a c", [0, None, 1]),
        ("a bc", [0, 1, 1]),
        ("x y", [None, None, None]),
        ("", [None, None, None]),
    ],
)
def test_lines_are_found_again_after_a_change(after: str, rows: list[int | None]) -> None:
    assert follow_rows(range(3), ["a", "b", "c"], after.split()) == rows


@given(LINES, LINES)
def test_a_line_that_stands_beside_what_changed_is_found_as_it_was(
    before: list[str], after: list[str]
) -> None:
    rows = follow_rows(range(len(before)), before, after)
    assert all(row is None or 0 <= row < len(after) for row in rows)
    known = [row for row in rows if row is not None]
    assert known == sorted(known)
    assert follow_rows(range(len(before)), before, [*before, *after])[: len(before)] == list(
        range(len(before))
    )


@pytest.mark.parametrize(("row", "told"), [(11, "12✗ A(x)"), (None, "    A(x)")])
def test_a_wrapped_line_has_its_sign_only_where_it_begins(row: int | None, told: str) -> None:
    line = Strip([Segment("12  "), Segment("A(x)")])
    styles = dict.fromkeys(("mistake", "mistake-gutter"), Style())
    found = sign(line, row, 4, styles, is_wrong=True)
    assert found.text == told
    assert found.cell_length == line.cell_length


@pytest.mark.parametrize(
    ("column", "excerpt", "line", "marked"),
    [
        (3, "Bat", "a Bat(x)", "Bat"),
        (3, "", "a Bat(x)", "Bat"),
        (6, "gone", "a Bat(x)", "("),
        (9, "", "a Bat(x)", ")"),
    ],
)
def test_what_is_wrong_in_a_line_is_underlined(
    column: int, excerpt: str, line: str, marked: str
) -> None:
    mark = mark_of(Diagnostic(1, column, "wrong", excerpt=excerpt), line)
    assert line[mark.start : mark.stop] == marked
    assert mark.is_wrong


def test_a_predicate_is_renamed_where_it_is_used_and_nowhere_else() -> None:
    text = 'A(x) :- B(x), x == "A";\n# A\nAB(x) :- ~A(x); /* A\nA */ C := A(B: A);\n'
    assert rename(text, "A", "New") == (
        'New(x) :- B(x), x == "A";\n# A\nAB(x) :- ~New(x); /* A\nA */ C := New(B: New);\n',
        4,
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
