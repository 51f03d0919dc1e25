"""World, mind and history together, without a screen."""

from __future__ import annotations

import asyncio
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_least, best_of
from benchmarks.subjects import LARGEST, robots_of, solution_of
from logical_robots_tui import load_level
from logical_robots_tui.game import Game

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level, Program
    from logical_robots_tui.game import Frame

__all__ = ["ticks_per_second", "whole_game"]

SECONDS = 0.001  # of running for each tick that is to be measured
LEVELS = {
    "01-first-steps": at_least(2500),
    "04-everybody-home": None,
    "07-station-management": at_least(1000),
    LARGEST: at_least(400),
    "13-swarm": None,
}
"""Levels, and what each must reach."""


def whole_game(effort: Effort) -> Iterator[Measurement]:
    """Measure the ticks per second of levels under their reference programs."""
    for name, target in LEVELS.items():
        level = load_level(name)
        program = solution_of(name)
        yield best_of(
            "world, mind, history",
            f"{level.name}, {robots_of(level)}",
            "ticks/s",
            effort.repeats,
            partial(ticks_per_second, level, program, SECONDS * effort.ticks),
            target=target,
            best=max,
        )


def ticks_per_second(level: Level, program: Program, seconds: float) -> float:
    """Return the ticks per second of a level at full speed, restarted when it is won.

    Args:
        level: The level.
        program: The robots' program.
        seconds: How long to run, after a first tick that is not counted.
    """
    return asyncio.run(_ticks_per_second(level, program, seconds))


async def _ticks_per_second(level: Level, program: Program, seconds: float) -> float:
    game = Game(level, program)
    ticks = 0

    def count(frame: Frame) -> None:
        nonlocal ticks
        ticks += frame.tick > 0

    try:
        await game.step()
        game.listen(count)
        began = perf_counter()
        until = began + seconds
        while perf_counter() < until:
            await game.run_until(condition=lambda _: perf_counter() >= until)
            if game.won_at is not None:
                game.restart()
                game.forget_future()
        return ticks / (perf_counter() - began)
    finally:
        await game.close()
