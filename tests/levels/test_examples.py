"""The free examples run, and do what they say."""

import math
from itertools import combinations

import pytest

from tests.levels.moments import Moment, moments
from tests.levels.playing import load_level, program_text, shipped_program, ticks_to_win
from tests.levels.verdicts import verdict

EXAMPLES = {
    # a program, and the level where to try it
    "clock-in-memory": "01-first-steps",
    "herd": "05-lighthouse",
    "obstacle-avoider": "02-open-space",
    "steering": "03-the-long-hall",
    "wall-crawler": "03-the-long-hall",
}


def away_from_start(moment: Moment) -> list[float]:
    pairs = zip(moment.state.robots, moment.level.robots, strict=True)
    return [math.dist((robot.x, robot.y), (start.x, start.y)) for robot, start in pairs]


@pytest.mark.sampled
@pytest.mark.parametrize(("program", "level"), EXAMPLES.items())
def test_an_example_has_nothing_odd_and_moves_every_robot(program: str, level: str) -> None:
    assert shipped_program(program).warnings == ()
    assert verdict(load_level(level), shipped_program(program), 100).noticed(100) == set()
    *_, last = moments(level, program_text(program), 100)
    assert min(away_from_start(last)) > 5


def test_the_clock_brings_a_robot_round_a_square() -> None:
    program, ticks = program_text("clock-in-memory"), 4 * 91
    ways = [away_from_start(moment)[0] for moment in moments("01-first-steps", program, ticks + 1)]
    assert max(ways) > 40
    assert ways[ticks] < 5


@pytest.mark.slow
@pytest.mark.parametrize("program", ["steering", "wall-crawler"])
def test_a_hand_on_the_wall_leads_out_of_a_labyrinth(program: str) -> None:
    assert ticks_to_win(load_level(EXAMPLES[program]), shipped_program(program), 6000)


def ticks_near_each_other(program: str) -> int:
    return sum(
        math.dist((a.x, a.y), (b.x, b.y)) < 100
        for moment in moments(EXAMPLES["herd"], program_text(program), 1500)
        for a, b in combinations(moment.state.robots, 2)
    )


@pytest.mark.slow
def test_a_herd_keeps_together() -> None:
    assert ticks_near_each_other("herd") > 3 * ticks_near_each_other("open-space")
