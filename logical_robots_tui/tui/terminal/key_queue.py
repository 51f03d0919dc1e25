"""One key after the other: each goes where the one before has led."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any

from textual import events

if TYPE_CHECKING:
    from textual.app import App
    from textual.message_pump import MessagePump
    from textual.screen import Screen

__all__ = ["KeyQueue"]

_LONGEST = 0.5  # seconds that a key may keep the next ones waiting
_ROUNDS = 3  # of the event loop, in which a worker that was started has opened its dialog


class KeyQueue:
    """Holds keys back while an earlier one is being answered.

    Several keys come at once over a slow line, or from quick fingers. Textual sends each to what
    has the focus when it comes, so those typed for a dialog would be commands to what lies below.

    Args:
        app: Whose keys.
    """

    def __init__(self, app: App[None]) -> None:
        self._app = app
        self._waiting: deque[events.Key | events.Paste] = deque()
        self._number = 0  # of the key that is being answered
        self._answering = False

    @property
    def waiting(self) -> int:
        """How many events are held back."""
        return len(self._waiting)

    def forget(self) -> None:
        """Drop what is held back."""
        self._waiting.clear()

    def must_wait(self, event: events.Key | events.Paste) -> bool:
        """Whether an event is held back; it comes to the app again when its turn has come."""
        if self._answering:
            self._waiting.append(event)
        return self._answering

    def begin(self, event: events.Key | events.Paste) -> None:
        """Hold back what comes until what was just sent to the focus has been answered."""
        focused = self._app.focused
        if isinstance(event, events.Paste) or (
            focused is not None and focused.check_consume_key(event.key, event.character)
        ):
            return  # it is text, which leads nowhere
        self._answering = True
        self._number += 1
        screen = self._app.screen
        asyncio.get_running_loop().call_later(_LONGEST, self._later, self._end, self._number)
        self._follow(focused or screen, screen, self._number)

    def _later(self, *what: Any) -> None:
        self._app.call_later(*what)

    def _follow(self, node: MessagePump | None, screen: Screen[Any], number: int) -> None:
        """Go the way of the key, from the focus upwards to the app."""
        if node is None or node is self._app:
            self._later(self._arrive, screen, number)
        elif not node.call_later(self._follow, node._parent, screen, number):
            self._follow(node._parent, screen, number)

    async def _arrive(self, screen: Screen[Any], number: int) -> None:
        """Wait for the focus of the dialog that the key has opened, if it has."""
        for _ in range(_ROUNDS):
            await asyncio.sleep(0)
        now = self._app.screen
        if now is screen or not now.call_after_refresh(self._later, self._end, number):
            await self._end(number)

    async def _end(self, number: int) -> None:
        """Let the next ones have their turn."""
        if number != self._number:
            return
        self._answering = False
        while self._waiting and not self._answering:
            await self._app.on_event(self._waiting.popleft())
