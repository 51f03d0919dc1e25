"""What is wrong with the program, right under its text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.message import Message
from textual.widgets import Static

from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic

__all__ = ["MistakeStrip"]

_MOST_SHOWN = 3
_LONGEST = 400


class MistakeStrip(Static):
    """The messages of the mistakes; a click goes to the first one."""

    DEFAULT_CSS = """
    MistakeStrip {
        height: auto; max-height: 50%; padding: 0 1; display: none;
        background: $mistake-strip; color: $foreground;
    }
    MistakeStrip.-odd { background: $odd-strip; }
    """

    class Chosen(Message):
        """The player wants to go to the mistake."""

    def show(self, mistakes: tuple[Diagnostic, ...]) -> None:
        """Show mistakes, or nothing."""
        self.display = bool(mistakes)
        self.set_class(all(mistake.severity == "warning" for mistake in mistakes), "-odd")
        lines = [_described(mistake) for mistake in mistakes[:_MOST_SHOWN]]
        if len(mistakes) > _MOST_SHOWN:
            lines.append(Content.styled(f"and {len(mistakes) - _MOST_SHOWN} more", INK.dim))
        self.update(Content("\n").join(lines))

    def on_click(self) -> None:
        """Go to the mistake."""
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
