"""Values that last: the same text gives the same record or list as a moment ago."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.stored import from_sql

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["Lasting"]

_SHORT = 100  # characters; less is read as quickly as it is found
_ROOM = 500_000  # characters that are read before those not seen meanwhile are forgotten


class Lasting:
    """Reads values out of tables, for those who never change a record or a list.

    What follows can then be quick where nothing has changed: it sees the same object again.

    Args:
        deepest: How deep records and lists may be nested.
    """

    def __init__(self, deepest: int) -> None:
        self._deepest = deepest
        self._now: dict[str, Value] = {}
        self._before: dict[str, Value] = {}
        self._room = _ROOM

    def read(self, value: Any) -> Value:
        """As `from_sql`.

        Raises:
            TooDeepError: As `from_sql` does.
        """
        if value.__class__ is not str or len(value) < _SHORT or value[0] not in "{[":
            return from_sql(value, self._deepest)
        found = self._now.get(value)
        if found is None:
            found = self._before.get(value)
            if found is None:
                found = from_sql(value, self._deepest)
            self._room -= len(value)
            if self._room < 0:
                self._before, self._now, self._room = self._now, {}, _ROOM
            self._now[value] = found
        return found
