"""What actions act on."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["ScreenActions"]


class ScreenActions:
    """Methods that act on the main screen.

    Args:
        screen: What to act on.
    """

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen
