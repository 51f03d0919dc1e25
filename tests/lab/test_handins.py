"""Hand-ins as they come: exports, archives, names, and a roster that is matched before it runs."""

import io
import tarfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.classroom import student_of
from logical_robots_tui.lab.folder import Manifest, digest
from logical_robots_tui.lab.grading import duplicates
from logical_robots_tui.lab.handins import Submission, entries_of, normalise, stems_of
from logical_robots_tui.lab.submissions import account_of, plan_grading
from logical_robots_tui.toml_files import TomlFileError
from tests.cli.running import Command
from tests.installed import CHECKOUT
from tests.lab.laboratory import write_files

Files = Mapping[str, str | bytes]

FIRST, SECOND = "01-first-steps", "02-open-space"
STEMS = stems_of([FIRST, SECOND])
ROSTER = "id,name\n1001,Ada Lovelace\n1002,Zoë Müller\n1003,Cem Aydin\n"


def zipped(files: Mapping[Any, str | bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def tarred(files: Mapping[str, str], mode: str = "w:gz") -> bytes:
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode=mode) as archive:  # type: ignore[call-overload] # literals only
        for name, content in files.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content.encode()))
    return out.getvalue()


def only(folder: Path, files: Files) -> Submission:
    (submission,) = entries_of(write_files(folder, files), STEMS).values()
    return submission


def planned(folder: Path, files: Files, roster: str = ROSTER, more: str = "") -> Manifest:
    text = f'[assignment]\nroster = "roster.csv"\n{more}\n[[level]]\nname = "{FIRST}"\n'
    text += f'[[level]]\nname = "{SECOND}"\n'
    write_files(folder, {"roster.csv": roster, "a.toml": text})
    manifest, _ = plan_grading(folder / "a.toml", write_files(folder / "submissions", files))
    return manifest


BOTH = {FIRST: "one", SECOND: "two"}
SHAPES: dict[str, Files] = {
    "a folder": {"ada/01-first-steps.l": "one", "ada/Open_Space.L": "two"},
    "one folder down": {"ada/week 1/first-steps.l": "one", "ada/week 1/open-space.l": "two"},
    "a zip": {"ada.ZIP": zipped({"01-first-steps.l": "one", "02-open-space.l": "two"})},
    "a zip of Windows": {"ada.zip": zipped({r"w\first-steps.l": "one", r"w\open-space.l": "two"})},
    "a tar": {"ada.tgz": tarred({"./first-steps.l": "one", "./open-space.l": "two"})},
    "an xz": {"ada.tar.xz": tarred({"first-steps.l": "one", "open-space.l": "two"}, "w:xz")},
    "archives in a folder": {
        "ada/1.zip": zipped({"first-steps.l": "one"}),
        "ada/2.tar": tarred({"a/open-space.l": "two"}, "w"),
    },
    "what macOS packs": {
        "ada.zip": zipped(
            {"ada/": "", "ada/first-steps.l": "one", "ada/open-space.l": "two"}
            | {"__MACOSX/ada/._first-steps.l": "\0\5\x16\7", "ada/.DS_Store": ""}
        )
    },
}


@pytest.mark.parametrize("shape", SHAPES)
def test_one_student_hands_in(tmp_path: Path, shape: str) -> None:
    found = only(tmp_path, SHAPES[shape])
    assert (found.owner.key, found.programs, found.remarks) == ("ada", BOTH, [])


STARTER = (CHECKOUT / "programs/first-steps-starter.l").read_text("utf-8")
ONE = 'A("one");\n'
NAMES: list[tuple[Files, dict[str, str], str]] = [
    ({"my-first-steps-starter.l": ONE, "aufgabe2 final.l": "two"}, {FIRST: ONE, SECOND: "two"}, ""),
    ({"01-first-steps.l.txt": ONE, "Open space.TXT": "two"}, {FIRST: ONE, SECOND: "two"}, ""),
    ({"01-first-steps.l": ONE, "mine.l": "two"}, {FIRST: ONE, SECOND: "two"}, ""),
    (
        {"01-first-steps.l": ONE.encode("utf-16")},
        {FIRST: ONE},
        "",
    ),
    ({"01-first-steps.l": "A('\xfc');\rB();".encode("cp1252")}, {FIRST: "A('\xfc');\nB();"}, ""),
    ({"week 1.l": ONE}, {"": ONE}, ""),
    (
        {"first-steps.l": "x", "first-steps (1).l": ONE, "first-steps final.txt": "y"},
        {FIRST: "x"},
        "first-steps.l was graded, not first-steps",
    ),
    ({"first-steps.l": STARTER, "my first steps.l": ONE}, {FIRST: ONE}, ""),
    (
        {"first-steps.l": STARTER},
        {FIRST: STARTER},
        "first-steps.l is the level's starter, unchanged",
    ),
    ({"a.l": ONE, "b.l": ONE}, {}, "?a.l is not named after a level"),
    ({"level 1 or 2.l": ONE, "b.l": ONE}, {}, "?b.l is not named after a level"),
    ({"05-lighthouse.l": ONE, "open-space.l": "two", "09-doors.l": ONE}, {SECOND: "two"}, ""),
    ({"05-lighthouse.l": ONE}, {}, "?there is no program (*.l) in it, only 05-lighthouse.l"),
    ({"Aufgabe 1.docx": "PK"}, {}, "?there is no program (*.l) in it, only Aufgabe 1.docx"),
    ({"readme.md": "x", "first-steps.l": ONE}, {FIRST: ONE}, ""),
    ({"02.pdf": "x", "first-steps.l": ONE}, {FIRST: ONE}, "?"),
    (
        {"first-steps.l": "#" * 200_001},
        {},
        "?first-steps.l has 200,001 characters, more",
    ),
]
"""Files of a student, the texts by level, and a remark, with a ? if what lacks is ungraded."""


@pytest.mark.parametrize(("files", "programs", "remark"), NAMES)
def test_a_level_is_found_where_it_is_clear(
    files: Files, programs: dict[str, str], remark: str, tmp_path: Path
) -> None:
    folder = write_files(tmp_path, {f"ada/{name}": content for name, content in files.items()})
    (entry,) = entries_of(folder, STEMS, "", {FIRST: normalise(STARTER)}).values()
    assert (entry.programs, entry.is_unclear) == (programs, remark.startswith("?"))
    assert "".join(entry.remarks).startswith(remark.removeprefix("?"))
    assert bool(entry.remarks) == (remark not in ("", "?"))


def test_an_export_needs_not_be_unpacked(tmp_path: Path) -> None:
    files: dict[str, str] = {"class/ada/first-steps.l": "one", "class/ben.l": "all"}
    cem: Files = {"class/cem.zip": zipped({"first-steps.l": "one"})}
    programs = {"ada": {FIRST: "one"}, "ben": {"": "all"}}
    for name, content, more in (
        ("submissions.zip", zipped({**files, **cem}), {"cem": {FIRST: "one"}}),
        ("submissions.tar.gz", tarred(files), {}),
    ):
        file = tmp_path / name
        file.write_bytes(content)
        found = {key: entry.programs for key, entry in entries_of(file, STEMS).items()}
        assert found == programs | more


def test_a_pattern_says_how_files_are_named(tmp_path: Path) -> None:
    files: Files = {
        "Ada_Lovelace_1001_first_steps.l": "one",
        "Ada_Lovelace_1001_02-open-space.L": "two",
        "deep/Ben_1002_bonus.l": "three",
        "Cem_1003_all.zip": zipped({"first-steps.l": "four"}),
        "notes.txt": "",
    }
    found = entries_of(write_files(tmp_path / "submissions", files), STEMS, "{name}_{id}_{level}.l")
    assert {name: entry.programs for name, entry in found.items()} == {
        "Ada_Lovelace_1001": BOTH,
        "Ben_1002": {"": "three"},
        "Cem_1003": {FIRST: "four"},
        "notes.txt": {},
    }
    folder = write_files(tmp_path / "attempts", {"W_1001_attempt_9_first-steps.l": "one"})
    assert [*entries_of(folder, STEMS, "W_{id}_*_{level}.l")] == ["1001"]
    for wrong in ("{level}.l", "{who}_{id}", "{id}_{id}"):
        with pytest.raises(TomlFileError, match=r"a\.toml:3: .*pattern"):
            planned(tmp_path, files, more=f'pattern = "{wrong}"')


def test_texts_are_compared_within_a_level(tmp_path: Path) -> None:
    manifest = planned(tmp_path, {"1001/01.l": "A();", "1001/02.l": "A();  # the same"})
    assert [cell.own for cell in manifest.cells] == ["", ""]  # else one would run for nobody


def test_two_of_one_name_are_not_guessed(tmp_path: Path) -> None:
    files = {"x_11_assignsubmission_file_/a.l": "", "ada_22_assignsubmission_file_/a.l": ""}
    manifest = planned(tmp_path, files, "id,name\n1,Ada\n2,Ada\n")
    assert [student.submission for student in manifest.students] == ["", "", "ada_22", "x_11"]
    assert "ada_22 fits several: Ada (1), Ada (2)" in account_of(manifest)
    names = [student_of(manifest, query).id for query in ("22", "X_1")]
    assert names == ["ada_22", "x_11"]


METADATA = """
sub_77:
  :submitters:
  - :name: Ada Lovelace
    :sid: '1001'
  - :name: Zoë Müller
    :sid: ''
sub_78:
  :submitters:
  - :name: Cem O'Aydin
"""
TEAMS = "id,name,Gruppe\n1,Ada,Gruppe A\n2,Ben,Gruppe A\n3,Cem,Gruppe B\n4,Dot,Gruppe B\n"


@pytest.mark.parametrize(
    ("files", "roster", "programs"),
    [
        (
            {"submission_metadata.yml": METADATA, "sub_77/x.l": "1", "sub_78/x.l": "2"},
            ROSTER.replace("Cem Aydin", "Cem O'Aydin"),
            "112",
        ),
        ({"Gruppe A_55_assignsubmission_file_/x.l": "1", "gruppe b.l": "2"}, TEAMS, "1122"),
        ({"ben/x.l": "1", "cem.l": "2", "hw1_dot.l": "3"}, TEAMS, "1123"),
    ],
)
def test_every_member_of_a_group_gets_the_result(
    files: Files, roster: str, programs: str, tmp_path: Path
) -> None:
    manifest = planned(tmp_path, files, roster)
    texts = {cell.student: cell.program for cell in manifest.cells}
    own = [texts[student.id] for student in manifest.students]
    assert own == [digest(program) for program in programs]
    assert duplicates(manifest) == []


@pytest.mark.parametrize(
    ("roster", "note"),
    [
        ("\ufeffid,submision\nada,x\n", 'The column "submision" is not known. Did you mean "sub'),
        ('id;"a,b,c";submision\nada;"x;y";z\n', 'The column "submision" is not known. Did'),
        ("sep=\t\nid\tname\nada\t\n", ""),
        ("Kennung,Wer\nada,Ada Byron\nben,B O\n", '"Wer" is taken for the name, "Ken'),
        ("nr,Kennung\n1,ada\n", ""),
    ],
)
def test_tables_of_spreadsheets_are_rosters(roster: str, note: str, tmp_path: Path) -> None:
    more = 'columns = {id = "Kennung"}' if roster.startswith("nr") else ""
    for end in ("\n", "\r\n"):
        manifest = planned(tmp_path, {"ada.l": "one"}, roster.replace("\n", end), more)
        assert manifest.students[0].submission == "ada"
        assert "".join(account_of(manifest)[1:]).startswith(f"roster.csv: {note}" if note else "")


@pytest.mark.parametrize(
    "name", ["hw1_s1004", "s1004-hw1", "OSecond_Ben_LP_1", "O Second Ben 1", "week-1-s1004/a"]
)
def test_an_id_or_a_name_may_be_anywhere(name: str, tmp_path: Path) -> None:
    roster = "id,name\ns1004,Ben O'Second\ns100,Ann Lee\ns1005,Lee Ann Chu\n"
    files = {f"{name}.l": "1", "x Chu Lee Ann.l": "2", "01 Lee_Ann.l": "3", "02 lee ann.l": "4"}
    manifest = planned(tmp_path, files, roster)
    assert [cell.program for cell in manifest.cells] == [digest(t) for t in "113422"]


@pytest.mark.parametrize(
    ("file", "roster"),
    [
        *(("ada", f"submission\n7,{name}\n") for name in ("ada", "ADA.l", "ada.zip", "Ada.tar.gz")),
        ("dorde oeuvre", "name\n7,Đorđe Œuvré\n"),
        ("thaedan gross", "name\n7,Þæðan Groß\n"),
    ],
)
def test_a_submission_is_matched_without_marks(tmp_path: Path, file: str, roster: str) -> None:
    manifest = planned(tmp_path, {f"{file}.l": "one"}, f"id,{roster}")
    assert [(student.id, student.submission) for student in manifest.students] == [("7", file)]


def test_before_it_runs_it_says_who_was_matched(tmp_path: Path, command: Command) -> None:
    right = "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}) :- Sensor(robot_name:);"
    files: Files = {
        "1001.zip": zipped({"first-steps.l": right}),
        "1002/steps.txt": right,
        "stranger.l": right,
        "notes.docx": "",
    }
    warning, account, *remarks = account_of(planned(tmp_path, files))
    assert warning.startswith("Of 3 students only 1 can be graded. Compare the roster with")
    assert account == (
        "3 in the roster, 2 matched; not matched: Cem Aydin (1003); "
        "files matched to no student: stranger, notes.docx"
    )
    assert remarks == ["Zoë Müller (1002): there is no program (*.l) in it, only steps.txt"]
    paths = tmp_path / "a.toml", tmp_path / "submissions"
    told = command("grade", *paths, "-o", tmp_path / "out", status=1)
    assert told.out.startswith(f"{warning}\n{account}")
    why = (
        "Ungraded:\n  Zoë Müller (1002): 01-first-steps: it is not clear which file is the program"
    )
    assert why in told.out
    assert why in command("lab", "status", tmp_path / "out", status=1).out
    assert command("lab", "report", tmp_path / "out").status == 1
    assert account in (tmp_path / "out/report.html").read_text("utf-8")
    feedback = (tmp_path / "out/feedback/1002.md").read_text("utf-8")
    assert "nothing was submitted" not in feedback
    assert "- It is not clear which file is the program for this level." in feedback


def test_nothing_was_submitted_only_if_nothing_is_left_over(tmp_path: Path) -> None:
    files: Files = {"1001.l": "", "1002.l": ""}
    manifest = planned(tmp_path, files)
    assert manifest.students[2].remarks == ("nothing was submitted",)
    account = "3 in the roster, 2 matched; nothing was handed in by Cem Aydin (1003)"
    assert account_of(manifest) == [account]
    more = planned(tmp_path, {**files, "essay.docx": ""}).students[2].remarks
    assert more == ("no submission could be matched to this student",)


def test_where_there_is_nothing_at_all_nobody_is_graded(tmp_path: Path) -> None:
    (tmp_path / "submissions").mkdir()
    with pytest.raises(InputError, match="submissions: There are no submissions in it"):
        planned(tmp_path, {})
    with pytest.raises(InputError, match=r"a\.toml: .* The assignment comes first"):
        plan_grading(tmp_path / "submissions", tmp_path / "a.toml")


def test_what_can_not_be_read_is_said(tmp_path: Path) -> None:
    assert only(tmp_path / "a", {"ada.zip": b"PK no zip"}).remarks == ["ada.zip: it is damaged"]
    assert only(tmp_path / "b", {"ada.zip": zipped({})}).remarks == ["ada.zip: it is empty"]
    two = only(tmp_path / "c", {"ada/first-steps.l": "1", "ada/old/first-steps.l": "2"})
    assert two.programs == {FIRST: "1"}
    assert two.remarks == ["first-steps.l was graded, not old/first-steps.l"]
    with pytest.raises(InputError, match=r"Several entries have this name: ada, ada\.zip"):
        only(tmp_path / "e", {"ada/x.l": "", "ada.zip": zipped({"x.l": ""})})


@pytest.mark.parametrize(
    ("metadata", "message"),
    [
        ("#" * 1_000_001, "submission_metadata.yml can't be read: it is larger than 1 MB"),
        ("a: &a 1\nb: *a\n", "submission_metadata.yml, line 2: This YAML can't be read: an alias"),
        ("a: " + "[" * 30, "line 1: This YAML can't be read: nested too deeply"),
        ("a:\n  b: 'x\n", "line 3: This YAML can't be read: found unexpected end of stream"),
        ("a: \x01", "This YAML can't be read: "),
    ],
)
def test_metadata_that_can_not_be_read_are_refused(
    metadata: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError) as refusal:
        planned(tmp_path, {"s1/first-steps.l": "", "submission_metadata.yml": metadata})
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    "metadata", ["", "a", "- a", "a: {b: c}", "s1: {? [x] : y}", "s1: {a: {}}"]
)
def test_metadata_of_nobody_leave_submissions_as_they_are(metadata: str, tmp_path: Path) -> None:
    files = {"1001/first-steps.l": "", "submission_metadata.yml": metadata}
    assert planned(tmp_path, files).students[0].submission == "1001"
