"""How a line of a proof looks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.tui.inspector.widgets.cells import cell, written
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.mind import Node
    from logical_robots_tui.tui.inspector.widgets.folds import Line
    from logical_robots_tui.values import Value

__all__ = ["FOLD", "guides", "line_content"]

_GUIDE = "│ "  # for each node above a line
_MOST_GUIDES = 3  # parts of a line, of which one may be guides
_OPEN, _CLOSED, _LEAF = "▾ ", "▸ ", "  "
FOLD = len(_OPEN)
"""Columns of the marker that folds."""

_MARKS = {True: ("✓ ", INK.good), False: ("✗ ", INK.bad), None: ("", INK.dim)}
_DEEPER = " →"
_WIDEST_VALUE = 60
_NARROWEST_TEXT = 8
_INKS = {
    "rule": f"bold {INK.title}",
    "note": INK.dim,
    "value": INK.dim,
    "read": INK.dim,
}


def guides(depth: int, width: int) -> str:
    """What stands before a line: a guide for each node above it, or else how many these are.

    Args:
        depth: How many nodes are above it.
        width: Columns of the whole line.
    """
    most = max(1, width // (_MOST_GUIDES * len(_GUIDE)))
    if depth <= most:
        return _GUIDE * depth
    number = f"{depth} "
    return (_GUIDE * most)[: -len(number)] + number


def line_content(line: Line, width: int, *, is_open: bool) -> Content:
    """A line in its colours, cut to a width; what is said about it is never cut off.

    Args:
        line: The line.
        width: Columns.
        is_open: Whether its children are in sight.
    """
    node = line.node
    fold = (_OPEN if is_open else _CLOSED) if line.folds else _LEAF
    before = Content.assemble(
        (guides(line.depth, width), INK.faint), (fold, INK.key), _MARKS[node.holds]
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
    """The values of a node, as many as there is room for, and how many more there are."""
    parts: list[Content] = []
    rest = ""
    for number, value in enumerate(node.values):
        more = len(node.values) - number - 1 + node.more
        words = f" (and {more:,} more)" if more else ""
        glue = " or " if parts else " = "
        left = room - sum(part.cell_length for part in parts) - len(glue) - len(words)
        text, colour = _value(node, value, _WIDEST_VALUE if parts else max(4, left))
        if parts and len(text) > left:
            break
        parts.append(Content.assemble((glue, INK.dim), (text, colour)))
        rest = words
    return Content("").join([*parts, Content.styled(rest, INK.warn)])


def _value(node: Node, value: Value, limit: int) -> tuple[str, str]:
    if node.is_truth:
        return written(None if value is None else bool(value)), INK.number
    return cell(value, min(limit, _WIDEST_VALUE))
