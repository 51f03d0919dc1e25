"""Values that last: records and lists that stay the same objects from moment to moment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.stored import from_sql, size_of

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["Lasting", "Sizes"]

_SHORT = 100  # characters; less is read as quickly as it is found
_LONG = 100_000  # characters; more is not kept, because the objects take far more
_ROOM = 400_000  # characters that are read before those not seen meanwhile are forgotten


class Lasting:
    """Reads values out of tables, for those who never change a record or a list.

    What follows can then be quick where nothing has changed: it sees the same object again.
    """

    def __init__(self) -> None:
        self._now: dict[str, Value] = {}
        self._before: dict[str, Value] = {}
        self._room = _ROOM

    def read(self, value: Any, deepest: int) -> Value:
        """As `from_sql`, with the same depth each time.

        Raises:
            TooDeepError: As `from_sql` does.
        """
        if value.__class__ is not str:
            return from_sql(value, deepest)
        length = len(value)
        is_text = value[:1] not in _OPENING
        if is_text and length < _SHORT and "\0" not in value:
            return value
        if is_text or not _SHORT <= length < _LONG:
            return from_sql(value, deepest)
        found = self._now.get(value)
        if found is None:
            found = self._before.get(value)
            if found is None:
                found = from_sql(value, deepest)
            self._room -= len(value)
            if self._room < 0:
                self._before, self._now, self._room = self._now, {}, _ROOM
            self._now[value] = found
        return found


class Sizes:
    """Bytes of memories, for those who never change a record or a list in one."""

    def __init__(self) -> None:
        # By identity; what is kept here with its bytes can't give its identity to another.
        self._now: dict[int, tuple[Value, int]] = {}
        self._before: dict[int, tuple[Value, int]] = {}

    def next_moment(self) -> None:
        """Forget what was not asked for since the last time."""
        self._before, self._now = self._now, {}

    def of(self, memory: Value) -> int:
        """As `size_of`."""
        if memory.__class__ not in _NESTED:
            return size_of(memory)
        if not isinstance(memory, dict):
            return self._of_part(memory)
        parts = [part for part in memory.values() if part.__class__ in _NESTED]
        if not parts:
            return size_of(memory)
        shell = {key: 0 if v.__class__ in _NESTED else v for key, v in memory.items()}
        return size_of(shell) + sum(map(self._of_part, parts)) - len(parts)

    def _of_part(self, part: Value) -> int:
        known = self._before.get(id(part)) or self._now.get(id(part)) or (part, size_of(part))
        self._now[id(part)] = known
        return known[1]


_NESTED = frozenset({dict, list})
_OPENING = frozenset("{[")
