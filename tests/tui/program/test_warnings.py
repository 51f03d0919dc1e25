"""Warnings in the editor: what is odd, lacks in the level, or differs on the web platform."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.program.pane import ProgramPane
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


def title(game: Opened) -> str:
    return game.main.query_one(ProgramPane).label


ODD = """\
# forgets everything

Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}) :-
  Sensor(robot_name:);
"""


ORDERED = STILL.replace("memory: 1", "memory: {order: 1}")


async def test_in_a_level_of_the_web_platform_what_fails_there_is_marked(data_dir: Path) -> None:
    async with opened(data_dir, text=ORDERED) as game:
        await game.until(lambda: title(game).startswith("Program · applied, 1 warning"))
        await game.sees("order is a word of SQL")


async def test_in_a_level_of_this_game_it_is_not_marked(data_dir: Path) -> None:
    level = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=level, text=ORDERED) as game:
        await game.until(lambda: title(game).startswith("Program · applied · "))


async def test_a_program_that_runs_though_something_is_odd_shows_a_warning(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.write(ODD)
        await game.sees("applied, 1 warning")
        await game.sees("! line 3")
        assert game.session.state.applied == ODD


LOST = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: sees) :-
  Sensor(robot_name:, sensor:),
  sees = (if sensor.forward_label == "Sola" then 1 else 0);
"""


async def test_a_name_that_the_level_lacks_is_a_warning_with_the_nearest(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.write(LOST)
        await game.sees("applied, 1 warning")
        await game.sees('Did you mean "Solo"?')
        await game.write(LOST.replace("Sola", "Solo"))
        await game.until(lambda: game.session.state.mistakes == () and not game.shows("warning"))


NAMED = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: near) :-
  Sensor(robot_name:, sensor:),
  near = sensor.forward_distance < 60;
"""


@pytest.mark.parametrize("level", ["open_room", shipped_folder("levels") / "01-first-steps.toml"])
async def test_a_comparison_without_parentheses_is_marked_in_levels_of_both_kinds(
    data_dir: Path, level: str | Path
) -> None:
    async with opened(data_dir, level=level, text=STILL) as game:
        await game.ready()
        await game.write(NAMED)
        await game.until(lambda: len(game.session.state.mistakes) == 1)
        (found,) = game.session.state.mistakes
        assert (found.line, found.column) == (3, 3)
        assert found.hint.endswith("near = (sensor.forward_distance < 60).")
        await game.sees("! line 3, column 3")
