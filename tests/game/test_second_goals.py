"""Second goals: checked alike in a game and in a process that measures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui import Game, Program, load_level
from logical_robots_tui.game.measuring import STARTS, measure
from logical_robots_tui.game.victory import victory_of
from logical_robots_tui.world.level import LevelError, SecondGoal
from tests.short import AHEAD, LEVEL

if TYPE_CHECKING:
    from pathlib import Path

GOALS = (
    "at most 20 symbols",
    "at most 60 ticks",
    "at most 30 units",
    "never blocked",
    "won from all 20 starts",
    "won in the mirrored labyrinth",
)
DURING, ELSEWHERE = GOALS[:4], GOALS[4:]
BACKWARDS = """\
Power(clock) = (if clock < 20 then -1 else 0.5);
Robot(robot_name:, desire: {left_engine: power, right_engine: power}, memory: 1) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:), power == Power(sensor.clock);
"""
"""It is blocked at first, then wins, is longer than the goal."""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(f"second_goals = {list(GOALS)}\n{LEVEL}", "utf-8")
    return path


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("text", "reached"), [(AHEAD, DURING), (BACKWARDS, ()), (10 * "A(1);\n" + AHEAD, DURING[1:])]
)
async def test_a_game_and_a_measuring_process_find_the_same(
    file: Path, text: str, reached: tuple[str, ...]
) -> None:
    level, program = load_level(file), Program.compile(text)
    game = Game(level, program)
    try:
        await game.run_until(tick=500)
        victory = victory_of(game, level)
    finally:
        await game.close()
    assert victory is not None
    assert victory.measures is not None
    measured = await measure(level, program, None)
    assert measured is not None
    assert victory.measures.goals == reached
    assert measured.goals == reached + (ELSEWHERE if measured.wins == STARTS else ELSEWHERE[1:])


async def test_who_goes_back_before_a_wall_was_not_blocked(file: Path) -> None:
    level = load_level(file)
    game = Game(level, Program.compile(BACKWARDS))
    try:
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
    finally:
        await game.close()


@pytest.mark.parametrize("words", GOALS)
def test_a_goal_is_written_as_it_is_read(words: str) -> None:
    goal = SecondGoal.of(words)
    assert goal is not None
    assert goal.words == words


@pytest.mark.parametrize(
    "words", ["at most -1 symbols", "at most 1 symbols", "at most 1 rule", "without memory", "fast"]
)
def test_what_is_no_second_goal_is_refused(file: Path, words: str) -> None:
    file.write_text(f'second_goals = ["never blocked", "{words}"]\n{LEVEL}', "utf-8")
    with pytest.raises(LevelError) as caught:
        load_level(file)
    assert caught.value.place == f"{file}: second_goals[1]"
    assert caught.value.message == f'"{words}" is not a second goal.'
