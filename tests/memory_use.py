"""How much memory a process has, as Linux tells it."""

import re
from pathlib import Path
from typing import Literal

__all__ = ["memory_use"]


def memory_use(
    process: int | Literal["self"], what: Literal["VmRSS", "VmHWM", "VmSize"] = "VmRSS"
) -> int:
    """Return the bytes that a process holds, the most it ever held, or its address space."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace")
    found = re.search(rf"{what}:\s+(\d+)", status)
    assert found
    return int(found[1]) * 1024
