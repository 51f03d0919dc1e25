"""Bonus goals: checked alike in a game and in a process that measures."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from logical_robots_tui import Program, load_level
from logical_robots_tui.game.measuring import measure, mirror
from logical_robots_tui.game.victory import victory_of
from logical_robots_tui.world.level import LevelError, SecondGoal, alike
from tests.game.playing import Play
from tests.short import AHEAD, LEVEL

GOALS = (
    "at most 11 symbols",
    "at most 60 ticks",
    "at most 30 units",
    "never blocked",
    "wins from all 20 starts",
    "wins in the mirrored labyrinth",
)
AT_ONCE, LATER = GOALS[:4], GOALS[5]
"""Those that a victory shows by itself, and one that takes another run."""
BACKWARDS = """\
Power(clock) = (if clock < 20 then -1 else 0.5);
Robot(robot_name:, desire: {left_engine: power, right_engine: power}, memory: 1) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:), power == Power(sensor.clock);
"""
"""It is blocked at first, then wins, and has more symbols."""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "short.toml").write_text(f"second_goals = {list(GOALS)}\n{LEVEL}", "utf-8")
    return tmp_path / "short.toml"


@pytest.mark.parametrize(
    ("text", "reached"),
    [
        (AHEAD, (*AT_ONCE, LATER)),
        pytest.param(BACKWARDS, (LATER,), marks=pytest.mark.slow),
        pytest.param("A(1);\n" + AHEAD, (*AT_ONCE[1:], LATER), marks=pytest.mark.slow),
    ],
)
async def test_a_game_and_a_measuring_process_find_the_same(
    file: Path, text: str, reached: tuple[str, ...], play: Play
) -> None:
    level, program = load_level(file), Program.compile(text)
    game = play(program, level)
    await game.run_until(tick=500)
    victory = victory_of(game, level)
    assert victory is not None
    assert victory.measures is not None
    measured = await measure(level, program, None)
    assert measured is not None
    assert victory.measures.goals == tuple(goal for goal in reached if goal in AT_ONCE)
    assert measured.goals == reached
    assert measured.wins != 20
    known = victory.measures._replace(wins=20, starts=20)
    again = await measure(level, program, known)
    assert again == known._replace(goals=(*known.goals, *GOALS[4:]))


async def test_who_goes_back_before_a_wall_was_not_blocked(file: Path, play: Play) -> None:
    level = load_level(file)
    game = play(BACKWARDS, level)
    await game.run_until(tick=40)
    assert game.history.is_blocked_up_to(40)
    first = next(tick for tick in range(40) if game.history.is_blocked_up_to(tick))
    game.go_to(first - 1)
    game.use(Program.compile(AHEAD))
    await game.run_until(tick=first + 5)
    assert not game.history.is_blocked_up_to(first + 5)
    game.restart()
    await game.step()
    assert not game.history.is_blocked_up_to(1)


def test_a_goal_is_written_as_it_is_read() -> None:
    goals = [SecondGoal.of(words) for words in GOALS]
    assert [goal and goal.words for goal in goals] == list(GOALS)


def test_goals_of_earlier_versions_are_passed_over(file: Path) -> None:
    goals = '"at most 3 rules", "never blocked", "without memory", "at most 1 rule"'
    file.write_text(f"second_goals = [{goals}]\n{LEVEL}", "utf-8")
    assert [goal.words for goal in load_level(file).second_goals] == ["never blocked"]


def test_a_mirrored_level_is_the_same_from_the_other_side() -> None:
    level = load_level("06-breadcrumbs")
    mirrored = mirror(level)
    assert mirrored.robots[0].x == level.width - level.robots[0].x
    assert math.cos(mirrored.robots[0].angle) == pytest.approx(-math.cos(level.robots[0].angle))
    assert math.sin(mirrored.robots[0].angle) == pytest.approx(math.sin(level.robots[0].angle))
    assert (mirrored.walls == level.walls[:, ::-1]).all()
    assert not mirrored.walls.flags.writeable
    twice = mirror(mirrored)
    assert alike(replace(twice, robots=level.robots), level)


def test_what_is_not_a_second_goal_is_refused(file: Path) -> None:
    numbers = ("at most -1 symbols", "at most 1 symbols", "at most 1 symbol ", "at most many ticks")
    for words in (*numbers, "NEVER blocked", "fast"):
        file.write_text(f'second_goals = ["never blocked", "{words}"]\n{LEVEL}', "utf-8")
        with pytest.raises(LevelError) as caught:
            load_level(file)
        assert caught.value.place == f"{file}: second_goals[1]"
        assert caught.value.message == f'"{words}" is not a bonus goal.'
