"""A lifeline: a pipe whose other end is held by the process that another one must not outlive."""

from __future__ import annotations

import fcntl
import os
import select
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import signal


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
