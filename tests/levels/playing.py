"""Levels and programs for the tests of this folder."""

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

import logical_robots_tui
from logical_robots_tui import Level, Program, list_levels
from logical_robots_tui.game.measuring import STARTS, vary_start
from logical_robots_tui.game.source import load_program, reference_names
from logical_robots_tui.game.victory import reference_table
from logical_robots_tui.progress import Measures
from tests.levels.verdicts import verdict

load_level = cache(logical_robots_tui.load_level)
LEVELS = list_levels()
LONG = 2_000  # thoughts, that is robots times ticks; only a full run waits for more
LONGEST = 4_000  # and only a long proof for more than these
LONGEST_OF_A_SOLUTION = 12_000

SMALL = 1_050  # characters of a program that is soon compiled


def slow(is_slow: bool, is_proof: bool = False) -> list[pytest.MarkDecorator]:
    """The marks of a case that only a full run waits for, or only a long proof."""
    return [pytest.mark.slow] * is_slow + [pytest.mark.proof] * is_proof


@cache
def program_text(name: str) -> str:
    return load_program(name).text


def is_small(name: str) -> bool:
    """Whether a program is soon compiled."""
    return len(program_text(name)) < SMALL


@cache
def shipped_program(name: str) -> Program:
    return Program.compile(program_text(name))


def solution_of(name: str) -> str:
    solution = load_level(name).solution
    assert solution, f"{name} has no solution"
    return solution


def measured(name: str) -> Measures:
    return reference_table()[name][solution_of(name)]


@cache
def references_of(name: str) -> list[str]:
    return reference_names(solution_of(name))


def reference_cases() -> list[Any]:
    return [
        pytest.param(level, program, marks=slow(thoughts > LONG, thoughts > most))
        for level, programs in reference_table().items()
        for program, measures in programs.items()
        for thoughts in [len(load_level(level).robots) * measures.ticks]
        for most in [LONGEST_OF_A_SOLUTION if program == solution_of(level) else LONGEST]
    ]


def ticks_to_win(level: Level, program: Program | str, ticks: int) -> int | None:
    if isinstance(program, str):
        program = Program.compile(program)
    won_at = verdict(level, program, ticks).won_at
    return None if won_at is None or won_at > ticks else won_at


def wins_from_starts(level: Level, program: Program, ticks: int) -> Iterator[int]:
    """The varied starts from which a program wins within so many ticks, in order."""
    for seed in range(STARTS):
        if ticks_to_win(vary_start(level, seed), program, ticks):
            yield seed


def code_in(lesson: str) -> list[str]:
    return re.findall(r"^```\n(.*?)^```$", lesson, re.DOTALL | re.MULTILINE)


def squeezed(text: str) -> str:
    return "".join(text.split())
