"""What is said about a line of the program, in the line itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from logical_robots_tui.tui.theme.safe_text import clip, one_line

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Mark", "marked"]

_GAP = 3
"""Cells between a line and the message behind it: the cursor may stand there."""

_LEAST_ROOM = 16
"""Cells from which on a message is worth its place."""


class Mark(NamedTuple):
    """What is to be said about a line.

    Attributes:
        message: One sentence.
        is_wrong: Whether the program can't run because of it.
    """

    message: str
    is_wrong: bool


def marked(strip: Strip, mark: Mark, row: int, gutter: int, styles: Mapping[str, Style]) -> Strip:
    """Return a line with a sign in the gutter, and a message behind it as far as there is room.

    Args:
        strip: The line as the text area draws it.
        mark: What to say.
        row: The number of the line, from 0.
        gutter: Cells of the gutter.
        styles: As ``SYNTAX`` names them.
    """
    sign, ink = ("✗", "mistake-gutter") if mark.is_wrong else ("!", "odd-gutter")
    paper = styles["mistake"] if mark.is_wrong else Style()
    label = Segment(f"{row + 1:>{gutter - 2}}{sign} ", styles[ink])
    rest = strip.crop(gutter)
    end = cell_len(rest.text.rstrip()) + _GAP
    space = rest.cell_length - end
    if space >= _LEAST_ROOM:
        message = clip(f"◂ {one_line(mark.message)}", space)
        told = Strip([Segment(message, styles["message"])]).crop(0, space)
        rest = Strip.join([rest.crop(0, end), told, rest.crop(end + told.cell_length)])
    text = [Segment(text, (style or Style()) + paper, control) for text, style, control in rest]
    return Strip([label, *text])
