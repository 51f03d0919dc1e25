"""Repeating a piece of work and keeping the median."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Effort", "Measurement", "median_of", "seconds_for"]


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try.

    Attributes:
        repeats: How often to repeat each measurement.
        ticks: How many ticks a measurement of a running game takes.
    """

    repeats: int
    ticks: int


@dataclass(frozen=True, slots=True)
class Measurement:
    """One number.

    Attributes:
        group: What kind of number it is.
        subject: What it was measured on.
        value: The median of the repeats.
        unit: Of the value.
        lowest: The lowest of the repeats.
        highest: The highest of the repeats.
        required: What it must reach, in words such as ``<= 0.6``, or "".
    """

    group: str
    subject: str
    value: float
    unit: str
    lowest: float
    highest: float
    required: str = ""


def seconds_for(work: Callable[[], object]) -> float:
    """Wall time of one call in seconds."""
    began = perf_counter()
    work()
    return perf_counter() - began


def median_of(
    group: str,
    subject: str,
    unit: str,
    repeats: int,
    once: Callable[[], float],
    *,
    required: str = "",
) -> Measurement:
    """Repeat a measurement and sum it up.

    Args:
        group: What kind of number it is.
        subject: What it is measured on.
        unit: Of the number.
        repeats: How often to measure.
        once: Measures once.
        required: What it must reach, in words.
    """
    found = [once() for _ in range(repeats)]
    median = statistics.median(found)
    return Measurement(group, subject, median, unit, min(found), max(found), required)
