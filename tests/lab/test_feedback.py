"""What a teacher adds to grades, and what a student reads before and after."""

import json
import os
import re
from contextlib import nullcontext
from datetime import UTC, datetime
from pathlib import Path
from typing import get_args

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.explain.diagnosis.telling import FindingKind
from logical_robots_tui.game.victory import reference_table
from logical_robots_tui.lab.exporting import parts_as_markdown
from logical_robots_tui.lab.folder import Student
from logical_robots_tui.lab.grading import QUESTIONS
from logical_robots_tui.lab.submissions import Late, plan_grading
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.toml_files import TomlFileError
from tests.cli.running import Command
from tests.lab.laboratory import FIRST_STEPS, STANDING, rows, write_files

ASSIGNMENT = Path(__file__).with_name("feedback.toml").read_text("utf-8")
TIMES = ("--file-times", "--late-anyway")


@pytest.fixture
def assignment(tmp_path: Path) -> tuple[Path, Path]:
    """Three students who were all too late, but one had more time."""
    files = {
        "a.toml": ASSIGNMENT,
        "roster.csv": "id,name\nada,Ada\nben,Ben\ncem,Cem\n",
        "extensions.csv": "id,until\nben,2026-02-01T12:00:00+00:00\n",
        "by-hand.csv": "id;points;reason\nada;1,5;neat\nada;-0.5;\nben;3;\n",
        **{f"all/{name}.l": FIRST_STEPS for name in ("ada", "ben")},
        "all/cem.l": STANDING,
    }
    folder = write_files(tmp_path, files) / "all"
    changed = datetime(2026, 1, 31, 13, 2, 3, tzinfo=UTC).timestamp()
    for file in folder.iterdir():
        os.utime(file, (changed, changed))
    return tmp_path / "a.toml", folder


def test_points_are_told_part_by_part(assignment: tuple[Path, Path], command: Command) -> None:
    out = assignment[1].parent / "out"
    for _ in range(2):  # what was added by hand survives that
        graded = command("grade", *assignment, "-o", out, *TIMES).success
        (count,) = re.findall(r"a: \d+ runs done, .*", graded)
        assert count in command("lab", "report", out).success
        ada, ben, cem = rows(out / "gradebook.csv")
        assert (ada["points"], ada["late"], ada["by_hand"]) == ("6.0", "true", "1.0")
        assert (ben["points"], ben["late"], cem["points"]) == ("10.0", "false", "0.0")
    assert (out / "gradebook.csv").read_bytes().startswith(b"\xef\xbb\xbfid,name,")
    feedback = (out / "feedback/ada.md").read_text()
    assert "6 of 10 points (1 hour 2 minutes late; 50% counts)" in feedback
    assert "+1.5 points by hand: neat" in feedback.replace("\\", "")
    lost = (out / "feedback/cem.md").read_text().replace("\\", "")
    assert "Ada ended at (" in lost
    assert "and had stood there since tick 0." in lost
    assert "logical-robots play 01-first-steps YOUR-PROGRAM" in lost
    # Each part of the points is told with its number and the reference.
    text = ASSIGNMENT.replace("by_hand", "#") + "[points]\nwon = 5\nticks = 3\nsize = 2\n"
    text = text.replace("points = 10", "points = 20") + "home = 4\ntime_home = 3\nbest_start = 3\n"
    assignment[0].write_text(text.replace("keep = 0.5", ""))
    assert command("grade", *assignment, "-o", out, *TIMES).status == 0
    won, lost = ((out / f"feedback/{name}.md").read_text() for name in ("ben", "cem"))
    first = reference_table()["01-first-steps"]["first-steps"]
    size = size_of(FIRST_STEPS)
    assert "- 5 of 5 points for winning: won from the given start.\n" in won
    ticks = f"{first.ticks:,} ticks; the reference program has {first.ticks:,}.\n"
    assert f"- 3 of 3 points for ticks: {ticks}" in won
    points = f"{2 * min(1, first.size / size):.2f}".rstrip("0").rstrip(".")
    symbols = f"{size} symbols; the reference program has {first.size}.\n"
    assert f"- {points} of 2 points for size: {symbols}" in won
    assert "- 0 of 3 points for ticks: not won from the given start.\n" in lost
    for share, part, words in (("100%", 1, won), ("0%", 0, lost)):
        told = f"{share} of the robots at once; the reference program has 100%.\n"
        assert f"- {4 * part} of 4 points for robots home: {told}" in words
        assert f"- {3 * part} of 3 points for best start: {told}" in words
    best = 100 * (1 - (first.ticks - 1) / (2 * first.ticks + 200))
    told = f"of the time; the reference program has at least {best:.1f}%.\n"
    assert f"- 3 of 3 points for time home: {best:.1f}% {told}" in won
    assert f"- 0 of 3 points for time home: 0.0% {told}" in lost


HOUR = 3600
DAILY = Late(per_day=0.2, days=1, grace=15)


@pytest.mark.parametrize(
    ("late", "student", "share", "rule"),
    [
        (Late(keep=0.5), Student("a", late=True), 0.5, "50% counts"),
        (Late(), Student("a", late=True, late_by=60), 1, "100% counts"),
        (DAILY, Student("a", late_by=600), 1, "within 15 minutes of grace"),
        (DAILY, Student("a", late_by=9 * HOUR, grace_days=2), 1, "1 of 2 grace days used"),
        (
            DAILY,
            Student("a", late=True, late_by=49 * HOUR, grace_days=1),
            0.6,
            "20% less for each day after 1 grace day: 60% counts",
        ),
        (
            Late(per_day=0.4, keep=0.3),
            Student("a", late=True, late_by=25 * HOUR),
            0.3,
            "40% less for each day: 30% counts",
        ),
        (DAILY, Student("a", late=True), 0.8, "20% less for each day: 80% counts"),
    ],
)
def test_the_rule_for_late_submissions_is_told(
    late: Late, student: Student, share: float, rule: str
) -> None:
    kept, words = late.rule(student)
    assert (round(kept, 9), words) == (share, rule)


@pytest.mark.parametrize(
    ("minutes", "late", "options", "refusal"),
    [
        ([0, 1, 1440], "", {}, "When the submissions were handed in is not known"),
        ([0, 1, 1440], "c", {"file_times": True}, ""),
        ([0, 1440, 2000], "bc", {"file_times": True}, "2 of 3 submissions are late"),
        ([0, 1440, 2000], "bc", {"file_times": True, "late_anyway": True}, ""),
        ([0, 0, 0], "", {"file_times": True}, "All submissions are of 2026-01-31 13:00:00+00:00"),
    ],
)
def test_suspicious_times_stop_it(
    minutes: list[int], late: str, options: dict[str, bool], refusal: str, tmp_path: Path
) -> None:
    text = ASSIGNMENT.replace("by_hand", "#").replace("roster", "#").replace("extensions", "#")
    write_files(tmp_path, {"a.toml": text.replace("12:00:00Z", "13:05:00Z\ngrace = 3")})
    for name, minute in zip("abc", minutes, strict=True):
        write_files(tmp_path, {f"all/{name}.l": STANDING})
        time = datetime(2026, 1, 31, 13, tzinfo=UTC).timestamp() + 60 * minute
        os.utime(tmp_path / f"all/{name}.l", (time, time))
    with pytest.raises(InputError, match=re.escape(refusal)) if refusal else nullcontext():
        manifest, _ = plan_grading(tmp_path / "a.toml", tmp_path / "all", **options)
        assert "".join(s.id for s in manifest.students if s.late) == late


def test_a_time_that_one_student_wrote_does_not_count(tmp_path: Path) -> None:
    text = ASSIGNMENT.replace("by_hand", "#").replace("roster", "#").replace("extensions", "#")
    write_files(tmp_path, {"a.toml": text, **{f"all/{name}/a.l": STANDING for name in "abc"}})
    for name, moment in zip("abc", ("12:00", "13:00", "11:00"), strict=True):
        with pytest.raises(InputError, match="When the submissions were handed in is not known"):
            plan_grading(tmp_path / "a.toml", tmp_path / "all")
        stamp = f"2026-01-31 {moment}:00.000000 UTC"
        write_files(tmp_path, {f"all/{name}/timestamp.txt": stamp})
    manifest, _ = plan_grading(tmp_path / "a.toml", tmp_path / "all")
    assert [s.id for s in manifest.students if s.late] == ["b"]


def test_a_loss_is_asked_about_and_drawn(assignment: tuple[Path, Path], command: Command) -> None:
    out = assignment[1].parent / "out"
    text = "Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.forward_distance < 0;\n"
    driving = "{left_engine: 1, right_engine: 1}"
    text += f'Robot(robot_name:, desire: {driving}, memory: "") :- Sensor(robot_name:), ~Near();'
    (assignment[1] / "cem.l").write_text(text.replace("~Near()", "~Near(robot_name:)"))
    assert command("grade", *assignment, "-o", out, *TIMES).status == 0
    lost = (out / "feedback/cem.md").read_text()
    assert "\\`" not in lost
    assert "- Line 1: The rule of Near in line 1 never had a row: " in lost
    assert f"- Line 2: Ada was blocked from tick 302 to 513, mostly with `{driving}`. Which" in lost
    pages = {file.stem: file.read_text() for file in (out / "feedback").glob("*.html")}
    assert f"mostly with <code>{driving}</code>. Which rule decided" in pages["cem"]
    path = re.search('<polyline points="([^"]*)"', pages["cem"])
    assert path is not None
    assert path[1].endswith(" 364.0,20.0")
    assert "<svg" not in pages["ada"]
    for page in pages.values():
        assert not any(outside in page for outside in ("<script", "href=", "src=", "url("))
    data = json.loads((out / "feedback/cem.json").read_text())
    questions = [question[:7] for question in data["levels"][0]["questions"]]
    assert questions == ["Line 1:", "Line 2:", "Line 2:"]
    text = ASSIGNMENT.replace("starts = 0", 'starts = 0\nshow = ["size"]')
    assignment[0].write_text(text)
    assert command("grade", *assignment, "-o", out, *TIMES).status == 0
    assert "blocked" not in (out / "feedback/cem.json").read_text()
    assert "<svg" not in (out / "feedback/cem.html").read_text()


@pytest.mark.parametrize(
    ("said", "written"),
    [
        ("`a_b{c}` is <b>", r"`a_b{c}` is \<b\>"),
        ("`a` and ` left", r"`a` and \` left"),
        ("``[x]``", r"\``[x]`\`"),
        (r"`\` *x*", r"`\` \*x\*"),
    ],
)
def test_code_in_feedback_is_as_it_was_and_nothing_else_is_markup(said: str, written: str) -> None:
    assert parts_as_markdown("", [(said, [])]) == f"# \n\n{written}\n"


def test_there_is_a_question_about_each_kind_of_finding() -> None:
    assert {*QUESTIONS} == {*get_args(FindingKind)}
    assert all(question.endswith("?") for question in QUESTIONS.values())


def test_how_a_run_ended_is_said_in_words(assignment: tuple[Path, Path], command: Command) -> None:
    file, folder = assignment
    text = ASSIGNMENT.replace("01-first-steps", "my-level.toml").replace("starts = 0", "starts = 2")
    text = text.replace("[assignment]", "[assignment]\nticks = 99") + "[points]\nstarts = 1\n"
    level = (shipped_folder("levels") / "01-first-steps.toml").read_text("utf-8")
    start = '[[areas]]\nname = "Start"\nx = 66\ny = 62\nradius = 9\ngoal_for = ["Ada"]\n'
    level = f"all_goals = true\n{level}{start}"
    write_files(file.parent, {"a.toml": text, "my-level.toml": level})
    (folder / "cem.l").rename(folder / "x.l")
    programs = {
        "ada.l": STANDING,
        "ben.l": "Robot(",
        "cem/1.l": FIRST_STEPS,
        "cem/2.l": FIRST_STEPS,
    }
    write_files(folder, programs)
    assert command("grade", file, folder, "-o", folder / "../out", *TIMES).status == 0
    feedback = file.with_name("out") / "feedback"
    ada, ben, cem = ((feedback / f"{name}.md").read_text() for name in ("ada", "ben", "cem"))
    untried = "varied starts: not tried, because it was not won from the given start.\n"
    assert f"- 0 of 5 points for {untried}" in ada
    ended = "- The run ended at tick 2: nothing could change any more.\n"
    assert f"{ended}- Most at once: 1 of 2, tick 1.\n- Ada ended at (66, 62)" in ada
    assert "- To see that: logical-robots play my-level.toml YOUR-PROGRAM\n" in ada
    assert "- Your program does not compile:\n- line 1: " in ben
    assert "- It is not clear which file is the program for this level.\n" in cem
    assert "- 1.l is not named after a level\n" in cem


def test_one_student_is_run_before_others(assignment: tuple[Path, Path], command: Command) -> None:
    out = assignment[1].parent / "out"
    run = ("grade", *assignment, "-o", out, *TIMES)
    for student in ("Cem", "EM"):
        assert "# a\n\nCem: 0 of 10 points" in command(*run, "--student", student).success
    assert not (out / "gradebook.csv").exists()
    assert command("lab", "status", out).status == 1  # the others are left
    assert command(*run, "--student", "Dot").status == 2


def test_what_is_wrong_with_the_tables_is_said(assignment: tuple[Path, Path]) -> None:
    folder = assignment[0].parent

    def problems(*tables: str) -> list[str]:
        names = ("extensions.csv", "by-hand.csv", "roster.csv")
        write_files(folder, dict(zip(names, tables, strict=False)))
        with pytest.raises(TomlFileError) as caught:
            plan_grading(*assignment, late_anyway=True)
        return [problem.removeprefix(f"{folder}/") for problem in caught.value.problems]

    assert problems("id,until\nben,tomorrow\n", "id;points\nada;1\n\nada;many\n") == [
        "extensions.csv:2: until for ben must be like 2026-01-31T23:59:00+01:00.",
        "by-hand.csv:4: points for ada must be a number.",
    ]
    until = "2026-02-01T12:00:00+00:00\n"
    first = "the first line names the columns"
    assert problems(f"id,unitl\nben,{until}", "i\nada\n", "when\na day\na day\n") == [
        f'roster.csv:1: There is no column "id"; {first}: when.',
        f'by-hand.csv:1: There is no column "id"; {first}: i.',
        "extensions.csv:2: until for ben must be like 2026-01-31T23:59:00+01:00.",
    ]
    twice = problems("id,until\n", "id,points\n", "id\nada\nben\nada\n")
    assert twice == ["roster.csv:4: ada is there twice."]
    assert problems(f"id,until\nbenn,{until}", "id,points\nxyz,1\n", "id\nada\nben\n") == [
        'extensions.csv:2: benn is not among the students. Did you mean "ben"?',
        "by-hand.csv:2: xyz is not among the students.",
    ]
