"""The timeline as a line of characters."""

from __future__ import annotations

from itertools import groupby, islice
from typing import TYPE_CHECKING, NamedTuple

from textual.content import Content

from logical_robots_tui.game import MARK_KINDS, MarkKind
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["SIGNS", "Scale", "Span", "track"]

SIGNS: dict[MarkKind, tuple[str, str, str]] = {
    "victory": ("★", f"bold {INK.key}", "victory"),
    "breakpoint": ("◉", f"bold {INK.bad}", "a breakpoint was hit"),
    "program": ("¶", f"bold {INK.title}", "another program thinks from here on"),
    "edit": ("✎", f"bold {INK.title}", "the labyrinth was changed by hand"),
    "area": ("◇", INK.good, "an area was switched"),
    "notice": ("!", f"bold {INK.warn}", "a notice"),
    "memory": ("┷", INK.record, "a memory changed; of the chosen robot, if one is chosen"),
}
"""Each kind of mark with its sign, its colour and what it means."""

PARTING = ("≠", f"bold {INK.number}", "the two futures part here")
_PAST, _KNOWN, _OTHER, _UNKNOWN = "━", "─", "┄", " "
TRACKS = (
    (_PAST, INK.text, "the ticks up to the one on the screen"),
    (_KNOWN, INK.dim, "later ticks that are known"),
    (_OTHER, INK.faint, "ticks of the other future"),
)
"""The signs of the track itself, with colours and meanings."""


class Span(NamedTuple):
    """What there is to show.

    Attributes:
        first: The earliest tick in history.
        last: The latest one.
        tick: The one on the screen.
        other_last: The latest tick of the other future, or None.
        parted: Where the two futures part, or None.
    """

    first: int
    last: int
    tick: int
    other_last: int | None = None
    parted: int | None = None


class Scale(NamedTuple):
    """Which ticks a column stands for; it changes seldom while the game runs.

    Attributes:
        first: The first tick of the first column.
        each: How many ticks a column stands for: 1, 2, 5, 10, 20, 50 and so on.
    """

    first: int
    each: int

    @classmethod
    def to_hold(cls, span: Span, width: int) -> Scale:
        """The finest scale at which all of a span has room."""
        ticks = max(span.last, span.other_last or 0) - span.first + 1
        each, factors = 1, [2, 2.5, 2]
        while each * width < ticks:
            each = round(each * factors[0])
            factors.append(factors.pop(0))
        return cls(span.first, each)

    def column(self, tick: int) -> int:
        """The column of a tick."""
        return (tick - self.first) // self.each

    def ticks(self, column: int) -> tuple[int, int]:
        """The first and the last tick of a column."""
        begin = self.first + column * self.each
        return begin, begin + self.each - 1


def track(span: Span, width: int, has: Callable[[MarkKind, int, int], bool]) -> Content:
    """The line: the ticks that are known, and the most telling mark in each column.

    Args:
        span: What there is to show.
        width: Columns to fill.
        has: Whether a kind of mark is in the ticks from one to another.
    """
    scale = Scale.to_hold(span, width)
    here = scale.column(span.tick)
    signs, styles = [], []
    for column in range(width):
        sign, style = _at(span, *scale.ticks(column), has)
        signs.append(sign)
        styles.append(f"{style} reverse" if column == here else style)
    text = iter(signs)
    runs = ((style, len(list(run))) for style, run in groupby(styles))
    return Content.assemble(*[("".join(islice(text, length)), style) for style, length in runs])


def _at(
    span: Span, begin: int, end: int, has: Callable[[MarkKind, int, int], bool]
) -> tuple[str, str]:
    """The sign and the style of one column."""
    if span.parted is not None and begin <= span.parted <= end:
        return PARTING[:2]
    if begin <= span.last:
        for kind in MARK_KINDS:
            if has(kind, begin, end):
                return SIGNS[kind][:2]
        return TRACKS[0][:2] if begin <= span.tick else TRACKS[1][:2]
    return TRACKS[2][:2] if begin <= (span.other_last or 0) else (_UNKNOWN, INK.dim)
