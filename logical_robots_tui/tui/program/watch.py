"""Notices when the file of a program changes, so that it can be edited in another window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program

if TYPE_CHECKING:
    from logical_robots_tui.game import Source

__all__ = ["FileWatch"]


class FileWatch:
    """Looks at one file, again and again."""

    def __init__(self) -> None:
        self._source: Source | None = None
        self._stamp: tuple[int, int] | None = None

    def newer(self, source: Source) -> Source | None:
        """Return the program as it is on disk if that has changed since the last look.

        Args:
            source: What the game knows of it; another file, or what was just saved there, is not
                a change.
        """
        stamp = _stamp(source)
        if source is not self._source:
            self._source, self._stamp = source, stamp
            return None
        if source.shipped or stamp is None or stamp == self._stamp:
            return None
        self._stamp = stamp
        try:
            found = load_program(source.path)
        except InputError:
            return None  # half written, or no text any more; there may be a next change
        return found if found.text != source.text else None


def _stamp(source: Source) -> tuple[int, int] | None:
    try:
        status = source.path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
