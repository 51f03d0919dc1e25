"""How much memory a process has, as Linux tells it."""

import re
from pathlib import Path
from typing import Literal

__all__ = ["memory_share", "memory_use"]


def memory_use(
    process: int | Literal["self"], what: Literal["VmRSS", "VmHWM", "VmSize"] = "VmRSS"
) -> int:
    """Return the bytes that a process holds, the most it ever held, or its address space."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii", errors="replace")
    found = re.search(rf"{what}:\s+(\d+)", status)
    assert found
    return int(found[1]) * 1024


def memory_share(process: int, *, and_children: bool = False) -> int:
    """Return the bytes of a process, of what it shares only its part; 0 if it has ended."""
    folder = Path(f"/proc/{process}")
    try:
        rollup = (folder / "smaps_rollup").read_text(encoding="ascii")
        tasks = [*(folder / "task").iterdir()] if and_children else []
        children = [child for task in tasks for child in (task / "children").read_text().split()]
    except OSError:
        return 0
    found = re.search(r"Pss:\s+(\d+)", rollup)
    assert found
    own = int(found[1]) * 1024
    return own + sum(memory_share(int(child), and_children=True) for child in children)
