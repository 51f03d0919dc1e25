"""Scripts in a Python of their own."""

import subprocess
import sys

from tests.waiting import PATIENCE


def python(script: str, *arguments: str) -> str:
    """What a script prints, which ends well and complains of nothing."""
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True, timeout=PATIENCE
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout
