"""Robots that block each other, and levels with several goals at once."""

import math
from dataclasses import replace

from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Level, Robot, World
from tests.world.making import make_level


def face_to_face(*, solid: bool = True) -> Level:
    level = make_level((Robot("Ann", 30.5, 50.5), Robot("Bob", 70.5, 50.5, angle=math.pi)))
    return replace(level, solid_robots=solid)


def drive(world: World, ticks: int, **powers: float) -> None:
    for _ in range(ticks):
        world.act({name: Desire(power, power) for name, power in powers.items()})


def gap(world: World) -> float:
    ann, bob = world.robots
    return bob.x - ann.x


def test_robots_that_meet_block_each_other_and_can_part() -> None:
    world = World(face_to_face())
    drive(world, 40, Ann=1, Bob=1)
    assert 16 <= gap(world) <= 18
    assert all(robot.blocked for robot in world.robots)
    drive(world, 10, Ann=-1, Bob=1)
    assert not any(robot.blocked for robot in world.robots)
    assert world.robots[0].x < 40
    free = World(face_to_face(solid=False))  # unless the level says otherwise
    drive(free, 40, Ann=1, Bob=1)
    assert gap(free) < -30
    assert not any(robot.blocked for robot in free.robots)


def test_the_order_of_the_robots_makes_no_difference() -> None:
    level = face_to_face()
    world, other = World(level), World(replace(level, robots=level.robots[::-1]))
    for each in (world, other):
        drive(each, 40, Ann=1, Bob=0.7)
    assert world.robots == other.robots[::-1]


def test_all_goals_are_to_be_reached_at_once_where_the_level_says_so() -> None:
    homes = [Area(n, x, 50, 9, victory_robots=(n,)) for n, x in (("Ann", 30), ("Bob", 60))]
    level = replace(face_to_face(), areas=tuple(homes))
    first, both = World(level), World(replace(level, all_goals=True))
    for world in (first, both):
        drive(world, 15, Bob=1)
    assert (first.won_at, both.won_at) == (1, 2)
