"""Proofs of decisions: milliseconds for the whole tree, and the ratio to a think."""

from __future__ import annotations

import statistics
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmarks.measure import Effort, Measurement, at_most, processor_seconds_for, summed_up
from benchmarks.subjects import solution_of
from logical_robots_tui import Mind, World, load_level
from logical_robots_tui.explain import Explainer
from logical_robots_tui.world import list_levels

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["proofs"]

MOST_TICKS = 150
LOOKS = 5  # at each run
ROBOTS = 3  # at each look
THINKS = 5


def proofs(effort: Effort) -> Iterator[Measurement]:
    """Measure the 95th percentile for the solutions' decisions on every third level."""
    levels = list_levels()[:: 6 if effort.is_quick else 3]
    subject = f"{len(levels)} levels"
    all_times, all_ratios = [], []
    for name in levels:
        times, ratios = _measured(name, min(effort.ticks, MOST_TICKS))
        all_times += times
        all_ratios += ratios
    target = at_most(150)
    yield summed_up("proof, p95", subject, "ms", all_times, value=_p95, target=target)
    yield summed_up("proof / think, p95", subject, "x", all_ratios, value=_p95)


def _measured(name: str, ticks: int) -> tuple[list[float], list[float]]:
    """Return processor milliseconds of proofs, and the ratio of each to a think of all robots."""
    level = load_level(name)
    program = solution_of(name)
    visibility = level.visibility
    world = World(level)
    memories: dict[str, Any] = {}
    times: list[float] = []
    ratios: list[float] = []
    with closing(Mind(program, visibility.memory, visibility.sensor)) as mind:
        for tick in range(1, ticks + 1):
            rows = world.sense()
            decisions = mind.think(rows, memories)
            if tick % max(1, ticks // LOOKS) == 0:
                once = partial(mind.think, rows, memories)
                think = statistics.median(processor_seconds_for(once) for _ in range(THINKS))
                for robot in [each.name for each in level.robots[:ROBOTS]]:
                    explainer = Explainer(mind, robot, rows, memories)
                    if not times:
                        explainer.proof()  # takes the predicates apart, once for each program
                        explainer = Explainer(mind, robot, rows, memories)
                    seconds = processor_seconds_for(explainer.proof)
                    times.append(1000 * seconds)
                    ratios.append(seconds / think)
            memories = {d.robot_name: d.memory for d in decisions}
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
    return times, ratios


def _p95(values: Sequence[float]) -> float:
    return statistics.quantiles(values, n=20)[-1]
