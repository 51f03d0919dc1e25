import math

import pytest
from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, legend
from logical_robots_tui.tui.labyrinth.drawing.cells import BLOCKS
from logical_robots_tui.tui.labyrinth.drawing.glyphs import GlyphSet


def characters(glyphs: GlyphSet) -> str:
    return "".join(glyphs)


@pytest.mark.parametrize("drawing", Drawing)
def test_every_glyph_is_one_cell_wide(drawing: Drawing) -> None:
    for char in characters(drawing.glyphs):
        assert cell_len(char) == 1
    for glyph, _, meaning in legend(drawing):
        assert cell_len(glyph) == 1
        assert meaning


def test_every_block_is_one_cell_wide() -> None:
    for count, blocks in BLOCKS.items():
        assert len(set(blocks)) == len(blocks)
        assert len(blocks) == (2**count if count > 1 else 1)
        assert all(cell_len(char) == 1 for char in blocks)


def test_plain_characters_are_ascii() -> None:
    assert characters(Drawing.ASCII.glyphs).isascii()
    assert all(glyph.isascii() for glyph, _, _ in legend(Drawing.ASCII))


@pytest.mark.parametrize("drawing", Drawing)
@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_the_legend_has_one_row_for_each_meaning(drawing: Drawing, palette: object) -> None:
    rows = legend(drawing, DARK if palette is DARK else LIGHT)
    meanings = [meaning for _, _, meaning in rows]
    assert len(set(meanings)) == len(meanings)


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


@pytest.mark.parametrize("angle", [math.nan, math.inf])
def test_a_heading_that_is_not_a_number_has_a_glyph(angle: float) -> None:
    assert cell_len(Drawing.QUADRANTS.glyphs.heading(angle)) == 1
