"""Flow control: limits the output in flight, so that a key press never waits long."""

from __future__ import annotations

from collections import deque
from math import inf

__all__ = ["ASK", "Line"]

ASK = "\x1b[6n"
"""Asks a terminal for its cursor position; it answers after everything sent before."""

PATIENCE = 2.0  # seconds after which an answer counts as lost

_QUEUE = 0.05  # seconds of data that may queue on the way
_LEAST = 1500  # bytes; less is not worth a query
_LITTLE = 500  # bytes that don't queue
_FIRST = 16_000  # bytes sent at once to an unknown terminal
_MOST = 256_000
_MOST_ASKED = 8  # queries in flight on a long line
_LONG = 1 / 15  # seconds; the longest time between pictures on a long line


class Line:
    """Decides when to send to a terminal, and how much.

    sshd and the kernel buffer far more than a slow line takes in a second, so being able to write
    says nothing. So each output ends in a query (`ASK`), and is in flight until the answer. Usually
    that is one output; on a line with high latency but enough bandwidth, as many as fit into the
    latency. The latency is measured once by a query alone, because even a small picture takes time
    on a slow line. Before a terminal has answered for the first time, its answers are not relied
    upon.

    All times are in seconds on one clock of the caller's.

    """

    def __init__(self) -> None:
        self._room = _FIRST
        self._asked: deque[tuple[float, int]] = deque()
        self._least: float | None = None
        self._window = 1
        self._is_measuring = self._is_measured = False

    @property
    def is_to_be_measured(self) -> bool:
        """Whether to send a query alone now."""
        return self._least is not None and not self._is_measured and not self._asked

    @property
    def is_free(self) -> bool:
        """Whether to send now."""
        return self._least is None or len(self._asked) < self._window

    @property
    def room(self) -> float:
        """Bytes to send at once."""
        return inf if self._least is None else self._room

    def sent(self, size: int, now: float) -> None:
        """Note that so many bytes and a query were sent; 0 bytes for a measurement."""
        self._is_measuring = not size and not self._asked
        self._asked.append((now, size))

    def answered(self, now: float) -> None:
        """Note that the terminal has answered the oldest query."""
        if not self._asked:
            return
        asked, size = self._asked.popleft()
        taken = max(now - asked, 0.001)
        self._is_measured = self._is_measured or (self._is_measuring and not self._asked)
        if self._least is None or taken < self._least:
            self._least = taken
        elif size <= _LITTLE and self._window == 1:
            # The latency has increased.
            self._least += (taken - self._least) / 10
        waited = taken - self._least
        if waited > _QUEUE:
            self._window = 1
            self._room = max(_LEAST, int(self._room * _QUEUE / waited))
            return
        if self._is_measured:
            self._window = min(_MOST_ASKED, 1 + int(self._least / _LONG))
        if 2 * size > self._room:
            self._room = min(_MOST, 2 * self._room)

    def forget(self, now: float) -> None:
        """Give up overdue answers; a terminal that never answered is not relied upon."""
        while self._asked and now - self._asked[0][0] > PATIENCE:
            self._asked.popleft()
            self._least = None
            self._window = 1
            self._is_measured = False
