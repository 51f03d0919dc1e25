"""The heartbeat of the game's event loop, which the supervisor watches."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop
    from collections.abc import Iterator
    from mmap import mmap

BEATS, AWAY = 0, 1
"""Bytes that both processes share: what counts up, 0 before the first beat, and `away`."""

_BEAT_SECONDS = 1.0
_MOST_COMPUTED = 30.0  # processor seconds without a heartbeat after which the kernel ends the game

_shared: list[mmap] = []  # in a game that is supervised, one


def is_watched_in(shared: mmap) -> None:
    _shared.append(shared)


def keep_beating(loop: AbstractEventLoop) -> None:
    """Make an event loop signal that it is alive, if a supervisor watches."""
    for shared in _shared:
        if not shared[BEATS]:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is for the supervisor
        shared[BEATS] = shared[BEATS] % 255 + 1
        signal.setitimer(signal.ITIMER_PROF, _MOST_COMPUTED)  # should the supervisor be killed
        loop.call_later(_BEAT_SECONDS, keep_beating, loop)


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
