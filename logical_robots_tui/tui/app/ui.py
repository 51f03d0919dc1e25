"""What a controller may ask of the screen without knowing it: saying, asking, working."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.screen import Screen

    from logical_robots_tui.tui.app.background import Work

__all__ = ["ScreenUi", "Ui"]

Result = TypeVar("Result")


class Ui(Protocol):
    """Says, asks and works for a controller."""

    def tell(self, message: str) -> None:
        """Say something in passing."""

    def warn(self, message: str) -> None:
        """Say what went wrong."""

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Work in the background; an exclusive work cancels what its group still does."""

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog, and call `closed` with what it gives."""

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog and return what it gives; only for work in the background."""


class ScreenUi(Ui):
    """Does so on a screen of the app.

    Args:
        screen: Work in the background ends with it.
    """

    def __init__(self, screen: Screen[Any]) -> None:
        self._screen = screen

    def tell(self, message: str) -> None:
        """Say something in passing."""
        self._screen.notify(message, markup=False, timeout=4)

    def warn(self, message: str) -> None:
        """Say what went wrong."""
        self._screen.notify(one_line(message), markup=False, severity="warning", timeout=8)

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Work in the background."""
        in_background(self._screen, work, group, exclusive=exclusive)

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog over the screen."""
        self._screen.app.push_screen(dialog, closed)

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog over the screen and wait for what it gives."""
        return await self._screen.app.push_screen_wait(dialog)
