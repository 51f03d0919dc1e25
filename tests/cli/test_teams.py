"""Commands for levels with teams: a program for each."""

from __future__ import annotations

import json
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.cli.main import main
from tests.game.playing import BACKWARDS, COUNTER
from tests.game.test_teams import MATCH

SCORED = (
    "match = {ticks = 60}\n" + MATCH + '\n[[scores]]\nkind = "hold"\narea = "Door"\npoints = 2\n'
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("match.toml").write_text(SCORED, "utf-8")
    Path("on.l").write_text(COUNTER, "utf-8")
    Path("off.l").write_text(BACKWARDS, "utf-8")
    Path("broken.l").write_text("\n\nRobot(x :- ;\n", "utf-8")
    return tmp_path


def told(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, Any]:
    status = main([*words, "--json", "--data-dir", "data"])
    return status, json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(
    "programs",
    [
        ("on.l", "off.l"),
        ("--ticks", "90", "on.l", "off.l"),
        ("on.l", "--team", "blue=off.l"),
        ("--team", "blue=off.l", "--team", "red=on.l"),
    ],
)
def test_each_team_is_named_by_order_or_by_name(
    programs: tuple[str, ...], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, found = told(capsys, "run", "match.toml", *programs)
    assert (status, found["ticks"], found["won"]) == (0, 60, False)
    red, blue = found["scores"]["red"], found["scores"]["blue"]
    assert red[0] > 0
    assert blue == [0]
    assert [robot["memory"] for robot in found["robots"]] == [60, 60, 60]


def test_the_result_for_people_names_the_best_first(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("logical_robots_tui.cli.run.prefers_json", lambda _options: False)
    assert main(["run", "match.toml", "off.l", "on.l", "--data-dir", "data"]) == 0
    assert "Hall: after 60 ticks blue " in capsys.readouterr().out


def test_why_explains_with_the_program_of_the_robot(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("why", "match.toml", "on.l", "off.l", "--tick", "3", "--robot")
    assert told(capsys, *words, "Bo")[1]["row"]["desire"]["left_engine"] == -1
    assert told(capsys, *words, "Cy")[1]["row"]["desire"]["left_engine"] == 1


@pytest.mark.parametrize(
    ("programs", "said"),
    [
        (("on.l", "off.l", "on.l"), "3 programs are too many: match has 2 teams."),
        (("on.l", "--team", "bleu=off.l"), "match has no team bleu."),
        (("on.l", "missing.l"), "There is no such program"),
        (("on.l", "--team", "red=off.l"), "Two programs are named for red."),
        ((), "No program is named."),
    ],
)
def test_a_wrong_team_is_refused(
    programs: tuple[str, ...], said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, found = told(capsys, "run", "match.toml", *programs)
    assert status == 2
    assert said in found["error"]["message"]


def test_a_mistake_is_told_with_its_file_and_line(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, found = told(capsys, "run", "match.toml", "on.l", "broken.l")
    assert status == 2
    assert found["error"]["place"] == "broken.l"
    assert found["error"]["diagnostics"][0]["line"] == 3


def test_a_level_without_teams_takes_one_program(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    status, found = told(capsys, "run", "01-first-steps", "on.l", "off.l")
    assert status == 2
    assert "01-first-steps has no teams" in found["error"]["message"]
    status, found = told(capsys, "run", "01-first-steps", "on.l", "--team", "red=off.l")
    assert (status, found["error"]["message"]) == (2, "01-first-steps has no team red.")


def test_a_match_is_recorded_with_the_programs_of_all_teams(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["replay", "record", "match.toml", "on.l", "off.l", "-o", "m.replay"]
    assert main([*words, "--data-dir", "data"]) == 0
    assert "60 ticks" in capsys.readouterr().out
    assert main(["replay", "verify", "m.replay"]) == 0
    assert main(["replay", "show", "m.replay", "--json"]) == 0
    assert COUNTER in capsys.readouterr().out.encode().decode("unicode_escape")


def test_a_match_is_played_in_lines(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", StringIO("run\nquit\n"))
    words = ["play", "match.toml", "on.l", "--team", "blue=off.l", "--plain"]
    assert main([*words, "--data-dir", "data"]) == 0
    assert "The match is over: red " in capsys.readouterr().out
