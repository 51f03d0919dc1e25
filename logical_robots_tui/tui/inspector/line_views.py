"""Views that paint lines instead of holding widgets, so that a new tick needs no layout."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from textual import events
from textual.content import Content
from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from logical_robots_tui.tui.theme.themes import rich_style

_CURSOR = "on $here"
_CURSOR_OF_16 = "$here-ink on $here"
_END = 1_000_000


class LinesView(ScrollView, can_focus=True):
    """Shows lines; repaints only those that differ from the previous ones."""

    DEFAULT_CSS = """
    LinesView { background: $surface; height: 1fr; overflow: hidden auto; margin: 0 1; }
    """

    def __init__(self, *, id: str) -> None:  # noqa: A002 - the name that widgets have
        super().__init__(id=id)
        self._painted: list[Content] = []
        self._lines_for: Callable[[int], Sequence[Content]] | None = None

    @property
    def columns(self) -> int:
        """Width of a line; 0 while the view has no room."""
        return self.scrollable_content_region.width

    @property
    def height(self) -> int:
        return len(self._painted)

    @property
    def plain(self) -> str:
        return "\n".join(self.content(number).plain for number in range(self.height))

    def content(self, number: int) -> Content:
        return self._painted[number]

    def is_at_cursor(self, number: int) -> bool:
        return False

    def show_lines(self, lines_for: Callable[[int], Sequence[Content]]) -> None:
        self._lines_for = lines_for
        self.redraw()

    def draw(self) -> None:
        if self._lines_for is not None:
            self.paint(self._lines_for(self.columns))

    def redraw(self) -> None:
        if self.columns > 0:
            self.draw()

    def on_resize(self) -> None:
        self.redraw()

    def paint(self, lines: Sequence[Content]) -> None:
        old_lines, self._painted = self._painted, list(lines)
        if len(old_lines) != len(lines):
            self.virtual_size = Size(self.columns, len(lines))
            self.refresh()
        else:
            pairs = enumerate(zip(old_lines, lines, strict=True))
            self.repaint(*(number for number, (old, new) in pairs if not old.is_same(new)))

    def repaint(self, *numbers: int) -> None:
        top, width = self.scroll_offset.y, self.size.width
        regions = [Region(0, number - top, width, 1) for number in numbers if number >= top]
        if regions:
            self.refresh(*regions)

    def render_line(self, y: int) -> Strip:
        number = y + self.scroll_offset.y
        if number >= self.height:
            return Strip.blank(self.columns, self.rich_style)
        content, style = self.content(number), self.rich_style
        if self.is_at_cursor(number):
            if self.app.current_theme.ansi:  # an ink may be as blue as the cursor
                content = content.stylize(_CURSOR_OF_16)
            content, style = content.stylize_before(_CURSOR), style + rich_style(_CURSOR)
        strip = Strip(content.render_segments(self.visual_style))
        return strip.adjust_cell_length(self.columns, style)


class CursorView(LinesView):
    """Lines with a cursor on an item: one line, or several that belong together."""

    BINDINGS = [
        ("up", "move(-1)"),
        ("down", "move(1)"),
        ("pageup", "page(-1)"),
        ("pagedown", "page(1)"),
        ("home", f"move({-_END})"),
        ("end", f"move({_END})"),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - the name that widgets have
        super().__init__(id=id)
        self._at = 0
        self._spans: list[range] = []

    @property
    def count(self) -> int:
        return len(self._spans)

    def span(self, item: int) -> range:
        return self._spans[item]

    def item_at(self, line: int) -> int | None:
        return next((n for n in range(self.count) if line in self.span(n)), None)

    def paint_items(self, items: Sequence[Sequence[Content]], footer: Sequence[Content]) -> None:
        lines: list[Content] = []
        self._spans = []
        for item in items:
            self._spans.append(range(len(lines), len(lines) + len(item)))
            lines += item
        self._at = max(0, min(self._at, len(items) - 1))
        self.paint([*lines, *footer])

    def cursor_moved(self) -> None:
        """Follow the cursor, which the player has put on an item."""

    def is_at_cursor(self, number: int) -> bool:
        return self.has_focus and self._at < self.count and number in self.span(self._at)

    def on_focus(self) -> None:
        self._repaint_item(self._at)
        self.cursor_moved()

    def on_blur(self) -> None:
        self._repaint_item(self._at)

    def on_click(self, event: events.Click) -> None:
        """Move the cursor to an item; pass on whether it was there already."""
        line = event.y + self.scroll_offset.y
        item = self.item_at(line)
        if item is not None:
            was_there = item == self._at
            self.action_move(item - self._at)
            self.clicked(event.x, line - self.span(item).start, again=was_there)

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        """React to a click.

        `x` is a column, `line` one of the item, now under the cursor; `again`: it was before, too.
        """

    def action_move(self, down: int) -> None:
        if self.count:
            old_item, self._at = self._at, max(0, min(self._at + down, self.count - 1))
            self._repaint_item(old_item)
            self._repaint_item(self._at)
            lines = self.span(self._at)
            # The last item is shown with the lines below it.
            stop = self.height if self._at == self.count - 1 else lines.stop
            area = Region(0, lines.start, 1, stop - lines.start)
            self.scroll_to_region(area, animate=False, force=True)
            self.cursor_moved()

    def action_page(self, down: int) -> None:
        if self.count:
            self.action_move(down * max(1, (self.size.height - 1) // len(self.span(self._at))))

    def _repaint_item(self, item: int) -> None:
        if item < self.count:
            self.repaint(*self.span(item))
