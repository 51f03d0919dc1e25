"""What controllers may do on the screen: show messages, ask, and start work."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar

from textual.css.query import NoMatches

from logical_robots_tui.tui.terminal.textual_internals import is_being_removed
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from textual.dom import DOMNode
    from textual.screen import Screen
    from textual.worker import Worker

__all__ = ["ScreenUi", "Spawn", "Ui", "Work", "in_background", "nothing"]

Result = TypeVar("Result")

Work: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"
"""A function and not a coroutine, because one that is cancelled early would never be awaited."""


class Spawn(Protocol):
    """Starts background work on the screen."""

    def __call__(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Run `work`; an exclusive one cancels the other work of its group."""


class Ui(Protocol):
    """Messages, dialogs and work for a controller."""

    def tell(self, message: str) -> None:
        """Show a message."""

    def warn(self, message: str) -> None:
        """Show a warning."""

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Start background work; exclusive work cancels the other work of its group."""

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog, and call `closed` with its result."""

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog and return its result; only for background work."""


async def nothing() -> None:
    """Replace work that must end."""


def in_background(
    node: DOMNode, work: Work, group: str = "default", *, exclusive: bool = False
) -> Worker[None]:
    """Start background work for a widget.

    Args:
        node: The widget.
        work: The work.
        group: Name of its group.
        exclusive: Whether to cancel the other work of the group.
    """

    async def unless_gone() -> None:
        try:
            await work()
        except NoMatches:
            # A closed dialog loses its widgets before its work is cancelled.
            if not is_being_removed(node):
                raise

    worker: Worker[None] = node.run_worker(unless_gone, group=group, exclusive=exclusive)
    return worker


class ScreenUi(Ui):
    """The user interface of one screen of the app.

    Args:
        screen: Background work ends with it.
    """

    def __init__(self, screen: Screen[Any]) -> None:
        self._screen = screen

    def tell(self, message: str) -> None:
        """Show a message."""
        self._screen.notify(message, markup=False, timeout=4)

    def warn(self, message: str) -> None:
        """Show a warning."""
        self._screen.notify(one_line(message), markup=False, severity="warning", timeout=8)

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Start background work."""
        in_background(self._screen, work, group, exclusive=exclusive)

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog over the screen."""
        self._screen.app.push_screen(dialog, closed)

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog over the screen and wait for its result."""
        return await self._screen.app.push_screen_wait(dialog)
