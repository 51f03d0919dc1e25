"""Work in the background of a widget, given up when the widget goes; and a `Ui` on a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from textual.css.query import NoMatches

from logical_robots_tui.tui.app.ui import Ui
from logical_robots_tui.tui.terminal.textual_internals import is_being_removed
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.dom import DOMNode
    from textual.screen import Screen
    from textual.worker import Worker

    from logical_robots_tui.tui.app.ui import Work

Result = TypeVar("Result")


def in_background(
    node: DOMNode, work: Work, group: str = "default", *, exclusive: bool = False
) -> Worker[None]:
    """Start work for a widget; if exclusive, cancel its group's other work."""

    async def unless_gone() -> None:
        try:
            await work()
        except NoMatches:
            # A dialog that is closed loses its widgets before its work is cancelled.
            if not is_being_removed(node):
                raise

    worker: Worker[None] = node.run_worker(unless_gone, group=group, exclusive=exclusive)
    return worker


class ScreenUi(Ui):
    """Does so on a screen of the app; background work ends with it."""

    def __init__(self, screen: Screen[Any]) -> None:
        self._screen = screen

    def tell(self, message: str) -> None:
        self._screen.notify(message, markup=False, timeout=4)

    def warn(self, message: str) -> None:
        self._screen.notify(one_line(message), markup=False, severity="warning", timeout=8)

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        in_background(self._screen, work, group, exclusive=exclusive)

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        self._screen.app.push_screen(dialog, closed)

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        return await self._screen.app.push_screen_wait(dialog)
