"""Our own levels can be won, from wherever one starts, and not without doing something."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from logical_robots_tui import Game, Program, list_levels, load_level
from logical_robots_tui.shipped import shipped_names
from tests.levels.playing import FARTHEST_SHIFT, program_text, shifted, ticks_to_win

CONFORMANCE = Path(__file__).parent.parent / "conformance" / "levels"
TICKS_FOR_LOSING = 5000
ROBOT_RADIUS = 9.0
OBSTACLE_AVOIDER = "obstacle-avoider"
LONGEST_LINE = 64


@dataclass(frozen=True)
class Solved:
    """A level and the tick in which its solution wins from the given start."""

    level: str
    program: str
    won_at: int

    @property
    def patience(self) -> int:
        """Ticks that a shifted start may take."""
        return 2 * self.won_at

    def __str__(self) -> str:
        return self.level


SOLVED = [
    Solved("01-first-steps", "first-steps", 1258),
    Solved("02-open-space", "open-space", 2063),
    Solved("03-everybody-home", "everybody-home", 1106),
    Solved("08-formation", "formation", 2334),
    Solved("09-gate", "gate", 2637),
    Solved("10-mapping", "mapping", 2237),
    Solved("11-power-line", "power-line", 3783),
    Solved("12-swarm", "swarm", 633),
]
each_level = pytest.mark.parametrize("solved", SOLVED, ids=str)

LOWER_SOLUTIONS = [
    # a level, and the solution of a lower one
    ("02-open-space", "first-steps"),
    ("03-everybody-home", "first-steps"),
    ("03-everybody-home", "open-space"),
]


def test_these_are_our_levels() -> None:
    assert list_levels() == [solved.level for solved in SOLVED]


@each_level
def test_a_level_has_texts_that_fit_a_pane_and_a_starter(solved: Solved) -> None:
    level = load_level(solved.level)
    lines = level.briefing.split("\n")
    assert 3 <= len(lines) <= 6
    assert max(map(len, lines)) <= LONGEST_LINE
    assert 2 <= len(level.hints) <= 3
    assert level.starter == f"{solved.program}-starter"


@each_level
def test_a_level_has_a_closed_rim(solved: Solved) -> None:
    walls = load_level(solved.level).walls
    assert all(rim.all() for rim in (walls[0], walls[-1], walls[:, 0], walls[:, -1]))


def around(place: float) -> tuple[int, int]:
    """Return the range that a robot takes up when it is shifted as far as can be."""
    reach = round(FARTHEST_SHIFT + ROBOT_RADIUS)
    return int(place) - reach, int(place) + reach + 1


@each_level
def test_nothing_stands_in_a_wall_wherever_it_is_shifted(solved: Solved) -> None:
    level = load_level(solved.level)
    for robot in level.robots:
        across, down = slice(*around(robot.x)), slice(*around(robot.y))
        assert not np.any(level.walls[down, across])
    for x, y in [(b.x, b.y) for b in level.beacons] + [(a.x, a.y) for a in level.areas]:
        assert not level.walls[int(y), int(x)]


@each_level
async def test_the_solution_wins_in_as_many_ticks_as_ever(solved: Solved) -> None:
    level = load_level(solved.level)
    won_at = await ticks_to_win(level, program_text(solved.program), solved.patience)
    assert won_at == solved.won_at


@each_level
async def test_the_starter_does_not_win(solved: Solved) -> None:
    level = load_level(solved.level)
    text = program_text(level.starter)
    assert await ticks_to_win(level, text, TICKS_FOR_LOSING) is None


@pytest.mark.proof
@pytest.mark.parametrize(("level", "program"), LOWER_SOLUTIONS)
async def test_the_solution_of_a_lower_level_does_not_win(level: str, program: str) -> None:
    text = program_text(program)
    assert await ticks_to_win(load_level(level), text, TICKS_FOR_LOSING) is None


@each_level
@pytest.mark.parametrize("seed", range(3))
async def test_the_solution_wins_from_a_shifted_start(solved: Solved, seed: int) -> None:
    level = shifted(load_level(solved.level), seed)
    assert await ticks_to_win(level, program_text(solved.program), solved.patience)


@pytest.mark.proof
@each_level
async def test_the_solution_wins_from_19_of_20_shifted_starts(solved: Solved) -> None:
    level, text = load_level(solved.level), program_text(solved.program)
    won = [await ticks_to_win(shifted(level, i), text, solved.patience) for i in range(20)]
    assert sum(tick is not None for tick in won) >= 19, won


def as_the_first_briefing_says(text: str) -> str:
    """Return the starter of the first level with the change that the briefing asks for."""
    briefing = load_level("01-first-steps").briefing.replace("\n", " ")
    asked = re.search(r'change "([^"]+)" to "([^"]+)"', briefing)
    assert asked, "the briefing of the first level asks for no change"
    before, after = asked.groups()
    assert re.sub(r"\d+", "", before) == re.sub(r"\d+", "", after), "one number is enough"
    assert text.count(before) == 1
    return text.replace(before, after)


async def test_the_first_level_is_won_by_changing_the_number_as_its_briefing_says() -> None:
    level = load_level("01-first-steps")
    text = as_the_first_briefing_says(program_text(level.starter))
    assert await ticks_to_win(level, text, TICKS_FOR_LOSING) == 1255


@pytest.mark.proof
async def test_the_changed_number_wins_from_19_of_20_shifted_starts() -> None:
    level = load_level("01-first-steps")
    text = as_the_first_briefing_says(program_text(level.starter))
    won = [await ticks_to_win(shifted(level, i), text, TICKS_FOR_LOSING) for i in range(20)]
    assert sum(tick is not None for tick in won) >= 19, won


async def test_the_second_level_is_won_when_rays_weigh_their_length() -> None:
    level = load_level("02-open-space")
    text = program_text(level.starter)
    assert text.count("1 ->") == 1
    assert await ticks_to_win(level, text.replace("1 ->", "ray.distance ->"), TICKS_FOR_LOSING)


@pytest.mark.proof
async def test_stopping_at_any_beacon_does_not_bring_everybody_home() -> None:
    text = program_text("everybody-home")
    label = ', ray.label == "Home"'
    assert text.count(label) == 1
    level = load_level("03-everybody-home")
    assert await ticks_to_win(level, text.replace(label, ""), TICKS_FOR_LOSING) is None


async def test_the_printed_program_finds_its_way_through_the_corridor() -> None:
    level = load_level("02-open-space")
    assert await ticks_to_win(level, program_text(OBSTACLE_AVOIDER), TICKS_FOR_LOSING) == 3270


@pytest.mark.parametrize(
    "level",
    [*(solved.level for solved in SOLVED), *map(str, sorted(CONFORMANCE.glob("*.json")))],
    ids=lambda level: Path(level).stem,
)
async def test_the_printed_program_thinks_without_failing(level: str) -> None:
    seen = await every_notice(level)
    assert "failed" not in seen


async def every_notice(level: str) -> set[str]:
    """Return the kinds of notices of 50 ticks under the printed program."""
    kinds: set[str] = set()
    game = Game(load_level(level), Program.compile(program_text(OBSTACLE_AVOIDER)))
    game.listen(lambda frame: kinds.update(n.kind for d in frame.decisions for n in d.notices))
    try:
        while game.frame.tick < 50:  # on, after a victory
            await game.step()
    finally:
        await game.close()
    return kinds


@pytest.mark.parametrize("name", shipped_names("programs", ".l"))
def test_a_program_begins_by_saying_what_it_shows(name: str) -> None:
    first = program_text(name).split("\n", 1)[0]
    assert re.fullmatch(r"# .+: .+\.", first)


def test_every_solution_has_a_starter_beside_it() -> None:
    names = shipped_names("programs", ".l")
    wanted = [name for s in SOLVED for name in (s.program, f"{s.program}-starter")]
    assert sorted([*wanted, OBSTACLE_AVOIDER]) == names
