"""Diagnosis of shipped programs: nothing is held against them, up to their victory."""

from __future__ import annotations

import asyncio

import pytest

from logical_robots_tui.game import Run
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose_run
from logical_robots_tui.mind import Program
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import list_levels, load_level

ENOUGH = 6000
"""Ticks in which every solution wins."""

DEFAULT = 3000
"""Ticks in which not all of them do."""

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


def diagnosed(level: str, program: str, ticks: int) -> Diagnosis:
    text = (PROGRAMS / f"{program}.l").read_text("utf-8")

    async def work() -> Diagnosis:
        run = Run(load_level(level), Program.compile(text))
        try:
            return await diagnose_run(run, ticks)
        finally:
            await run.close()

    return asyncio.run(work())


def check(found: Diagnosis) -> None:
    assert [each.message for each in found.findings if each.severity == "warning"] == []
    assert found.second_step == 1


def check_victory(level: str, program: str) -> None:
    """What is noted of a program that wins is that something never happened; and that is true."""
    found = diagnosed(level, program, ENOUGH)
    assert found.won_at is not None
    check(found)
    assert {each.kind for each in found.findings} <= {"never true", "never false", "never null"}


@pytest.mark.parametrize(
    ("level", "program"),
    [
        SOLUTIONS[0],
        *(pytest.param(*case, marks=pytest.mark.slow) for case in SOLUTIONS if case[0] == CURVES),
    ],
)
def test_of_a_solution_nothing_is_held_against_it(level: str, program: str) -> None:
    check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), [*SOLUTIONS, *REFERENCES])
def test_of_no_reference_program_anything_is_held_against_it(level: str, program: str) -> None:
    check_victory(level, program)


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), SOLUTIONS)
def test_before_its_victory_nothing_is_held_against_a_solution(level: str, program: str) -> None:
    check(diagnosed(level, program, DEFAULT))


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), ARENAS)
def test_in_a_match_nothing_is_held_against_a_program(level: str, program: str) -> None:
    check(diagnosed(level, program, DEFAULT))
