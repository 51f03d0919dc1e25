"""A lifeline: a pipe held open by the process that this one must not outlive."""

from __future__ import annotations

import fcntl
import os
import select
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop
    from mmap import mmap


LIFELINE = "LOGICAL_ROBOTS_LIFELINE"
"""Names the environment variable with the pipe that keeps a command running."""


def signal_when_closed(lifeline: int, number: signal.Signals) -> None:
    """Let the kernel signal this process when the other end of a pipe is closed.

    That needs no interpreter, which a call into C may hold for minutes.
    """
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    if hasattr(fcntl, "F_SETSIG"):
        fcntl.fcntl(lifeline, fcntl.F_SETSIG, number)
    flags = fcntl.fcntl(lifeline, fcntl.F_GETFL)
    fcntl.fcntl(lifeline, fcntl.F_SETFL, flags | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        os.kill(os.getpid(), number)  # it was closed before


BEATS, AWAY, LEFT = 0, 1, 2
"""Bytes that both processes share.

The first counts up, and is 0 before the first beat; then `away`, and whether the game itself has
left its screen.
"""

HEARTBEAT_BYTES = 3

_BEAT_SECONDS = 1.0
_MAX_COMPUTED = 30.0  # processor seconds without a heartbeat after which the kernel ends the game

_shared: list[mmap] = []  # in a game that is supervised, one


def share_heartbeat(shared: mmap) -> None:
    _shared.append(shared)


def beat(loop: AbstractEventLoop) -> None:
    """Make an event loop signal that it is alive, if a supervisor watches."""
    for shared in _shared:
        if not shared[BEATS]:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is for the supervisor
        shared[BEATS] = shared[BEATS] % 255 + 1
        signal.setitimer(signal.ITIMER_PROF, _MAX_COMPUTED)  # in case the supervisor is killed
        loop.call_later(_BEAT_SECONDS, beat, loop)


MOST_IN_A_CALL = 15.0  # processor seconds

_is_bounded = False


def bound_calls() -> None:
    """Let the kernel end this process by SIGPROF if one call into C keeps computing.

    Such a call holds the interpreter, so that nothing in this process could end it.
    """
    global _is_bounded
    _is_bounded = True


def renew_bound(*, is_working: bool) -> None:
    """Restart the time limit of a call, or lift it while there is no work."""
    if _is_bounded:
        signal.setitimer(signal.ITIMER_PROF, MOST_IN_A_CALL if is_working else 0)


@contextmanager
def away() -> Iterator[None]:
    """Suspend the heartbeat while another program, such as an editor, has the terminal."""
    for shared in _shared:
        shared[AWAY] = 1
    try:
        yield
    finally:
        for shared in _shared:
            shared[AWAY] = 0


def note_screen(*, is_left: bool) -> None:
    """Tell the supervisor whether the terminal still shows the game's screen."""
    for shared in _shared:
        shared[LEFT] = is_left
