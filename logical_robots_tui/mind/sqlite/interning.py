"""Interning: equal records and lists stay the same objects from moment to moment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.stored import from_sql, size_of

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["Interner", "Sizes"]

_SHORT = 100  # characters; parsing a shorter text is as fast as looking it up
_LONG = 100_000  # characters; longer texts are not kept, because their objects take far more
_ROOM = 400_000  # characters parsed before entries that were not used meanwhile are dropped


class Interner:
    """Parses values from tables, for callers who never change a record or list.

    Later steps can then skip values that are the same object as before.
    """

    def __init__(self) -> None:
        self._now: dict[str, Value] = {}
        self._before: dict[str, Value] = {}
        self._room = _ROOM

    def read(self, value: Any, deepest: int) -> Value:
        """Return a value as `from_sql` does, with the same depth each time."""
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
    """Sizes of memories, for callers who never change a record or list in one."""

    def __init__(self) -> None:
        # By identity; entries keep the object alive, so that no other gets its identity.
        self._now: dict[int, tuple[Value, int]] = {}
        self._before: dict[int, tuple[Value, int]] = {}

    def next_moment(self) -> None:
        """Drop entries that were not used since the last call."""
        self._before, self._now = self._now, {}

    def of(self, memory: Value) -> int:
        """Return the size as `size_of` does."""
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
