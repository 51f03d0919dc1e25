"""A class at a glance: what went wrong with whom, similar programs, and playing one of them."""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.lab.classroom import ALIKE, likeness
from logical_robots_tui.lab.folder import Folder
from tests.cli.running import Command
from tests.lab.laboratory import FIRST_STEPS, program_text
from tests.lab.test_running import SENSOR, STILL

if TYPE_CHECKING:
    from pathlib import Path

ASSIGNMENT = """
[assignment]
title = "Week 1"
starts = 1
roster = "roster.csv"
[[level]]
name = "01-first-steps"
[[level]]
name = "02-open-space"
[limits]
steps = 1_000_000
run_steps = 3_000_000
"""

ROSTER = {
    "2017": "Ada Lovelace",
    "2018": "Ben Ary",
    "2019": "Cem <b>Demir</b>",
    "2020": "Dot Ary",
    "2021": "Eve Hacker",
    "2022": "Fay Slow",
    "2023": "Gus Still",
    "2024": "Hal Two",
}

RENAMED = """
Robot(robot_name:, desire: Move(s.forward_distance), memory: "") :-
  Sensor(robot_name:, sensor: s);
/* all mine */ Move(d) = (
  if d < Wall() then {left_engine: 0.8, right_engine: -0.8}
  else if (d) < 90 then {left_engine: 0.8, right_engine: 0.6}
  else {left_engine: 0.8, right_engine: 0.8});
Wall() = 40;
"""

SLOW = """
N(x) :- x in Range(150);
Robot(robot_name:, desire: {left_engine: Sum{x * y :- N(x), N(y)} * 0, right_engine: 0}, memory:)
  :- Sensor(robot_name:, sensor:), memory == sensor.clock;
"""

TWO = STILL.format("0", '""', SENSOR) + STILL.format("1", '""', SENSOR)


@pytest.fixture(scope="module")
def grades(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A graded class with each kind of fault, and a program that was handed in three times."""
    folder = tmp_path_factory.mktemp("class")
    (folder / "a.toml").write_text(ASSIGNMENT)
    rows = [f"{mine},{name},{name.split()[0].lower()}" for mine, name in ROSTER.items()]
    (folder / "roster.csv").write_text("id,name,submission\n" + "\n".join(rows))
    files = {
        "ada/01-first-steps": FIRST_STEPS,
        "ada/02-open-space": program_text("open-space"),
        "ben/01-first-steps": RENAMED,
        "ben/02-open-space": program_text("references/open-space-shortest"),
        "cem/01-first-steps": "Robot(robot_name:, desire: 1, memory: 2) :- Snesor(robot_name:);",
        "dot/01-first-steps": f"# {'again ' * 9}\n{FIRST_STEPS}",
        "eve/01-first-steps": TWO,
        "fay/01-first-steps": SLOW,
        "gus/01-first-steps": STILL.format("0", '""', SENSOR),
        "hal/01-first-steps": program_text("first-steps-starter"),
    }
    for name, text in files.items():
        file = folder / f"all/{name}.l"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder


@pytest.fixture
def graded(grades: Path, capsys: pytest.CaptureFixture[str]) -> tuple[Command, Path]:
    command, out = Command(capsys), grades / "grades"
    told = command("grade", grades / "a.toml", grades / "all", "-o", out, "--workers", 1)
    assert told.status == 0, told.err
    return command, out


def test_what_went_wrong_is_told_by_kind_with_names(graded: tuple[Command, Path]) -> None:
    command, out = graded
    told = command("lab", "report", out).out
    _, _, faults = told.partition("Common problems\n")
    assert max(map(len, faults.splitlines())) <= max(80, len(str(out)) + 30)
    faults = " ".join(faults.split())
    assert "does not compile: 01-first-steps: Cem <b>Demir</b> (2019): Snesor" in faults
    assert "too slow: 01-first-steps: Fay Slow (2022): too slow" in faults
    assert "errors while running: 01-first-steps: Eve Hacker (2021): Robot has 2 rows" in faults
    assert "did not win: 01-first-steps: Gus Still (2023)" in faults
    assert "02-open-space: Cem <b>Demir</b> (2019), Dot Ary (2020)," in faults


def test_the_report_names_people_levels_and_short_commands(graded: tuple[Command, Path]) -> None:
    command, out = graded
    assert command("lab", "report", out).status == 0
    page = (out / "report.html").read_text("utf-8")
    assert "<h3>Does not compile</h3>" in page
    assert "Cem &lt;b&gt;Demir&lt;/b&gt; (2019)" in page
    assert "<code>logical-robots lab play grades 2019 01</code>" in page
    assert "<b>Demir" not in page
    assert not re.search("[0-9a-f]{64}", page)


def test_renamed_and_reordered_programs_are_found(graded: tuple[Command, Path]) -> None:
    command, out = graded
    assert command("lab", "export", out).status == 0
    with (out / "similar.csv").open(newline="") as lines:
        (found,) = csv.DictReader(lines)
    assert (found["level"], found["one"], found["other"]) == (
        "01-first-steps",
        "2017, 2020",
        "2018",
    )
    assert (found["one_name"], found["other_name"]) == ("Ada Lovelace, Dot Ary", "Ben Ary")
    assert 0.9 < float(found["score"]) <= 1
    command("lab", "report", out)
    page = (out / "report.html").read_text("utf-8")
    _, _, both = page.partition("<details>")
    assert "Drive(distance) = (" in both
    assert "/* all mine */ Move(d) = (" in both


def test_likeness_is_of_what_is_ones_own_without_its_names() -> None:
    statements = FIRST_STEPS.split(";\n")
    renamed = re.sub(r"\b(Near|Drive|distance)\b", r"\1x", FIRST_STEPS)
    assert likeness(FIRST_STEPS, renamed) == 1
    assert likeness(FIRST_STEPS, ";\n".join([*statements[-2::-1], ""])) == 1
    assert ALIKE < likeness(FIRST_STEPS, FIRST_STEPS.replace("90", "95")) < 1
    moved = RENAMED.replace("robot_name:, desire: Move(s.forward_distance)", "robot_name:")
    assert ALIKE < likeness(FIRST_STEPS, moved) < likeness(FIRST_STEPS, RENAMED) <= 1
    starter = program_text("first-steps-starter")
    assert likeness(starter, f"{starter} Unused() = 1;", starter) == 0
    assert likeness("", "") == 0


def test_programs_of_different_authors_are_not_alike() -> None:
    for level in ("lighthouse", "station-management", "the-long-hall", "swarm"):
        own, other = program_text(level), program_text(f"references/{level}-shortest")
        assert likeness(own, other, program_text(f"{level}-starter")) < ALIKE


def test_a_program_is_played_by_name_and_number(
    graded: tuple[Command, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    command, out = graded
    for words in (("2017", "02"), ("ada", "2"), ("lovelace", "open-space", "--start", 1)):
        monkeypatch.setattr("sys.stdin", io.StringIO("quit\n"))
        told = command("lab", "play", out, *words, "--plain")
        assert (told.status, told.err) == (0, "")
        assert told.out.startswith("Open space"), told.out


def test_what_cannot_be_played_is_said(graded: tuple[Command, Path]) -> None:
    command, out = graded
    before = sorted(Folder(out).path.iterdir())
    for words, said in {
        ("Ary", "1"): "Several students match. Name one by the id: Ben Ary (2018), Dot",
        ("Lovelance", "1"): 'No student matches. Did you mean "Lovelace"?',
        ("2017", "7"): "No program was run in this level. Levels: 01-first-steps, 02-open-space",
        ("hal", "02"): "Hal Two (2024) has no program for 02-open-space",
    }.items():
        told = command("lab", "play", out, *words)
        assert told.status == 2
        assert said in told.err
    assert sorted(Folder(out).path.iterdir()) == before
