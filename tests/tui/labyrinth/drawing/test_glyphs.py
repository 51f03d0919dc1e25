import math
from itertools import product

from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, legend
from logical_robots_tui.tui.labyrinth.drawing.cells import BLOCKS
from logical_robots_tui.tui.labyrinth.drawing.glyphs import GlyphSet


def characters(glyphs: GlyphSet) -> str:
    return "".join(glyphs)


def test_every_glyph_is_one_cell_wide_and_has_a_row_of_its_own_in_the_legend() -> None:
    for drawing, palette in product(Drawing, (DARK, LIGHT)):
        assert {cell_len(char) for char in characters(drawing.glyphs)} == {1}
        rows = legend(drawing, palette)
        assert {cell_len(glyph) for glyph, _, _ in rows} == {1}
        meanings = [meaning for _, _, meaning in rows]
        assert all(meanings)
        assert len(set(meanings)) == len(meanings)


def test_every_block_is_one_cell_wide() -> None:
    for count, blocks in BLOCKS.items():
        assert len(set(blocks)) == len(blocks)
        assert len(blocks) == (2**count if count > 1 else 1)
        assert all(cell_len(char) == 1 for char in blocks)


def test_plain_characters_are_ascii() -> None:
    assert characters(Drawing.ASCII.glyphs).isascii()
    assert all(glyph.isascii() for glyph, _, _ in legend(Drawing.ASCII))


def test_what_stands_in_a_labyrinth_is_told_apart_by_its_glyph() -> None:
    for drawing in Drawing:
        glyphs = drawing.glyphs
        signs = [
            *glyphs.headings,
            glyphs.dead,
            glyphs.beacon,
            glyphs.charger,
            glyphs.hit_wall,
            glyphs.hit_beacon,
            glyphs.hit_robot,
        ]
        assert len(set(signs)) == len(signs)


def test_a_heading_that_is_not_a_number_has_a_glyph() -> None:
    assert {
        cell_len(Drawing.QUADRANTS.glyphs.heading(angle)) for angle in (math.nan, math.inf)
    } == {1}
