"""One think of very many robots."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, at_most, best_of, median_of
from benchmarks.mind import think_milliseconds
from benchmarks.subjects import program_text, rows_of
from logical_robots_tui import Mind, Program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import SensorRow

__all__ = ["swarms"]

EVERYBODY_SEES_ALL = '@Visible(Memory, "all");\n@Visible(Sensor, "all");\n'
TARGETS = {3: None, 100: at_most(4), 1000: at_most(45)}  # by number of robots
ROBOTS_AT_ONCE = 300  # at least, in one measurement


def swarms(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds of one think of a swarm, and the cost of own-only visibility."""
    text = program_text("steering")
    each, everybody = Program.compile(text), Program.compile(EVERYBODY_SEES_ALL + text)
    ratios = []
    for robots, target in TARGETS.items():
        rows = rows_of(halls(1200, 700, robots=robots, beacons=56))
        thinks = max(1, ROBOTS_AT_ONCE // robots)
        own, together = Mind(each), Mind(everybody)
        subject = f"steering, {robots} robots"
        once = partial(think_milliseconds, own, rows, thinks)
        yield best_of("swarm", subject, "ms", effort.repeats, once, target=target)
        # Measured in turn, because the machine's speed may change.
        ratios.append(
            median_of(
                "each sees itself only",
                f"{robots} robots",
                "x all see all",
                2 * effort.repeats,
                partial(_ratio, own, together, rows, thinks),
                target=at_most(1.3),
            )
        )
        own.close()
        together.close()
    yield from ratios


def _ratio(own: Mind, together: Mind, rows: list[SensorRow], thinks: int) -> float:
    """Return the ratio of the two minds' times."""
    return think_milliseconds(own, rows, thinks) / think_milliseconds(together, rows, thinks)
