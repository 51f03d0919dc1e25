import math
from itertools import product

from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, legend
from logical_robots_tui.tui.labyrinth.drawing.cells import BLOCKS


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
