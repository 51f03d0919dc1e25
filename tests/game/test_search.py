"""Seeking: the nearest known tick in which a question holds."""

import asyncio
from contextlib import suppress

import pytest

from logical_robots_tui.game import Breakpoint, Game, search_ticks
from logical_robots_tui.mind import ProgramError

CLOCK = "Sensor(sensor:), t == sensor.clock, "
HERE = f"{CLOCK}t in [10, 11, 12, 40, 41, 77]"


@pytest.fixture
async def game(game: Game) -> Game:
    while game.frame.tick < 100:
        await game.run_until(tick=100)
    return game


async def sought(game: Game, begin: int, way: int, query: str = HERE) -> int | None:
    game.go_to(begin)
    return (await search_ticks(game, query, 1 if way > 0 else -1)).tick


FORWARD = {0: 10, 9: 10, 10: 40, 11: 40, 12: 40, 41: 77, 77: None, 100: None}
BACKWARD = {100: 77, 77: 41, 41: 12, 40: 12, 39: 12, 13: 12, 11: None, 10: None, 0: None}


async def test_the_nearest_tick_beside_those_around_here_is_found(game: Game) -> None:
    assert {begin: await sought(game, begin, 1) for begin in FORWARD} == FORWARD
    assert {begin: await sought(game, begin, -1) for begin in BACKWARD} == BACKWARD


async def test_it_is_known_how_far_was_looked_and_whether_it_holds_here(game: Game) -> None:
    game.go_to(77)
    told: list[int] = []
    found = await search_ticks(game, HERE, 1, told.append)
    assert (found.tick, found.last, found.holds_here) == (None, 100, True)
    assert told == sorted(told)
    assert told[-1] == 100


async def test_expressions_count_where_they_are_true(game: Game) -> None:
    assert await sought(game, 0, 1, "Max{m :- Memory(memory: m)} == 33") == 34
    assert await sought(game, 50, -1, "1 == 2") is None


async def test_ticks_in_which_it_fails_are_passed_over_and_told(game: Game) -> None:
    game.go_to(0)
    query = f'{CLOCK}x in ["a"], (if t < 20 then x.field else t) == 33'
    found = await search_ticks(game, query, 1)
    assert found.tick == 33
    assert found.problem.startswith("Tick 0: This failed: ")


async def test_a_wrong_question_is_refused(game: Game) -> None:
    with pytest.raises(ProgramError, match="robot_nam"):
        await search_ticks(game, "Sensor(robot_nam:)", 1)


async def test_a_search_that_is_cancelled_ends_and_changes_nothing(game: Game) -> None:
    game.go_to(0)
    begun = asyncio.Event()
    search = asyncio.create_task(search_ticks(game, "1 == 2", 1, lambda _tick: begun.set()))
    await begun.wait()
    search.cancel()
    with suppress(asyncio.CancelledError):
        await search
    assert search.cancelled()
    assert game.frame.tick == 0
    assert await sought(game, 0, 1) == 10


async def test_a_search_and_a_breakpoint_find_the_same_tick(game: Game) -> None:
    where = await sought(game, 0, 1, f"{CLOCK}t > 22")
    game.go_to(0)
    game.breakpoints.add(Breakpoint("rows", f"{CLOCK}t > 22"))
    await game.run_until(tick=100)
    assert game.frame.tick == where == 23
