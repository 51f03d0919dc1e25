"""Redrawing: when a changed game is drawn again."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from logical_robots_tui.tui.app.frame_scheduler import Tempo

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.widget import Widget

    from logical_robots_tui.game import Pace

__all__ = ["Redrawing"]


class Redrawing:
    """Draws soon after something has changed, but no more often than `Tempo` allows.

    Args:
        widget: For which to draw; it hears of exceptions.
        draw: Draws everything.

    Attributes:
        tempo: How often to draw.
        pace: Leaves as much time to others as the drawing does; None leaves it alone.
    """

    def __init__(self, widget: Widget, draw: Callable[[], None]) -> None:
        self.tempo = Tempo()
        self._widget = widget
        self._draw = draw
        self.pace: Pace | None = None
        self._due: asyncio.TimerHandle | None = None

    def soon(self) -> None:
        """Draw when it is time to."""
        if self._due is None and self._widget.is_mounted:
            # Textual's timers are tasks, and take longer to begin than a picture leaves them.
            loop = asyncio.get_running_loop()
            self._due = loop.call_later(max(self.tempo.wait, 0.0), self._now)

    def hasten(self) -> None:
        """Let nothing that changes in this moment wait for others: the player pressed a key."""
        self.tempo.hurry()
        if self._due is not None:
            self._due.cancel()
            self._due = None
            self.soon()

    def _now(self) -> None:
        self._due = None
        if not self._widget.is_running:
            return
        try:
            with self.tempo.drawing():
                self._draw()
            if self.pace is not None:
                self.pace.spacing = self.tempo.spacing
        except Exception as error:  # as timers of Textual's do
            self._widget.app._handle_exception(error)
