"""Textual's terminal driver, extended to read the terminal's answers."""

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

from logical_robots_tui.tui.terminal.input_filter import InputFilter, Pasted, TolerantParser
from logical_robots_tui.tui.terminal.textual_internals import handle_exception

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.message import Message

LARGEST = (1000, 400)
"""Columns and lines of the largest screen that is drawn."""

_LAST_ANSWER = 0.5  # seconds to wait for it before another program gets the terminal

_CHUNK = 4096
_LOOK_UP_EVERY = 0.1  # seconds
_FLOOD = 1000  # unanswered events

_MARK = re.compile(r"\x1b\[20([01])~")
_TEXT = re.compile(r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]{64,}")
"""More than anybody types at once, with only letters, tabs and line ends."""


class UnbracketedPasteDetector:
    """Detects pastes in terminals without bracketed paste, such as GNU screen.

    As keys they would take minutes, and outside the editor each letter is a command.
    """

    def __init__(self) -> None:
        self._is_marked = self._is_escape_begun = False

    def paste_in(self, typed: str) -> str:
        """Return a paste among all that arrived at once, with line feeds, or ""."""
        is_plain = not self._is_marked and not self._is_escape_begun
        self._is_escape_begun = typed.endswith("\x1b")
        for mark in _MARK.finditer(typed):
            self._is_marked = mark[1] == "0"
        text = typed.replace("\r\n", "\n").replace("\r", "\n")
        is_several_lines = "\n" in text.rstrip("\n")  # not one line followed by enter
        return text if is_plain and is_several_lines and _TEXT.fullmatch(text) else ""


class ListeningDriver(LinuxDriver):
    """Posts each answer of the terminal to the app, as ``CursorPosition``."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._asked = 0
        self._under_way = 0
        self._all_answered = threading.Condition()
        self._heard_at: float | None = None  # since it has answered once

    @property
    def silence(self) -> float:
        """Seconds since an answering terminal last sent input; 0 for any other terminal."""
        return 0.0 if self._heard_at is None else monotonic() - self._heard_at

    def ask(self, text: str) -> None:
        """Write text that ends in a query to the terminal."""
        with self._all_answered:
            self._asked += 1
        self.write(text)

    def disable_input(self) -> None:
        """Stop reading after any pending answers, so that the next program doesn't get them."""
        with self._all_answered:
            self._all_answered.wait_for(lambda: not self._asked, _LAST_ANSWER)
            self._asked = 0
        super().disable_input()

    def _sigcont_application(self, *_: object) -> None:
        # After a stop that no process is asked about, Textual would take the terminal twice.
        if self._auto_restart and not self._must_signal_resume:
            self.suspend_application_mode()
        super()._sigcont_application()

    def process_message(self, message: Message) -> None:
        """Forward a message; limits the terminal's size."""
        if isinstance(message, events.Resize):
            message = events.Resize(_bounded(message.size), _bounded(message.size))
        super().process_message(message)

    def send_message(self, message: Message) -> None:
        with self._all_answered:
            self._under_way += 1

        async def post() -> None:
            with self._all_answered:
                self._under_way -= 1
            await self._app._post_message(message)

        asyncio.run_coroutine_threadsafe(post(), loop=self._loop)

    def run_input_thread(self) -> None:
        """Forward input until the driver stops; an exception ends the app."""
        try:
            self._listen()
        except Exception as error:  # it would end the thread unnoticed
            self._loop.call_soon_threadsafe(handle_exception, self._app, error)

    def _get_terminal_size(self) -> tuple[int, int]:
        return tuple(_bounded(Size(*super()._get_terminal_size())))  # type: ignore[return-value]  # a pair

    def _listen(self) -> None:
        parser = TolerantParser(self._debug)
        incoming, unmarked = InputFilter(), UnbracketedPasteDetector()
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
                if answers or self._heard_at is not None:
                    self._heard_at = monotonic()
                self._hear(answers)
            for piece in pieces:
                if isinstance(piece, Pasted):
                    self.process_message(events.Paste(piece))
                    parser = TolerantParser(self._debug)
                elif self._is_flooded():
                    parser = TolerantParser(self._debug)
                elif pasted := unmarked.paste_in(piece):
                    self.process_message(events.Paste(pasted))
                else:
                    for message in parser.feed(piece):
                        self.process_message(message)
            for message in parser.tick():
                self.process_message(message)

    def _is_flooded(self) -> bool:
        """Return whether more input is pending than anybody types; if so, discard it."""
        with self._all_answered:
            waiting = self._under_way
        backlog, forget = self._backlog()
        if waiting + backlog < _FLOOD:
            return False
        self._loop.call_soon_threadsafe(forget)
        return True

    def _backlog(self) -> tuple[int, Callable[[], None]]:
        app = self._app
        if isinstance(app, BacklogApp):
            return app.backlog, app.drop_typed
        return 0, lambda: None

    def _hear(self, answers: int) -> None:
        """Post answers, at most as many as there were queries."""
        with self._all_answered:
            heard = min(answers, self._asked)
            self._asked -= heard
            self._all_answered.notify_all()
        for _ in range(heard):
            self.process_message(events.CursorPosition(0, 0))


@runtime_checkable
class BacklogApp(Protocol):
    """An app that counts its unhandled events."""

    @property
    def backlog(self) -> int:
        """Return the number of waiting keys and other events."""

    def drop_typed(self) -> None:
        """Drop the waiting keys."""


def _bounded(size: Size) -> Size:
    return Size(*(max(1, min(most, side)) for most, side in zip(LARGEST, size, strict=True)))
