"""Text over the picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.widgets import Static

if TYPE_CHECKING:
    from textual import events

__all__ = ["Overlay"]


class Overlay(Static):
    """Text over the picture; a click closes it. It never takes the focus."""

    DEFAULT_CSS = """
    Overlay { layer: over; display: none; background: $panel 92%; width: 100%; height: auto; }
    """

    def on_click(self, event: events.Click) -> None:
        """Close."""
        event.stop()
        self.display = False
