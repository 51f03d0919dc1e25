"""A class at a glance: what went wrong with whom, similar programs, and playing one of them."""

import re
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.classroom import ALIKE, likeness
from logical_robots_tui.lab.folder import Folder
from tests.cli.running import Command
from tests.lab.laboratory import (
    FIRST_STEPS,
    SENSOR,
    STANDING,
    STILL,
    lane,
    program_text,
    rows,
    write_files,
)
from tests.short import AHEAD

ASSIGNMENT = Path(__file__).with_name("classroom.toml").read_text("utf-8")

STUDENTS = [
    *("Ada Lovelace", "Ben Ary", "Cem <b>Demir</b>", "Dot Ary"),
    *("Eve Hacker", "Fay Slow", "Gus Still", "Hal Two"),
]

RENAMED = Path(__file__).with_name("renamed.l").read_text("utf-8")

SLOW = """
N(x) :- x in Range(150);
Robot(robot_name:, desire: {left_engine: Sum{x * y :- N(x), N(y)} * 0, right_engine: 0}, memory:)
  :- Sensor(robot_name:, sensor:), memory == sensor.clock;
"""

TWO = STANDING + STILL.format("1", '""', SENSOR)


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A graded class with each kind of fault, and a program that was handed in three times."""
    folder = tmp_path_factory.mktemp("class")
    lines = [f"{n},{name},{name.split()[0].lower()}" for n, name in enumerate(STUDENTS, 2017)]
    files = {
        "a.toml": ASSIGNMENT,
        "roster.csv": "id,name,submission\n" + "\n".join(lines),
        "01-first-steps.toml": lane("First steps"),
        "02-open-space.toml": lane("Open space"),
        "all/ada/01-first-steps.l": FIRST_STEPS,
        "all/ada/02-open-space.l": FIRST_STEPS,
        "all/ben/01-first-steps.l": RENAMED,
        "all/ben/02-open-space.l": AHEAD.replace("0.5", "0.9"),
        "all/cem/01-first-steps.l": "Robot(robot_name:, desire: 1) :- Snesor(robot_name:);",
        "all/dot/01-first-steps.l": f"# {'again ' * 9}\n{FIRST_STEPS}",
        "all/eve/01-first-steps.l": TWO,
        "all/fay/01-first-steps.l": SLOW,
        "all/gus/01-first-steps.l": STANDING,
        "all/hal/01-first-steps.l": program_text("first-steps-starter"),
    }
    write_files(folder, files)
    out = folder / "grades"
    assert main(["grade", f"{folder}/a.toml", f"{folder}/all", "-o", str(out)]) == 0
    return out


def test_what_went_wrong_is_told_by_kind_and_names(out: Path, command: Command) -> None:
    _, _, faults = command("lab", "report", out).out.partition("Common problems\n")
    assert max(map(len, faults.splitlines())) <= max(80, len(str(out)) + 30)
    faults = " ".join(faults.split())
    assert "does not compile: 01-first-steps: Cem <b>Demir</b> (2019): Snesor" in faults
    assert "too slow: 01-first-steps: Fay Slow (2022): too slow" in faults
    assert "errors while running: 01-first-steps: Eve Hacker (2021): Robot has 2 rows" in faults
    assert "did not win: 01-first-steps: Gus Still (2023)" in faults
    assert "02-open-space: Cem <b>Demir</b> (2019), Dot Ary (2020)," in faults
    page = (out / "report.html").read_text("utf-8")
    assert "<h3>Does not compile</h3>" in page
    assert "Cem &lt;b&gt;Demir&lt;/b&gt; (2019)" in page
    assert "<code>logical-robots lab play grades 2019 01</code>" in page
    assert "<b>Demir" not in page
    assert not re.search("[0-9a-f]{64}", page)


def test_renamed_and_reordered_programs_are_found(out: Path, command: Command) -> None:
    assert command("lab", "export", out).status == 0
    (pair,) = rows(out / "similar.csv")
    assert (pair["level"], pair["one"], pair["other"]) == ("01-first-steps", "2017, 2020", "2018")
    assert (pair["one_name"], pair["other_name"]) == ("Ada Lovelace, Dot Ary", "Ben Ary")
    assert 0.9 < float(pair["score"]) <= 1
    command("lab", "report", out)
    _, _, both = (out / "report.html").read_text("utf-8").partition("<details>")
    assert "Drive(distance) = (" in both
    assert "/* all mine */ Move(d) = (" in both


def test_likeness_is_of_what_is_ones_own_without_its_names() -> None:
    statements = FIRST_STEPS.split(";\n")
    assert likeness(FIRST_STEPS, re.sub(r"\b(Near|Drive|distance)\b", r"\1x", FIRST_STEPS)) == 1
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


def test_a_program_is_played_by_name_and_number_or_missed(out: Path, command: Command) -> None:
    for words in (("2017", "02"), ("ada", "2"), ("lovelace", "open-space", "--start", 1)):
        told = command("lab", "play", out, *words, "--plain", typed=("quit",))
        assert (told.status, told.err) == (0, "")
        assert told.out.startswith("Open space"), told.out
    before = sorted(Folder(out).path.iterdir())
    for words, said in {
        ("Ary", "1"): "Several students match. Name one by the id: Ben Ary (2018), Dot",
        ("Lovelance", "1"): 'No student matches. Did you mean "Lovelace"?',
        ("2017", "7"): "No program was run in this level. Levels: 01-first-steps, 02-open-space",
        ("hal", "02"): "Hal Two (2024) has no program for 02-open-space",
    }.items():
        assert said in command("lab", "play", out, *words).refusal
    assert sorted(Folder(out).path.iterdir()) == before
