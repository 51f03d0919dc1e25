"""Whether the processor time of some work grows in proportion to the size of its input."""

from collections.abc import Callable, Iterable
from contextlib import suppress
from time import process_time
from typing import Any

import pytest

from logical_robots_tui.errors import LogicalRobotsError

__all__ = ["few_of", "growth_of"]

ONE_OF = 47  # cases is tried in each run; `make proof` tries all
SMALLEST, LARGEST, FACTOR = 2_000, 900_000, 4
MOST_GROWTH = 2.5**2
"""Of the time for a text of four times the size; if it grew with the square, it would be 16."""

SLOWEST = 0.02  # seconds for the smallest text, at most a few times
ENOUGH = 0.05  # seconds after which larger texts are not tried
NOISE = 0.01  # seconds
ATTEMPTS = 5


def seconds(work: Callable[[str], object], text: str) -> float:
    """Return the processor time of some work; a reason not to do it is one as well."""
    began = process_time()
    with suppress(LogicalRobotsError, ValueError):
        work(text)
    return process_time() - began


def growth_of(work: Callable[[str], object], family: Callable[[int], str]) -> str:
    """Return "" if the time for larger texts grows with their size, else how it grows."""
    size, times = SMALLEST, [SLOWEST]
    while size <= LARGEST and (len(times) < 3 or times[-1] < ENOUGH):
        text = family(size)
        times.append(min(seconds(work, text) for _ in range(2)))
        if times[-1] > MOST_GROWTH * times[-2] + NOISE:
            smaller = family(size // FACTOR)
            for _ in range(ATTEMPTS):
                times[-2] = max(times[-2], seconds(work, smaller))
                times[-1] = min(times[-1], seconds(work, text))
        if times[-1] > MOST_GROWTH * times[-2] + NOISE:
            return f"{size:,}: {times}"
        size *= FACTOR
    return ""


def few_of(cases: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return the cases, most of them only for the long proof."""
    return [
        pytest.param(*case, marks=[pytest.mark.proof] * (place % ONE_OF > 0))
        for place, case in enumerate(cases)
    ]
