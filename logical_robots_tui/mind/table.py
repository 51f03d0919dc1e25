"""Rows of a predicate, as a mind answers with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.values import Value

__all__ = ["Table", "table_of"]


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
