"""World and mind together, without a screen."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, median_of, seconds_for
from benchmarks.subjects import few_levels, own_programs, robots_of
from logical_robots_tui import Game, Program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level

__all__ = ["whole_game"]


def whole_game(effort: Effort) -> Iterator[Measurement]:
    """Ticks per second of a whole game."""
    for name, text in own_programs().items():
        program = Program.compile(text)
        for level in few_levels():
            yield median_of(
                "world and mind",
                f"{name}, {level.name}, {robots_of(level)}",
                "ticks/s",
                effort.repeats,
                partial(_ticks_per_second, level, program, effort.ticks),
            )


def _ticks_per_second(level: Level, program: Program, ticks: int) -> float:
    return ticks / seconds_for(lambda: asyncio.run(_play(level, program, ticks)))


async def _play(level: Level, program: Program, ticks: int) -> None:
    game = Game(level, program)
    try:
        while game.frame.tick < ticks:
            await game.step()
    finally:
        await game.close()
