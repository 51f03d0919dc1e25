"""Handling of bugs in the game, and of a terminal that goes away."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType
from typing import Any

from rich.text import Text
from textual import constants
from textual.app import App
from textual.css.query import NoMatches
from textual.worker import WorkerFailed

from logical_robots_tui.errors import is_out_of_memory

_RESERVE = 16 * 1024**2  # bytes of address space reserved for ending cleanly when out of memory
_GRACE = 1.0  # seconds for a clean end after a hangup


class BugReport(Exception):  # noqa: N818 - it is called what it is
    """An unexpected exception; shown as one line instead of a traceback."""

    def __rich__(self) -> Text:
        ending = "has run out of memory" if is_out_of_memory(self.__cause__) else "has stopped"
        return Text(f"The game {ending}. Unsaved text is kept and offered the next time.")


class CrashSafeApp(App[None]):
    """An app that ends cleanly after an unexpected exception."""

    mistake: Exception | None = None
    _reserve = bytes(_RESERVE)

    def save_unsaved(self) -> None:
        """Save what must not be lost; called before anything else."""

    def _handle_exception(self, error: Exception) -> None:
        # Textual has no public hook for this. Its default, a traceback with all local variables,
        # is avoided by passing it an exception that renders as one line.
        cause = error.error if isinstance(error, WorkerFailed) else error
        if self.mistake is not None:
            return  # that one ends the game
        if isinstance(cause, NoMatches) and (self.return_code is not None or not self.is_running):
            return  # a dialog that was about to be shown has lost its parts
        self._reserve = CrashSafeApp._reserve = b""
        self.mistake = cause if isinstance(cause, Exception) else error
        self.save_unsaved()
        report = BugReport(str(error))
        report.__cause__ = cause
        super()._handle_exception(report)


def end_on_hangup(
    save_unsaved: Callable[[], None], leave: Callable[[], None]
) -> Callable[[], None]:
    """End cleanly when the terminal goes away; return what restores the previous handlers.

    A process may get no signal then, so a thread waits for that too, and does everything if the
    main thread is blocked. All is done in the handler, because the event loop may wait for the
    lost terminal. `leave` is called on any thread.
    """

    def handler(number: int, frame: FrameType | None) -> None:
        timer = threading.Timer(_GRACE, os._exit, (128 + number,))
        timer.daemon = True
        timer.start()
        save_unsaved()
        leave()

    previous_handlers: dict[int, Any] = {
        number: signal.signal(number, handler)
        for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGXCPU)
    }
    # Checked here: a terminal that is gone before the thread starts no longer looks like one.
    has_peer = sys.__stdin__ is not None and (sys.__stdin__.isatty() or constants.DRIVER)
    if sys.__stdin__ is not None and has_peer:
        threading.Thread(
            target=_end_with_terminal,
            args=(sys.__stdin__.fileno(), save_unsaved),
            name="logical-robots-hangup",
            daemon=True,
        ).start()

    def restore() -> None:
        for number, previous in previous_handlers.items():
            signal.signal(number, previous)

    return restore


def _end_with_terminal(descriptor: int, save_unsaved: Callable[[], None]) -> None:
    """Send this process SIGHUP when its terminal is gone; force it to end if it doesn't."""
    with contextlib.suppress(OSError, ValueError):
        terminal = select.poll()
        terminal.register(descriptor, 0)  # hangups are always reported
        for _, event in terminal.poll():
            if event & (select.POLLHUP | select.POLLERR):
                os.kill(os.getpid(), signal.SIGHUP)
                time.sleep(1.2 * _GRACE)
                save_unsaved()
                os._exit(128 + signal.SIGHUP)
