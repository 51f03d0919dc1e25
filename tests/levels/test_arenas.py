"""Our arenas are fair, and each is won by an idea and not by luck."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from logical_robots_tui import Program, list_arenas
from logical_robots_tui.editing.checks import check
from logical_robots_tui.game.measuring import start_of
from logical_robots_tui.paths import ARENAS, shipped_names
from logical_robots_tui.world import Level
from tests.levels.playing import LEVELS, code_in, load_level, program_text, slow, squeezed
from tests.levels.test_levels import assert_room_for_robots, check_texts
from tests.levels.verdicts import verdict

NAMES = list_arenas()
QUICK = NAMES[0]
"""The arena whose programs are soon compiled."""

SEATS = [(name, seat) for name in NAMES for seat in range(len(load_level(name).teams))]
STARTS = range(1, 11)
MOST_STARTS = 1
"""The last varied start that a full run tries; `make proof` tries all."""


def matches(*cases: tuple[Any, ...]) -> pytest.MarkDecorator:
    """Cases of which a quick run takes a tenth of those in one arena."""
    names = ("name", "seat", "start")[: len(cases[0])]
    params = []
    for name, *others in cases:
        is_slow, is_proof = name != QUICK, max(others[1:], default=0) > MOST_STARTS
        params.append(pytest.param(name, *others, marks=slow(is_slow, is_slow and is_proof)))
    return pytest.mark.parametrize(names, params)


def scores(level: Level, programs: list[str]) -> tuple[float, ...]:
    names = [team.name for team in level.teams]
    program = Program.compile(dict(zip(names, map(program_text, programs), strict=True)))
    played = verdict(level, program, level.match_ticks or 0)
    assert played.notices == {}
    return played.points


def played(name: str, seat: int | None, start: int) -> tuple[float, ...]:
    """The scores with the solution on one seat, or on none, and sparring partners on the others."""
    level = start_of(load_level(name), start)
    programs = [team.program for team in level.teams]
    if seat is not None:
        programs[seat] = level.solution
    return scores(level, programs)


def turned(level: Level, x: float, y: float) -> tuple[float, float]:
    """Where a place comes to be when each team takes the seat of the next one."""
    middle = level.width / 2, level.height / 2
    dx, dy = x - middle[0], y - middle[1]
    if len(level.teams) == 4:
        dx, dy = -dy, dx
    else:
        dx, dy = -dx, -dy
    return round(middle[0] + dx, 6), round(middle[1] + dy, 6)


def test_arenas_are_numbered_after_the_course() -> None:
    numbers = [int(name.partition("-")[0]) for name in NAMES]
    assert numbers == [len(LEVELS) + 1 + place for place in range(len(NAMES))]
    assert len(NAMES) == 3


def test_an_arena_has_texts_that_fit_a_pane_and_programs_of_its_name() -> None:
    for level in map(load_level, NAMES):
        check_texts(level)
        assert level.solution == level.name.partition("-")[2]
        assert level.solution == level.title.lower().replace(" ", "-")
        assert {team.program for team in level.teams} == {level.starter}
        assert level.starter == f"{level.solution}-sparring"
        (block,) = code_in(level.lesson)
        assert squeezed(block) in squeezed(program_text(level.solution)), level.name
        assert max(map(len, block.split("\n"))) <= 76


def test_every_program_for_arenas_belongs_to_one() -> None:
    levels = map(load_level, NAMES)
    wanted = [name for level in levels for name in (level.starter, level.solution)]
    assert sorted(wanted) == shipped_names("programs", ".l", ARENAS)


def test_an_arena_is_without_mistakes_and_nobody_wins_it_for_all() -> None:
    for level in map(load_level, NAMES):
        assert check(level) == []
        assert level.match_ticks
        assert level.scores
        assert not any(area.victory_robots for area in level.areas)
        assert_room_for_robots(level)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("start", [0, 1])
def test_an_arena_looks_the_same_from_every_seat(name: str, start: int) -> None:
    level = start_of(load_level(name), start)
    teams = [team.name for team in level.teams]
    quarters = 4 // len(teams)
    assert np.array_equal(level.walls, np.rot90(level.walls, quarters))
    for kind in ("beacons", "areas"):
        things = getattr(level, kind)
        places = sorted((round(one.x, 6), round(one.y, 6)) for one in things)
        assert places == sorted(turned(level, one.x, one.y) for one in things)
        if len(teams) == 2:  # a program that knows a name finds it from either side
            spots = {replace(one, x=round(one.x, 6), y=round(one.y, 6)) for one in things}
            opposite = [turned(level, one.x, one.y) for one in things]
            pairs = zip(things, opposite, strict=True)
            assert spots == {replace(one, x=x, y=y) for one, (x, y) in pairs}
    seats = [[robot for robot in level.robots if robot.team == team] for team in teams]
    for mine, theirs in zip(seats, [*seats[1:], seats[0]], strict=True):
        for one, other in zip(mine, theirs, strict=True):
            assert turned(level, one.x, one.y) == pytest.approx((other.x, other.y))
            turn = math.remainder(other.angle - one.angle - math.pi / 2 * quarters, math.tau)
            assert turn == pytest.approx(0, abs=1e-9)
            own = replace(one, name="", team="", color="", x=0, y=0, angle=0)
            assert own == replace(other, name="", team="", color="", x=0, y=0, angle=0)
    assert sorted(robot.name for robot in seats[0]) == [robot.name for robot in seats[0]]


@pytest.mark.sampled
@matches(*((name, None, start) for name in NAMES for start in (0, 1)))
def test_equal_programs_have_equal_scores(name: str, seat: None, start: int) -> None:
    assert len(set(played(name, seat, start))) == 1


@pytest.mark.sampled
@matches(*((name,) for name in NAMES))
def test_the_solution_has_an_equal_match_against_itself(name: str) -> None:
    level = load_level(name)
    assert len(set(scores(level, [level.solution] * len(level.teams)))) == 1


@pytest.mark.sampled
@matches(*((name, seat, start) for name, seat in SEATS if seat for start in (0, 2)))
def test_who_takes_another_seat_takes_the_scores_along(name: str, seat: int, start: int) -> None:
    first = played(name, 0, start)
    assert played(name, seat, start) == (*first[len(first) - seat :], *first[: len(first) - seat])


@pytest.mark.sampled
@matches(*((name, seat, start) for start in STARTS for name, seat in SEATS))
def test_the_solution_beats_all_sparring_partners(name: str, seat: int, start: int) -> None:
    found = played(name, seat, start)
    assert found[seat] > 1.2 * max([*found[:seat], *found[seat + 1 :]])
