"""Sending differences: a terminal shows what it would show if everything were sent."""

import re
from collections.abc import Iterable, Sequence
from typing import TypeAlias

import pyte
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pyte.modes import DECAWM
from rich.color import Color, ColorSystem
from rich.console import Console
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region
from textual.strip import Strip

from logical_robots_tui.tui.terminal.cell_diff import CellDiff, reduce_colour
from tests.terminal import looks

COLUMNS, ROWS = 12, 4

_styles = st.one_of(
    st.none(),
    st.builds(
        Style,
        color=st.sampled_from((None, "#102030", "#ff8800", "red")),
        bgcolor=st.sampled_from((None, "#102030", "#204060")),
        bold=st.sampled_from((None, True)),
        reverse=st.sampled_from((None, True)),
        underline=st.sampled_from((None, True, False)),
    ),
)
_texts = st.from_regex(r"([ab █▚]|e\u0301?){0,5}", fullmatch=True)
_segments = st.lists(st.builds(Segment, _texts, _styles, st.none()), max_size=5)
_pieces = st.lists(
    st.tuples(st.integers(-1, ROWS), st.integers(-3, COLUMNS + 9), _segments), max_size=6
)
Pieces: TypeAlias = list[tuple[int, int, list[Segment]]]


def difference_of(colours: ColorSystem | None = ColorSystem.TRUECOLOR) -> CellDiff:
    return CellDiff(COLUMNS, ROWS, colours)


def send(difference: CellDiff, pieces: Iterable[tuple[int, int, Sequence[Segment]]]) -> str:
    difference.take(pieces)
    return difference.sequence()


def terminal() -> pyte.Screen:
    """A terminal; pyte's would scroll for a mark on the letter in the last column of all."""
    screen = pyte.Screen(COLUMNS, ROWS)
    screen.reset_mode(DECAWM)
    return screen


def fitting(pieces: Pieces) -> list[tuple[int, int, Strip]]:
    """Pieces as a compositor gives them: within the screen, no character of two cells cut."""
    return [
        (row, column, Strip(segments).crop(0, COLUMNS - column))
        for row, column, segments in pieces
        if 0 <= row < ROWS and 0 <= column < COLUMNS
    ]


@given(st.lists(_pieces, min_size=1, max_size=4))
def test_differences_show_what_all_would_show_and_are_sent_once(updates: list[Pieces]) -> None:
    console = Console(color_system="truecolor", force_terminal=True)
    one, other = terminal(), terminal()
    theirs, ours = pyte.Stream(other), pyte.Stream(one)
    difference = difference_of()
    blank = [Segment(" " * COLUMNS)]
    ours.feed(send(difference, [(row, 0, blank) for row in range(ROWS)]))
    for update in updates:
        for row, column, strip in fitting(update):
            theirs.feed(f"\x1b[{row + 1};{column + 1}H{strip.render(console)}")
            ours.feed(send(difference, [(row, column, list(strip))]))
            assert send(difference, [(row, column, list(strip))]) == ""
        assert looks(one) == looks(other)


@given(st.lists(st.text("ab機 ", max_size=6), min_size=1, max_size=6))
def test_characters_of_two_cells_are_replaced_whole(texts: list[str]) -> None:
    screen = pyte.Screen(COLUMNS, ROWS)
    stream = pyte.Stream(screen)
    difference = difference_of()
    for text in texts:
        line = Strip([Segment(text)]).adjust_cell_length(COLUMNS)
        stream.feed(send(difference, [(0, 0, list(line))]))
        assert screen.display[0] == line.text


def test_a_character_that_lost_a_half_is_sent_again() -> None:
    difference = CellDiff(4, 1, None)
    send(difference, [(0, 0, [Segment("機機")])])
    send(difference, [(0, 1, [Segment("ab")])])
    assert send(difference, [(0, 0, [Segment("機機")])]) == "\x1b[1;1H機機"


@given(_pieces)
def test_pieces_that_reach_out_of_the_terminal_do_no_harm(pieces: Pieces) -> None:
    screen = pyte.Screen(COLUMNS, ROWS)
    pyte.Stream(screen).feed(send(difference_of(None), pieces))
    assert len(screen.display) == ROWS


@example([[(0, 0, [Segment("a")]), (3, 3, [Segment("aaaaaaaae\u0301")])]], Region(0, 0, 1, 1), 1)
@given(
    st.lists(_pieces, min_size=1, max_size=4),
    st.builds(Region, *(st.integers(0, size) for size in (COLUMNS, ROWS, COLUMNS, ROWS))),
    st.integers(1, 40),
)
def test_what_has_no_room_is_sent_later(updates: list[Pieces], last: Region, limit: int) -> None:
    one, other = terminal(), terminal()
    ours, theirs = pyte.Stream(one), pyte.Stream(other)
    sparing, plain = difference_of(), difference_of()
    for update in updates:
        pieces = [(row, column, list(strip)) for row, column, strip in fitting(update)]
        theirs.feed(send(plain, pieces))
        sparing.take(pieces)
        ours.feed(sparing.sequence(limit, last))
    for _ in range(2 * ROWS):
        ours.feed(sparing.sequence(limit, last))
    assert (sparing.sequence(), looks(one)) == ("", looks(other))


def test_a_text_is_sent_before_the_picture_whose_rows_take_turns() -> None:
    difference = CellDiff(4, 3, None)
    send(difference, [(row, 0, [Segment("    ")]) for row in range(3)])
    picture = Region(0, 0, 2, 3)
    sent = []
    for text in ("abcd", "efgh", "ijkl"):
        difference.take([(row, 0, [Segment(text)]) for row in range(3)])
        sent.append(difference.sequence(25, picture))
    texts = [re.sub(r"\x1b.*?[HC]", " ", sequence) for sequence in sent]
    assert texts == [" cd cd cd ab", " gh gh gh ef", " kl kl kl ij"]
    assert [re.findall(r"\x1b\[(\d)", sequence)[-1] for sequence in sent] == ["1", "2", "3"]


def test_one_changed_cell_costs_a_move_and_a_colour() -> None:
    difference = CellDiff(40, 2, ColorSystem.TRUECOLOR)
    style = Style(color="#ff0000", bgcolor="#000000")
    send(difference, [(1, 0, [Segment("a" * 40, style)])])
    sent = send(difference, [(1, 0, [Segment("a" * 20 + "b" + "a" * 19, style)])])
    assert sent == "\x1b[2;21H\x1b[38;2;255;0;0;48;2;0;0;0mb\x1b[m"
    sent = send(CellDiff(10, 1, None), [(0, 0, [Segment("ab", Style(color="red", bold=True))])])
    assert sent == "\x1b[1;1H\x1b[1mab\x1b[m", "without colours none are sent"


@pytest.mark.parametrize(
    ("colour", "is_blue"), [("#1e4068", True), ("#10161e", False), ("#1b2e4b", True)]
)
def test_a_dark_blue_stays_blue_in_256_colours(colour: str, is_blue: bool) -> None:
    triplet = reduce_colour(Color.parse(colour), ColorSystem.EIGHT_BIT).get_truecolor()
    assert (triplet.blue > triplet.red) == is_blue
    assert max(triplet) < 130


@given(st.tuples(*[st.integers(0, 255)] * 3))
def test_a_colour_among_256_is_near(rgb: tuple[int, int, int]) -> None:
    found = reduce_colour(Color.from_rgb(*rgb), ColorSystem.EIGHT_BIT).get_truecolor()
    assert max(abs(a - b) for a, b in zip(found, rgb, strict=True)) <= 60


def test_nothing_turns_the_direction_of_what_follows() -> None:
    sent = send(difference_of(), [(0, 0, [Segment("a\u202eb\u2066c\u200fe\u0301")])])
    assert "abce\u0301" in sent
    assert not set("\u202e\u2066\u200f") & {*sent}
