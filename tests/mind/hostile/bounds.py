"""Bounds on the memory and the work of this process, for whatever comes from others."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import process_time

import pytest

from tests.memory_use import memory_use

__all__ = ["GROWTH", "bounded_memory", "bounded_work"]

GROWTH = 400 * 1024**2  # bytes: the memory of SQLite, and what all rows of a thought may take


@contextmanager
def bounded_memory(most: int = GROWTH) -> Iterator[None]:
    before = _forget_peak()
    yield
    assert memory_use("self", "VmHWM") - before < most


@contextmanager
def bounded_work(most: float = 10.0) -> Iterator[None]:
    """Assert that a block computes for no more seconds than a hundred times the usual."""
    began = process_time()
    yield
    computed = process_time() - began
    assert computed < most


def _forget_peak() -> int:
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        pytest.skip("this system does not tell how much memory is used")
    return memory_use("self", "VmHWM")
