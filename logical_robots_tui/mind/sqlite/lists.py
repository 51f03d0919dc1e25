"""The table of records of lists in memories, updated only where they changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.remembered import ITEMS, items

if TYPE_CHECKING:
    from logical_robots_tui.mind.sqlite.database import Database
    from logical_robots_tui.mind.sqlite.moment import Moment

__all__ = ["Lists"]


class Lists:
    """The content of the table ``Item`` of a database.

    Args:
        frozen: Whether nobody changes a memory; then a list that is the same object as before has
            the same records.
    """

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._columns: tuple[str, ...] | None = ()  # None: unknown
        self._there: dict[int, list[Any]] = {}

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Update the records of lists that changed.

        Args:
            database: The same as before, unless `forget` was called.
            moment: The moment.
            columns: In the form of `spelled_item`.

        Raises:
            Exception: The exceptions of `items` and `Database.fill`.
        """
        there = self._there if self._frozen and columns == self._columns else {}
        fillings, now = items(moment, columns, there)
        gone: list[tuple[int, int]] | None = None
        if there:
            gone = [(n, n + ITEMS - 1) for n, listed in there.items() if now.get(n) is not listed]
        elif self._columns is not None and not self._there:
            gone = []
        if fillings or gone is None or gone:
            self._columns = None
            database.fill("Item", fillings, gone)
        self._columns, self._there = columns, now

    def forget(self) -> None:
        """Start again with an empty table."""
        self._columns, self._there = (), {}
