"""The ticks in which a question holds: sought, asked once, kept, and never trusted unseen."""

import asyncio
from contextlib import suppress
from pathlib import Path

import pytest

from logical_robots_tui.game import Breakpoint, Game, Matches, find_matches, search_ticks
from logical_robots_tui.mind import Limits, Mind, Program, ProgramError
from logical_robots_tui.world import Level
from tests.game.playing import COUNTER
from tests.game.test_run import ENDLESS_AT_41, opened

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

    game.go_to(77)
    ticks: list[int] = []
    search = await search_ticks(game, HERE, 1, ticks.append)
    assert (search.tick, search.last, search.holds_here) == (None, 100, True)
    assert ticks == sorted(ticks)
    assert ticks[-1] == 100


async def test_expressions_count_where_they_are_true_and_failures_are_told(game: Game) -> None:
    assert await sought(game, 0, 1, "Max{m :- Memory(memory: m)} == 33") == 34
    assert await sought(game, 50, -1, "1 == 2") is None
    game.go_to(0)
    query = f'{CLOCK}x in ["a"], (if t < 20 then x.field else t) == 33'
    search = await search_ticks(game, query, 1)
    assert search.tick == 33
    assert search.problem.startswith("Tick 0: This failed: ")
    with pytest.raises(ProgramError, match="robot_nam"):
        await search_ticks(game, "Sensor(robot_nam:)", 1)


async def test_a_search_can_be_cancelled_and_finds_the_tick_of_a_breakpoint(game: Game) -> None:
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
    where = await sought(game, 0, 1, f"{CLOCK}t > 22")
    game.go_to(0)
    game.breakpoints.add(Breakpoint("rows", f"{CLOCK}t > 22"))
    await game.run_until(tick=100)
    assert game.frame.tick == where == 23


CLOCK = "Sensor(sensor:), t == sensor.clock, "
QUERY = f"{CLOCK}t in [3, 4, 9]"
FOUND = Matches(20, None, ((3, 4), (9, 9)))


async def found(
    level: Level, query: str = QUERY, ticks: int = 20, robot: str = "", text: str = COUNTER
) -> Matches:
    program = Program.compile(text)
    async with opened(level, text, Limits(think_seconds=0.3)) as run:
        return await find_matches(run, program.question(query), ticks, robot)


def kept(folder: Path) -> list[Path]:
    files = folder.parent.glob("*.program")
    return [file for file in files if b"FindMatches" in file.read_bytes()]


async def test_the_stretches_of_each_question_robot_and_number_of_ticks_are_asked_for_once(
    level: Level, monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    assert await found(level) == FOUND
    assert len(kept(folder)) == 1
    assert (FOUND.holds_in, FOUND.failed_in) == (3, 0)
    assert (await found(level, f"{CLOCK}t in [3, 4]")).stretches == ((3, 4),)
    assert (await found(level, ticks=8)).stretches == ((3, 4),)
    here = 'Memory(robot_name:, memory: 5), robot_name == "Bo"'
    for robot, stretches in (("", ((6, 6),)), ("Bo", ((6, 6),)), ("Ada", ())):
        assert (await found(level, here, robot=robot)).stretches == stretches
    monkeypatch.setattr(Mind, "ask", None)
    assert await found(level) == FOUND


async def test_what_failed_may_hold_another_time_and_is_lost(level: Level, folder: Path) -> None:
    matches = await found(level, f'{CLOCK}x in ["a"], (if t == 2 then x.field else 1) == 1', 5)
    assert matches.stretches == ((1, 1), (3, 5))
    assert matches.failed == ((2, 2),)
    assert "neither a record nor a list" in matches.reason
    assert not kept(folder)


@pytest.mark.slow
async def test_nothing_is_kept_of_a_run_with_a_thought_cut_off(level: Level, folder: Path) -> None:
    text = ENDLESS_AT_41.replace("41", "5")
    assert (await found(level, text=text)).stretches == FOUND.stretches
    assert not kept(folder)
