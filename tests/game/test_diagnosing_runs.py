"""Diagnosis of whole runs: found as in a game, kept, nothing against shipped programs; circles."""

import asyncio
import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from logical_robots_tui.explain.why.explanation import Subject
from logical_robots_tui.game import diagnosing, load_program, origin_in_run
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose_run, extent
from logical_robots_tui.game.history import recording
from logical_robots_tui.game.history.marks import ROUNDS, Rounds
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import Level, World, list_levels, load_level
from tests.game.test_diagnosing import diagnosed
from tests.game.test_run import opened

TICKS = 120
TEXT = """
Late(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 100;
Never(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock < 0;
Robot(robot_name:, desire: {left_engine: x, right_engine: -x}, memory: {n:}) :-
  Sensor(robot_name:), Memory(robot_name:, memory:), ~Never(robot_name:),
  n = Coalesce(memory.n, 0) + 1, x = (if n > 1000 then 0.3 else 0.2);
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 1) :-
  Late(robot_name:), Never(robot_name:);
"""


async def of_run(level: Level, ticks: int = TICKS) -> tuple[Diagnosis, list[Diagnosis]]:
    shown: list[Diagnosis] = []
    async with opened(level, TEXT) as run:
        return await diagnose_run(run, ticks, show=shown.append), shown


@pytest.mark.usefixtures("folder")
async def test_a_run_is_diagnosed_as_that_of_a_game_and_findings_are_kept(level: Level) -> None:
    there = await diagnosed(level, TEXT, TICKS)
    assert len(there.findings) > 2
    more, shown = await of_run(level, TICKS + 1)  # computed
    assert more.examined is None
    assert shown
    for early in shown:  # what is sure is shown first and stays
        assert early.examined is not None
        assert early.findings[: early.sure] == more.findings[: early.sure]
    found, shown = await of_run(level)  # stored
    assert shown
    assert found.findings == there.findings
    assert extent(found) == extent(there) == f"Ticks 1 to {TICKS}, not won."
    assert await of_run(level) == (found, [])


@pytest.mark.usefixtures("folder")
async def test_it_ends_where_the_run_is_won_even_if_more_ticks_are_stored(level: Level) -> None:
    async with opened(level) as run:
        frame = await run.frame(200)
        found = await diagnose_run(run, 300)
    assert frame.after.won_at is not None
    assert found.last == found.won_at == frame.after.won_at


@pytest.mark.usefixtures("folder")
async def test_of_a_run_that_is_too_long_for_memory_the_end_is_diagnosed(
    level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "MAX_BYTES", 1_000)
    monkeypatch.setattr(recording, "MAX_HELD_BYTES", 3_000)
    async with opened(level, TEXT) as run:
        diagnosis = await diagnose_run(run, 2 * TICKS)
        origin = await origin_in_run(run, "Ada", Subject(path=("n",)), 2 * TICKS)
    assert 1 < diagnosis.first < diagnosis.last == 2 * TICKS
    assert diagnosis.findings
    assert (origin.links[0].value, origin.complete) == (2 * TICKS, False)


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("error", [OSError, pytest.param(RuntimeError, marks=pytest.mark.slow)])
async def test_without_the_second_process_it_takes_longer(
    level: Level, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
) -> None:
    expected = await diagnosed(level, TEXT, TICKS)

    def refuse(*_: object) -> None:
        raise error

    monkeypatch.setattr(diagnosing, "TaskHelper", refuse)
    assert (await of_run(level))[0].findings == expected.findings


@pytest.mark.usefixtures("folder")
async def test_what_was_found_before_it_ends_is_kept(
    level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(diagnosing, "_SECONDS", 0.0)
    shown: list[Diagnosis] = []
    some = asyncio.Event()

    def show(found: Diagnosis) -> None:
        shown.append(found)
        some.set()

    async with opened(level, TEXT) as run:
        task = asyncio.create_task(diagnose_run(run, TICKS, show=show))
        await some.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
    assert "of these ticks were examined." in extent(shown[-1])


ENOUGH = 6000  # ticks in which every solution wins
DEFAULT = 3000  # ticks in which not all of them do
CURVES = "05-lighthouse"
PROGRAMS = shipped_folder("programs")
SOLUTIONS = [(level, str(load_level(level).solution)) for level in list_levels()]
REFERENCES = [
    (level, f"references/{path.stem}")
    for level, solution in SOLUTIONS
    for path in sorted((PROGRAMS / "references").glob(f"{solution}-*.l"))
]
ARENAS = [
    (path.stem, f"arenas/{path.stem[3:]}{kind}")
    for path in sorted((shipped_folder("levels") / "arenas").glob("*.toml"))
    for kind in ("", "-sparring")
]


async def check(level: str, program: str, ticks: int) -> Diagnosis:
    async with opened(load_level(level), load_program(PROGRAMS / f"{program}.l").text) as run:
        found = await diagnose_run(run, ticks)
    assert [each.message for each in found.findings if each.severity == "warning"] == []
    assert found.second_step == 1
    return found


async def check_victory(level: str, program: str) -> None:
    """What is noted of a program that wins is that something never happened; and that is true."""
    found = await check(level, program, ENOUGH)
    assert found.won_at is not None
    assert {each.kind for each in found.findings} <= {"never true", "never false", "never null"}


CURVED = [pytest.param(*it, marks=pytest.mark.slow) for it in SOLUTIONS if it[0] == CURVES]


@pytest.mark.parametrize(("level", "program"), [SOLUTIONS[0], *CURVED])
async def test_of_a_solution_nothing_is_held_against_it(level: str, program: str) -> None:
    await check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), [*SOLUTIONS, *REFERENCES])
async def test_nothing_is_held_against_a_reference_program(level: str, program: str) -> None:
    await check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), [*SOLUTIONS, *ARENAS])
async def test_nothing_is_held_against_one_before_victory_or_in_a_match(
    level: str, program: str
) -> None:
    await check(level, program, DEFAULT)


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
