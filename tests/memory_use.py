"""How much memory a process has, as Linux tells it."""

import re
from contextlib import suppress
from pathlib import Path
from typing import Literal

__all__ = ["descendants", "memory_share", "memory_use"]


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
    try:
        rollup = Path(f"/proc/{process}/smaps_rollup").read_text(encoding="ascii")
    except OSError:
        return 0
    found = re.search(r"Pss:\s+(\d+)", rollup)
    assert found
    children = descendants(process) if and_children else []
    return int(found[1]) * 1024 + sum(map(memory_share, children))


def descendants(process: int) -> list[int]:
    """Return the processes that a process has started, those that they have started, and so on."""
    children: list[int] = []
    with suppress(OSError):  # it has ended, or this system doesn't say
        for task in Path(f"/proc/{process}/task").iterdir():
            children += map(int, (task / "children").read_text().split())
    return [pid for child in children for pid in (child, *descendants(child))]
