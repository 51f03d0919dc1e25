"""What is painted at a spot shows as it would in Textual, and leaves alone what lies over it."""

import pyte
from hypothesis import given
from hypothesis import strategies as st
from rich.color import ColorSystem
from textual.geometry import Region

from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, CONTINUED, Cells, text_id
from logical_robots_tui.tui.terminal.cell_diff import CellDiff
from logical_robots_tui.tui.terminal.diff_app import PaintTarget
from tests.terminal import looks

COLUMNS, ROWS = 14, 6
SPOT = Region(2, 1, 9, 4)
WHOLE = [(row, 0, SPOT.width) for row in range(SPOT.height)]

_styles = st.builds(
    lambda ink, paper, bold: ink << 24 | paper | bold,
    *map(st.sampled_from, ((0x102030, 0xFF8800), (0x102030, 0x204060), (0, BOLD))),
)


@st.composite
def pictures(draw: st.DrawFn) -> Cells:
    cells = Cells.blank(SPOT.height, SPOT.width)
    for row in range(SPOT.height):
        texts = draw(st.lists(st.sampled_from(("a", " ", "█", "機")), min_size=9, max_size=9))
        column = 0
        for text in texts:
            is_wide = text == "機"
            if column + is_wide >= SPOT.width:
                break
            cells.style[row, column : column + 1 + is_wide] = draw(_styles)
            cells.text[row, column] = text_id(text)
            if is_wide:
                cells.text[row, column + 1] = CONTINUED
            column += 1 + is_wide
    return cells


def sent_in_strips(difference: CellDiff, cells: Cells) -> str:
    difference.take((SPOT.y + row, SPOT.x, list(cells.strip(row))) for row in range(SPOT.height))
    return difference.sequence()


_regions = st.builds(
    Region, st.integers(0, COLUMNS), st.integers(0, ROWS), st.integers(0, 6), st.integers(0, 4)
)


@given(
    pictures(),
    pictures(),
    st.lists(_regions, max_size=3),
    st.sampled_from((None, *ColorSystem)).filter(lambda colours: colours != ColorSystem.WINDOWS),
)
def test_a_spot_shows_its_cells_but_where_something_lies_over_it(
    before: Cells, now: Cells, covers: list[Region], colours: ColorSystem | None
) -> None:
    over = [found for cover in covers if (found := cover.intersection(SPOT))]
    covered = {(x, y) for region in over for y in region.line_range for x in region.column_range}
    straight, by_strips = pyte.Screen(COLUMNS, ROWS), pyte.Screen(COLUMNS, ROWS)
    ours, theirs = (CellDiff(COLUMNS, ROWS, colours) for _ in range(2))
    spot = PaintTarget(ours, SPOT, over)
    for cells, changes in ((before, WHOLE), (now, now.changes(before))):
        spot.put(cells, changes)
        pyte.Stream(straight).feed(ours.sequence())
        pyte.Stream(by_strips).feed(sent_in_strips(theirs, cells))
    shown, expected = looks(straight), looks(by_strips)
    for y in SPOT.line_range:
        for x in SPOT.column_range:
            if (x, y) in covered:
                assert shown[y][x] == looks(pyte.Screen(COLUMNS, ROWS))[y][x]
            elif not is_half_covered(now, x, y, covered):
                assert shown[y][x] == expected[y][x]


def is_half_covered(cells: Cells, x: int, y: int, covered: set[tuple[int, int]]) -> bool:
    """Whether a cell belongs to a character whose other half is covered."""
    row, column = y - SPOT.y, x - SPOT.x
    if cells.text[row, column] == CONTINUED:
        return (x - 1, y) in covered
    return cells.is_cut(row, column + 1) and (x + 1, y) in covered


@given(pictures(), st.integers(1, COLUMNS), st.integers(1, ROWS))
def test_of_a_spot_is_shown_what_there_is_room_for(cells: Cells, columns: int, rows: int) -> None:
    straight, by_strips = pyte.Screen(columns, rows), pyte.Screen(columns, rows)
    ours, theirs = (CellDiff(columns, rows, None) for _ in range(2))
    PaintTarget(ours, SPOT, []).put(cells, WHOLE)
    pyte.Stream(straight).feed(ours.sequence())
    pyte.Stream(by_strips).feed(sent_in_strips(theirs, cells))
    assert straight.display == by_strips.display
