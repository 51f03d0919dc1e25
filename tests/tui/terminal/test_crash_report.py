"""A process ends with its terminal, whatever its main thread is doing."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from pathlib import Path

# Signals can't get through, as to a thread that began to wait for a lock in the wrong moment.
STUCK = """\
import signal, sys, threading
from pathlib import Path
from logical_robots_tui.tui.terminal.crash_report import end_on_hangup

signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
end_on_hangup(lambda: Path(sys.argv[1]).write_text("kept"), lambda: None)
lock = threading.Lock()
lock.acquire()
print("stuck", flush=True)
lock.acquire()
"""

# A busy machine: when a thread has its first turn, the terminal is gone already.
BUSY = """\
import select, threading

def run(thread, run=threading.Thread.run):
    terminal = select.poll()
    terminal.register(0, 0)
    terminal.poll()
    run(thread)

threading.Thread.run = run
"""


@pytest.mark.parametrize(
    "before", ["", pytest.param(BUSY, marks=pytest.mark.slow)], ids=["idle", "busy"]
)
def test_a_main_thread_that_hears_no_signal_does_not_outlive_its_terminal(
    tmp_path: Path, before: str
) -> None:
    ours, theirs = os.openpty()
    kept = tmp_path / "kept"
    command = [sys.executable, "-c", before + STUCK, str(kept)]
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    try:
        with os.fdopen(os.dup(ours)) as terminal:  # to its end: who is still writing would fail
            assert terminal.readline() == "stuck\n"
        os.close(ours)
        assert process.wait(PATIENCE) == 129
        assert kept.read_text() == "kept"
    finally:
        process.kill()
        process.wait(PATIENCE)
