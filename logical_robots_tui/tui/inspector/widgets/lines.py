"""A view that paints lines: quick to replace many times a second, and only where they differ."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.style import Style
    from textual.content import Content

__all__ = ["LinesView"]


class LinesView(ScrollView, can_focus=True):
    """Paints lines instead of holding widgets, so that a new tick never lays anything out anew."""

    DEFAULT_CSS = """
    LinesView { background: $surface; height: 1fr; overflow: hidden auto; }
    """

    def __init__(self, *, id: str) -> None:  # noqa: A002 - the name that widgets have
        super().__init__(id=id)
        self._painted: list[Content] = []

    @property
    def columns(self) -> int:
        """How wide a line may be; 0 as long as the view has no room."""
        return self.scrollable_content_region.width

    @property
    def plain(self) -> str:
        """All lines without their colours, also those out of sight."""
        return "\n".join(line.plain for line in self._painted)

    def paint(self, lines: Sequence[Content]) -> None:
        """Show lines; what is the same stays as it is."""
        before, self._painted = self._painted, list(lines)
        if len(before) != len(lines):
            self.virtual_size = Size(self.columns, len(lines))
            self.refresh()
            return
        top = self.scroll_offset.y
        changed = [
            Region(0, number - top, self.columns, 1)
            for number, (old, new) in enumerate(zip(before, lines, strict=True))
            if number >= top and not old.is_same(new)
        ]
        if changed:
            self.refresh(*changed)

    def render_line(self, y: int) -> Strip:
        """One line of the view."""
        number = y + self.scroll_offset.y
        if number >= len(self._painted):
            return Strip.blank(self.columns, self.rich_style)
        strip = Strip(self._painted[number].render_segments(self.visual_style))
        return strip.adjust_cell_length(self.columns, self.fill(number))

    def fill(self, number: int) -> Style:
        """The style behind the end of a line."""
        del number
        return self.rich_style
