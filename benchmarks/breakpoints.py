"""The cost of a breakpoint: processor time of a run with one and of the same run without."""

from __future__ import annotations

import asyncio
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, ratio_of_bests, repeated
from benchmarks.subjects import robots_of, solution_of
from logical_robots_tui import load_level
from logical_robots_tui.game import Breakpoint, Breakpoints, Game

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level, Program

__all__ = ["breakpoints"]

WATCHED = {
    "13-swarm": (
        "Robot",
        "Settled(robot_name:, distance:), distance < 10",
    ),
    "06-breadcrumbs": ("Sensor(robot_name:, sensor:), ray in sensor.radar, ray.distance < 3",),
}
TICKS = {"13-swarm": 0.05, "06-breadcrumbs": 0.3}
"""Ticks to run for each unit of effort."""


def breakpoints(effort: Effort) -> Iterator[Measurement]:
    """Measure the slowdown of a run by a breakpoint on a predicate or a question."""
    for name, subjects in WATCHED.items():
        level = load_level(name)
        program = solution_of(name)
        ticks = max(10, int(TICKS[name] * effort.ticks))
        for subject in subjects:
            once = partial(_both_seconds, level, program, subject, ticks)
            # In turn, because the machine's speed may change.
            watched, plain = zip(*repeated(effort.repeats, once), strict=True)
            yield ratio_of_bests(
                "run with a breakpoint",
                f"{name}, {robots_of(level)}: {subject[:40]}",
                "x without",
                watched,
                plain,
                target=at_most(1.3) if name == "13-swarm" else None,
            )


def _both_seconds(level: Level, program: Program, subject: str, ticks: int) -> tuple[float, float]:
    """Return the processor time with a breakpoint and without."""
    return _seconds(level, program, ticks, subject), _seconds(level, program, ticks, "")


def _seconds(level: Level, program: Program, ticks: int, subject: str) -> float:
    async def run() -> float:
        wanted = [Breakpoint("rows", subject)] if subject else []
        game = Game(level, program, breakpoints=Breakpoints(wanted))
        await _run_to(game, 3)  # compiling and the first statements don't count
        began = process_time()
        await _run_to(game, 3 + ticks)
        took = process_time() - began
        assert not any(map(game.problem_with, wanted))
        await game.close()
        return took

    return asyncio.run(run())


async def _run_to(game: Game, tick: int) -> None:
    """Run to a tick, past hits of the breakpoint."""
    while game.frame.tick < tick:
        await game.run_until(tick=tick)
