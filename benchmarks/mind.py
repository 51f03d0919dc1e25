"""The mind alone: compiling and thinking."""

from __future__ import annotations

from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, median_of, seconds_for
from benchmarks.subjects import few_levels, own_programs, robots_of, rows_under_way
from logical_robots_tui import Mind, Program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import SensorRow, Value

__all__ = ["compiling", "thinking"]

THINKS = 20  # in one measurement

_numbers = count()


def compiling(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds to compile a program that was never seen before."""
    for name, text in own_programs().items():
        once = partial(_compile_milliseconds, text)
        yield median_of("compile", name, "ms", effort.repeats, once)


def thinking(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds for one think of all robots together."""
    for name, text in own_programs().items():
        program = Program.compile(text)
        for level in few_levels():
            rows = rows_under_way(level)
            mind = Mind(program)
            decisions = mind.think(rows, {})
            memories = {decision.robot_name: decision.memory for decision in decisions}
            yield median_of(
                "think",
                f"{name}, {robots_of(level)}",
                "ms",
                effort.repeats,
                partial(_think_milliseconds, mind, rows, memories),
            )
            mind.close()


def _compile_milliseconds(text: str) -> float:
    # A comment of its own keeps the text from being found in a cache.
    fresh = f"{text}\n# {next(_numbers)}\n"
    return 1000 * seconds_for(partial(Program.compile, fresh))


def _think_milliseconds(mind: Mind, rows: list[SensorRow], memories: dict[str, Value]) -> float:
    def think() -> None:
        for _ in range(THINKS):
            mind.think(rows, memories)

    return 1000 * seconds_for(think) / THINKS
