"""Moments of a level under a program, and the programs that steps of a briefing result in.

``steps`` has the program that results from each step that gives code or says what to do first; the
last hint of a level mostly results in its solution.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from math import dist
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from logical_robots_tui import Level, Mind, Program, World
from logical_robots_tui.mind.program import ResultTable
from logical_robots_tui.world.dynamics import WorldState
from tests.levels.playing import load_level, program_text

STEPS = Path(__file__).with_name("steps")

NO_TABLES: Mapping[str, ResultTable] = MappingProxyType({})


class Moment(NamedTuple):
    """The middle of a tick: robots have sensed and not yet decided."""

    level: Level
    tick: int
    state: WorldState
    rows: Any
    memories: dict[str, Any]
    mind: Mind
    tables: Mapping[str, ResultTable] = NO_TABLES

    def radar(self, robot: str) -> list[Any]:
        (sensor,) = (row["sensor"] for row in self.rows if row["robot_name"] == robot)
        return list(sensor["radar"])

    def to(self, beacon: str, robot: str) -> float:
        """How far a robot is from the nearest beacon of a name."""
        (state,) = (r for r in self.state.robots if r.name == robot)
        beacons = [b for b in self.level.beacons if b.name == beacon]
        return min(dist((state.x, state.y), (b.x, b.y)) for b in beacons)


def moments(name: str, text: str, ticks: int) -> Iterator[Moment]:
    level = load_level(name)
    sees = level.visibility
    world = World(level)
    mind = Mind(Program.compile(text), memory=sees.memory, sensor=sees.sensor)
    memories: dict[str, Any] = {robot.name: "" for robot in level.robots}
    try:
        while world.tick < ticks and world.won_at is None:
            rows = world.sense()
            yield Moment(level, world.tick, world.save(), rows, memories, mind)
            decisions = mind.think(rows, memories)
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
    finally:
        mind.close()


def at(name: str, ticks: Sequence[int], *predicates: str) -> list[Moment]:
    """Some ticks of a level under its starter, with the tables of some predicates."""
    return [
        moment._replace(
            tables={p: moment.mind.query(p, moment.rows, moment.memories) for p in predicates}
        )
        for moment in moments(name, program_text(load_level(name).starter), max(ticks))
        if moment.tick in ticks
    ]


@cache
def step(name: str, which: str) -> str:
    """The program that results from the ``briefing`` or the last ``hint``."""
    path = STEPS / f"{name}-{which}.l"
    return path.read_text("utf-8") if path.exists() else program_text(load_level(name).solution)
