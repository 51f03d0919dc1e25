"""What a predicate costs and why: the SQL that was generated, SQLite's plan for it, its time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Machinery", "plan_lines"]


@dataclass(frozen=True, slots=True)
class Machinery:
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
