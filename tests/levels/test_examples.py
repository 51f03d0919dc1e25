"""The free examples run, and do what they say."""

from __future__ import annotations

import math
from itertools import combinations

import pytest

from logical_robots_tui import Mind, World, load_level
from tests.levels.playing import shipped_program, ticks_to_win

EXAMPLES = {
    # a program, and the level where to try it
    "clock-in-memory": "01-first-steps",
    "herd": "04-everybody-home",
    "obstacle-avoider": "02-open-space",
    "wall-crawler": "03-the-long-hall",
}


def world_after(program: str, ticks: int) -> World:
    """The world after so many ticks; fails if a program has anything to remark."""
    world = World(load_level(EXAMPLES[program]))
    mind = Mind(shipped_program(program))
    memories: dict[str, object] = {}
    for _ in range(ticks):
        decisions = mind.think(world.sense(), memories)
        assert [notice for d in decisions for notice in d.notices] == []
        world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
        memories = {d.robot_name: d.memory for d in decisions}
    mind.close()
    return world


@pytest.mark.parametrize("program", EXAMPLES)
def test_an_example_has_nothing_odd_and_moves_every_robot(program: str) -> None:
    assert shipped_program(program).warnings == ()
    world = world_after(program, 100)
    for robot, start in zip(world.robots, world.level.robots, strict=True):
        assert math.dist((robot.x, robot.y), (start.x, start.y)) > 5


def test_the_clock_brings_a_robot_round_a_square() -> None:
    world = world_after("clock-in-memory", 4 * 91)
    (robot,), (start,) = world.robots, world.level.robots
    assert math.dist((robot.x, robot.y), (start.x, start.y)) < 5


def test_the_wall_crawler_finds_its_way_out_of_a_labyrinth() -> None:
    level = load_level(EXAMPLES["wall-crawler"])
    assert ticks_to_win(level, shipped_program("wall-crawler"), 6000)


def test_a_herd_keeps_together() -> None:
    robots = world_after("herd", 3000).robots
    apart = [math.dist((a.x, a.y), (b.x, b.y)) for a, b in combinations(robots, 2)]
    assert min(apart) < 100
