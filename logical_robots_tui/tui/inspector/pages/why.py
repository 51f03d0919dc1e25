"""Why, in the inspector: a proof as a tree to fold, walked through with a cursor."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.geometry import Region, Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from logical_robots_tui.tui.inspector.widgets.folds import Folds, Line
from logical_robots_tui.tui.inspector.widgets.proof_lines import FOLD, guides, line_content
from logical_robots_tui.tui.theme.themes import rich_style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual import events
    from textual.content import Content

    from logical_robots_tui.mind import Ask, Node

__all__ = ["WhyView"]

_HERE = "on $here"
_END = 1_000_000


class WhyView(ScrollView, can_focus=True):
    """A proof. Only the lines in sight are painted, however many there are.

    Right opens, left closes, enter asks one step deeper, backspace comes back.
    """

    DEFAULT_CSS = """
    WhyView { background: $surface; height: 1fr; overflow: hidden auto; margin: 0 1; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("up", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("pageup", "page(-1)", show=False),
        Binding("pagedown", "page(1)", show=False),
        Binding("home", f"move({-_END})", show=False),
        Binding("end", f"move({_END})", show=False),
        Binding("right", "inward", show=False),
        Binding("left", "outward", show=False),
        Binding("enter", "deeper", show=False),
        Binding("backspace", "back", show=False),
    ]

    class Pointed(Message):
        """The cursor is on another node, or the node under it is another one.

        Attributes:
            node: The node.
            moved: Whether the player has moved the cursor.
        """

        def __init__(self, node: Node, *, moved: bool) -> None:
            super().__init__()
            self.node, self.moved = node, moved

    class Deeper(Message):
        """The player asks one step deeper.

        Attributes:
            asked: What is asked.
        """

        def __init__(self, asked: Ask) -> None:
            super().__init__()
            self.asked = asked

    class Lacking(Message):
        """A line was opened whose proof is not known yet.

        Attributes:
            key: The line.
            asked: What it asks.
        """

        def __init__(self, key: int, asked: Ask) -> None:
            super().__init__()
            self.key, self.asked = key, asked

    class Opened(Message):
        """The player wants to look into the values of the node under the cursor."""

    class Back(Message):
        """The player wants the question before."""

    def __init__(self) -> None:
        super().__init__(id="why")
        self._folds = Folds()
        self._at, self._key = 0, 0
        self._has_way_back = False

    @property
    def lines(self) -> Sequence[Line]:
        """The nodes that are not folded away, in order."""
        return self._folds.lines

    @property
    def line(self) -> Line | None:
        """The line under the cursor."""
        return self.lines[self._at] if self.lines else None

    @property
    def pointed(self) -> Node | None:
        """The node under the cursor."""
        return self.line.node if self.line is not None else None

    @property
    def plain(self) -> str:
        """All lines without their colours, also those out of sight."""
        return "\n".join(self._content(number).plain for number in range(len(self.lines)))

    def is_open(self, number: int) -> bool:
        """Whether the children of a line are in sight."""
        return self._folds.is_open(self.lines[number])

    def show(
        self,
        roots: Sequence[Node],
        rest: Sequence[Node] = (),
        *,
        anew: bool = False,
        has_way_back: bool = False,
    ) -> None:
        """Show a proof; what the player opened or closed stays so, and the cursor where it is.

        Args:
            roots: The rules of the proof.
            rest: Rules that have no part in it; they are folded.
            anew: Whether this is another question, so that the cursor begins at the top.
            has_way_back: Whether there is a question before.
        """
        was_empty = not self.lines
        self._has_way_back = has_way_back
        self._folds.show(roots, rest, self.size.height, anew=anew)
        if anew:
            self._at, self._key = 0, 0
            self.scroll_to(y=0, animate=False)
        self._return()
        if was_empty:
            self.scroll_to_region(Region(0, self._at, 1, 1), animate=False, force=True)
        self._tell(moved=False)

    def open(self, number: int) -> None:
        """Open a line, and bring what is below it to sight as far as there is room."""
        line = self.lines[number]
        self._folds.open(number)
        self._return()
        height = 1 + min(len(line.children), self.size.height - 1)
        self.scroll_to_region(Region(0, number, 1, height), animate=False, force=True)
        if line.lacks and line.node.asked is not None:
            self.post_message(self.Lacking(line.key, line.node.asked))

    def close(self, number: int) -> None:
        """Close a line."""
        self._folds.close(number)
        self._return()

    def unfold(self, key: int, nodes: Sequence[Node]) -> None:
        """Put the proof of what a line asks below it."""
        self._folds.unfold(key, nodes)
        self._return()

    def on_resize(self) -> None:
        """Use the room there is now."""
        self._folds.fit(self.size.height)
        self._return()

    def on_focus(self) -> None:
        """Show the cursor."""
        self.refresh()
        self._tell(moved=True)

    def on_blur(self) -> None:
        """Hide the cursor."""
        self.refresh()

    def on_click(self, event: events.Click) -> None:
        """Fold at the marker; elsewhere put the cursor there, and go deeper at a second click."""
        number = event.y + self.scroll_offset.y
        if number >= len(self.lines):
            return
        was_there = number == self._at
        self.action_move(number - self._at)
        start = len(guides(self.lines[number].depth, self._width))
        if start <= event.x < start + FOLD and self.lines[number].folds:
            self.close(number) if self.is_open(number) else self.open(number)
        elif was_there:
            self.action_deeper()

    def action_move(self, down: int) -> None:
        """Move the cursor."""
        if not self.lines:
            return
        before, self._at = self._at, max(0, min(self._at + down, len(self.lines) - 1))
        self._key = self.lines[self._at].key
        top = self.scroll_offset.y
        self.refresh(*(Region(0, row - top, self.size.width, 1) for row in (before, self._at)))
        self.scroll_to_region(Region(0, self._at, 1, 1), animate=False, force=True)
        self._tell(moved=True)

    def action_page(self, down: int) -> None:
        """Move the cursor by what is in sight."""
        self.action_move(down * max(1, self.size.height - 1))

    def action_inward(self) -> None:
        """Open the line under the cursor; if it is open, go to the first one below it."""
        if not self.lines or not self.lines[self._at].folds:
            return
        if not self.is_open(self._at):
            self.open(self._at)
        elif self.lines[self._at].children:
            self.action_move(1)

    def action_outward(self) -> None:
        """Close the line under the cursor, or go to the one above it; at a root, come back."""
        parent = self._folds.parent(self._at) if self.lines else None
        if parent is None and self._has_way_back:
            self.action_back()
        elif not self.lines:
            return
        elif self.is_open(self._at):
            self.close(self._at)
        elif parent is not None:
            self.action_move(parent - self._at)

    def action_deeper(self) -> None:
        """Ask about what the line under the cursor asks, or look into its values."""
        node = self.pointed
        if node is None:
            return
        if node.asked is not None:
            self.post_message(self.Deeper(node.asked))
        elif node.values:
            self.post_message(self.Opened())
        elif self.is_open(self._at):
            self.close(self._at)
        else:
            self.open(self._at)

    def action_back(self) -> None:
        """Return to the question before."""
        self.post_message(self.Back())

    def render_line(self, y: int) -> Strip:
        """One line of the view."""
        number = y + self.scroll_offset.y
        width = self._width
        if number >= len(self.lines):
            return Strip.blank(width, self.rich_style)
        content, style = self._content(number), self.rich_style
        if number == self._at and self.has_focus:
            content, style = content.stylize_before(_HERE), style + rich_style(_HERE)
        strip = Strip(content.render_segments(self.visual_style))
        return strip.adjust_cell_length(width, style)

    # -- inside --------------------------------------------------------------------------------

    @property
    def _width(self) -> int:
        """Columns of a line."""
        return self.scrollable_content_region.width

    def _content(self, number: int) -> Content:
        return line_content(self.lines[number], self._width, is_open=self.is_open(number))

    def _return(self) -> None:
        """Put the cursor on the line that it was on, if that is there, and show what is new."""
        at = self._folds.number(self._key)
        self._at = max(0, min(self._at, len(self.lines) - 1)) if at is None else at
        if self.lines:
            self._key = self.lines[self._at].key
        self._draw()

    def _tell(self, *, moved: bool) -> None:
        if self.pointed is not None:
            self.post_message(self.Pointed(self.pointed, moved=moved))

    def _draw(self) -> None:
        self.virtual_size = Size(self._width, len(self.lines))
        self.refresh()
