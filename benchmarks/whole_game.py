"""World, mind and history together, without a screen."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, median_of
from benchmarks.subjects import robots_of
from logical_robots_tui import Program, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.game.speed import measure_speed
from logical_robots_tui.world import list_levels

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level

__all__ = ["whole_game"]

SECONDS = 0.005  # of running for each tick that is to be measured
REQUIRED = {"01": ">= 2500", "02": ">= 2500", "07": ">= 1000", "10": ">= 400"}


def whole_game(effort: Effort) -> Iterator[Measurement]:
    """Ticks per second of each level under its reference program."""
    for level in map(load_level, list_levels()):
        program = Program.compile(load_program(level.solution).text)
        yield median_of(
            "world, mind, history",
            f"{level.name}, {robots_of(level)}",
            "ticks/s",
            effort.repeats,
            partial(_ticks_per_second, level, program, SECONDS * effort.ticks),
            required=REQUIRED.get(level.name[:2], ""),
        )


def _ticks_per_second(level: Level, program: Program, seconds: float) -> float:
    return asyncio.run(measure_speed(level, program, seconds)).ticks_per_second
