"""Textual's driver for terminals, with an ear for what the terminal answers."""

from __future__ import annotations

import asyncio
import os
import re
import select
import threading
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from textual import events
from textual.drivers.linux_driver import LinuxDriver
from textual.geometry import Size

from logical_robots_tui.tui.terminal.input_filter import CarefulParser, Incoming, Pasted

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.message import Message

__all__ = ["LARGEST", "ListeningDriver", "Unmarked"]

LARGEST = (1000, 400)
"""Columns and lines of the largest screen that is drawn; real ones have fewer."""

_LAST_ANSWER = 0.5  # seconds to wait for it before the terminal is somebody else's

_CHUNK = 4096
_LOOK_UP_EVERY = 0.1  # seconds
_FLOOD = 1000  # events that nobody has answered yet

_MARK = re.compile(r"\x1b\[20([01])~")
_TEXT = re.compile(r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]{64,}")
"""More than anybody types at once, and nothing but letters, tabs and ends of lines."""


class Unmarked:
    """Knows a paste from keys where the terminal, or GNU screen in it, does not mark pastes.

    As keys it would be worked off letter by letter, for minutes; and out of the editor each letter
    is a command.
    """

    def __init__(self) -> None:
        self._is_marked = self._is_escape_begun = False

    def paste_in(self, typed: str) -> str:
        """Return what was pasted, with line feeds, or "" if those are keys or marked pastes.

        Args:
            typed: All that came in at once, after all that came in before.
        """
        is_plain = not self._is_marked and not self._is_escape_begun
        self._is_escape_begun = typed.endswith("\x1b")
        for mark in _MARK.finditer(typed):
            self._is_marked = mark[1] == "0"
        text = typed.replace("\r\n", "\n").replace("\r", "\n")
        is_several_lines = "\n" in text.rstrip("\n")  # and not one line, then enter
        return text if is_plain and is_several_lines and _TEXT.fullmatch(text) else ""


class ListeningDriver(LinuxDriver):
    """Tells the app of each answer by ``CursorPosition``, wherever it comes in."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._asked = 0
        self._under_way = 0
        self._all_answered = threading.Condition()

    def ask(self, text: str) -> None:
        """Write something that ends in a question to the terminal."""
        with self._all_answered:
            self._asked += 1
        self.write(text)

    def disable_input(self) -> None:
        """Stop listening; an answer that is due is waited for, lest the next program reads it."""
        with self._all_answered:
            self._all_answered.wait_for(lambda: not self._asked, _LAST_ANSWER)
            self._asked = 0
        super().disable_input()

    def process_message(self, message: Message) -> None:
        """Pass on a message, of a terminal that is no larger than any real one."""
        if isinstance(message, events.Resize):
            message = events.Resize(_bounded(message.size), _bounded(message.size))
        super().process_message(message)

    def send_message(self, message: Message) -> None:
        """Pass on a message, and know how many the app has not heard of yet."""
        with self._all_answered:
            self._under_way += 1

        async def post() -> None:
            with self._all_answered:
                self._under_way -= 1
            await self._app._post_message(message)

        asyncio.run_coroutine_threadsafe(post(), loop=self._loop)

    def run_input_thread(self) -> None:
        """Pass on what comes in until the driver stops; a mistake of our own ends the app."""
        try:
            self._listen()
        except Exception as error:  # it would end the thread, and nobody would know
            self._loop.call_soon_threadsafe(self._app._handle_exception, error)

    def _get_terminal_size(self) -> tuple[int, int]:
        return tuple(_bounded(Size(*super()._get_terminal_size())))  # type: ignore[return-value]  # a pair

    def _listen(self) -> None:
        parser = CarefulParser(self._debug)
        incoming, unmarked = Incoming(), Unmarked()
        terminal = select.poll()
        terminal.register(self.fileno, select.POLLIN)
        while not self.exit_event.is_set():
            pieces: list[str | Pasted] = []
            if terminal.poll(1000 * _LOOK_UP_EVERY):
                try:
                    data = os.read(self.fileno, _CHUNK)
                except OSError:  # the terminal is gone
                    break
                if not data:
                    break
                pieces, answers = incoming.take(data, monotonic())
                self._hear(answers)
            for piece in pieces:
                if isinstance(piece, Pasted):
                    self.process_message(events.Paste(piece))
                    parser = CarefulParser(self._debug)
                elif self._is_flooded():
                    parser = CarefulParser(self._debug)
                elif pasted := unmarked.paste_in(piece):
                    self.process_message(events.Paste(pasted))
                else:
                    for message in parser.feed(piece):
                        self.process_message(message)
            for message in parser.tick():
                self.process_message(message)

    def _is_flooded(self) -> bool:
        """Whether more is waiting than anybody types; then all of that is dropped."""
        with self._all_answered:
            waiting = self._under_way
        backlog, forget = self._backlog()
        if waiting + backlog < _FLOOD:
            return False
        self._loop.call_soon_threadsafe(forget)
        return True

    def _backlog(self) -> tuple[int, Callable[[], None]]:
        app = self._app
        if isinstance(app, SwampedApp):
            return app.backlog, app.forget_typed
        return 0, lambda: None

    def _hear(self, answers: int) -> None:
        """Tell of answers, as far as there were questions."""
        with self._all_answered:
            heard = min(answers, self._asked)
            self._asked -= heard
            self._all_answered.notify_all()
        for _ in range(heard):
            self.process_message(events.CursorPosition(0, 0))


@runtime_checkable
class SwampedApp(Protocol):
    """An app that knows how much of what was typed it has not answered yet."""

    @property
    def backlog(self) -> int:
        """How many keys and other events wait."""

    def forget_typed(self) -> None:
        """Answer none of those keys."""


def _bounded(size: Size) -> Size:
    return Size(*(max(1, min(most, side)) for most, side in zip(LARGEST, size, strict=True)))
