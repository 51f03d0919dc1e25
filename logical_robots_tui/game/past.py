"""Restoring frames of past ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game.advancing import known_frame
from logical_robots_tui.game.worlds import Worlds

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.history import History

__all__ = ["Past"]


class Past:
    """Restores ticks of a history, on the event loop.

    Going back tick by tick requests each one twice, first as the previous tick and then as the
    current one; so the last one is cached.

    Args:
        history: The history.

    Attributes:
        worlds: The worlds in which the robots sense again.
    """

    def __init__(self, history: History) -> None:
        self.worlds = Worlds(history.level_at(0))
        self._history = history
        self._last: Frame | None = None
        self._turns = 0

    def frame(self, tick: int) -> Frame:
        """Return the exact frame of a tick.

        Raises:
            NoSuchTickError: History does not hold it.
        """
        history = self._history
        before, _ = history.around(tick)
        if self._last is None or self._last.tick != tick or self._turns != history.turns:
            known = history.known(tick)
            self._last = known_frame(self.worlds, before.after, before.memories, known)
            self._turns = history.turns
        return self._last

    def forget(self) -> None:
        """Clear the cache, because the end of a tick was edited."""
        self._last = None
