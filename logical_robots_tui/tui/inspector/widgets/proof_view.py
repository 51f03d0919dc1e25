"""A proof on the screen: an expandable tree with a cursor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from textual.content import Content
from textual.geometry import Region, Size

from logical_robots_tui.tui.inspector.widgets.line_views import CursorView
from logical_robots_tui.tui.inspector.widgets.proof_tree import (
    MARKER_WIDTH,
    ProofLine,
    ProofTree,
    guides,
    line_content,
)
from logical_robots_tui.tui.layout.command_bar import CommandChosen

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask, Node


class WhyView(CursorView):
    """A proof; renders only visible lines. Arrows, enter and backspace expand and ask."""

    BINDINGS = [
        ("right", "inward"),
        ("left", "outward"),
        ("enter", "deeper"),
        ("backspace", "back"),
    ]

    def __init__(
        self,
        *,
        pointed: Callable[[Node, bool], None],
        deeper: Callable[[Ask], None],
        lacking: Callable[[int, Ask], None],
        back: Callable[[], None],
    ) -> None:
        """`pointed` gets whether the player has moved the cursor, `lacking` the key of a line."""
        super().__init__(id="why")
        self._tell_pointed, self._tell_deeper, self._tell_lacking = pointed, deeper, lacking
        self.action_back = back
        self._tree = ProofTree()
        self._key = 0
        self._has_way_back = False

    @property
    def lines(self) -> Sequence[ProofLine]:
        return self._tree.lines

    @property
    def line(self) -> ProofLine | None:
        return self.lines[self._at] if self.lines else None

    @property
    def pointed(self) -> Node | None:
        return self.line.node if self.line is not None else None

    @property
    def path(self) -> Sequence[Node]:
        """The node under the cursor, then those above it, the nearest first."""
        found: list[Node] = []
        at: int | None = self._at if self.lines else None
        while at is not None:
            found.append(self.lines[at].node)
            at = self._tree.parent(at)
        return found

    @property
    def has_room_for_proofs(self) -> bool:
        """Whether there is room below lines whose proofs are not known yet."""
        return len(self.lines) < self.size.height and any(line.lacks for line in self.lines)

    @property
    def height(self) -> int:
        return len(self.lines)

    count = height

    def span(self, item: int) -> range:
        return range(item, item + 1)

    def item_at(self, line: int) -> int | None:
        return line if line < self.count else None

    def content(self, number: int) -> Content:
        return line_content(self.lines[number], self.columns, is_open=self.is_open(number))

    def is_open(self, number: int) -> bool:
        return self._tree.is_open(self.lines[number])

    def show(
        self,
        roots: Sequence[Node],
        rest: Sequence[Node] = (),
        *,
        anew: bool = False,
        has_way_back: bool = False,
    ) -> None:
        """Show a proof. Cursor and expansions stay, unless `anew`; `rest` is collapsed."""
        was_empty = not self.lines
        self._has_way_back = has_way_back
        self._tree.show(roots, rest, self.size.height, anew=anew)
        if anew:
            self._at, self._key = 0, 0
            self.scroll_to(y=0, animate=False)
        self._restore_cursor()
        if was_empty:
            self.scroll_to_region(Region(0, self._at, 1, 1), animate=False, force=True)
        self._post_pointed(moved=False)

    def open(self, number: int) -> None:
        line = self.lines[number]
        self._tree.open(number)
        self._restore_cursor()
        height = 1 + min(len(line.children), self.size.height - 1)
        self.scroll_to_region(Region(0, number, 1, height), animate=False, force=True)
        if line.lacks and line.node.asked is not None:
            self._tell_lacking(line.key, line.node.asked)

    def close(self, number: int) -> None:
        self._tree.close(number)
        self._restore_cursor()

    def toggle_fold(self, number: int) -> None:
        self.close(number) if self.is_open(number) else self.open(number)

    def unfold(self, key: int, nodes: Sequence[Node]) -> None:
        self._tree.unfold(key, nodes)
        self._restore_cursor()

    def draw(self) -> None:
        self._tree.fit(self.size.height)
        self._restore_cursor()

    def cursor_moved(self) -> None:
        if self.line is not None:
            self._key = self.line.key
        self._post_pointed(moved=True)

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        """Expand or collapse at the marker; elsewhere a second click goes deeper."""
        del line
        start = len(guides(self.lines[self._at].depth, self.columns))
        if start <= x < start + MARKER_WIDTH and self.lines[self._at].folds:
            self.toggle_fold(self._at)
        elif again:
            self.action_deeper()

    def action_inward(self) -> None:
        """Expand the line under the cursor; if it is expanded, go to its first child."""
        if not self.lines or not self.lines[self._at].folds:
            return
        if not self.is_open(self._at):
            self.open(self._at)
        elif self.lines[self._at].children:
            self.action_move(1)

    def action_outward(self) -> None:
        """Collapse the line under the cursor, or go to its parent; at a root, go back."""
        parent = self._tree.parent(self._at) if self.lines else None
        if parent is None and self._has_way_back:
            self.action_back()
        elif not self.lines:
            return
        elif self.is_open(self._at):
            self.close(self._at)
        elif parent is not None:
            self.action_move(parent - self._at)

    def action_deeper(self) -> None:
        node = self.pointed
        if node is None:
            return
        if node.asked is not None:
            self._tell_deeper(node.asked)
        elif node.values:
            self.post_message(CommandChosen("open_value"))
        else:
            self.toggle_fold(self._at)

    def _restore_cursor(self) -> None:
        at = self._tree.number(self._key)
        self._at = max(0, min(self._at, len(self.lines) - 1)) if at is None else at
        if self.lines:
            self._key = self.lines[self._at].key
        self.virtual_size = Size(self.columns, len(self.lines))
        self.refresh()

    def _post_pointed(self, *, moved: bool) -> None:
        if self.pointed is not None:
            self._tell_pointed(self.pointed, moved)
