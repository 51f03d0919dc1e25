"""Swarms: one think of very many robots."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, median_of
from benchmarks.mind import think_milliseconds
from benchmarks.subjects import program_text, rows_of
from logical_robots_tui import Mind, Program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import SensorRow

__all__ = ["swarms"]

EVERYBODY_SEES_ALL = '@Visible(Memory, "all");\n@Visible(Sensor, "all");\n'
REQUIRED = {3: "", 30: "", 100: "<= 4", 400: "", 1000: "<= 45"}  # by number of robots
ROBOTS_AT_ONCE = 300  # in one measurement, at least


def swarms(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds for one think of a swarm, and what it costs that each sees only itself."""
    text = program_text("steering")
    each, everybody = Program.compile(text), Program.compile(EVERYBODY_SEES_ALL + text)
    ratios = []
    for robots, required in REQUIRED.items():
        rows = rows_of(halls(1200, 700, robots=robots, beacons=56))
        thinks = max(1, ROBOTS_AT_ONCE // robots)
        own, together = Mind(each), Mind(everybody)
        subject = f"steering, {robots} robots"
        once = partial(think_milliseconds, own, rows, thinks)
        yield median_of("swarm", subject, "ms", effort.repeats, once, required=required)
        # Both in turn: the machine may be slower or quicker a moment later.
        ratios.append(
            median_of(
                "each sees itself only",
                f"{robots} robots",
                "x all see all",
                2 * effort.repeats,
                partial(_ratio, own, together, rows, thinks),
                required="<= 1.3",
            )
        )
        own.close()
        together.close()
    yield from ratios


def _ratio(own: Mind, together: Mind, rows: list[SensorRow], thinks: int) -> float:
    """How many times as long as the other a mind takes."""
    return think_milliseconds(own, rows, thinks) / think_milliseconds(together, rows, thinks)
