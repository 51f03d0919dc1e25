"""The world alone."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, median_of, seconds_for
from benchmarks.subjects import all_levels, drive, robots_of
from logical_robots_tui import World

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level

__all__ = ["world_alone"]


def world_alone(effort: Effort) -> Iterator[Measurement]:
    """Ticks per second of sensing and acting, without a mind."""
    for level in all_levels():
        yield median_of(
            "world alone",
            f"{level.name}, {robots_of(level)}",
            "ticks/s",
            effort.repeats,
            partial(_ticks_per_second, level, effort.ticks),
        )


def _ticks_per_second(level: Level, ticks: int) -> float:
    return ticks / seconds_for(partial(drive, World(level), ticks))
