"""Repeating a piece of work and keeping the median."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = ["Effort", "Measurement", "median_of", "repeated", "seconds_for", "summed_up"]

T = TypeVar("T")

BUDGET = 0.6  # seconds for the repeats of one number
LEAST = 3  # repeats, however long they take


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try.

    Attributes:
        repeats: How often to repeat each measurement; fewer times if one takes long.
        ticks: How many ticks a measurement of a running game takes.
        is_quick: Whether to leave out what takes long beside another measurement of its kind.
    """

    repeats: int
    ticks: int
    is_quick: bool = False


@dataclass(frozen=True, slots=True)
class Measurement:
    """One number.

    Attributes:
        group: What kind of number it is.
        subject: What it was measured on.
        value: The median of the repeats, or what the group says.
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
    """Repeat a measurement and sum it up; after `BUDGET` seconds it is not begun again.

    Args:
        group: What kind of number it is.
        subject: What it is measured on.
        unit: Of the number.
        repeats: How often to measure at most.
        once: Measures once.
        required: What it must reach, in words.
    """
    return summed_up(group, subject, unit, repeated(repeats, once), required=required)


def repeated(repeats: int, once: Callable[[], T]) -> list[T]:
    """Measure so often, but at least `LEAST` times and not much longer than `BUDGET` seconds."""
    began = perf_counter()
    found: list[T] = []
    while len(found) < repeats and (len(found) < LEAST or perf_counter() - began < BUDGET):
        found.append(once())
    return found


def summed_up(
    group: str,
    subject: str,
    unit: str,
    found: Sequence[float],
    *,
    required: str = "",
    value: Callable[[Sequence[float]], float] = statistics.median,
) -> Measurement:
    """The median of what was found, or another value of it, with the lowest and the highest."""
    return Measurement(group, subject, value(found), unit, min(found), max(found), required)
