"""The free examples run, and do what they say."""

from __future__ import annotations

import math
from collections import deque
from itertools import combinations
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui import Mind, World, load_level
from tests.levels.playing import shipped_program, ticks_to_win

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import Value

EXAMPLES = {
    # a program, and the level where to try it
    "clock-in-memory": "01-first-steps",
    "herd": "05-lighthouse",
    "obstacle-avoider": "02-open-space",
    "steering": "03-the-long-hall",
    "wall-crawler": "03-the-long-hall",
}


def worlds(program: str, level: str, ticks: int) -> Iterator[World]:
    """The world after each tick; fails if the program has anything to remark."""
    world = World(load_level(level))
    mind = Mind(shipped_program(program))
    memories: dict[str, Value] = {}
    try:
        for _ in range(ticks):
            decisions = mind.think(world.sense(), memories)
            assert [notice for d in decisions for notice in d.notices] == []
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
            yield world
    finally:
        mind.close()


def last(states: Iterator[World]) -> World:
    return deque(states, maxlen=1).pop()


def away_from_start(world: World) -> list[float]:
    """How far each robot is from its start."""
    starts = world.level.robots
    return [math.dist((r.x, r.y), (s.x, s.y)) for r, s in zip(world.robots, starts, strict=True)]


@pytest.mark.sampled
@pytest.mark.parametrize(("program", "level"), EXAMPLES.items())
def test_an_example_has_nothing_odd_and_moves_every_robot(program: str, level: str) -> None:
    assert shipped_program(program).warnings == ()
    assert min(away_from_start(last(worlds(program, level, 100)))) > 5


def test_the_clock_brings_a_robot_round_a_square() -> None:
    ways = [
        away_from_start(world)[0]
        for world in worlds("clock-in-memory", EXAMPLES["clock-in-memory"], 4 * 91)
    ]
    assert max(ways) > 40
    assert ways[-1] < 5


@pytest.mark.slow
@pytest.mark.parametrize("program", ["steering", "wall-crawler"])
def test_a_hand_on_the_wall_leads_out_of_a_labyrinth(program: str) -> None:
    assert ticks_to_win(load_level(EXAMPLES[program]), shipped_program(program), 6000)


def ticks_near_each_other(program: str) -> int:
    """How often two robots are near each other in a sea."""
    return sum(
        math.dist((a.x, a.y), (b.x, b.y)) < 100
        for world in worlds(program, EXAMPLES["herd"], 1500)
        for a, b in combinations(world.robots, 2)
    )


@pytest.mark.slow
def test_a_herd_keeps_together() -> None:
    assert ticks_near_each_other("herd") > 3 * ticks_near_each_other("open-space")
