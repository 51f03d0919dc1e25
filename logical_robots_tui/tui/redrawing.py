"""Redrawing: when a changed game is drawn again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.tempo import Tempo

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.timer import Timer
    from textual.widget import Widget

__all__ = ["Redrawing"]


class Redrawing:
    """Draws soon after something has changed, but no more often than `Tempo` allows.

    Args:
        widget: Whose timers to use.
        draw: Draws everything.

    Attributes:
        tempo: How often to draw.
    """

    def __init__(self, widget: Widget, draw: Callable[[], None]) -> None:
        self.tempo = Tempo()
        self._widget = widget
        self._draw = draw
        self._is_due = False
        self._timer: Timer | None = None

    def soon(self) -> None:
        """Draw when it is time to."""
        if self._is_due or not self._widget.is_mounted:
            return
        self._is_due = True
        if (wait := self.tempo.wait) > 0:
            self._timer = self._widget.set_timer(wait, self._now)
        else:
            self._widget.call_later(self._now)

    def hasten(self) -> None:
        """Let nothing that changes in this moment wait for others: the player pressed a key."""
        self.tempo.hurry()
        if self._timer is not None:
            self._timer.stop()
            self._timer, self._is_due = None, False
            self.soon()

    def _now(self) -> None:
        self._timer, self._is_due = None, False
        with self.tempo.drawing():
            self._draw()
