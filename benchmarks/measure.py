"""Repeating a piece of work and summing up what it took."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Literal, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = [
    "Effort",
    "Measurement",
    "Skipped",
    "Target",
    "at_least",
    "at_most",
    "best_of",
    "median_of",
    "need",
    "processor_seconds_for",
    "ratio_of_bests",
    "repeated",
    "seconds_for",
    "summed_up",
]

T = TypeVar("T")

BUDGET = 0.6  # seconds for the repeats of one number
LEAST = 3  # repeats, however long they take
MORE = 3  # times as many repeats for the best of them


class Skipped(Exception):  # noqa: N818 - it is not an error
    """What a benchmark needs is missing on this machine; the message says what."""


def need(what: str, found: object) -> None:
    """Skip the benchmark unless something was found.

    Raises:
        Skipped: It was not.
    """
    if not found:
        raise Skipped(f"no {what}")


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
class Target:
    """What a number has to reach."""

    relation: Literal["at least", "at most"]
    number: float

    def is_met(self, value: float) -> bool:
        """Whether a value reaches it."""
        return value <= self.number if self.relation == "at most" else value >= self.number

    def __str__(self) -> str:
        return f"{self.relation} {self.number:,g}"


def at_least(number: float) -> Target:
    """Return the target for what should be high."""
    return Target("at least", number)


def at_most(number: float) -> Target:
    """Return the target for what should be low."""
    return Target("at most", number)


@dataclass(frozen=True, slots=True)
class Measurement:
    """One number.

    Attributes:
        group: What kind of number it is.
        subject: What it was measured on.
        value: The median or the best of the repeats, or what the group says.
        unit: Of the value.
        lowest: The lowest of the repeats.
        highest: The highest of the repeats.
        target: What it has to reach, if anything.
    """

    group: str
    subject: str
    value: float
    unit: str
    lowest: float
    highest: float
    target: Target | None = None

    def __str__(self) -> str:
        return f"{self.group}, {self.subject}: {self.value:,.2f} {self.unit}"


def seconds_for(work: Callable[[], object]) -> float:
    """Wall time of one call in seconds."""
    began = perf_counter()
    work()
    return perf_counter() - began


def processor_seconds_for(work: Callable[[], object]) -> float:
    """Processor time of one call in seconds, in all threads of this process."""
    began = process_time()
    work()
    return process_time() - began


def median_of(
    group: str,
    subject: str,
    unit: str,
    repeats: int,
    once: Callable[[], float],
    *,
    target: Target | None = None,
) -> Measurement:
    """Repeat a measurement and sum it up; after `BUDGET` seconds it is not begun again.

    Args:
        group: What kind of number it is.
        subject: What it is measured on.
        unit: Of the number.
        repeats: How often to measure at most.
        once: Measures once.
        target: What it has to reach.
    """
    return summed_up(group, subject, unit, repeated(repeats, once), target=target)


def best_of(
    group: str,
    subject: str,
    unit: str,
    repeats: int,
    once: Callable[[], float],
    *,
    target: Target | None = None,
    best: Callable[[Sequence[float]], float] = min,
) -> Measurement:
    """Like `median_of`, for what other processes can only make slower: pure computation."""
    found = repeated(MORE * repeats, once)
    return summed_up(group, subject, unit, found, target=target, value=best)


def ratio_of_bests(
    group: str,
    subject: str,
    unit: str,
    found: Sequence[float],
    others: Sequence[float],
    *,
    target: Target | None = None,
) -> Measurement:
    """The lowest of some times over the lowest of others, which were measured in turn with them."""
    ratios = [one / other for one, other in zip(found, others, strict=True)]
    value = min(found) / min(others)
    return Measurement(group, subject, value, unit, min(ratios), max(ratios), target)


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
    target: Target | None = None,
    value: Callable[[Sequence[float]], float] = statistics.median,
) -> Measurement:
    """The median of what was found, or another value of it, with the lowest and the highest."""
    return Measurement(group, subject, value(found), unit, min(found), max(found), target)
