"""Replays: the size of their files, and the time to gather one from a history."""

from __future__ import annotations

import asyncio
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, summed_up
from logical_robots_tui import Game, Program, load_level
from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.game import load_program
from logical_robots_tui.game.replay import gather

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["replays"]

RUNS = (("01-first-steps", "first-steps", 5000), ("08-formation", "formation", 600))
"""Level, program and the most ticks; a victory ends a run."""


def replays(effort: Effort) -> Iterator[Measurement]:
    """Measure kilobytes, and the milliseconds to make the file at the end of a run."""
    for level, program, ticks in RUNS[: 1 if effort.is_quick else None]:
        done, size, milliseconds = asyncio.run(_measured(level, program, ticks))
        subject = f"{level}, {done:,} ticks"
        yield summed_up("replay", subject, "kB", [size])
        yield summed_up("replay, gathered and packed", subject, "ms", [milliseconds])


async def _measured(level: str, program: str, ticks: int) -> tuple[int, float, float]:
    game = Game(load_level(level), Program.compile(load_program(program).text))
    try:
        await game.run_until(tick=ticks)
        began = perf_counter()
        replay = await gather(game.history, write_native, lambda _program: program)
        content = replay.to_bytes()
        return replay.last, len(content) / 1000, 1000 * (perf_counter() - began)
    finally:
        await game.close()
