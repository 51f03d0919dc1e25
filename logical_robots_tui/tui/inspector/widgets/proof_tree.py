"""A proof as an expandable tree: which nodes are expanded, and how their lines look."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from textual.content import Content

from logical_robots_tui.tui.inspector.widgets.plots import inked
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.explain import Node

_GUIDE = "│ "  # for each node above a line
_GUIDES_SHARE = 3  # guides take a third of a line at most
_EXPANDED, _COLLAPSED, _LEAF = "▾ ", "▸ ", "  "
MARKER_WIDTH = len(_EXPANDED)
"""Columns of the marker that expands and collapses."""

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

    node: Node
    depth: int
    key: int
    children: tuple[Node, ...]
    lacks: bool

    @property
    def folds(self) -> bool:
        return bool(self.children) or self.lacks


class ProofTree:
    def __init__(self) -> None:
        self.lines: list[ProofLine] = []
        self._roots: tuple[Node, ...] = ()
        self._rest: tuple[Node, ...] = ()
        self._open: set[int] = set()
        self._chosen: dict[int, bool] = {}
        self._unfolded: dict[int, tuple[Node, ...]] = {}
        self._made: dict[int, list[ProofLine]] = {}
        self._keys: dict[tuple[int, str, str, int], int] = {}

    def show(
        self, roots: Sequence[Node], rest: Sequence[Node], room: int, *, anew: bool = False
    ) -> None:
        """Replace the nodes, keeping what the player expanded or collapsed, unless `anew`.

        `roots` are expanded as far as there is `room` (lines), `rest` stays collapsed below them.
        """
        self._unfolded.clear()
        self._made.clear()
        if anew:
            self._chosen.clear()
            self._keys.clear()
        self._roots, self._rest = tuple(roots), tuple(rest)
        self.fit(room)

    def fit(self, room: int) -> None:
        lines = self._siblings((*self._roots, *self._rest), 0, 0)
        self._open = self._fitting(lines, len(self._roots), room)
        self.lines = [each for line in lines for each in (line, *self._below(line))]

    def is_open(self, line: ProofLine) -> bool:
        return line.key in self._open

    def open(self, number: int) -> None:
        line = self.lines[number]
        if line.folds and not self.is_open(line):
            self._open.add(line.key)
            self._chosen[line.key] = True
            self.lines[number + 1 : number + 1] = self._below(line)

    def close(self, number: int) -> None:
        line = self.lines[number]
        if self.is_open(line):
            self._open.remove(line.key)
            self._chosen[line.key] = False
            del self.lines[number + 1 : self._end(number)]

    def parent(self, number: int) -> int | None:
        depth = self.lines[number].depth
        return next((n for n in range(number - 1, -1, -1) if self.lines[n].depth < depth), None)

    def number(self, key: int) -> int | None:
        return next((n for n, line in enumerate(self.lines) if line.key == key), None)

    def unfold(self, key: int, nodes: Sequence[Node]) -> None:
        self._unfolded[key] = tuple(nodes)
        self._made.clear()
        number = self.number(key)
        if number is not None:
            line = self.lines[number]
            known = self._line(line.node, line.depth, key)
            self.lines[number : self._end(number)] = [known, *self._below(known)]

    def _end(self, number: int) -> int:
        """Return the number of the first line after a line's descendants."""
        depth = self.lines[number].depth
        later = range(number + 1, len(self.lines))
        return next((n for n in later if self.lines[n].depth <= depth), len(self.lines))

    def _fitting(self, lines: Sequence[ProofLine], roots: int, room: int) -> set[int]:
        found: set[int] = set()
        shown = len(lines)
        waiting = deque((line, number < roots) for number, line in enumerate(lines))
        while waiting:
            line, is_wanted = waiting.popleft()
            fits = is_wanted and bool(line.children) and shown + len(line.children) <= room
            if line.folds and self._chosen.get(line.key, fits):
                found.add(line.key)
                below = self._children(line)
                shown += len(below)
                failed_first = sorted(below, key=lambda each: each.node.holds is not False)
                waiting.extend((each, True) for each in failed_first)
        return found

    def _below(self, line: ProofLine) -> list[ProofLine]:
        found: list[ProofLine] = []
        waiting = [line]
        while waiting:
            each = waiting.pop()
            found.append(each)
            if self.is_open(each):
                waiting += reversed(self._children(each))
        return found[1:]

    def _children(self, line: ProofLine) -> list[ProofLine]:
        found = self._made.get(line.key)
        if found is None:
            found = self._siblings(line.children, line.depth + 1, line.key)
            self._made[line.key] = found
        return found

    def _siblings(self, nodes: Sequence[Node], depth: int, above: int) -> list[ProofLine]:
        keys, alike, found = self._keys, dict[tuple[str, str], int](), []
        for node in nodes:
            about = node.kind, node.text
            alike[about] = which = alike.get(about, 0) + 1
            key = keys.setdefault((above, *about, which), len(keys) + 1)
            found.append(self._line(node, depth, key))
        return found

    def _line(self, node: Node, depth: int, key: int) -> ProofLine:
        if node.asked is None:
            return ProofLine(node, depth, key, node.children, lacks=False)
        more = self._unfolded.get(key, ())
        is_proved = more or any(
            child.kind in ("rule", "note", "instance") for child in node.children
        )
        return ProofLine(node, depth, key, (*node.children, *more), lacks=not is_proved)


def guides(depth: int, width: int) -> str:
    """Return a line's indentation: a guide per ancestor, or their number if there are many."""
    most = max(1, width // (_GUIDES_SHARE * len(_GUIDE)))
    if depth <= most:
        return _GUIDE * depth
    number = f"{depth} "
    return (_GUIDE * most)[: -len(number)] + number


def line_content(line: ProofLine, width: int, *, is_open: bool) -> Content:
    """Return a coloured line cut to a width; the remark at its end is never cut off."""
    node = line.node
    marker = (_EXPANDED if is_open else _COLLAPSED) if line.folds else _LEAF
    before = Content.assemble(
        (guides(line.depth, width), INK.faint), (marker, INK.key), _MARKS[node.holds]
    )
    if node.kind == "rule" and node.span is not None:
        before = before.append(Content.styled(f"{node.span.line}: ", INK.faint))
    said = f"  {one_line(node.said)}" if node.said else ""
    after = Content.assemble(
        (said, INK.bad if node.holds is False else INK.dim),
        (_DEEPER if node.asked is not None else "", INK.key),
    )
    text = one_line(node.text)
    room = max(_NARROWEST_TEXT, width - before.cell_length - after.cell_length)
    values = _values(node, max(room - len(text), room // 2))
    text = clip(text, max(_NARROWEST_TEXT, room - values.cell_length))
    named = Content.styled(text, _INKS.get(node.kind, INK.text))
    return before.append(named).append(values).append(after).truncate(width)


def _values(node: Node, room: int) -> Content:
    parts: list[Content] = []
    rest = ""
    for number, value in enumerate(node.values):
        more = len(node.values) - number - 1 + node.more
        words = f" (and {more:,} more)" if more else ""
        glue = " or " if parts else " = "
        left = room - sum(part.cell_length for part in parts) - len(glue) - len(words)
        widest = _WIDEST_VALUE if parts else min(max(4, left), _WIDEST_VALUE)
        text, colour = inked(value, widest)
        if parts and len(text) > left:
            break
        parts.append(Content.assemble((glue, INK.dim), (text, colour)))
        rest = words
    return Content("").join([*parts, Content.styled(rest, INK.warn)])
