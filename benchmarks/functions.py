"""The longest single call of a function that a program may call, whatever it is given."""

from __future__ import annotations

from time import thread_time
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, summed_up
from tests.mind.hostile.test_functions import FUNCTIONS, called, filled

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["functions"]


def functions(_effort: Effort) -> Iterator[Measurement]:
    """Measure the processor time of the longest call of all."""
    longest: dict[str, float] = {}
    with filled() as database:
        for name in FUNCTIONS:
            longest[name], began = 0.0, thread_time()
            for _ in called(name, database):
                ended = thread_time()
                longest[name], began = max(longest[name], 1000 * (ended - began)), ended
    slowest = max(longest, key=lambda name: longest[name])
    subject = f"{slowest}, of {len(FUNCTIONS)} functions"
    yield summed_up("longest call", subject, "ms", [longest[slowest]], target=at_most(1000))
