"""What a mind answers with: the rows of a predicate, or how they are computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.values import Value

__all__ = ["QueryPlan", "Table", "plan_lines", "table_of"]


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of a predicate.

    Attributes:
        columns: Names of the columns.
        rows: Values; records are dicts, lists are lists.
        viewers: For each row the robot in whose reasoning it holds; () when all reason alike.
        truncated: Whether there were more rows than are shown.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]
    viewers: tuple[str, ...] = ()
    truncated: bool = False


def table_of(
    answers: Iterable[tuple[str, Sequence[str], Sequence[tuple[Value, ...]]]],
    most: int,
    *,
    separate: bool,
) -> Table:
    """Several answers as one table.

    Args:
        answers: In whose reasoning, names of the columns, and rows.
        most: How many rows to show.
        separate: Whether it matters in whose reasoning a row holds.
    """
    columns: Sequence[str] = ()
    rows: list[tuple[Value, ...]] = []
    viewers: list[str] = []
    for viewer, names, found in answers:
        columns = names
        rows += found
        viewers += [viewer] * len(found)
    if "logica_value" in columns and "value" not in columns:
        columns = ["value" if column == "logica_value" else column for column in columns]
    return Table(
        tuple(columns),
        tuple(rows[:most]),
        tuple(viewers[:most]) if separate else (),
        truncated=len(rows) > most,
    )


@dataclass(frozen=True, slots=True)
class QueryPlan:
    """How a predicate is computed at a moment, for one robot or for all that reason alike.

    Attributes:
        predicate: Its name.
        generated: The SQL as the compiler generated it.
        tuned: The SQL that is run in its place, or "" if it is run as it is.
        plan: SQLite's plan for what is run, one step a line, indented.
        milliseconds: How long it took, for all robots together.
    """

    predicate: str
    generated: str
    tuned: str
    plan: tuple[str, ...]
    milliseconds: float


def plan_lines(rows: Sequence[Sequence[Any]]) -> tuple[str, ...]:
    """The steps of a plan, indented, from the rows of SQLite: number, parent, unused, words."""
    depths = {0: -1}
    lines = []
    for number, parent, _, words in rows:
        depths[number] = depths.get(parent, -1) + 1
        lines.append("  " * depths[number] + str(words))
    return tuple(lines)
