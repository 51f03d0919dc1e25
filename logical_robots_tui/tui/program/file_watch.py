"""Watches the file of a program, so that it can be edited in another window."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game import Source

__all__ = ["FileWatch"]

_PAUSE = 0.25  # seconds between two checks


class FileWatch:
    """Checks one file repeatedly, in a thread, because a disk may be slow.

    Args:
        source: Returns what the game knows of the file.
        changed: Called with the program on disk after a change.
    """

    def __init__(self, source: Callable[[], Source], changed: Callable[[Source], None]) -> None:
        self._current, self._changed = source, changed
        self._source: Source | None = None
        self._stamp: tuple[int, int] | None = None

    async def follow(self) -> None:
        """Check until cancelled."""
        while True:
            await asyncio.sleep(_PAUSE)
            source = self._current()
            if source.shipped:
                continue
            found = await asyncio.to_thread(self.newer, source)
            if found is not None and self._current() is source:
                self._changed(found)

    def newer(self, source: Source) -> Source | None:
        """Return the program on disk if it has changed since the last check.

        Args:
            source: What the game knows of it. The first check compares its text, because the file
                may have changed since it was read.
        """
        stamp = _stamp(source)
        if source is not self._source:
            self._source, self._stamp = source, None
        if source.shipped or stamp is None or stamp == self._stamp:
            return None
        self._stamp = stamp
        try:
            found = load_program(source.path)
        except InputError:
            return None  # half written, or not text; a later check may succeed
        return found if found.text != source.text else None


def _stamp(source: Source) -> tuple[int, int] | None:
    try:
        status = source.path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
