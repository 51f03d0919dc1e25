"""Bonus goals without a screen."""

from pathlib import Path

import pytest

from logical_robots_tui.cli.run import play_out
from logical_robots_tui.mind import Program
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import load_level
from tests.cli.running import Command
from tests.lab.laboratory import write_files
from tests.short import AHEAD, LEVEL

SIZE, DISTANCE = 11, 24.5
GOALS = ("at most 9 ticks", "never blocked", "wins from all 20 starts")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    text = f"second_goals = {list(GOALS)}\n{LEVEL}"
    return write_files(tmp_path, {"goals.toml": text}) / "goals.toml"


def test_a_run_says_which_are_reached(command: Command, file: Path, ahead: Path) -> None:
    found = command("run", file, ahead).data
    assert (found["size"], found["distance"]) == (SIZE, DISTANCE)
    assert found["second_goals"] == dict(zip(GOALS, (False, True, None), strict=True))


async def test_a_run_says_so_in_words(file: Path) -> None:
    outcome = await play_out(load_level(file), Program.compile(AHEAD), "ahead", 500)
    told = outcome.as_text()
    goals = "at most 9 ticks: no; never blocked: yes; wins from all 20 starts: not tried"
    drove = f"The program has {SIZE} symbols; the robots drove {DISTANCE:.0f} units."
    assert f"\n{drove}\nBonus goals: {goals}.\n" in told


def test_the_game_in_lines_names_and_keeps_them(
    command: Command, file: Path, ahead: Path, tmp_path: Path
) -> None:
    words = (file, ahead, "--plain", "--data-dir", tmp_path / "data")
    told = command("play", *words, typed=("run",)).out
    assert "Bonus goal: never blocked.\n" in told
    assert "Bonus goal reached: never blocked.\n" in told
    assert "reached: at most 9 ticks" not in told
    progress = Progress(tmp_path / "data" / FILE_NAME)
    assert progress.record(str(file)).bests.goals == ("never blocked",)
    progress.close()
