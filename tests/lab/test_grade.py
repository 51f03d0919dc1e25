"""Grades: right, wrong, not compiling, endless and hostile submissions, late ones and copies."""

import json
import os
from pathlib import Path
from xml.etree import ElementTree

import msgspec
import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.exporting import ResultTable, RunRecords, csv_of
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.lab.grading import grades_of
from tests.cli.running import Command
from tests.lab.laboratory import ENDLESS, FIRST_STEPS, STANDING, lane, page_of, rows, write_files

ASSIGNMENT = Path(__file__).with_name("grade.toml").read_text("utf-8")

MISTAKE = 'Robot(robot_name:, desire: 1, memory: "") :- Snesor(robot_name:);\n'
HOSTILE = b'=cmd|"\xff\x1b[31m\n<b>'


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("class")
    files = {
        b"../assignment.toml": ASSIGNMENT,
        b"../01-first-steps.toml": lane("First steps"),
        b"../02-open-space.toml": lane("Open space"),
        b"../roster.csv": 'id,name,submission\n1,Ada,ada\n2,"=Ben()",ben\n3,Cem,cem\n4,Dot,dot\n',
        b"../late.csv": "id\n2\n",
        b"ada/01-first-steps.l": FIRST_STEPS,
        b"ada/open-space.l": FIRST_STEPS.replace("40", "41"),
        b"ben/01-first-steps.l": "# mine!\n\n" + FIRST_STEPS.replace("  ", "    "),
        b"cem/01-first-steps.l": MISTAKE,
        b"eve.l": ENDLESS,
        HOSTILE + b"/01-first-steps.l": "\n\n# mine\n" + MISTAKE,
        HOSTILE + b"/readme.txt": "not a program",
        b"yan/first-steps.txt": FIRST_STEPS,
        b"zoe/01-first-steps.l": STANDING,
    }
    write_files(folder / "submissions", {os.fsdecode(name): text for name, text in files.items()})
    (folder / "submissions/zoe/02-open-space.l").symlink_to("/etc/passwd")
    submissions, out = f"{folder}/submissions", folder / "out"
    assert main(["grade", f"{folder}/assignment.toml", submissions, "-o", str(out)]) == 0
    return out


def test_the_gradebook_has_the_points_of_everybody(exported: Path) -> None:
    book = {row["id"]: row for row in rows(exported / "gradebook.csv")}
    points = {name: float(row["points"]) for name, row in book.items() if row["points"]}
    hostile = next(name for name in book if "cmd" in name)
    assert points == {"1": 15, "2": 5, "3": 0, "eve": 0, hostile: 0, "yan": 10}
    assert (book["2"]["late"], book["2"]["01-first-steps"]) == ("true", "10.0")
    assert book["4"]["remarks"] == "no submission could be matched to this student"
    assert "it is a link" in book["zoe"]["remarks"]
    ungraded = {name: row["ungraded"] for name, row in book.items() if row["ungraded"] != "0"}
    assert ungraded == {"4": "2", "zoe": "1"}


def test_no_cell_is_a_formula_and_no_control_character_passes(exported: Path) -> None:
    for file in exported.glob("*.csv"):
        assert rows(file) or file.name in ("duplicates.csv", "similar.csv")
        for row in rows(file):
            for cell in row.values():
                assert cell.isprintable()
                assert cell[:1] not in "=+@" or not cell
    for file in [*exported.rglob("*.md"), *exported.rglob("*.xml"), *exported.rglob("*.html")]:
        assert "\x1b" not in file.read_text("utf-8")
    cells = ["=1+1", " @x", "+a", "-a", "\t=x", "a\x1b[0m\nb", -3, 2.5, None, True]
    written = csv_of(ResultTable(("x",), [(cell,) for cell in cells])).splitlines()[1:]
    replaced = "a\N{REPLACEMENT CHARACTER}[0m b"
    assert written == ["'=1+1", "' @x", "'+a", "'-a", "' =x", replaced, "-3", "2.5", '""', "true"]


def test_the_same_program_runs_once_and_mistakes_have_their_own_lines(exported: Path) -> None:
    assert {"1", "2", "yan"} in [
        set(row["ids"].split(", ")) for row in rows(exported / "duplicates.csv")
    ]
    runs: dict[str, list[str]] = {"1": [], "2": []}
    for row in rows(exported / "runs.csv"):
        if row["student"] in runs and row["level"] == "01-first-steps":
            runs[row["student"]].append(row["run"])
    assert len(runs["1"]) == 3
    assert runs["1"] == runs["2"]
    feedback = [file.read_text("utf-8") for file in (exported / "feedback").glob("*.md")]
    befores = [text.partition("Snesor")[0] for text in feedback if "Snesor" in text]
    assert sorted(before.rpartition("line ")[2] for before in befores) == ["1: ", "4: "]


def test_students_read_what_they_may_see(exported: Path) -> None:
    text = (exported / "feedback/1.md").read_text("utf-8")
    assert text.startswith("# Week \\<1\\>\n\nAda: 15 of 15 points\n")
    assert "- 7.5 of 7.5 points for winning: won from the given start.\n" in text
    assert "- 2.5 of 2.5 points for varied starts: won from 2 of 2.\n" in text
    assert "ticks" not in text
    assert "rule" not in text
    data = json.loads((exported / "feedback/1.json").read_text("utf-8"))
    assert "ticks" not in data["levels"][0]
    assert data["points"] == 15
    assert "5 of 15 points (late; 50% counts)" in (exported / "feedback/2.md").read_text("utf-8")
    eve = (exported / "feedback/eve.md").read_text("utf-8")
    assert "thinking took more than 100,000 steps" in eve


def test_other_programs_read_the_grades(exported: Path) -> None:
    scope = json.loads((exported / "gradescope/1.json").read_text("utf-8"))
    assert (scope["score"], [test["max_score"] for test in scope["tests"]]) == (15, [10, 5])
    junit = ElementTree.parse(exported / "junit.xml").getroot()
    suites = {suite.get("name"): suite for suite in junit}
    counts = [suites["Cem (3)"].get(name) for name in ("tests", "failures", "errors", "skipped")]
    assert counts == ["2", "1", "0", "1"]
    names = [file.name for file in (exported / "feedback").iterdir()]
    assert all(n.isascii() and n.isprintable() and not set(n) & set('<>"|') for n in names)


def test_what_was_not_run_or_not_matched_stays_ungraded(exported: Path) -> None:
    folder = Folder(exported)
    manifest = folder.manifest()
    more = msgspec.structs.replace(manifest, starts=3)  # a start that has not been run
    with folder.ledger() as ledger:
        ada, *_ = grades_of(RunRecords(more, ledger))
    assert [level.points for level in ada.levels] == [None, None]
    assert ada.ungraded == 2
    remarks = ("nothing that was submitted was found to be theirs",)
    students = [
        msgspec.structs.replace(each, remarks=each.remarks if each.submission else remarks)
        for each in manifest.students
    ]
    with folder.ledger() as ledger:
        found = grades_of(
            RunRecords(msgspec.structs.replace(manifest, students=tuple(students)), ledger)
        )
    assert {grade.student.id for grade in found if grade.points is None} == {"4", "zoe"}


def test_the_report_is_one_page_and_says_what_is_missing_without_the_extra(
    exported: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "Students who win from the given start" in command("lab", "report", exported).success
    page = page_of(exported)
    assert "<svg" in page
    assert "Week &lt;1&gt;" in page
    monkeypatch.setattr("logical_robots_tui.errors.is_installed", lambda _module: False)
    assert "pip install 'logical-robots-tui[lab]'" in command("lab", "report", exported).refusal
