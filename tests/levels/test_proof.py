"""Our levels are good: their solutions win from wherever one starts, and nothing else does.

Everything is read from the files, so a level that is added is proved too. Among the ordinary tests
are the given start and up to three varied ones, and losers are watched for a while; ``make prove``
tries 20 starts and watches losers to the end.
"""

from itertools import combinations

import pytest

from logical_robots_tui.game.measuring import MOST_TICKS, STARTS, patience_for, vary_start
from logical_robots_tui.game.victory import measures_of, reference_table
from logical_robots_tui.world.level import SecondGoal
from tests.levels.playing import (
    LEVELS,
    LONG,
    is_small,
    load_level,
    measured,
    reference_cases,
    references_of,
    shipped_program,
    slow,
    solution_of,
    ticks_to_win,
    wins_from_starts,
)
from tests.levels.verdicts import verdict

PAIRS = [(level, lower) for lower, level in combinations(LEVELS, 2)]

# One thought of one robot is the unit of effort here.
THOUGHTS_FOR_VARIED_STARTS = 6_000
THOUGHTS_FOR_A_STARTER = 1_500
THOUGHTS_TO_THE_END = 600_000  # of a swarm; the others end at the most ticks that a level may take
THOUGHTS_OF_A_SOLUTION = 60_000  # as many as one waits for

RECORDS = {"fastest": "ticks", "shortest": "size", "careful": "distance"}
SIGHT = ("own", "seen", "all")

each_reference = pytest.mark.parametrize(("name", "program"), reference_cases())
each_level = pytest.mark.parametrize("name", LEVELS)
each_pair = pytest.mark.parametrize(("name", "lower"), PAIRS)


def ticks_for(name: str, thoughts: int) -> int:
    return min(thoughts // len(load_level(name).robots), MOST_TICKS)


@pytest.mark.sampled
@each_reference
def test_a_reference_asks_for_no_more_than_robots_may_see(name: str, program: str) -> None:
    allowed = load_level(name).visibility
    compiled = shipped_program(program)
    assert SIGHT.index(compiled.memory or "own") <= SIGHT.index(allowed.memory)
    assert SIGHT.index(compiled.sensor or "own") <= SIGHT.index(allowed.sensor)
    assert compiled.warnings == ()


@pytest.mark.sampled
@each_reference
def test_a_reference_does_as_well_as_was_measured_and_never_goes_in_circles(
    name: str, program: str
) -> None:
    level, compiled = load_level(name), shipped_program(program)
    expected = reference_table()[name][program]
    played = verdict(level, compiled, MOST_TICKS)
    assert played.won_at is not None
    assert played.circling == ()
    found = measures_of(
        level, compiled, played.won_at, round(played.distance, 1), played.is_blocked
    )
    later = {goal.words for goal in level.second_goals if goal.is_tried_later}
    at_once = tuple(goal for goal in expected.goals if goal not in later)
    assert found == expected._replace(wins=None, starts=0, goals=at_once), "run `make measures`"


@each_level
def test_every_reference_is_measured_and_the_best_at_what_it_is_called(name: str) -> None:
    table, solution = reference_table()[name], solution_of(name)
    assert list(table) == references_of(name)
    assert len(table) >= 3
    assert {measures.starts for measures in table.values()} == {STARTS} == {20}
    assert (measured(name).wins or 0) >= 19
    assert measured(name).ticks * len(load_level(name).robots) < THOUGHTS_OF_A_SOLUTION
    for word, field in RECORDS.items():
        best = min(getattr(measures, field) for measures in table.values())
        holder = table.get(f"{solution}-{word}")  # where there is none, another one is best
        assert holder is None or getattr(holder, field) == best, word


@each_level
def test_each_second_goal_is_reached_by_a_reference_and_not_by_the_solution(name: str) -> None:
    """But for that of all starts, which every reference reaches."""
    starts = {SecondGoal("starts").words}
    goals = {goal.words for goal in load_level(name).second_goals}
    assert len(goals) == 2
    reached = [set(measures.goals) for measures in reference_table()[name].values()]
    assert set().union(*reached) == goals
    assert set.intersection(*reached) <= starts
    assert set(measured(name).goals) <= starts  # whoever copies it has a challenge


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "seed"),
    [
        pytest.param(name, seed, marks=slow(thoughts > LONG))
        for name in LEVELS
        for seed in range(3)
        for thoughts in [measured(name).ticks * len(load_level(name).robots)]
        if (seed + 1) * thoughts < THOUGHTS_FOR_VARIED_STARTS  # `make prove` tries all
    ],
)
def test_the_solution_wins_from_a_varied_start(name: str, seed: int) -> None:
    program, patience = shipped_program(solution_of(name)), patience_for(measured(name).ticks)
    assert ticks_to_win(vary_start(load_level(name), seed), program, patience)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=slow(not is_small(load_level(n).starter))) for n in LEVELS]
)
def test_the_starter_does_not_win_soon(name: str) -> None:
    level = load_level(name)
    ticks = ticks_for(name, THOUGHTS_FOR_A_STARTER)
    assert ticks_to_win(level, shipped_program(level.starter), ticks) is None


@pytest.mark.proof
@each_reference
def test_a_reference_wins_from_as_many_varied_starts_as_was_measured(
    name: str, program: str
) -> None:
    expected, compiled = reference_table()[name][program], shipped_program(program)
    wins = wins_from_starts(load_level(name), compiled, patience_for(expected.ticks))
    assert len(list(wins)) == expected.wins


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
