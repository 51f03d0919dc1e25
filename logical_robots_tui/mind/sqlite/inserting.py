"""Statements that fill the tables of tuned queries."""

from __future__ import annotations

from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Filling", "in_blocks", "insert_into"]

_AT_ONCE = 16  # rows per statement; smaller batches each need their own statement


class Filling(NamedTuple):
    """A batch of rows for a table.

    Attributes:
        insert: A statement that inserts one of the items.
        items: The values of each execution.
    """

    insert: str
    items: Sequence[Sequence[Any]]


def in_blocks(
    table: str, columns: tuple[str, ...], rows: Sequence[Sequence[Any]]
) -> Sequence[Filling]:
    """Yield the batches for a table, with many rows per statement."""
    if not rows:
        return ()
    together = len(rows) // _AT_ONCE * _AT_ONCE
    whole = [[*chain.from_iterable(rows[i : i + _AT_ONCE])] for i in range(0, together, _AT_ONCE)]
    rest = [*chain.from_iterable(rows[together:])]
    return [
        Filling(insert_into(table, columns, count), items)
        for count, items in ((_AT_ONCE, whole), (len(rows) - together, [rest]))
        if count and items
    ]


@cache
def insert_into(table: str, columns: tuple[str, ...], rows: int = 1) -> str:
    """Return a statement that inserts or replaces rows; parameters are ``id`` and the columns."""
    names = ", ".join(("id", *columns))
    row = ", ".join("?" * (len(columns) + 1))
    values = ", ".join([f"({row})"] * rows)
    return f"REPLACE INTO {table}({names}) VALUES {values}"  # noqa: S608 - our own names
