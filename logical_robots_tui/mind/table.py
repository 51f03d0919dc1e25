"""A mind's answers: the rows of a predicate, or how they are computed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from logical_robots_tui.values import Value


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of a predicate; records are dicts, lists are lists.

    Attributes:
        viewers: For each row the robot in whose mind it holds; () if all think alike.
        truncated: Whether further rows were left out.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]
    viewers: tuple[str, ...] = ()
    truncated: bool = False

    def in_mind_of(self, robot: str | None) -> Table:
        if not robot or not self.viewers:
            return self
        kept = [n for n, viewer in enumerate(self.viewers) if viewer == robot]
        return replace(self, rows=tuple(self.rows[n] for n in kept), viewers=(robot,) * len(kept))


def table_of(
    answers: Iterable[tuple[str, Sequence[str], Sequence[tuple[Value, ...]]]],
    most: int,
    labels: Mapping[str, str],
    *,
    separate: bool,
) -> Table:
    columns: Sequence[str] = ()
    rows: list[tuple[Value, ...]] = []
    viewers: list[str] = []
    for viewer, names, found in answers:
        columns = names
        rows += found
        viewers += [viewer] * len(found)
    return Table(
        tuple(labels.get(column, column) for column in columns),
        tuple(rows[:most]),
        tuple(viewers[:most]) if separate else (),
        truncated=len(rows) > most,
    )


@dataclass(frozen=True, slots=True)
class QueryPlan:
    """How a predicate is computed at a moment, for one robot or for all that think alike.

    Attributes:
        tuned: The tuned SQL that is run instead of `generated`, or "".
        plan: SQLite's plan for the SQL that is run, one indented step per line.
        milliseconds: The time for all robots together.
    """

    predicate: str
    generated: str
    tuned: str
    plan: tuple[str, ...]
    milliseconds: float


def plan_lines(rows: Sequence[Sequence[Any]]) -> tuple[str, ...]:
    """Return the steps of a plan, indented, from SQLite's rows: number, parent, unused, text."""
    depths = {0: -1}
    lines = []
    for number, parent, _, words in rows:
        depths[number] = depths.get(parent, -1) + 1
        lines.append("  " * depths[number] + str(words))
    return tuple(lines)
