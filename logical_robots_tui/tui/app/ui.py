"""What controllers may ask of the screen: messages, dialogs, background work, offers."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from textual.css.query import NoMatches
from textual.dom import NoScreen
from textual.errors import NoWidget

from logical_robots_tui.errors import InputError
from logical_robots_tui.player.session_state import Ui, Work
from logical_robots_tui.tui.terminal.textual_internals import is_being_removed, withdraw_message
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from pathlib import Path

    from textual import events
    from textual.dom import DOMNode
    from textual.screen import Screen
    from textual.widget import Widget
    from textual.worker import Worker

    from logical_robots_tui.player.recovery import Offering
    from logical_robots_tui.tui.layout.dialogs import QuestionDialog

Outcome = TypeVar("Outcome")
Result = TypeVar("Result")


def in_background(
    node: DOMNode, work: Work, group: str = "default", *, exclusive: bool = False
) -> Worker[None]:
    """Start work for a widget; if exclusive, cancel its group's other work."""

    async def unless_gone() -> None:
        try:
            await work()
        except (NoMatches, NoScreen):
            # What is closed loses its widgets, and its screen, before its work is cancelled.
            if node.is_attached and not is_being_removed(node):
                raise

    worker: Worker[None] = node.run_worker(unless_gone, group=group, exclusive=exclusive)
    return worker


def widget_at(screen: Screen[Any], x: int, y: int) -> Widget | None:
    """Return None outside of the screen, where terminals report the mouse, too."""
    try:
        return screen.get_widget_at(x, y)[0]
    except NoWidget:
        return None


class Dialogs(Ui, Protocol):
    """A `Ui` with dialogs of its own."""

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog, and call `closed` with its result."""

    def deliver(self, content: Path | str, name: str | None = None) -> None:
        """Let the browser, if the game is in one, download a file that was saved, or a text."""
        return

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog and return its result; only for background work."""

    def withdraw(self, message: str) -> None:
        """Remove a message that was told, if it is still shown."""


class ScreenUi(Dialogs):
    def __init__(self, screen: Screen[Any]) -> None:
        self.screen = screen

    def tell(self, message: str) -> None:
        self.screen.notify(message, markup=False, timeout=4)

    def warn(self, message: str) -> None:
        self.screen.notify(one_line(message), markup=False, severity="warning", timeout=8)

    def withdraw(self, message: str) -> None:
        app = self.screen.app
        app.call_later(withdraw_message, app, message)  # after the message has arrived

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        async def work_or_warn() -> None:
            try:
                await work()
            except InputError as error:
                self.warn(str(error))

        in_background(self.screen, work_or_warn, group, exclusive=exclusive)

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        self.screen.app.push_screen(dialog, closed)

    def deliver(self, content: Path | str, name: str | None = None) -> None:
        if self.screen.app.is_web:
            file = BytesIO(content.encode()) if isinstance(content, str) else content
            self.screen.app.deliver_binary(file, save_filename=name)

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        # `push_screen_wait` would also run what the app has queued; when the game ends meanwhile,
        # the end of its screens would be cancelled with this work.
        answer = self.screen.app.push_screen(dialog, wait_for_dismiss=True)
        return await asyncio.shield(answer)

    async def choose(
        self, title: str, question: str, answers: Sequence[tuple[str, str]]
    ) -> str | None:
        from logical_robots_tui.tui.layout.dialogs import QuestionDialog

        return await self.ask(QuestionDialog(title, question, answers))


NOTICING = 0.7
"""Seconds for a player to notice a question; earlier keys were meant for the game.

Seeing something new and stopping a key press takes about half a second.
"""


class ScreenOffers:
    """Makes offers when nothing covers the game, and ignores keys meant for the game."""

    def __init__(self, ui: ScreenUi) -> None:
        self._ui = ui
        self.resumed = asyncio.Event()
        """Set whenever a dialog has closed."""
        self._question: QuestionDialog | None = None

    async def make(self, *offerings: Offering) -> None:
        for offering in offerings:
            await offering(self)

    async def at_hand(self, load: Callable[[], Awaitable[Outcome]]) -> Outcome:
        """Repeat `load` until nothing covers the game after it, and return its outcome."""
        while True:
            await self.free()
            outcome = await load()
            if self._ui.screen.is_active:
                return outcome

    async def ask(
        self, title: str, question: str, answers: Sequence[tuple[str, str]], *, text: str = ""
    ) -> str | None:
        """Return the name of the answer, or None; the answer ``show`` shows `text`."""
        from logical_robots_tui.tui.layout.dialogs import QuestionDialog

        await self.free()
        return await self.put(
            QuestionDialog(title, question, answers, text=text, noticing=NOTICING)
        )

    async def put(self, question: QuestionDialog) -> str | None:
        """Return the name of the answer, or None; keys before there are answers are ignored."""
        self._question = question
        return await self._ui.ask(question)

    def ignores(self, event: events.Key | events.Paste) -> bool:
        """Return whether a key arrived before the player could see the question."""
        question = self._question
        return question is not None and question.is_active and event.time < question.answered_from

    async def free(self) -> None:
        """Wait until nothing covers the game."""
        while not self._ui.screen.is_active:
            self.resumed.clear()
            await self.resumed.wait()
