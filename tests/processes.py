"""Commands that are run to their end, and processes that may have ended."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.waiting import PATIENCE


def run_command(
    command: Sequence[object], *, timeout: float = PATIENCE, **options: Any
) -> subprocess.CompletedProcess[str]:
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, timeout=timeout, **options)


def is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"  # Z: it is over, only nobody has asked yet how it ended
