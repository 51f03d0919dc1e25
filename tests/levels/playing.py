"""Levels and programs for the tests of this folder."""

from __future__ import annotations

from functools import cache

from logical_robots_tui import Level, Program, list_levels, load_level
from logical_robots_tui.game.robustness import play_through
from logical_robots_tui.shipped import shipped_folder

LEVELS = list_levels()


def program_text(name: str) -> str:
    return (shipped_folder("programs") / f"{name}.l").read_text("utf-8")


@cache
def shipped_program(name: str) -> Program:
    return Program.compile(program_text(name))


def solution_of(name: str) -> str:
    """The name of the program that wins a level."""
    solution = load_level(name).solution
    assert solution, f"{name} has no solution"
    return solution


def ticks_to_win(level: Level, program: Program | str, ticks: int) -> int | None:
    """The tick of victory, or None if it isn't reached in so many ticks."""
    if isinstance(program, str):
        program = Program.compile(program)
    return play_through(level, program, ticks).won_at
