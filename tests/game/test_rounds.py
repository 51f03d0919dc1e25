"""Robots that go round in circles are noticed.

`tests/levels/test_proof.py` follows all reference programs on their way to victory: none does.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from logical_robots_tui.game.history.marks import ROUNDS, Rounds
from logical_robots_tui.world import World, load_level

LEVEL = load_level("01-first-steps")


def told(pose: Callable[[int], tuple[float, float, float]], ticks: int) -> list[int]:
    """The ticks in which a robot with these poses is found to go round in circles."""
    (robot,) = World(LEVEL).save().robots
    rounds, found = Rounds(), []
    for tick in range(ticks):
        x, y, angle = pose(tick)
        if rounds.follow([replace(robot, x=x, y=y, angle=angle)]):
            found.append(tick)
    return found


def turning(tick: int) -> tuple[float, float, float]:
    return 100.0, 100.0, tick * math.tau / 50


def circle(tick: int) -> tuple[float, float, float]:
    angle = tick * math.tau / 700
    return 200 + 100 * math.cos(angle), 200 + 100 * math.sin(angle), angle + math.pi / 2


def spiral(tick: int) -> tuple[float, float, float]:
    angle, radius = tick * math.tau / 300, 50 + tick / 20
    return 300 + radius * math.cos(angle), 300 + radius * math.sin(angle), angle


def to_and_fro(tick: int) -> tuple[float, float, float]:
    there = tick % 400
    return (100.0 + there, 50.0, 0.0) if there < 200 else (500.0 - there, 50.0, math.pi)


def test_the_same_way_several_times_in_a_row_is_told_once() -> None:
    for pose, period in ((turning, 50), (circle, 700), (to_and_fro, 400)):
        (tick,) = told(pose, 8 * period)
        assert ROUNDS * period - period // 8 <= tick <= (ROUNDS + 1) * period


def test_who_goes_elsewhere_or_nowhere_does_not_go_in_circles() -> None:
    assert told(lambda _tick: (50.0, 50.0, 0.0), 4000) == []  # parked
    assert told(lambda tick: (tick / 2, 50.0, 0.0), 4000) == []
    assert told(spiral, 4000) == []
    assert told(lambda tick: (math.nan, 0.0, tick / 10), 4000) == []


def test_who_leaves_the_circle_and_comes_back_is_told_again() -> None:
    def pose(tick: int) -> tuple[float, float, float]:
        return turning(tick) if tick < 300 or tick > 400 else (100.0 + tick, 100.0, 0.0)

    assert len(told(pose, 800)) == 2
