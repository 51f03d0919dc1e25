"""Nodes of a proof as lines to fold: which nodes are open, and the lines that they make."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.mind import Node

__all__ = ["Folds", "Line"]


class Line(NamedTuple):
    """One node that is in sight, or would be if the view were high enough.

    A tuple and no dataclass: that halves the time for ten thousand of them.

    Attributes:
        node: The node.
        depth: How many nodes are above it.
        key: Stays the same for what has the same place in the tree of another tick.
        children: The nodes right below it.
        lacks: Whether the proof of what it asks is not known yet.
    """

    node: Node
    depth: int
    key: int
    children: tuple[Node, ...]
    lacks: bool

    @property
    def folds(self) -> bool:
        """Whether there is something to open."""
        return bool(self.children) or self.lacks


class Folds:
    """A forest of nodes, of which some are open.

    Attributes:
        lines: The nodes that are not folded away, in order.
    """

    def __init__(self) -> None:
        self.lines: list[Line] = []
        self._roots: tuple[Node, ...] = ()
        self._rest: tuple[Node, ...] = ()
        self._open: set[int] = set()
        self._chosen: dict[int, bool] = {}
        self._unfolded: dict[int, tuple[Node, ...]] = {}
        self._made: dict[int, list[Line]] = {}
        self._keys: dict[tuple[int, str, str, int], int] = {}

    def show(
        self, roots: Sequence[Node], rest: Sequence[Node], room: int, *, anew: bool = False
    ) -> None:
        """Show other nodes: open as far as there is room, and what the player opened or closed.

        Args:
            roots: What is to be opened.
            rest: What stands below, folded.
            room: Lines that are in sight at once.
            anew: Whether these nodes have nothing to do with those before.
        """
        self._unfolded.clear()
        self._made.clear()
        if anew:
            self._chosen.clear()
            self._keys.clear()
        self._roots, self._rest = tuple(roots), tuple(rest)
        self.fit(room)

    def fit(self, room: int) -> None:
        """Open the nodes as far as there is room, but for what the player opened or closed.

        Args:
            room: Lines that are in sight at once.
        """
        lines = self._siblings((*self._roots, *self._rest), 0, 0)
        self._open = self._fitting(lines, len(self._roots), room)
        self.lines = [each for line in lines for each in (line, *self._below(line))]

    def is_open(self, line: Line) -> bool:
        """Whether the children of a line are in sight."""
        return line.key in self._open

    def open(self, number: int) -> None:
        """Open a line."""
        line = self.lines[number]
        if line.folds and not self.is_open(line):
            self._open.add(line.key)
            self._chosen[line.key] = True
            self.lines[number + 1 : number + 1] = self._below(line)

    def close(self, number: int) -> None:
        """Close a line."""
        line = self.lines[number]
        if self.is_open(line):
            self._open.remove(line.key)
            self._chosen[line.key] = False
            del self.lines[number + 1 : self._end(number)]

    def parent(self, number: int) -> int | None:
        """Number of the line that a line is below, or None."""
        depth = self.lines[number].depth
        return next((n for n in range(number - 1, -1, -1) if self.lines[n].depth < depth), None)

    def number(self, key: int) -> int | None:
        """Number of the line with a key, or None if that is not in sight."""
        return next((n for n, line in enumerate(self.lines) if line.key == key), None)

    def unfold(self, key: int, nodes: Sequence[Node]) -> None:
        """Put the proof of what a line asks below it."""
        self._unfolded[key] = tuple(nodes)
        self._made.clear()
        number = self.number(key)
        if number is not None:
            line = self.lines[number]
            known = self._line(line.node, line.depth, key)
            self.lines[number : self._end(number)] = [known, *self._below(known)]

    # -- inside --------------------------------------------------------------------------------

    def _end(self, number: int) -> int:
        """Number of the first line behind a line that is not below it."""
        depth = self.lines[number].depth
        later = range(number + 1, len(self.lines))
        return next((n for n in later if self.lines[n].depth <= depth), len(self.lines))

    def _fitting(self, lines: Sequence[Line], roots: int, room: int) -> set[int]:
        """The keys of the lines to open: level by level, as long as there is room."""
        found: set[int] = set()
        shown = len(lines)
        waiting = deque((line, number < roots) for number, line in enumerate(lines))
        while waiting:
            line, is_wanted = waiting.popleft()
            fits = is_wanted and bool(line.children) and shown + len(line.children) <= room
            if line.folds and self._chosen.get(line.key, fits):
                found.add(line.key)
                below = self._inside(line)
                shown += len(below)
                waiting.extend((each, True) for each in below)
        return found

    def _below(self, line: Line) -> list[Line]:
        """The lines below a line that are not folded away."""
        found: list[Line] = []
        waiting = [line]
        while waiting:
            each = waiting.pop()
            found.append(each)
            if self.is_open(each):
                waiting += reversed(self._inside(each))
        return found[1:]

    def _inside(self, line: Line) -> list[Line]:
        """The lines right below a line, whether they are in sight or not."""
        found = self._made.get(line.key)
        if found is None:
            found = self._siblings(line.children, line.depth + 1, line.key)
            self._made[line.key] = found
        return found

    def _siblings(self, nodes: Sequence[Node], depth: int, above: int) -> list[Line]:
        """Lines for nodes below a key, which is told from others by what it is about."""
        keys, alike, found = self._keys, dict[tuple[str, str], int](), []
        for node in nodes:
            about = node.kind, node.text
            alike[about] = which = alike.get(about, 0) + 1
            key = keys.setdefault((above, *about, which), len(keys) + 1)
            found.append(self._line(node, depth, key))
        return found

    def _line(self, node: Node, depth: int, key: int) -> Line:
        if node.asked is None:
            return Line(node, depth, key, node.children, lacks=False)
        more = self._unfolded.get(key, ())
        is_proved = more or any(child.kind in ("rule", "note") for child in node.children)
        return Line(node, depth, key, (*node.children, *more), lacks=not is_proved)
