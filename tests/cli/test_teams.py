"""Commands for levels with teams: a program for each."""

from pathlib import Path

import pytest

from tests.cli.running import Command
from tests.game.playing import BACKWARDS, COUNTER
from tests.game.test_teams import MATCH
from tests.lab.laboratory import write_files

SCORED = f'match = {{ticks = 60}}\n{MATCH}\n[[scores]]\nkind = "hold"\narea = "Door"\npoints = 2\n'


@pytest.fixture(autouse=True)
def _files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    programs = {"on.l": COUNTER, "off.l": BACKWARDS, "broken.l": "\n\nRobot(x :- ;\n"}
    write_files(tmp_path, {"match.toml": SCORED, **programs})


@pytest.mark.parametrize(
    "programs",
    [
        ("on.l", "off.l"),
        ("--ticks", "90", "on.l", "off.l"),
        ("on.l", "--team", "blue=off.l"),
        ("--team", "blue=off.l", "--team", "red=on.l"),
    ],
)
def test_a_team_is_named_by_order_or_by_name(programs: tuple[str, ...], command: Command) -> None:
    told = command("run", "match.toml", *programs)
    assert (told.status, told.data["ticks"], told.data["won"]) == (0, 60, False)
    red, blue = told.data["scores"]["red"], told.data["scores"]["blue"]
    assert red[0] > 0
    assert blue == [0]
    assert [robot["memory"] for robot in told.data["robots"]] == [60, 60, 60]


def test_a_match_is_played_in_lines(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("logical_robots_tui.cli.run.prefers_json", lambda _options: False)
    assert "Hall: after 60 ticks blue " in command("run", "match.toml", "off.l", "on.l").success
    words = ("match.toml", "on.l", "--team", "blue=off.l", "--plain", "--data-dir", "data")
    assert "The match is over: red " in command("play", *words, typed=("run", "quit")).success


def test_why_explains_with_the_program_of_the_robot(command: Command) -> None:
    words = ("why", "match.toml", "on.l", "off.l", "--tick", "3", "--robot")
    assert command(*words, "Bo").data["row"]["desire"]["left_engine"] == -1
    assert command(*words, "Cy").data["row"]["desire"]["left_engine"] == 1


FIRST = "01-first-steps"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("match.toml", "on.l", "off.l", "on.l"), "3 programs are too many: match has 2 teams."),
        (("match.toml", "on.l", "--team", "bleu=off.l"), "match has no team bleu."),
        (("match.toml", "on.l", "missing.l"), "There is no such program"),
        (("match.toml", "on.l", "--team", "red=off.l"), "Two programs are named for red."),
        (("match.toml",), "No program is named."),
        ((FIRST, "on.l", "off.l"), "01-first-steps has no teams"),
        ((FIRST, "on.l", "--team", "red=off.l"), "01-first-steps has no team red."),
    ],
)
def test_a_wrong_team_is_refused(words: tuple[str, ...], said: str, command: Command) -> None:
    told = command("run", *words)
    assert told.status == 2
    assert said in told.data["error"]["message"]


def test_a_mistake_is_told_with_its_file_and_line(command: Command) -> None:
    told = command("run", "match.toml", "on.l", "broken.l")
    assert (told.status, told.data["error"]["place"]) == (2, "broken.l")
    assert told.data["error"]["diagnostics"][0]["line"] == 3


def test_a_match_is_recorded_with_the_programs_of_all_teams(command: Command) -> None:
    words = ("match.toml", "on.l", "off.l", "-o", "m.replay")
    assert "60 ticks" in command("replay", "record", *words).success
    assert command("replay", "verify", "m.replay").status == 0
    shown = command("replay", "show", "m.replay", "--json").success
    assert COUNTER in shown.encode().decode("unicode_escape")
