"""A proof as an expandable tree: which nodes are expanded, how lines look, and the view of them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from textual.content import Content
from textual.geometry import Region, Size

from logical_robots_tui.tui.inspector.line_views import CursorView
from logical_robots_tui.tui.inspector.plots import ink_value
from logical_robots_tui.tui.layout.command_bar import CommandChosen
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask, ProofNode

_GUIDE = "│ "  # for each node above a line
_GUIDES_SHARE = 3  # guides take a third of a line at most
_EXPANDED, _COLLAPSED, _LEAF = "▾ ", "▸ ", "  "
_MARKS = {True: ("✓ ", INK.good), False: ("✗ ", INK.bad), None: ("", INK.dim)}
_DEEPER = " →"
_WIDEST_VALUE = 60
_NARROWEST_TEXT = 8
_INKS = {"rule": f"bold {INK.title}", "note": INK.dim, "value": INK.dim, "read": INK.dim}


class ProofLine(NamedTuple):
    """A node on a line. A tuple because 10,000 dataclasses take twice as long to make.

    `key` is the same for one place in trees of different ticks; a line `lacks` a proof that is
    not known yet.
    """

    node: ProofNode
    depth: int
    key: int
    children: tuple[ProofNode, ...]
    lacks: bool

    @property
    def folds(self) -> bool:
        return bool(self.children) or self.lacks


class ProofTree:
    def __init__(self) -> None:
        self.lines: list[ProofLine] = []
        self._roots: tuple[ProofNode, ...] = ()
        self._alternatives: tuple[ProofNode, ...] = ()
        self._open: set[int] = set()
        self._choices: dict[int, bool] = {}
        self._unfolded: dict[int, tuple[ProofNode, ...]] = {}
        self._child_lines: dict[int, list[ProofLine]] = {}
        self._keys: dict[tuple[int, str, str, int], int] = {}

    def show(
        self,
        roots: Sequence[ProofNode],
        alternatives: Sequence[ProofNode],
        room: int,
        *,
        anew: bool = False,
    ) -> None:
        """Replace the nodes, keeping what the player expanded or collapsed, unless `anew`.

        `roots` are expanded within `room` (lines); the `alternatives` below stay collapsed.
        """
        self._unfolded.clear()
        self._child_lines.clear()
        if anew:
            self._choices.clear()
            self._keys.clear()
        self._roots, self._alternatives = tuple(roots), tuple(alternatives)
        self.fit(room)

    def fit(self, room: int) -> None:
        lines = self._siblings((*self._roots, *self._alternatives), 0, 0)
        line_count = len(lines)
        self._open = set()
        waiting = deque((line, number < len(self._roots)) for number, line in enumerate(lines))
        while waiting:
            line, is_wanted = waiting.popleft()
            is_wanted = is_wanted and line.node.kind != "derivation"
            fits = is_wanted and bool(line.children) and line_count + len(line.children) <= room
            if line.folds and self._choices.get(line.key, fits):
                self._open.add(line.key)
                below = self._children(line)
                line_count += len(below)
                failed_first = sorted(below, key=lambda child: child.node.holds is not False)
                waiting.extend((child, True) for child in failed_first)
        self.lines = [descendant for line in lines for descendant in (line, *self._below(line))]

    def is_open(self, line: ProofLine) -> bool:
        return line.key in self._open

    def open(self, number: int) -> None:
        line = self.lines[number]
        if line.folds and not self.is_open(line):
            self._open.add(line.key)
            self._choices[line.key] = True
            self.lines[number + 1 : number + 1] = self._below(line)

    def close(self, number: int) -> None:
        line = self.lines[number]
        if self.is_open(line):
            self._open.remove(line.key)
            self._choices[line.key] = False
            del self.lines[number + 1 : self._end(number)]

    def parent(self, number: int) -> int | None:
        depth = self.lines[number].depth
        return next((n for n in range(number - 1, -1, -1) if self.lines[n].depth < depth), None)

    def number(self, key: int) -> int | None:
        return next((n for n, line in enumerate(self.lines) if line.key == key), None)

    def unfold(self, key: int, nodes: Sequence[ProofNode]) -> None:
        self._unfolded[key] = tuple(nodes)
        self._child_lines.clear()
        number = self.number(key)
        if number is not None:
            line = self.lines[number]
            new_line = self._line(line.node, line.depth, key)
            self.lines[number : self._end(number)] = [new_line, *self._below(new_line)]

    def _end(self, number: int) -> int:
        """Return the number of the first line after a line's descendants."""
        depth = self.lines[number].depth
        later = range(number + 1, len(self.lines))
        return next((n for n in later if self.lines[n].depth <= depth), len(self.lines))

    def _below(self, line: ProofLine) -> list[ProofLine]:
        subtree: list[ProofLine] = []
        waiting = [line]
        while waiting:
            child = waiting.pop()
            subtree.append(child)
            if self.is_open(child):
                waiting += reversed(self._children(child))
        return subtree[1:]

    def _children(self, line: ProofLine) -> list[ProofLine]:
        children = self._child_lines.get(line.key)
        if children is None:
            children = self._siblings(line.children, line.depth + 1, line.key)
            self._child_lines[line.key] = children
        return children

    def _siblings(self, nodes: Sequence[ProofNode], depth: int, above: int) -> list[ProofLine]:
        keys, alike, siblings = self._keys, dict[tuple[str, str], int](), []
        for node in nodes:
            about = node.kind, node.text
            alike[about] = which = alike.get(about, 0) + 1
            key = keys.setdefault((above, *about, which), len(keys) + 1)
            siblings.append(self._line(node, depth, key))
        return siblings

    def _line(self, node: ProofNode, depth: int, key: int) -> ProofLine:
        if node.query is None:
            return ProofLine(node, depth, key, node.children, lacks=False)
        extra_nodes = self._unfolded.get(key, ())
        is_proved = extra_nodes or any(
            child.kind in ("rule", "note", "instance") for child in node.children
        )
        return ProofLine(node, depth, key, (*node.children, *extra_nodes), lacks=not is_proved)


def _guides(depth: int, width: int) -> str:
    """Return a line's indentation: a guide per ancestor, or their number if there are many."""
    limit = max(1, width // (_GUIDES_SHARE * len(_GUIDE)))
    if depth <= limit:
        return _GUIDE * depth
    number = f"{depth} "
    return (_GUIDE * limit)[: -len(number)] + number


def line_content(line: ProofLine, width: int, *, is_open: bool) -> Content:
    """Return a coloured line cut to a width; the remark at its end is never cut off."""
    node = line.node
    marker = (_EXPANDED if is_open else _COLLAPSED) if line.folds else _LEAF
    head = Content.assemble(
        (_guides(line.depth, width), INK.faint), (marker, INK.key), _MARKS[node.holds]
    )
    if node.is_rule and node.span is not None:
        head = head.append(Content.styled(f"{node.span.line}: ", INK.faint))
    remark = f"  {one_line(node.remark)}" if node.remark else ""
    tail = Content.assemble(
        (remark, INK.bad if node.holds is False else INK.dim),
        (_DEEPER if node.query is not None else "", INK.key),
    )
    text = one_line(node.text)
    room = max(_NARROWEST_TEXT, width - head.cell_length - tail.cell_length)
    values = _values(node, max(room - len(text), room // 2))
    text = clip(text, max(_NARROWEST_TEXT, room - values.cell_length))
    named = Content.styled(text, _INKS.get("rule" if node.is_rule else node.kind, INK.text))
    return head.append(named).append(values).append(tail).truncate(width)


def _values(node: ProofNode, room: int) -> Content:
    parts: list[Content] = []
    ending = ""
    for number, value in enumerate(node.values):
        remainder = len(node.values) - number - 1 + node.excess
        words = f" (and {remainder:,} more)" if remainder else ""
        glue = " or " if parts else " = "
        left = room - sum(part.cell_length for part in parts) - len(glue) - len(words)
        widest = _WIDEST_VALUE if parts else min(max(4, left), _WIDEST_VALUE)
        text, colour = ink_value(value, widest)
        if parts and len(text) > left:
            break
        parts.append(Content.assemble((glue, INK.dim), (text, colour)))
        ending = words
    return Content("").join([*parts, Content.styled(ending, INK.warn)])


class WhyView(CursorView):
    """A proof; renders only visible lines. Arrows, enter and backspace expand and ask."""

    bar_keys = (
        *(("←→", "Fold"), ("enter", "Why"), ("backspace", "Back"), ("pin", "Pin")),
        *(("origin", "Origin"), ("other_values", "Other values"), ("break_here", "Break")),
    )

    BINDINGS = [
        ("right", "inward"),
        ("left", "outward"),
        ("enter", "deeper"),
        ("backspace", "back"),
    ]

    def __init__(
        self,
        *,
        pointed: Callable[[ProofNode, bool], None],
        deeper: Callable[[Ask], None],
        lacking: Callable[[int, Ask], None],
        back: Callable[[], bool],
    ) -> None:
        """`pointed` gets whether the player has moved the cursor, `lacking` the key of a line.

        `back` returns whether there is a way back.
        """
        super().__init__(id="why")
        self._tell_pointed, self._tell_deeper, self._tell_lacking = pointed, deeper, lacking
        self.action_back = back
        self._tree = ProofTree()
        self._key = 0

    @property
    def lines(self) -> Sequence[ProofLine]:
        return self._tree.lines

    @property
    def line(self) -> ProofLine | None:
        return self.lines[self._at] if self.lines else None

    @property
    def pointed(self) -> ProofNode | None:
        return self.line.node if self.line is not None else None

    @property
    def path(self) -> Sequence[ProofNode]:
        """The node under the cursor, then those above it, the nearest first."""
        nodes: list[ProofNode] = []
        number: int | None = self._at if self.lines else None
        while number is not None:
            nodes.append(self.lines[number].node)
            number = self._tree.parent(number)
        return nodes

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

    def content(self, number: int) -> Content:
        return line_content(self.lines[number], self.columns, is_open=self.is_open(number))

    def is_open(self, number: int) -> bool:
        return self._tree.is_open(self.lines[number])

    def show(
        self,
        roots: Sequence[ProofNode],
        alternatives: Sequence[ProofNode] = (),
        *,
        anew: bool = False,
    ) -> None:
        """Show a proof. Cursor and expansions stay, unless `anew`."""
        was_empty = not self.lines
        self._tree.show(roots, alternatives, self.size.height, anew=anew)
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
        if line.lacks and line.node.query is not None:
            self._tell_lacking(line.key, line.node.query)

    def close(self, number: int) -> None:
        self._tree.close(number)
        self._restore_cursor()

    def toggle_fold(self, number: int) -> None:
        self.close(number) if self.is_open(number) else self.open(number)

    def unfold(self, key: int, nodes: Sequence[ProofNode]) -> None:
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
        start = len(_guides(self.lines[self._at].depth, self.columns))
        if start <= x < start + len(_EXPANDED) and self.lines[self._at].folds:
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
        if not (parent is None and self.action_back()) and self.lines:
            if self.is_open(self._at):
                self.close(self._at)
            elif parent is not None:
                self.action_move(parent - self._at)

    def action_deeper(self) -> None:
        node = self.pointed
        if node is None:
            return
        if node.query is not None:
            self._tell_deeper(node.query)
        elif node.values:
            self.post_message(CommandChosen("open_value"))
        else:
            self.toggle_fold(self._at)

    def _restore_cursor(self) -> None:
        number = self._tree.number(self._key)
        self._at = max(0, min(self._at, len(self.lines) - 1)) if number is None else number
        if self.lines:
            self._key = self.lines[self._at].key
        self.virtual_size = Size(self.columns, len(self.lines))
        self.refresh()

    def _post_pointed(self, *, moved: bool) -> None:
        if self.pointed is not None:
            self._tell_pointed(self.pointed, moved)
