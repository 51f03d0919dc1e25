"""Errors: signs beside the lines of a program, and a strip of messages below the text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rich.segment import Segment
from rich.style import Style
from textual.content import Content
from textual.message import Message
from textual.strip import Strip
from textual.widgets import Static

from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic

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

    _shown: tuple[Diagnostic, ...] = ()

    class Chosen(Message):
        """The player goes to the error."""

    def show(self, mistakes: tuple[Diagnostic, ...], row: int) -> None:
        if len(mistakes) > _MOST_SHOWN:
            mistakes = tuple(sorted(mistakes, key=lambda mistake: mistake.line != row + 1))
        if mistakes == self._shown:
            return
        self._shown = mistakes
        self.display = bool(mistakes)
        self.set_class(all(mistake.severity == "warning" for mistake in mistakes), "-odd")
        lines = [_describe(mistake) for mistake in mistakes[:_MOST_SHOWN]]
        if len(mistakes) > _MOST_SHOWN:
            lines.append(Content.styled(f"and {len(mistakes) - _MOST_SHOWN} more", INK.dim))
        self.update(Content("\n").join(lines))

    def on_click(self) -> None:
        self.post_message(self.Chosen())


def _describe(mistake: Diagnostic) -> Content:
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


def mark(
    strip: Strip, row: int | None, gutter: int, styles: Mapping[str, Style], *, is_wrong: bool
) -> Strip:
    """Mark a line in its gutter, and an error's ground; row None continues a wrapped line."""
    sign, ink = ("✗", "mistake-gutter") if is_wrong else ("!", "odd-gutter")
    label = " " * gutter if row is None else f"{row + 1:>{gutter - 2}}{sign} "
    rest = strip.crop(gutter)
    if is_wrong:
        paper = styles["mistake"]
        rest = Strip(
            [Segment(text, (style or Style()) + paper, control) for text, style, control in rest]
        )
    return Strip([Segment(label, styles[ink]), *rest])
