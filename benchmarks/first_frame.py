"""How long a player waits for the first picture, in a real pseudo-terminal."""

from __future__ import annotations

import sys
import tempfile
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, median_of
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["first_frame"]

SIZES = ((80, 24), (120, 40))


def first_frame(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds from starting the process to the picture, and to a program that is ready."""
    for size in SIZES:
        for event, seen in (("first frame", "tick 0"), ("program ready", "· applied")):
            once = partial(_milliseconds, size, seen)
            yield median_of(event, f"{size[0]}x{size[1]}", "ms", effort.repeats, once)


def _milliseconds(size: tuple[int, int], seen: str) -> float:
    with tempfile.TemporaryDirectory() as data_dir:
        command = [sys.executable, "-m", "logical_robots_tui", "play", "--data-dir", data_dir]
        began = perf_counter()
        with Terminal(command, size=size) as terminal:
            return 1000 * (terminal.arrival_of(lambda: seen in terminal.text) - began)
