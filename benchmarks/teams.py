"""Teams: what a second mind costs in a tick, beside one mind with as many robots."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, processor_seconds_for, summed_up
from benchmarks.subjects import solution_of
from logical_robots_tui import load_level
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.world import Team

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level, Program

__all__ = ["teams"]

LEVELS = ("04-everybody-home", "07-station-management", "13-swarm")
ONE, TWO = ("red",), ("red", "blue")


def teams(effort: Effort) -> Iterator[Measurement]:
    """Measure whole ticks by turns: one team with one mind, and two teams with as many robots."""
    for name in LEVELS:
        level = load_level(name)
        program = solution_of(name)
        ticks = max(20, 3 * effort.ticks // len(level.robots))  # a crowd shows it in fewer
        ratios = []
        for _ in range(effort.repeats + 2):
            one, two = (_seconds(_in_teams(level, names), program, ticks) for names in (ONE, TWO))
            ratios.append(two / one)
        robots = f"{name}, {len(level.robots)} robots"
        yield summed_up("a second mind", robots, "times", ratios[1:], target=at_most(1.15))


def _in_teams(level: Level, names: tuple[str, ...]) -> Level:
    """Return the level with its robots in teams by turns."""
    robots = tuple(replace(r, team=names[i % len(names)]) for i, r in enumerate(level.robots))
    return replace(level, robots=robots, teams=tuple(map(Team, names)))


def _seconds(level: Level, program: Program, ticks: int) -> float:
    return processor_seconds_for(partial(play_through, level, program, ticks))
