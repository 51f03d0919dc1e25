"""The world alone."""

from __future__ import annotations

import tracemalloc
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.halls import halls, open_room
from benchmarks.measure import (
    Effort,
    Measurement,
    at_most,
    best_of,
    median_of,
    processor_seconds_for,
)
from benchmarks.subjects import drive
from logical_robots_tui import World

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level

__all__ = ["crowds"]

CROWDS = (
    ("1 robot, open 500x500", open_room(500, 500), at_most(0.15)),
    (
        "3 robots, 10 beacons, 3 areas",
        halls(1200, 700, robots=3, beacons=10, areas=3),
        at_most(0.4),
    ),
    *(
        (f"{robots} robots, 56 beacons", halls(1200, 700, robots=robots, beacons=56), at_most(most))
        for robots, most in ((6, 0.6), (100, 8), (400, 35), (1000, 100))
    ),
)
TICKS_OF_ROBOTS = 400  # in one measurement, at least 5


def crowds(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds to sense and act, and the memory of the largest level."""
    for subject, level, target in CROWDS:
        ticks = max(5, TICKS_OF_ROBOTS // len(level.robots))
        once = partial(_tick_milliseconds, level, ticks)
        repeats = effort.repeats
        yield best_of("sense and act", subject, "ms", repeats, once, target=target)
    yield median_of("memory", "4,000x4,000", "MB", 1, _largest_megabytes, target=at_most(200))


def _tick_milliseconds(level: Level, ticks: int) -> float:
    world = World(level)
    drive(world, 1)
    return 1000 * processor_seconds_for(partial(drive, world, ticks)) / ticks


def _largest_megabytes() -> float:
    """Return the peak memory of creating and running the largest level."""
    tracemalloc.start()
    try:
        drive(World(halls(4000, 4000, robots=10, beacons=100)), 3)
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()
