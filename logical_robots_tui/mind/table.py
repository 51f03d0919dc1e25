"""Rows of a predicate, as a mind answers with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["Table"]


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
