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
EVENTS = (
    ("first frame", "Labyrinth", "<= 350"),
    ("first useful picture", "tick 0", "<= 600"),
    ("program ready", "· applied", ""),
)
"""What to wait for, what stands on the screen then, and what is wanted."""


def first_frame(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds from starting the process to the outline, the picture, and a ready program."""
    for size in SIZES:
        for event, seen, wanted in EVENTS:
            once = partial(_milliseconds, size, seen)
            subject = f"{size[0]}x{size[1]}"
            yield median_of(event, subject, "ms", effort.repeats, once, required=wanted)


def _milliseconds(size: tuple[int, int], seen: str) -> float:
    with tempfile.TemporaryDirectory() as data_dir:
        command = [sys.executable, "-m", "logical_robots_tui", "play", "--data-dir", data_dir]
        began = perf_counter()
        with Terminal(command, size=size) as terminal:
            return 1000 * (terminal.arrival_of(lambda: seen in terminal.text) - began)
