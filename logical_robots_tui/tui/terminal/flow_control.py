"""The line to a terminal: how much may be under way, so that a key press never waits long."""

from __future__ import annotations

from collections import deque
from math import inf

__all__ = ["ASK", "Line"]

ASK = "\x1b[6n"
"""Asks a terminal where its cursor is; it answers when it has taken all that came before."""

PATIENCE = 2.0  # seconds after which an answer counts as lost

_QUEUE = 0.05  # seconds of data that may wait on the way
_LEAST = 1500  # bytes; less would not be worth the asking
_LITTLE = 500  # bytes that don't wait for themselves
_FIRST = 16_000  # bytes that are sent at once to a terminal that nothing is known of
_MOST = 256_000
_MOST_ASKED = 8  # questions under way on a long line
_LONG = 1 / 15  # seconds; so often a picture on a long line changes at least


class Line:
    """Decides when to send something to a terminal and how much.

    sshd and the kernel buffer far more than a slow line takes in a second, so that being able to
    write says nothing. Therefore each sending ends in a question (`ASK`), and what waits for the
    answer is under way. Usually that is one sending; on a line that is long, but not slow, it is
    as many as fit into the time of an answer. That time is measured once by a question alone: even
    a small picture takes its time on a slow line, and would let it seem long. Before a terminal
    has answered for the first time, it is not relied upon.

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
        """Whether to send a question alone now."""
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
        """Note that so many bytes and a question were sent; none, to measure."""
        self._is_measuring = not size and not self._asked
        self._asked.append((now, size))

    def answered(self, now: float) -> None:
        """Note that the terminal has answered the oldest question."""
        if not self._asked:
            return
        asked, size = self._asked.popleft()
        taken = max(now - asked, 0.001)
        self._is_measured = self._is_measured or (self._is_measuring and not self._asked)
        if self._least is None or taken < self._least:
            self._least = taken
        elif size <= _LITTLE and self._window == 1:
            # The way has become longer.
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
        """Give up answers that are overdue; a terminal that gave none is not relied upon."""
        while self._asked and now - self._asked[0][0] > PATIENCE:
            self._asked.popleft()
            self._least = None
            self._window = 1
            self._is_measured = False
