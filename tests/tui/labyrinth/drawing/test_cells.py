import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, legend
from logical_robots_tui.tui.labyrinth.drawing.cells import (
    BLOCKS,
    BOLD,
    CONTINUED,
    Cells,
    fit,
    pack,
    split,
    text_id,
)
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats


def row_of(*words: tuple[str, int]) -> Cells:
    cells, column = Cells.blank(1, 6), 0
    for word, ink in words:
        for char in word:
            cells.put(0, column, char, ink, 0x101010)
            column += 1
    return cells


def test_a_strip_has_a_segment_for_each_style_and_a_blank_joins_its_neighbours() -> None:
    strip = row_of(("abc", 0xFF0000), ("def", 0x00FF00)).strip(0)
    assert [segment.text for segment in strip] == ["abc", "def"]
    styles = [segment.style for segment in strip]
    assert all(style and style.color and style.bgcolor for style in styles)
    assert str(styles[0]) == "#ff0000 on #101010"
    strip = row_of(("ab", 0xFF0000), ("  ", 0x0000FF), ("cd", 0xFF0000)).strip(0)
    assert [segment.text for segment in strip] == ["ab  cd"]

    cells = Cells.blank(1, 1)
    cells.put(0, 0, "x", 0xFFFFFF, 0, bold=True)
    assert cells.style[0, 0] & BOLD
    (segment,) = cells.strip(0)
    assert segment.style is not None
    assert segment.style.bold


def test_changes_are_spans_of_rows_and_of_whole_characters() -> None:
    cells = Cells.blank(4, 10)
    later = cells.copy()
    assert later.changes(cells) == []
    for row, column in ((1, 3), (1, 7), (3, 0)):
        later.put(row, column, "x", 1, 0)
    assert later.changes(cells) == [(1, 3, 8), (3, 0, 1)]
    cells = Cells.blank(1, 6)
    cells.text[0, 2], cells.text[0, 3] = text_id("機"), CONTINUED
    later = cells.copy()
    later.style[0, 3] = 5
    assert later.changes(cells) == [(0, 2, 4)]
    assert (cells.strip(0).cell_length, cells.strip(0).text) == (6, "  機  ")


def test_dots_of_one_or_two_colours_are_fitted_exactly() -> None:
    dark, bright = (8, 12, 16), (200, 100, 40)
    for count, blocks in ((4, BLOCKS[4]), (2, BLOCKS[2])):
        for pattern in range(1, 2**count - 1):
            dots = [[bright if pattern >> i & 1 else dark for i in range(count)]]
            (index,), ink, paper = fit(np.array(dots, np.uint8))
            assert blocks[index] == blocks[pattern]
            assert pack(ink)[0] == 200 << 16 | 100 << 8 | 40
            assert pack(paper)[0] == 8 << 16 | 12 << 8 | 16
    (index,), ink, paper = fit(np.full((1, 4, 3), 96, np.uint8))
    assert BLOCKS[4][index] == " "
    assert pack(ink) == pack(paper) == 0x606060


@given(st.lists(st.integers(0, 255), min_size=12, max_size=12))
def test_no_division_of_the_dots_is_better(values: list[int]) -> None:
    dots = np.array(values, np.uint8).reshape(1, 4, 3)
    (index,), ink, paper = fit(dots)

    def error(pattern: int, one: Floats, other: np.ndarray) -> float:
        chosen = np.array([one if pattern >> i & 1 else other for i in range(4)])
        return float(((dots[0] - chosen) ** 2).sum())

    def best(pattern: int) -> float:
        members = np.array([pattern >> i & 1 for i in range(4)], bool)
        return error(pattern, dots[0][members].mean(axis=0), dots[0][~members].mean(axis=0))

    least = min(best(pattern) for pattern in range(1, 15))
    assert error(int(index), ink[0], paper[0]) <= least + 41


@pytest.mark.parametrize(("across", "down"), [(2, 2), (1, 2), (1, 1)])
def test_dots_are_split_by_cell_in_reading_order(across: int, down: int) -> None:
    image = np.arange(3 * down * 4 * across, dtype=np.uint8).reshape(3 * down, 4 * across)
    cells = split(np.repeat(image[..., None], 3, axis=2), across, down)
    assert cells.shape == (12, across * down, 3)
    block = image[down : 2 * down, 2 * across : 3 * across]
    assert cells[4 + 2, :, 0].tolist() == block.ravel().tolist()


def test_every_glyph_is_one_cell_wide_and_has_a_row_of_its_own_in_the_legend() -> None:
    for drawing, palette in product(Drawing, (DARK, LIGHT)):
        rows = legend(drawing, palette)
        assert {cell_len(char) for char in [*"".join(drawing.glyphs), *(r[0] for r in rows)]} == {1}
        meanings = [meaning for _, _, meaning in rows]
        assert all(meanings)
        assert len(set(meanings)) == len(meanings)
    for angle in (math.nan, math.inf):
        assert cell_len(Drawing.QUADRANTS.glyphs.heading(angle)) == 1


def test_blocks_are_all_shapes_of_their_dots_one_cell_wide_or_plain_ascii() -> None:
    for count, blocks in BLOCKS.items():
        assert len(set(blocks)) == len(blocks) == (2**count if count > 1 else 1)
        assert all(cell_len(char) == 1 for char in blocks)
    assert [BLOCKS[6][dots] for dots in (0b000011, 0b111110, 0b010101, 0b010110)] == [
        *("\N{BLOCK SEXTANT-12}", "\N{BLOCK SEXTANT-23456}", "▌", "\N{BLOCK SEXTANT-235}")
    ]
    glyphs = [glyph for glyph, _, _ in legend(Drawing.ASCII)]
    assert "".join([*Drawing.ASCII.glyphs, *glyphs]).isascii()


def test_what_stands_in_a_labyrinth_is_told_apart_by_its_glyph() -> None:
    for glyphs in (drawing.glyphs for drawing in Drawing):
        signs = [*glyphs.headings, glyphs.dead, glyphs.beacon, glyphs.charger]
        signs += [glyphs.hit_wall, glyphs.hit_beacon, glyphs.hit_robot]
        assert len(set(signs)) == len(signs)
