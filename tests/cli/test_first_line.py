"""A program is a program, whatever its first line says."""

from pathlib import Path

import pytest

from logical_robots_tui.game.replay import load_replay
from tests.cli.running import Command
from tests.game.playing import HALL
from tests.lab.laboratory import write_files

PLAIN = """\
Speed() = 1;
Robot(robot_name:, desire: {left_engine: Speed(), right_engine: Speed()}, memory: "") :-
  Sensor(robot_name:);
"""
LIKE_TEAMS = f'# teams: {{"red": 1, "blue": {PLAIN.count(chr(10))}}}\n{PLAIN}'


@pytest.fixture(autouse=True)
def _files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_files(tmp_path, {"hall.toml": HALL, "plain.l": PLAIN, "teams.l": LIKE_TEAMS})


def test_it_is_checked_as_one(command: Command) -> None:
    assert command("check", "teams.l").status == 0
    Path("teams.l").write_text(LIKE_TEAMS + "Wrong(x :- ;\n", "utf-8")
    told = command("check", "teams.l", "--json")
    (found,) = told.data["programs"][0]["diagnostics"]
    assert (told.status, found["line"]) == (2, 5)


def test_it_runs_and_is_played_in_lines_as_one(command: Command) -> None:
    plain = command("run", "hall.toml", "plain.l", "--json").data
    told = command("run", "hall.toml", "teams.l", "--json").data
    assert told["won"]
    assert (told["ticks"], told["robots"]) == (plain["ticks"], plain["robots"])
    words = ("play", "hall.toml", "teams.l", "--plain", "--data-dir", "data")
    assert "The victory is saved in your progress." in command(*words, typed=("run", "quit")).out


def test_it_is_recorded_verified_and_shown_as_one(command: Command) -> None:
    assert command("replay", "record", "hall.toml", "teams.l", "-o", "a.replay").status == 0
    assert load_replay(Path("a.replay")).programs == {1: {"": LIKE_TEAMS}}
    assert "The same: " in command("replay", "verify", "a.replay").out
    assert "program   teams from tick 1, " in command("replay", "show", "a.replay").out
    (program,) = command("replay", "show", "a.replay", "--json").data["programs"]
    assert (program["team"], program["text"]) == ("", LIKE_TEAMS)
