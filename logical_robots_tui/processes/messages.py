"""Messages between the game and a helper: pickled tasks to it, lines of JSON from it."""

from __future__ import annotations

import json
import pickle
import sys
from typing import Any

from logical_robots_tui.processes.helper import Helper

_LENGTH_BYTES = 8


class TaskHelper(Helper):
    """A helper that gets tasks and answers them, or raises OSError.

    One thread talks to it; the call to `end` that makes the others fail may come from any.
    """

    def send(self, task: object) -> None:
        """Send a task, or raise OSError or ValueError if the helper has ended. Blocks."""
        content = pickle.dumps(task)
        assert self.stdin is not None
        self.stdin.write(len(content).to_bytes(_LENGTH_BYTES, "big") + content)
        self.stdin.flush()

    def answer(self) -> Any:
        """Return the next answer, or raise OSError or ValueError as `send` does. Blocks."""
        assert self.stdout is not None
        return json.loads(self.stdout.readline())


def next_task() -> Any:
    """Return the next task that the game sent to this helper, or raise EOFError."""
    size = int.from_bytes(sys.stdin.buffer.read(_LENGTH_BYTES), "big")
    if not size:
        raise EOFError
    return pickle.loads(sys.stdin.buffer.read(size))  # noqa: S301 - from the game that started this


def send_answer(content: object) -> None:
    sys.stdout.write(json.dumps(content) + "\n")
    sys.stdout.flush()
