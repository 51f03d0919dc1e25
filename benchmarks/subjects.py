"""The levels and programs that are measured."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from logical_robots_tui import Desire, Program, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.world import World

if TYPE_CHECKING:
    from logical_robots_tui import Level
    from logical_robots_tui.values import SensorRow

__all__ = [
    "LARGEST",
    "PROGRAMS",
    "drive",
    "program_text",
    "robots_of",
    "rows_for",
    "rows_of",
    "solution_of",
]

LARGEST = "10-distributed-mapping"
"""The shipped level that takes the most thinking."""

ROWS_AT = 40  # ticks; by then robots have moved and radars differ

PROGRAMS = {
    "steering": ("Ada", "Bo", "Cy"),
    "herd": ("Ada", "Bo", "Cy", "Di"),
    "stations": ("Fire", "Water", "Miner"),
    "gate": ("Ada",),
    "mapping": ("Ada", "Bo", "Cy", "Di", "Ed", "Fay"),
    "follow": ("Ada", "Bo", "Cy", "Di"),
}
"""Programs beside this file, each with its robots."""

BEACONS = ("home", "fire station", "water station", "mine", "switch", "left post", "right post")


def robots_of(level: Level) -> str:
    """Return the number of robots of a level as text."""
    number = len(level.robots)
    return "1 robot" if number == 1 else f"{number} robots"


@cache
def solution_of(level_name: str) -> Program:
    """Return the solution of a shipped level, compiled once for all benchmarks."""
    return Program.compile(load_program(load_level(level_name).solution).text)


def program_text(name: str) -> str:
    """Return the text of a program."""
    return (Path(__file__).parent / "programs" / f"{name}.l").read_text(encoding="utf-8")


def rows_for(name: str) -> list[SensorRow]:
    """Return sensor rows for a program's robots: each other, and a few beacons it knows."""
    robots = PROGRAMS[name]
    level = halls(400, 300, robots=len(robots), beacons=len(BEACONS))
    return rows_of(
        replace(
            level,
            robots=tuple(replace(r, name=n) for r, n in zip(level.robots, robots, strict=True)),
            beacons=tuple(replace(b, name=n) for b, n in zip(level.beacons, BEACONS, strict=True)),
        )
    )


def drive(world: World, ticks: int) -> None:
    """Drive all robots along winding paths without thinking."""
    names = [robot.name for robot in world.robots]
    for _ in range(ticks):
        world.sense()
        left = 0.3 + 0.7 * ((world.tick // 25) % 2)
        world.act({name: Desire(left, 1.0 - 0.6 * left) for name in names})


def rows_of(level: Level) -> list[SensorRow]:
    """Return the sensor rows of a level's robots after some driving."""
    world = World(level)
    drive(world, ROWS_AT)
    return world.sense()
