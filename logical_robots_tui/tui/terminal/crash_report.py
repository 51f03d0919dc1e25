"""What happens when the game itself makes a mistake, or its terminal goes away."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from rich.text import Text
from textual.app import App
from textual.worker import WorkerFailed

from logical_robots_tui.errors import is_out_of_memory

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

__all__ = ["CarefulApp", "OwnMistake", "end_on_hangup"]

_RESERVE = 16 * 1024**2
"""Bytes of address space that a game out of memory has left to end in good order."""

_GRACE = 1.0  # seconds that an orderly end may take after a hangup


class OwnMistake(Exception):  # noqa: N818 - it is called what it is
    """An exception that should not have happened; shown as one line instead of a traceback."""

    def __rich__(self) -> Text:
        said = "has run out of memory" if is_out_of_memory(self.__cause__) else "has stopped"
        return Text(f"The game {said}. What you typed is kept and offered the next time.")


class CarefulApp(App[None]):
    """An app that ends in an orderly way after an exception nobody expected.

    Attributes:
        mistake: The first such exception, or None.
    """

    mistake: Exception | None = None
    _reserve = bytes(_RESERVE)

    def last_words(self) -> None:
        """Bring what must not be lost to safety; called before anything else."""

    def _handle_exception(self, error: Exception) -> None:
        # Textual has no public hook for this. Its own way, a traceback with all local variables,
        # is kept from the player by handing it an exception that knows how to be shown.
        cause = error.error if isinstance(error, WorkerFailed) else error
        if self.mistake is not None:
            return  # that one ends the game
        self._reserve = CarefulApp._reserve = b""
        self.mistake = cause if isinstance(cause, Exception) else error
        self.last_words()
        report = OwnMistake(str(error))
        report.__cause__ = cause
        super()._handle_exception(report)


def end_on_hangup(last_words: Callable[[], None], leave: Callable[[], None]) -> Callable[[], None]:
    """End in an orderly way when the terminal goes away or somebody ends the process.

    A process that does not belong to its terminal gets no signal when that goes; so a thread waits
    for it as well. Everything important is done in the signal handler, because the event loop may
    be waiting for a terminal that is gone; the process ends even then. Where Python has no chance
    to call the handler, because the main thread waits for a lock, that other thread does it all.

    Args:
        last_words: Brings to safety what must not be lost.
        leave: Asks the app to end; called on any thread.

    Returns:
        Puts the handlers back that were there before.
    """

    def handler(number: int, frame: FrameType | None) -> None:
        timer = threading.Timer(_GRACE, os._exit, (128 + number,))
        timer.daemon = True
        timer.start()
        last_words()
        leave()

    before: dict[int, Any] = {
        number: signal.signal(number, handler)
        for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGXCPU)
    }
    # Asked here: one that is gone before the thread has its first turn no longer says it is one.
    if sys.__stdin__ is not None and sys.__stdin__.isatty():
        threading.Thread(
            target=_end_with_terminal,
            args=(sys.__stdin__.fileno(), last_words),
            name="logical-robots-hangup",
            daemon=True,
        ).start()

    def put_back() -> None:
        for number, previous in before.items():
            signal.signal(number, previous)

    return put_back


def _end_with_terminal(descriptor: int, last_words: Callable[[], None]) -> None:
    """Send this process the signal of a hangup when its terminal is gone, and see that it ends."""
    with contextlib.suppress(OSError, ValueError):
        terminal = select.poll()
        terminal.register(descriptor, 0)  # hangups are told without being asked for
        for _, event in terminal.poll():
            if event & (select.POLLHUP | select.POLLERR):
                os.kill(os.getpid(), signal.SIGHUP)
                time.sleep(1.2 * _GRACE)
                last_words()
                os._exit(128 + signal.SIGHUP)
