"""Listing and exporting progress, and playing an export again."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import load_program
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.mind import Program
from logical_robots_tui.progress import FILE_NAME, Measures, Progress
from logical_robots_tui.world import load_level
from tests.cli.running import Command

LEVEL = "01-first-steps"
GOALS = ("never blocked",)
WON = "Mine() = 1;", Measures(1234, 56, 789.5)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The files of a player who has won the first level, and begun a level of her own."""
    progress = Progress(tmp_path / FILE_NAME)
    progress.begin(LEVEL)
    progress.win(LEVEL, WON[0], WON[1]._replace(goals=GOALS))
    progress.win(LEVEL, "Worse() = 1;", Measures(9000, 99, 9e9, 1, 20))
    progress.reveal("02-open-space", 2)
    progress.begin("/maps/cellar.toml")
    progress.begin("/maps/room")  # which was never saved, and so is not listed
    progress.close()
    return tmp_path


def achieved(level: str, program: str) -> Measures:
    played = play_through(load_level(level), Program.compile(program), 5000)
    assert played.won_at is not None
    return Measures(played.won_at, size_of(program), played.distance)


def written(folder: Path, level: str, *victories: dict[str, Any]) -> Path:
    file = folder / "export.json"
    levels = [{"level": level, "victories": victories}]
    file.write_text(json.dumps({"format": 1, "levels": levels}), encoding="utf-8")
    return file


def test_each_level_has_a_line(command: Command, folder: Path) -> None:
    lines = [line.split() for line in command("progress", "--data-dir", folder).out.splitlines()]
    assert (lines[1][:4], lines[1][-4:]) == ([LEVEL, "won", "1234", "56"], ["1", "of", "20", "1"])
    assert lines[2] == ["02-open-space", "new", "2"]
    assert lines[-1] == ["/maps/cellar.toml", "started"]
    nothing = folder / "nothing"
    assert command("progress", "--data-dir", nothing).status == 0
    assert not nothing.exists(), "nothing is written for who has no progress"


def test_exports_have_the_best_by_measure_with_programs(command: Command, folder: Path) -> None:
    told = command("progress", "--data-dir", folder, "--csv")
    rows = list(csv.DictReader(io.StringIO(told.out)))
    columns = ("level", "ticks", "goals")
    assert [rows[0][name] for name in columns] == [LEVEL, "1234", "never blocked"]
    assert [rows[1][name] for name in columns[1:]] == ["", ""]
    told = command("progress", "--data-dir", folder, "--json", status=0)
    first = told.data["levels"][0]
    others = {"wins": 1, "starts": 20, "goals": list(GOALS), "rules": None}
    assert first["best"] == WON[1]._asdict() | others
    assert {victory["program"] for victory in first["victories"]} == {WON[0], "Worse() = 1;"}


@pytest.mark.slow
def test_programs_are_played_again(command: Command, tmp_path: Path) -> None:
    text = load_program("first-steps").text.replace("distance < 90", "distance < 80")
    measures = achieved(LEVEL, text)
    true: dict[str, Any] = {"program": text, **measures._asdict(), "wins": 20, "starts": 20}
    false: list[dict[str, Any]] = [
        *({"ticks": 3}, {"size": 1}, {"distance": 5.0}, {"wins": 3}),
        {"goals": ["at most 9 ticks"]},
    ]
    victories = [true, *(true | change for change in false)]
    told = command("progress", "--check", written(tmp_path, LEVEL, *victories), status=1)
    _, confirmed, ticks, size, distance, wins, goals = told.out.splitlines()
    assert confirmed.endswith("20 of 20  confirmed")
    assert f"ticks: 3 claimed, {measures.ticks:,} found" in ticks
    assert f"size: 1 claimed, {measures.size} found" in size
    assert "distance: 5 claimed, " in distance
    assert "robust: 3 of 20 claimed, 20 found" in wins
    assert '"at most 9 ticks" claimed, not reached' in goals


@pytest.mark.proof
def test_a_victory_of_the_day_is_played_again(command: Command, tmp_path: Path) -> None:
    level, text = "daily-2026-11-22-small", load_program("the-long-hall").text
    true = {"program": text, **achieved(level, text)._asdict()}
    file = written(tmp_path, level, true, true | {"distance": 1.0})
    right, wrong = command("progress", "--check", file, "--json").data["results"]
    assert right["confirmed"]
    assert wrong["problem"].startswith("distance: 1 claimed, ")


@pytest.mark.parametrize(
    ("level", "program", "problem"),
    [
        (LEVEL, "Robot(", "line 1: "),
        (LEVEL, load_program("first-steps").text, "this is a reference program"),
        ("no-such-level", "Robot();", "no-such-level is neither a shipped level nor"),
        ("daily-2026-11-22-tiny", "Robot();", "daily-2026-11-22-tiny is neither a"),
        ("daily-2026-11-22-small", "Robot(", "line 1: "),
    ],
)
def test_what_can_not_be_confirmed_is_told(
    level: str, program: str, problem: str, command: Command, tmp_path: Path
) -> None:
    victory = {"program": program, "ticks": 3, "size": 1, "distance": 5.0}
    told = command("progress", "--check", written(tmp_path, level, victory), "--json", status=1)
    assert not told.data["confirmed"]
    (result,) = told.data["results"]
    assert result["problem"].startswith(problem)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "This is not an exported progress file"),
        ("[" * 100_000, "This is not an exported progress file"),
        ('{"format": 2, "levels": []}', "this version of the game reads 1"),
        ('{"format": 1}', "`levels`"),
        ('{"format": 1, "levels": [{"level": "x", "victories": [{}]}]}', "levels[0].victories[0]"),
    ],
)
def test_a_file_that_is_no_export_is_refused(
    content: str, message: str, command: Command, tmp_path: Path
) -> None:
    file = tmp_path / "export.json"
    file.write_text(content, encoding="utf-8")
    told = command("progress", "--check", file)
    assert message in told.refusal
    assert not told.out
