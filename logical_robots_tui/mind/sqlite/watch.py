"""Ending work in time: one thread looks after every query that is under way."""

from __future__ import annotations

import os
import threading
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Work"]

_LOOK_SECONDS = 0.02
_QUIET_LOOKS = 50  # the thread goes to sleep when it has seen nothing to do for this long


class Work:
    """Something that can be under way, and be halted from outside.

    Args:
        halt: Ends the work; called in another thread, again and again until the work has ended.

    Attributes:
        halted: Whether the work was told to end since it last began.
    """

    __slots__ = ("_deadline", "_halt", "_stop", "halted")

    def __init__(self, halt: Callable[[], None]) -> None:
        self._halt = halt
        self._deadline = 0.0
        self._stop: threading.Event | None = None
        self.halted = False

    def begin(self, deadline: float, stop: threading.Event | None) -> None:
        """Start watching.

        Args:
            deadline: On the clock of `time.monotonic`.
            stop: Halts the work when it is set.
        """
        self._deadline = deadline
        self._stop = stop
        self.halted = False
        _watcher.add(self)

    def end(self) -> None:
        """Stop watching; when this returns, the work is not halted any more."""
        _watcher.remove(self)

    @property
    def stopped(self) -> bool:
        """Whether somebody asked for the end, as opposed to the time being up."""
        return self._stop is not None and self._stop.is_set()

    def look(self) -> None:
        """Halt the work if that is due."""
        if self.stopped or monotonic() > self._deadline:
            self.halted = True
            self._halt()


class _Watcher:
    """The thread and what it looks after."""

    def __init__(self) -> None:
        self.start_anew()

    def start_anew(self) -> None:
        """Forget the thread and all work, as a fork must: it has the lock but not the thread."""
        self._works: set[Work] = set()
        self._lock = threading.Lock()
        self._awake = threading.Event()
        self._never = threading.Event()
        self._thread: threading.Thread | None = None

    def add(self, work: Work) -> None:
        with self._lock:
            self._works.add(work)
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(
                    target=self._run, name="logical-robots-watch", daemon=True
                )
                self._thread.start()
            if not self._awake.is_set():
                self._awake.set()

    def remove(self, work: Work) -> None:
        with self._lock:
            self._works.discard(work)

    def _run(self) -> None:
        quiet = 0
        while self._awake.wait():
            with self._lock:
                quiet = 0 if self._works else quiet + 1
                for work in self._works:
                    work.look()
                if quiet > _QUIET_LOOKS:
                    quiet = 0
                    self._awake.clear()
            self._never.wait(_LOOK_SECONDS)


_watcher = _Watcher()
os.register_at_fork(after_in_child=_watcher.start_anew)
