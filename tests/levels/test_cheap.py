"""Cheap programs, written to win without a level's idea, don't win.

``cheap`` has a folder of them for each level, and ``any`` with those that serve every level. The
first line of a program says what it avoids. The starter, the program that results from the first
line of the briefing, and references that do without memory are tried as well; ``test_ideas`` tries
the programs of other levels.

A full run tries the first varied starts of levels with few thoughts, a quick run of those with
fewer; ``make proof`` tries all 20 everywhere.
"""

import re
from functools import cache
from itertools import islice
from pathlib import Path

import pytest

from logical_robots_tui import Program
from logical_robots_tui.game.measuring import patience_for, vary_start
from tests.levels.moments import STEPS
from tests.levels.playing import (
    LEVELS,
    load_level,
    measured,
    program_text,
    references_of,
    slow,
    ticks_to_win,
    wins_from_starts,
)

CHEAP = Path(__file__).with_name("cheap")
FEWEST = 8
MOST_WINS = 1
THOUGHTS_IN_A_QUICK_RUN = 3_500
THOUGHTS_WHILE_ONE_WAITS = 4_000

HAVE_THE_IDEA = {
    # To react to what is ahead, to aggregate the radar, to keep a hand on the wall.
    "01-first-steps": {"bounce", "right-hand", "left-hand", "room", "far", "alphabet", "nearest"},
    "02-open-space": {"right-hand", "left-hand", "room", "far", "alphabet", "nearest"},
    "03-the-long-hall": {"right-hand", "left-hand"},
}
"""Programs for any level that are no cheap way to win one."""


@cache
def cheap_programs(name: str) -> dict[str, str]:
    level = load_level(name)
    found = {path.stem: path.read_text("utf-8") for path in sorted((CHEAP / name).iterdir())}
    for path in sorted((CHEAP / "any").iterdir()):
        if path.stem not in HAVE_THE_IDEA.get(name, ()):
            found[f"any/{path.stem}"] = path.read_text("utf-8")
    found["starter"] = program_text(level.starter)
    briefing = STEPS / f"{name}-briefing.l"
    if briefing.exists():
        found["briefing"] = briefing.read_text("utf-8")
    if "Memory(" in program_text(level.solution):
        for reference in references_of(name):
            if "Memory(" not in (text := program_text(reference)):
                found[reference] = text
    return found


def patience(name: str) -> int:
    return patience_for(measured(name).ticks)


def marks(name: str) -> list[pytest.MarkDecorator]:
    thoughts = len(load_level(name).robots) * patience(name)
    return slow(thoughts > THOUGHTS_IN_A_QUICK_RUN, thoughts > THOUGHTS_WHILE_ONE_WAITS)


each_cheap = pytest.mark.parametrize(
    ("name", "program"),
    [
        pytest.param(name, program, marks=marks(name))
        for name in LEVELS
        for program in cheap_programs(name)
    ],
)


@pytest.mark.sampled
@each_cheap
def test_a_cheap_program_does_not_win_from_the_first_starts(name: str, program: str) -> None:
    level, compiled = load_level(name), Program.compile(cheap_programs(name)[program])
    assert not all(
        ticks_to_win(vary_start(level, seed), compiled, patience(name))
        for seed in range(MOST_WINS + 1)
    )


@pytest.mark.proof
@each_cheap
def test_a_cheap_program_wins_from_one_start_at_most(name: str, program: str) -> None:
    compiled = Program.compile(cheap_programs(name)[program])
    won = wins_from_starts(load_level(name), compiled, patience(name))
    assert len(list(islice(won, MOST_WINS + 1))) <= MOST_WINS


def test_a_level_has_many_cheap_programs() -> None:
    assert {name for name in LEVELS if len(cheap_programs(name)) < FEWEST} == set()


def test_a_cheap_program_begins_by_saying_what_it_avoids() -> None:
    paths = list(CHEAP.rglob("*.l"))
    assert {path.parent.name for path in paths} == {"any", *LEVELS}
    for path in paths:
        assert re.match(r"# Avoids .+: .+\.\n\n", path.read_text("utf-8")), path
