"""What a snapshot keeps of a screen, and what it tells when another differs."""

import pyte

from tests.snapshots.picture import cells_of, differences, picture, read_picture


def screen(*chunks: str, lines: int = 3) -> pyte.Screen:
    made = pyte.Screen(20, lines)
    stream = pyte.Stream(made)
    for chunk in chunks:
        stream.feed(chunk)
    return made


def test_a_picture_can_be_read_back_and_has_no_differences_then() -> None:
    cells = cells_of(screen("\x1b[31mhé\x1b[1;48;2;1;2;3mx=|\x1b[0m y"))
    assert read_picture(picture(cells)) == cells
    assert list(differences(read_picture(picture(cells)), cells)) == []


def test_another_character_is_told_with_its_place() -> None:
    told = list(differences(cells_of(screen("one\r\ntwo")), cells_of(screen("one\r\ntoo"))))
    assert told[0] == "line 2, columns 2 to 2, 1 cells:"
    assert [line.split("|")[1] for line in told[1:]] == ["w", "o"]


def test_another_size_is_told_with_the_lines_that_are_missing() -> None:
    told = list(differences(cells_of(screen("a\r\nb")), cells_of(screen("a", lines=1))))
    assert told[0] == "20x1 cells instead of 20x3"
    assert told[1] == "line 2, columns 1 to 20, 20 cells:"
    assert told[3] == "  found  || starting with nothing"


def test_another_colour_is_a_difference_but_not_the_ink_of_a_blank_or_how_long_it_took() -> None:
    assert list(differences(cells_of(screen("\x1b[31mx")), cells_of(screen("\x1b[32mx"))))
    assert cells_of(screen("\x1b[31m ")) == cells_of(screen("\x1b[32m "))
    assert cells_of(screen("tick 3   0.4 ms")) == cells_of(screen("tick 3   12.7 ms"))
