"""Errors: marks in the lines of a program, and a strip of messages below the text."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.content import Content
from textual.message import Message
from textual.strip import Strip
from textual.widgets import Static

from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind import Diagnostic

__all__ = ["Mark", "MistakeStrip", "marked"]

_MOST_SHOWN = 3
_LONGEST = 400


class MistakeStrip(Static):
    """The messages of the errors; a click goes to the first one."""

    DEFAULT_CSS = """
    MistakeStrip {
        height: auto; max-height: 50%; padding: 0 1; display: none;
        background: $mistake-strip; color: $foreground;
    }
    MistakeStrip.-odd { background: $odd-strip; }
    """

    class Chosen(Message):
        """The player goes to the error."""

    def show(self, mistakes: tuple[Diagnostic, ...]) -> None:
        """Show errors, or nothing."""
        self.display = bool(mistakes)
        self.set_class(all(mistake.severity == "warning" for mistake in mistakes), "-odd")
        lines = [_described(mistake) for mistake in mistakes[:_MOST_SHOWN]]
        if len(mistakes) > _MOST_SHOWN:
            lines.append(Content.styled(f"and {len(mistakes) - _MOST_SHOWN} more", INK.dim))
        self.update(Content("\n").join(lines))

    def on_click(self) -> None:
        """Go to the error."""
        self.post_message(self.Chosen())


def _described(mistake: Diagnostic) -> Content:
    sign, ink = ("✗", INK.bad) if mistake.severity == "error" else ("!", INK.warn)
    place = f"{sign} line {mistake.line}, column {mistake.column}"
    content = Content.assemble(
        (place, f"bold {ink}"), "  ", clip(one_line(mistake.message), _LONGEST)
    )
    if mistake.hint:
        content = content.append("\n  ").append(
            Content.styled(clip(one_line(mistake.hint), _LONGEST), INK.warn)
        )
    return content


_GAP = 3
"""Cells between a line and its message, for the cursor."""

_LEAST_ROOM = 16
"""The fewest cells for a message."""


class Mark(NamedTuple):
    """The mark of a line.

    Attributes:
        message: One sentence.
        is_wrong: Whether it is an error and not a warning.
    """

    message: str
    is_wrong: bool


def marked(strip: Strip, mark: Mark, row: int, gutter: int, styles: Mapping[str, Style]) -> Strip:
    """Return a line with a sign in the gutter, and a message after it if there is room.

    Args:
        strip: The line drawn by the text area.
        mark: The mark.
        row: The number of the line, from 0.
        gutter: Cells of the gutter.
        styles: By the names in ``SYNTAX``.
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
