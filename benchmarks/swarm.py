"""Swarms: one think of very many robots, with each engine."""

from __future__ import annotations

from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, median_of
from benchmarks.mind import think_milliseconds
from benchmarks.subjects import program_text, rows_of
from logical_robots_tui import Mind, Program
from logical_robots_tui.mind.duck import engine as duck

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["swarms"]

EVERYBODY_SEES_ALL = '@Visible(Memory, "all");\n@Visible(Sensor, "all");\n'
REQUIRED = {3: "", 30: "", 100: "<= 4", 400: "", 1000: "<= 45"}  # by number of robots
ROBOTS_AT_ONCE = 300  # in one measurement, at least


def swarms(effort: Effort) -> Iterator[Measurement]:
    """Milliseconds for one think of a swarm, and what it costs that each sees only itself."""
    text = program_text("steering")
    each, everybody = Program.compile(text), Program.compile(EVERYBODY_SEES_ALL + text)
    duck.FEWEST = 1  # to see from where on it is quicker
    ratios = []
    for robots, required in REQUIRED.items():
        rows = rows_of(halls(1200, 700, robots=robots, beacons=56))
        thinks = max(1, ROBOTS_AT_ONCE // robots)

        def measured(mind: Mind, engine: str, required: str) -> Measurement:
            once = partial(think_milliseconds, mind, rows, thinks)  # noqa: B023 - called in this turn only
            subject = f"steering, {robots} robots, {engine}"  # noqa: B023 - as above
            found = median_of("swarm", subject, "ms", effort.repeats, once, required=required)
            mind.close()
            return found

        own = measured(Mind(each), "SQLite", required)
        yield own
        if find_spec("duckdb") is not None:
            yield measured(Mind(each, engine="duckdb"), "DuckDB", "")
        together = measured(Mind(everybody), "all see all", "")
        ratio = own.value / together.value
        ratios.append((robots, ratio, own.lowest / together.value, own.highest / together.value))
    for robots, ratio, lowest, highest in ratios:
        group, unit = "each sees itself only", "x all see all"
        yield Measurement(group, f"{robots} robots", ratio, unit, lowest, highest, "<= 1.3")
