"""The mind alone: compiling and thinking."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from benchmarks.measure import (
    Effort,
    Measurement,
    at_most,
    best_of,
    median_of,
    processor_seconds_for,
    seconds_for,
)
from benchmarks.subjects import LARGEST, PROGRAMS, program_text, rows_for
from logical_robots_tui import Mind, Program, caching, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.mind.compilation import (
    CompileProgram,
    find_result,
    keep_result,
    stop_compiling,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import SensorRow, Value

__all__ = ["compiling", "think_milliseconds", "thinking"]

THINKS = 50  # in one measurement

TARGETS = {
    "steering": at_most(0.14),
    "herd": at_most(0.26),
    "stations": at_most(0.26),
    "gate": at_most(0.10),
    "mapping": at_most(0.84),
    "follow": at_most(0.20),
}

_numbers = count()


def compiling(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds to compile a program with all predicates, uncached and cached."""
    stop_compiling()
    once = partial(_compile, program_text("steering"))
    yield median_of("start of the compiler", "and a first program", "ms", 1, once)
    largest = load_program(load_level(LARGEST).solution).text
    for name, text in (("gate", program_text("gate")), (LARGEST, largest)):
        once = partial(_compile, text)
        yield best_of("compile", name, "ms", effort.repeats, once, target=at_most(1000))
    once = partial(_find_kept, Program.compile(largest))
    with _cache_folder():
        yield best_of("compiled before", LARGEST, "ms", effort.repeats, once, target=at_most(50))


def thinking(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds of one think of all robots, tuned and plain."""
    for group, plain in (("think", False), ("think, the plain way", True)):
        for name, robots in PROGRAMS.items():
            mind = Mind(Program.compile(program_text(name)), plain=plain)
            once = partial(think_milliseconds, mind, rows_for(name), THINKS)
            subject = f"{name}, {len(robots)} robots"
            target = None if plain else TARGETS[name]
            yield best_of(group, subject, "ms", effort.repeats, once, target=target)
            mind.close()


def _compile(text: str) -> float:
    # A unique comment keeps the text out of any cache.
    fresh = f"{text}\n# {next(_numbers)}\n"
    return 1000 * seconds_for(partial(Program.compile, fresh))


@contextmanager
def _cache_folder() -> Iterator[None]:
    before = os.environ.get(caching.FOLDER_VARIABLE, "")
    with tempfile.TemporaryDirectory() as folder:
        os.environ[caching.FOLDER_VARIABLE] = folder
        yield
        os.environ[caching.FOLDER_VARIABLE] = before


def _find_kept(program: Program) -> float:
    """Return the milliseconds to load a program that an earlier process compiled."""
    task = CompileProgram(program.text)
    keep_result(task, program)
    return 1000 * seconds_for(partial(find_result, task, Program))


def think_milliseconds(mind: Mind, rows: list[SensorRow], thinks: int) -> float:
    """Return the processor milliseconds of one think, the mean of several after a warm-up."""
    memories: dict[str, Value] = {}
    for _ in range(3):
        memories = {d.robot_name: d.memory for d in mind.think(rows, memories)}

    def think() -> None:
        for _ in range(thinks):
            mind.think(rows, memories)

    return 1000 * processor_seconds_for(think) / thinks
