"""Our own levels are as the game and the course need them, and their briefings are true."""

import re
from pathlib import Path

import numpy as np
import pytest

from logical_robots_tui import Level, Program, ProgramError
from logical_robots_tui.game.measuring import FARTHEST_SHIFT
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.paths import shipped_names
from tests.levels.playing import (
    LEVELS,
    code_in,
    is_small,
    load_level,
    program_text,
    references_of,
    shipped_program,
    slow,
    solution_of,
    squeezed,
    ticks_to_win,
    wins_from_starts,
)
from tests.levels.verdicts import verdict
from tests.short import AHEAD

CONFORMANCE = Path(__file__).parent.parent / "conformance" / "levels"
TICKS_FOR_LOSING = 5000
ROBOT_RADIUS = 9.0
FREE_PROGRAMS = ["clock-in-memory", "herd", "obstacle-avoider", "steering", "wall-crawler"]
GUIDED = "04"  # the levels before it print rules that win
LONGEST_LINE = 64
LONGEST_IDEA = 60

each_solution = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=slow(not is_small(solution_of(name)))) for name in LEVELS]
)


def test_the_levels_are_numbered_from_1_on() -> None:
    assert [int(name.partition("-")[0]) for name in LEVELS] == list(range(1, len(LEVELS) + 1))


def check_texts(level: Level) -> None:
    assert level.lesson
    lines = level.briefing.split("\n")
    assert 3 <= len(lines) <= 6
    assert max(map(len, lines)) <= LONGEST_LINE
    assert 2 <= len(level.hints) <= 3
    assert 0 < len(level.idea) <= LONGEST_IDEA
    assert level.further


def test_a_level_has_texts_that_fit_a_pane() -> None:
    for level in map(load_level, LEVELS):
        check_texts(level)
        assert level.story.count(".") in (2, 3), level.name
        code = code_in(level.lesson)
        assert code, level.name
        assert max(len(line) for block in code for line in block.split("\n")) <= 76, level.name


def test_a_level_and_its_programs_have_one_name() -> None:
    for name in LEVELS:
        level = load_level(name)
        assert level.solution == name.partition("-")[2]
        assert level.starter == f"{level.solution}-starter"
        assert level.title.lower().replace(" ", "-") == level.solution


@pytest.mark.sampled
@each_solution
def test_the_programs_of_a_level_have_nothing_that_looks_odd(name: str) -> None:
    level = load_level(name)
    for program in (level.starter, level.solution):
        assert shipped_program(program).warnings == ()


def compiles(text: str) -> bool:
    try:
        return bool(Program.compile(text).predicates)
    except ProgramError:
        return False


@pytest.mark.sampled
@each_solution
def test_the_code_in_a_lesson_goes_with_a_program_and_is_in_no_reference(name: str) -> None:
    level = load_level(name)
    for block in code_in(level.lesson):
        rest = ("", AHEAD, program_text(level.starter), program_text(level.solution))
        assert any(compiles(f"{text}\n{block}") for text in rest), block
        for reference in references_of(name) if name > GUIDED else ():
            text = squeezed(program_text(reference))
            parts = [squeezed(part) for part in re.split(r";\n", block)]
            assert not any(part in text for part in filter(None, parts)), (reference, block)


def around(place: float) -> tuple[int, int]:
    """Return the range that a robot takes up when it is shifted as far as can be."""
    reach = round(FARTHEST_SHIFT + ROBOT_RADIUS)
    return int(place) - reach, int(place) + reach + 1


def test_a_level_has_a_closed_rim_and_nothing_stands_in_a_wall_wherever_it_is_shifted() -> None:
    for level in map(load_level, LEVELS):
        walls = level.walls
        assert all(rim.all() for rim in (walls[0], walls[-1], walls[:, 0], walls[:, -1])), level
        assert_room_for_robots(level)
        for x, y in [(b.x, b.y) for b in level.beacons] + [(a.x, a.y) for a in level.areas]:
            assert not walls[int(y), int(x)], (level.name, x, y)


def assert_room_for_robots(level: Level) -> None:
    for robot in level.robots:
        across, down = slice(*around(robot.x)), slice(*around(robot.y))
        assert not np.any(level.walls[down, across]), (level.name, robot.name)


def as_the_first_briefing_says(text: str) -> str:
    """Return the starter of the first level with the change that the briefing asks for."""
    briefing = load_level("01-first-steps").briefing.replace("\n", " ")
    asked = re.search(r'change "([^"]+)" to "([^"]+)"', briefing)
    assert asked, "the briefing of the first level asks for no change"
    before, after = asked.groups()
    assert re.sub(r"\d+", "", before) == re.sub(r"\d+", "", after), "one number is enough"
    assert text.count(before) == 1
    return text.replace(before, after)


def test_the_first_level_is_won_by_changing_the_number_as_its_briefing_says() -> None:
    level = load_level("01-first-steps")
    text = as_the_first_briefing_says(program_text(level.starter))
    assert ticks_to_win(level, text, TICKS_FOR_LOSING) == 1643


@pytest.mark.proof
def test_the_changed_number_wins_from_19_of_20_varied_starts() -> None:
    level = load_level("01-first-steps")
    text = as_the_first_briefing_says(program_text(level.starter))
    assert len(list(wins_from_starts(level, Program.compile(text), TICKS_FOR_LOSING))) >= 19


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("02-open-space", "1 ->", "ray.distance ->"),
        *(
            ("03-the-long-hall", "Greatest(45 - WallDistance(radar), 0)", f"(45 - {pull})")
            for pull in ("WallDistance(radar)", "Least(WallDistance(radar), 75)")
        ),
    ],
)
def test_a_level_is_won_when_long_rays_weigh_more_or_a_far_wall_pulls(
    name: str, before: str, after: str
) -> None:
    level = load_level(name)
    text = program_text(level.starter)
    assert text.count(before) == 1
    assert ticks_to_win(level, text.replace(before, after), TICKS_FOR_LOSING)


@pytest.mark.proof
def test_stopping_at_any_beacon_does_not_bring_everybody_home() -> None:
    text = program_text("everybody-home")
    label = ', ray.label == "Home"'
    assert text.count(label) == 1
    level = load_level("04-everybody-home")
    assert ticks_to_win(level, text.replace(label, ""), TICKS_FOR_LOSING) is None


@pytest.mark.slow
def test_the_printed_program_finds_its_way_through_the_corridor() -> None:
    level = load_level("02-open-space")
    assert ticks_to_win(level, program_text("obstacle-avoider"), TICKS_FOR_LOSING) == 3325


@pytest.mark.sampled
@pytest.mark.parametrize(
    "level",
    [*LEVELS, *map(str, sorted(CONFORMANCE.glob("*.json")))],
    ids=lambda level: Path(level).stem,
)
def test_the_printed_program_thinks_without_failing(level: str) -> None:
    played = verdict(load_level(level), shipped_program("obstacle-avoider"), 50)
    assert "failed" not in played.noticed(50)


def test_a_program_begins_by_saying_what_it_shows() -> None:
    for name in shipped_texts():
        text = program_text(name)
        assert re.match(r"# .+: .+\.\n", text), name
        if name.endswith("-starter"):  # read beside the map
            assert not re.search("\n#.{45}", text), name


def test_every_program_belongs_to_a_level_or_is_an_example() -> None:
    levels = [load_level(name) for name in LEVELS]
    wanted = [program for level in levels for program in (level.starter, level.solution)]
    assert sorted([*wanted, *FREE_PROGRAMS]) == shipped_names("programs", ".l")
