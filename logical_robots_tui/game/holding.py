"""When a question holds: what its answer at a tick counts for, and the stretches of such ticks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.mind import Question, Table

__all__ = ["Stretches", "rows_that_count"]


def rows_that_count(question: Question, table: Table, robot: str = "") -> Table:
    """The rows of an answer for which a question holds.

    Of an expression these are the values that are neither null, false nor 0; of conditions without
    variables the minds in which they are true; of all else every row.

    Args:
        question: What was asked.
        table: What it gave at a tick.
        robot: In whose mind; "" is any. Where all reason alike, it is any, too.
    """
    viewers = table.viewers or ("",) * len(table.rows)
    kept = [
        (row, viewer)
        for row, viewer in zip(table.rows, viewers, strict=True)
        if (not robot or viewer in ("", robot)) and _counts(question, row[0] if row else None)
    ]
    return replace(
        table,
        rows=tuple(row for row, _ in kept),
        viewers=tuple(viewer for _, viewer in kept) if table.viewers else (),
    )


def _counts(question: Question, value: object) -> bool:
    if question.gives == "truth":
        return value == "true"
    return question.gives == "rows" or value not in (None, False)  # 0 is equal to False


@dataclass
class Stretches:
    """The ticks in which something holds, found one after the other.

    Attributes:
        found: First and last tick of each stretch, ascending.
        ticks: How many ticks these are.
    """

    found: list[tuple[int, int]] = field(default_factory=list)
    ticks: int = 0

    def add(self, tick: int) -> None:
        """Take in a tick in which it holds, later than those before."""
        self.ticks += 1
        if self.found and self.found[-1][1] == tick - 1:
            self.found[-1] = (self.found[-1][0], tick)
        else:
            self.found.append((tick, tick))
