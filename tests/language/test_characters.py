"""Spaces and ends of lines of every kind; other characters are in `mind/broken/programs.txt`."""

import unicodedata

import pytest

from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.tree import Statement

TEXT = "A(x) :- # a comment\n  x = (if 1 is null then 2 else 3), x in [2];\nB() = Sum{x :- A(x)};\n"
SPACES = [
    character
    for character in map(chr, range(128, 0x10000))
    if unicodedata.category(character) in ("Zs", "Zl", "Zp")
]


def read(text: str) -> list[Statement]:
    parsed = parse(prepare(text))
    assert parsed.problems == []
    return parsed.statements


def test_spaces_of_every_width_are_spaces() -> None:
    assert {"\u00a0", "\u2009", "\u3000", "\u2028"} < set(SPACES)
    for space in SPACES:
        assert read(TEXT.replace(" ", space)) == read(TEXT)


@pytest.mark.parametrize("end", ["\r", "\r\n"])
def test_every_end_of_a_line_ends_it(end: str) -> None:
    text = f"{TEXT}C(x) :- x = ;"
    (problem,) = parse(prepare(text.replace("\n", end))).problems
    assert (problem.line, problem.column) == (4, 12)
    assert len(read(TEXT.replace("\n", end))) == 2
