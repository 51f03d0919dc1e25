"""A bound on the memory of this process, for whatever a program does."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["bounded_memory"]

GROWTH = 400 * 1024**2  # bytes: the memory of SQLite, and what all rows of a thought may take


@contextmanager
def bounded_memory() -> Iterator[None]:
    before = _forget_peak()
    yield
    assert _peak() - before < GROWTH


def _forget_peak() -> int:
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        pytest.skip("this system does not tell how much memory is used")
    return _peak()


def _peak() -> int:
    status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    return int(status.split("VmHWM:")[1].split()[0]) * 1024
