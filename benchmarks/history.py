"""History: the memory that a tick takes, and the time to restore one."""

from __future__ import annotations

import asyncio
import random
import re
import tracemalloc
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, at_most, summed_up
from benchmarks.subjects import LARGEST, program_text, robots_of, solution_of
from benchmarks.with_screen import SIZE, opened
from logical_robots_tui import Program, load_level
from logical_robots_tui.game import Frame, Game, History
from logical_robots_tui.game.history.history import DEFAULT_LENGTH

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level
    from tests.terminal import Terminal

__all__ = ["history"]

SHORT, LONG = 600, 1_200  # ticks: what is held grows by the same with each, once they are packed
JUMPS = 60
QUIET = 0.15  # seconds without output, after which a paused game has nothing more to say


def history(effort: Effort) -> Iterator[Measurement]:
    """Measure memory and time for ten robots, without and with a map in their memories."""
    ten = halls(1200, 700, robots=10, beacons=56)
    steering = Program.compile(program_text("steering"))
    for name, program in (("ten that steer", steering), ("ten that map", solution_of(LARGEST))):
        yield from asyncio.run(_measure(replace(ten, name=name), program, effort.ticks))
    yield _key_to_screen(effort.ticks // 40)


async def _measure(level: Level, program: Program, ticks: int) -> list[Measurement]:
    game = Game(level, program)
    frames = [game.frame]
    game.listen(frames.append)
    while game.frame.tick < ticks:
        await game.run_until(tick=ticks)
    chance = random.Random(ticks)
    jumps = _milliseconds(game, [chance.randrange(ticks) for _ in range(JUMPS)])
    steps = _milliseconds(game, list(range(ticks - 1, max(ticks - JUMPS, 0), -1)))
    await game.close()
    subject = f"{level.name}, {robots_of(level)}"
    megabytes = _megabytes(level, frames, program)
    kept = f"history of {DEFAULT_LENGTH:,} ticks"
    return [
        summed_up(kept, subject, "MB", [megabytes], target=at_most(200)),
        summed_up("restore a tick", subject, "ms", jumps),
        summed_up("step back a tick", subject, "ms", steps),
    ]


def _megabytes(level: Level, frames: list[Frame], program: Program) -> float:
    """What a full history holds, by what two short ones hold.

    They are of the ticks that were run, over and over, under new numbers.
    """
    held = []
    tracemalloc.start()
    try:
        kept = History(frames[0], level)
        for tick in range(1, LONG + 1):
            frame = frames[1 + (tick - 1) % (len(frames) - 1)]
            before, after = replace(frame.before, tick=tick - 1), replace(frame.after, tick=tick)
            kept.add(replace(frame, tick=tick, before=before, after=after), program)
            if tick in (SHORT, LONG):
                held.append(tracemalloc.get_traced_memory()[0] / 1e6)
    finally:
        tracemalloc.stop()
    short, long = held
    return long + (long - short) / (LONG - SHORT) * (DEFAULT_LENGTH - LONG)


def _milliseconds(game: Game, ticks: list[int]) -> list[float]:
    found = []
    for tick in ticks:
        began = perf_counter()
        game.go_to(tick)
        found.append(1000 * (perf_counter() - began))
    return found


def _key_to_screen(presses: int) -> Measurement:
    """Measure the milliseconds from the key to the previous tick on the screen."""
    with opened(LARGEST, load_level(LARGEST).solution) as terminal:
        terminal.send("U")
        terminal.wait_for("Run until tick")
        terminal.send(f"{presses + 100}\r")
        terminal.wait_for(lambda: _shows(terminal, presses + 100))
        found = []
        for press in range(1, presses + 1):
            terminal.wait_for_quiet(QUIET)
            began = perf_counter()
            terminal.send("p")
            there = partial(_shows, terminal, presses + 100 - press)
            found.append(1000 * (terminal.arrival_of(there) - began))
    return summed_up(
        "key to tick before", f"{SIZE[0]}x{SIZE[1]}, {LARGEST}", "ms", found, target=at_most(20)
    )


def _shows(terminal: Terminal, tick: int) -> bool:
    return bool(re.search(rf"\btick {tick}\b", terminal.text))
