"""What is measured: levels and programs of different weight."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui import Desire, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.world import World, list_levels

if TYPE_CHECKING:
    from logical_robots_tui import Level
    from logical_robots_tui.values import SensorRow

__all__ = ["all_levels", "drive", "few_levels", "own_programs", "robots_of", "rows_under_way"]

CHECKOUT = Path(__file__).parents[1]
ROWS_AT = 40  # ticks; by then robots have moved and radars differ


def all_levels() -> list[Level]:
    """The shipped levels, then those of the conformance tests, in order of robots."""
    paths = sorted((CHECKOUT / "tests" / "conformance" / "levels").glob("*.json"))
    levels = [load_level(name) for name in (*list_levels(), *map(str, paths))]
    return sorted(levels, key=lambda level: len(level.robots))


def few_levels() -> list[Level]:
    """A level with one robot, one with a few and one with many."""
    levels = {len(level.robots): level for level in all_levels()}
    numbers = sorted(levels)
    return [levels[number] for number in (numbers[0], numbers[len(numbers) // 2], numbers[-1])]


def robots_of(level: Level) -> str:
    """How many robots a level has, in words."""
    number = len(level.robots)
    return "1 robot" if number == 1 else f"{number} robots"


def own_programs() -> dict[str, str]:
    """Texts of the programs beside this file by name, from light to heavy."""
    sources = map(load_program, sorted((Path(__file__).parent / "programs").glob("*.l")))
    return {source.name: source.text for source in sources}


def drive(world: World, ticks: int) -> None:
    """Let all robots wind through a level without thinking."""
    names = [robot.name for robot in world.robots]
    for _ in range(ticks):
        world.sense()
        left = 0.3 + 0.7 * ((world.tick // 25) % 2)
        world.act({name: Desire(left, 1.0 - 0.6 * left) for name in names})


def rows_under_way(level: Level) -> list[SensorRow]:
    """What the robots of a level sense after some driving."""
    world = World(level)
    drive(world, ROWS_AT)
    return world.sense()
