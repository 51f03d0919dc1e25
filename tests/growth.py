"""Whether the processor time of some work grows in proportion to the size of its input."""

from collections.abc import Callable, Iterable
from math import inf
from time import process_time
from typing import Any

import pytest

__all__ = ["few_of", "growth_of"]

ONE_OF = 29  # cases is tried in each run; `make proof` tries all
MOST_GROWTH = 2.5  # of the time when the size doubles
MOST_RUNS = 6
NOISE = 0.004  # seconds


def seconds(work: Callable[[str], object], text: str) -> float:
    began = process_time()
    work(text)
    return process_time() - began


def growth_of(work: Callable[[str], object], text: Callable[[int], str], size: int) -> str:
    """Return "" if the time at most doubles and a half with the size, else how it grows.

    Each time is the least of several runs; there are more while they do not agree.
    """
    texts = text(size), text(2 * size)
    least = [inf, inf]
    for _ in range(MOST_RUNS):
        least = [min(time, seconds(work, of)) for time, of in zip(least, texts, strict=True)]
        if least[1] <= MOST_GROWTH * least[0] + NOISE:
            return ""
    return f"{size}: {least[0]:.4f} s, {2 * size}: {least[1]:.4f} s"


def few_of(cases: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return the cases, most of them only for the long proof."""
    return [
        pytest.param(*case, marks=[pytest.mark.proof] * (place % ONE_OF > 0))
        for place, case in enumerate(cases)
    ]
