"""Frames of past ticks, sensed anew."""

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

    Who goes back tick by tick asks for each one twice, as the one before the present and then as
    the present; so the last one is kept.

    Args:
        history: Where they are.

    Attributes:
        worlds: In which they are sensed anew.
    """

    def __init__(self, history: History) -> None:
        self.worlds = Worlds(history.level_at(0))
        self._history = history
        self._last: Frame | None = None
        self._turns = 0

    def frame(self, tick: int) -> Frame:
        """The frame of a tick, exactly as it was.

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
        """Forget what was kept: the end of a tick was changed by hand."""
        self._last = None
