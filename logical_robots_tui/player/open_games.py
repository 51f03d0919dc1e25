"""The games that one player has open at the same time, each with a locked file."""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

MOST_GAMES = 4
"""Games that one player may have open at the same time, of at most four processes each."""

_OPENING = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW


class OpenGames:
    """A player's open games, with this process until it ends; may raise InputError, OSError."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        for number in range(MOST_GAMES):
            handle = _lock(self._file(number))
            if handle is not None:
                self._number, self._handle = number, handle  # closing it would free the place
                break
        else:
            hint = "Leave one of them first; a game whose connection broke ends within a minute."
            raise InputError(f"you have {MOST_GAMES} games open, the most allowed", hint=hint)
        self._request(self._number).unlink(missing_ok=True)
        os.ftruncate(self._handle, 0)
        os.write(self._handle, datetime.now(UTC).isoformat(timespec="seconds").encode())

    def others(self) -> list[datetime]:
        """Return the start times of the player's other games, oldest first."""
        found = []
        for number in range(MOST_GAMES):
            if number == self._number or not self._file(number).exists():
                continue
            with suppress(OSError, ValueError):
                handle = _lock(self._file(number))
                if handle is not None:
                    os.close(handle)
                    continue
                found.append(datetime.fromisoformat(self._file(number).read_text("ascii")))
        return sorted(found)

    def end_others(self) -> None:
        """Ask the player's other games to end, without waiting for them."""
        for number in range(MOST_GAMES):
            if number != self._number and self._file(number).exists():
                with suppress(OSError):
                    self._request(number).touch()

    @property
    def is_to_end(self) -> bool:
        return self._request(self._number).exists()

    def _file(self, number: int) -> Path:
        return self._folder / f".game-{number}"

    def _request(self, number: int) -> Path:
        return self._folder / f".end-game-{number}"


def _lock(file: Path) -> int | None:
    """Open and lock a file; None if another process has it. May raise OSError."""
    handle = os.open(file, _OPENING, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(handle)
        return None
    return handle
