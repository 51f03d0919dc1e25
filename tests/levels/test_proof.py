"""Our levels are good: their solutions win from wherever one starts, and nothing else does.

Everything is read from the files, so a level that is added is proved too. Among the ordinary tests
are the given start and up to three shifted ones, and losers are watched for a while; ``make prove``
tries 20 starts and watches losers to the end.
"""

from __future__ import annotations

import time
from itertools import combinations

import pytest

from logical_robots_tui import load_level
from logical_robots_tui.game.measuring import MOST_TICKS, patience_for
from logical_robots_tui.game.robustness import STARTS, play_through, shifted, try_starts
from logical_robots_tui.game.victory import count_rules, reference_table
from tests.levels.playing import (
    LEVELS,
    program_text,
    shipped_program,
    solution_of,
    ticks_to_win,
)

PAIRS = [(level, lower) for lower, level in combinations(LEVELS, 2)]

# One thought of one robot is the unit of effort here.
THOUGHTS_FOR_SHIFTED_STARTS = 6_000
THOUGHTS_FOR_A_STARTER = 1_500
THOUGHTS_FOR_A_LOWER_SOLUTION = 450
THOUGHTS_TO_THE_END = 600_000  # of a swarm; the others end at the most ticks that a level may take
LONGEST_RUN = 120.0  # seconds

SIGHT = ("own", "seen", "all")

each_level = pytest.mark.parametrize("name", LEVELS)
each_pair = pytest.mark.parametrize(("name", "lower"), PAIRS)


def ticks_for(name: str, thoughts: int) -> int:
    return min(thoughts // len(load_level(name).robots), MOST_TICKS)


@each_level
def test_the_solution_asks_for_no_more_than_robots_may_see(name: str) -> None:
    allowed = load_level(name).visibility
    program = shipped_program(solution_of(name))
    assert SIGHT.index(program.memory or "own") <= SIGHT.index(allowed.memory)
    assert SIGHT.index(program.sensor or "own") <= SIGHT.index(allowed.sensor)


@pytest.mark.sampled
@each_level
def test_the_solution_does_as_well_as_was_measured(name: str) -> None:
    measured = reference_table()[name]
    assert measured.ticks <= MOST_TICKS
    solution = solution_of(name)
    played = play_through(load_level(name), shipped_program(solution), MOST_TICKS)
    rules = count_rules(program_text(solution))
    found = (played.won_at, rules, round(played.distance, 1))
    assert found == (measured.ticks, measured.rules, measured.distance), "run `make measures`"


@each_level
def test_the_solution_was_measured_to_win_from_19_of_20_shifted_starts(name: str) -> None:
    measured = reference_table()[name]
    assert measured.starts == STARTS == 20
    assert measured.wins is not None
    assert measured.wins >= 19


@pytest.mark.sampled
@each_level
@pytest.mark.parametrize("seed", range(3))
def test_the_solution_wins_from_a_shifted_start(name: str, seed: int) -> None:
    level = load_level(name)
    ticks = reference_table()[name].ticks
    if (seed + 1) * ticks * len(level.robots) > THOUGHTS_FOR_SHIFTED_STARTS:
        pytest.skip("takes long; `make prove` tries it")
    program = shipped_program(solution_of(name))
    assert ticks_to_win(shifted(level, seed), program, patience_for(ticks))


@pytest.mark.sampled
@each_level
def test_the_starter_does_not_win_soon(name: str) -> None:
    level = load_level(name)
    ticks = ticks_for(name, THOUGHTS_FOR_A_STARTER)
    assert ticks_to_win(level, shipped_program(level.starter), ticks) is None


@pytest.mark.sampled
@each_pair
def test_the_solution_of_a_lower_level_does_not_win_soon(name: str, lower: str) -> None:
    ticks = ticks_for(name, THOUGHTS_FOR_A_LOWER_SOLUTION)
    assert ticks_to_win(load_level(name), shipped_program(solution_of(lower)), ticks) is None


@pytest.mark.proof
@each_level
def test_the_solution_wins_from_as_many_shifted_starts_as_was_measured(name: str) -> None:
    measured = reference_table()[name]
    program = shipped_program(solution_of(name))
    assert try_starts(load_level(name), program, patience_for(measured.ticks)) == measured.wins


@pytest.mark.proof
@each_level
def test_the_solution_wins_while_one_waits(name: str) -> None:
    began = time.monotonic()
    assert ticks_to_win(load_level(name), shipped_program(solution_of(name)), MOST_TICKS)
    assert time.monotonic() - began < LONGEST_RUN


@pytest.mark.proof
@each_level
def test_the_starter_never_wins(name: str) -> None:
    level = load_level(name)
    ticks = ticks_for(name, THOUGHTS_TO_THE_END)
    assert ticks_to_win(level, shipped_program(level.starter), ticks) is None


@pytest.mark.proof
@each_pair
def test_the_solution_of_a_lower_level_never_wins(name: str, lower: str) -> None:
    level, program = load_level(name), shipped_program(solution_of(lower))
    assert ticks_to_win(level, program, ticks_for(name, THOUGHTS_TO_THE_END)) is None
