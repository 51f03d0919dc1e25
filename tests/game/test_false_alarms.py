"""Diagnosis of shipped programs: nothing is held against them, up to their victory."""

import pytest

from logical_robots_tui.game import load_program
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose_run
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import list_levels, load_level
from tests.game.test_run import opened

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
    """The diagnosis of a program, of which nothing warns."""
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


@pytest.mark.parametrize(
    ("level", "program"),
    [
        SOLUTIONS[0],
        *(pytest.param(*case, marks=pytest.mark.slow) for case in SOLUTIONS if case[0] == CURVES),
    ],
)
async def test_of_a_solution_nothing_is_held_against_it(level: str, program: str) -> None:
    await check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), [*SOLUTIONS, *REFERENCES])
async def test_of_no_reference_program_anything_is_held_against_it(
    level: str, program: str
) -> None:
    await check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), [*SOLUTIONS, *ARENAS])
async def test_before_its_victory_or_in_a_match_nothing_is_held_against_a_program(
    level: str, program: str
) -> None:
    await check(level, program, DEFAULT)
