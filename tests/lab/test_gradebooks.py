"""Gradebooks go back to their platforms: importers read them by the platforms' published rules."""

import csv
import io
import re
import zipfile
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.platforms.gradebooks import Gradebook, fill_in, gradebook_of
from logical_robots_tui.lab.platforms.tables import read_table
from tests.lab.laboratory import FIRST_STEPS, STANDING, lane, write_files
from tests.lab.test_exports import CASES, class_for, roster_of

ASSIGNMENT = """
[assignment]
roster = "w.csv"
starts = 0
ticks = 2000
[[level]]
name = "lane.toml"
"""
WORDS_OF_MOODLE = {"English": ("Identifier", "Grade"), "German": ("ID", "Bewertung")} | {
    "French": ("Identifiant", "Note"),
    "Spanish": ("Identificador", "Calificación"),
    "Italian": ("Identificativo", "Valutazione"),
    "Portuguese": ("Identificador", "Nota"),
    "Dutch": ("Identificatie", "Cijfer"),
    "Polish": ("Identyfikator", "Ocena"),
}
"""What Moodle calls the columns that its importer needs; it takes an id from the end of a cell."""


def book_of(content: bytes, columns: dict[str, str] | None = None) -> tuple[Gradebook, str]:
    table = read_table("a/roster.csv", content, ["id"], ["name"], columns or {})
    gradebook, _ = gradebook_of(table, "digest", "Week 1", 20)
    assert gradebook is not None
    return gradebook, table.text


def filled(content: bytes, points: dict[str, float | None], feedback: dict[str, str]) -> bytes:
    gradebook, text = book_of(content)
    return fill_in(gradebook, text, points, feedback, str)


def cells_of(content: bytes, encoding: str, separator: str) -> list[list[str]]:
    return [*csv.reader(io.StringIO(content.decode(encoding), newline=""), delimiter=separator)]


@pytest.mark.parametrize("language", WORDS_OF_MOODLE)
def test_moodle_takes_back_its_worksheet_in_any_language(language: str) -> None:
    content = roster_of(CASES["rosters"][f"worksheet, {language}"])
    ids = [row.id for row in read_table("r.csv", content, ["id"], [], {}).rows]
    points: dict[str, float | None] = {**dict.fromkeys(ids, 7.25), ids[0]: None, ids[1]: 0.0}
    separator = "," if language == "English" else ";"
    read, written = (
        cells_of(table, "utf-8", separator)
        for table in (content, filled(content, points, {ids[2]: "<p>Well, done</p>"}))
    )
    id_column, grade_column = (read[0].index(word) for word in WORDS_OF_MOODLE[language])
    grades = {re.sub(r"\D", "", row[id_column]): row[grade_column] for row in written[1:]}
    mark = "," if language in ("German", "French") else "."
    assert [*grades] == [fields["moodle"] for fields in class_for(["", ""])]
    assert [*grades.values()] == ["", "0", *[f"7{mark}25"] * 20]
    changed = {
        read[0][column]
        for old_row, new_row in zip(read, written, strict=True)
        for column, (old, new) in enumerate(zip(old_row, new_row, strict=True))
        if old != new
    }
    feedback = ["Feedback comments"] if language == "English" else []
    assert changed == {WORDS_OF_MOODLE[language][1], *feedback}


def test_canvas_takes_back_its_gradebook() -> None:
    content = roster_of(CASES["rosters"]["gradebook of Canvas"])
    ids = [fields["canvas"] for fields in class_for(["", ""])]
    points: dict[str, float | None] = {name: float(n) for n, name in enumerate(ids)}
    rows = cells_of(filled(content, points | {ids[3]: None}, {}), "utf-8", ",")
    heads, possible, test_student, *students = rows
    assert "Student" in heads[0]
    assert "ID" in heads[1]
    assert heads[4:] == ["Section", "Week 1 (90210)"]
    assert (possible[0], possible[5]) == ("    Points Possible", "20.00")
    assert test_student == ["Student, Test", "4999", "", "0f9d8c7b6a", "LP26", ""]
    grades = {row[1]: row[5] for row in students}
    assert grades == {name: f"{n}" * (n != 3) for n, name in enumerate(ids)}
    assert [row[0] for row in students][:2] == ["Placeholder, Alma", "Müßiggänger, Jörg"]


def test_blackboard_takes_back_its_gradebook() -> None:
    content = roster_of(CASES["rosters"]["gradebook of Blackboard, UTF-16"])
    written = filled(content, {"s1002": 12.5}, {})
    rows = cells_of(written, "utf-16", "\t")
    assert [row[5] for row in rows[:4]] == [
        "Week 1 [Total Pts: 20 Score] |123456",
        "Needs Grading(0.00)",
        "12.5",
        "Needs Grading(0.00)",
    ]


CANVAS = "Student,ID,SIS Login ID,Section,{}\n    Points Possible,,,,20,20\n"


@pytest.mark.parametrize(
    ("roster", "columns", "column", "note"),
    [
        (CANVAS.format("Week 1 (1),Week 2 (2)") + "A B,1,a,s,,\n", {}, 4, ""),
        (CANVAS.format("Week 2 (2),week 1 (1)") + "A B,1,a,s,,\n", {}, 5, ""),
        (CANVAS.format("Week 3 (3),Week 2 (2)") + "A B,1,a,s,,\n", {}, None, "Which column"),
        (CANVAS.format("W3 (3),W2 (2)") + "A B,1,a,s,,\n", {"points": "W2 (2)"}, 5, ""),
        ("id,name,Grade,Maximum grade\n1,Ada,,100\n", {}, 2, "The most is 100 points, but"),
        ("id,name,grade\n1,Ada,-\n", {}, 2, ""),
        ("id,name,note\n1,Ada,moved to Tuesday\n", {}, None, ""),
        ("id,name\n1,Ada\n", {}, None, ""),
        ("Wer;Nr\n", {"id": "Nr"}, None, ""),
    ],
)
def test_the_column_for_points_is_clear_or_asked_for(
    roster: str, columns: dict[str, str], column: int | None, note: str
) -> None:
    table = read_table("r.csv", roster.encode(), ["id"], ["name"], columns)
    gradebook, notes = gradebook_of(table, "digest", "Week 1", 20)
    assert (gradebook.points if gradebook else None) == column
    assert bool(notes) == bool(note)
    assert note in "".join(notes)


def test_what_a_teacher_wrote_and_what_a_spreadsheet_needs_stays() -> None:
    content = "sep=;\nid;name;Grade;Comment\n1;Ada;;Call me\n2;Ben;;\n\n3;Cem\n".encode("utf-8-sig")
    written = filled(content, {"1": 5.0, "2": 5.0, "3": 5.0}, dict.fromkeys("123", "Good"))
    lines = [
        "sep=;",
        "id;name;Grade;Comment",
        "1;Ada;5;Call me",
        "2;Ben;5;Good",
        "",
        "3;Cem;5;Good",
    ]
    assert written.decode("utf-8-sig").split("\r\n") == [*lines, ""]


def test_grading_writes_what_moodle_takes_back(tmp_path: Path) -> None:
    heads = "Identifier,Full name,Grade,Last modified (grade),Feedback comments\n"
    names = {"11": "Ada <b>", "12": "Ben_Lee", "13": "Cem"}
    worksheet = "".join(f"Participant {n},{name},,-,\n" for n, name in names.items())
    files = {
        "a.toml": ASSIGNMENT,
        "lane.toml": lane("A lane"),
        "w.csv": heads + worksheet,
        "in/Ada b_11_assignsubmission_file_/lane.l": FIRST_STEPS,
        "in/Ben Lee_12_assignsubmission_file_/lane.l": STANDING,
        "in/Cem_13_assignsubmission_file_/essay.docx": "not a program",
    }
    write_files(tmp_path, files)
    out = tmp_path / "out"
    (out / "upload").mkdir(parents=True)
    (out / "upload/old.csv").write_text("of an earlier class")
    arguments = ["grade", f"{tmp_path}/a.toml", f"{tmp_path}/in", "-o", f"{out}"]
    assert main(arguments) == 0
    assert sorted(file.name for file in (out / "upload").iterdir()) == ["feedback.zip", "w.csv"]
    rows = cells_of((out / "upload/w.csv").read_bytes(), "utf-8", ",")
    assert [row[2] for row in rows] == ["Grade", "10", "0", ""]
    assert rows[1][4].startswith("<p>Ada &lt;b&gt;: 10 of 10 points</p>")
    with zipfile.ZipFile(out / "upload/feedback.zip") as archive:
        parts = [name.split("/") for name in archive.namelist()]
        pages = [archive.read(name).decode() for name in archive.namelist()]
    assert [(folder.split("_", 4)[1:4], file) for folder, file in parts] == [
        (["11", "assignsubmission", "file"], "feedback.html"),
        (["12", "assignsubmission", "file"], "feedback.html"),
    ]
    assert "0 of 10 points" in pages[1]
