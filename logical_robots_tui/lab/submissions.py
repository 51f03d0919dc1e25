"""From an assignment and a folder of submissions to programs in levels."""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, TypeAlias, TypeVar, get_args

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX, shipped_texts
from logical_robots_tui.game.victory import reference_for
from logical_robots_tui.lab.folder import BUILT_IN, Cell, Manifest, Student, digest
from logical_robots_tui.lab.handins import (
    MOST_BYTES,
    Submission,
    entries_of,
    normalise,
    readable,
    stems_of,
)
from logical_robots_tui.lab.platforms.dates import parse_date
from logical_robots_tui.lab.platforms.exports import pattern_problem
from logical_robots_tui.lab.platforms.gradebooks import gradebook_of
from logical_robots_tui.lab.platforms.tables import (
    NO_TIME,
    StudentRow,
    StudentTable,
    TableError,
    number_of,
    read_table,
)
from logical_robots_tui.lab.sweeping import Name, Positive, RunLimit, Starts, level_to_run
from logical_robots_tui.language.diagnostics import printable
from logical_robots_tui.paths import did_you_mean, read_ordinary
from logical_robots_tui.toml_files import Bounds, Given, TomlFile
from logical_robots_tui.wording import count_of
from logical_robots_tui.world.levels.load import SUFFIXES

T = TypeVar("T")

_MOST_REMARKS = 20
_DAY = 86_400.0
_ROSTER, _BY_HAND = ("assignment", "roster"), ("assignment", "by_hand")
_DATE_FORM = "like 2026-01-31T23:59:00+01:00"
_TABLES: dict[tuple[str, str], tuple[tuple[str, ...], tuple[str, ...]]] = {
    _ROSTER: (("id",), ("name", "submission", "group")),
    ("late", "students"): (("id",), ()),
    ("late", "extensions"): (("id",), ("until", "days")),
    _BY_HAND: (("id", "points"), ("reason",)),
}
"""By the keys that name tables, the columns that they need and those that they may have."""

Share: TypeAlias = Annotated[float, Bounds(0)]


class LevelTable(msgspec.Struct, frozen=True):
    name: Name
    points: Share = 10.0


class Split(msgspec.Struct, frozen=True):
    """``[points]``: how the points of a level are split; only the proportions matter."""

    won: Share = 1.0
    starts: Share = 0.0
    home: Share = 0.0
    time_home: Share = 0.0
    best_start: Share = 0.0
    ticks: Share = 0.0
    size: Share = 0.0


class Late(msgspec.Struct, frozen=True):
    """``[late]``: deadlines or a file of late students, and the share of points they keep.

    `grace` are minutes, `days` grace days of every student. `keep` is kept at least, of which
    `per_day`, if any, is lost for each day that has begun.
    """

    after: datetime | None = None
    students: str = ""
    extensions: str = ""
    keep: Annotated[float, Bounds(0, 1)] | None = None
    per_day: Annotated[float, Bounds(0, 1)] = 0.0
    grace: Share = 0.0
    days: Annotated[int, Bounds(0)] = 0

    def rule(self, student: Student) -> tuple[float, str]:
        """Return the share of the points that a student keeps, and why."""
        days, grace_days = math.ceil(student.late_by / _DAY), student.grace_days
        if not student.late:
            used = f"{days} of {count_of(grace_days, 'grace day')} used"
            is_short = student.late_by <= 60 * self.grace
            return 1.0, f"within {self.grace:g} minutes of grace" if is_short else used
        share = 1.0 if self.keep is None else self.keep
        if not self.per_day:
            return share, f"{share:.0%} counts"
        share = max(self.keep or 0.0, 1 - self.per_day * max(1, days - grace_days))
        delay = f" after {count_of(grace_days, 'grace day')}" if grace_days else ""
        return share, f"{self.per_day:.0%} less for each day{delay}: {share:.0%} counts"


NOTHING = "nothing was submitted"
UNMATCHED = "no submission could be matched to this student"
UNCLEAR = "it is not clear which file is the program for this level"
NOT_IN_ROSTER = "not in the roster"
_UNTIMED = "when it was handed in is not known"


class Columns(msgspec.Struct, frozen=True):
    """``columns``: the heads of a roster's columns, where they are not known."""

    id: str = ""
    name: str = ""
    first: str = ""
    last: str = ""
    group: str = ""
    time: str = ""
    submission: str = ""
    points: str = ""


Shown: TypeAlias = Literal[
    "won", "starts", "home", "time_home", "best_start", "ticks", "size", "distance"
]


class AssignmentTable(msgspec.Struct, frozen=True):
    title: str = ""
    pattern: str = ""
    columns: Columns = Columns()
    by_hand: str = ""
    over: bool = False
    starts: Starts = 20
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = True
    roster: str = ""
    show: list[Shown] = msgspec.field(default_factory=lambda: [*get_args(Shown)[:-1]])


class GradeLimit(RunLimit, frozen=True):
    run_steps: Annotated[int, Bounds(0)] = 500_000_000
    seconds: Annotated[float, Bounds(0.001)] = 120.0


class Assignment(msgspec.Struct, frozen=True):
    assignment: AssignmentTable
    level: Annotated[list[LevelTable], Bounds(1)]
    points: Split = Split()
    late: Late = Late()
    limits: GradeLimit = GradeLimit()


def read_assignment(spec: TomlFile) -> Assignment:
    """Return an assignment, without looking up names; raises TomlFileError if there is none.

    What is wrong with parts of it is reported only.
    """
    assignment = spec.draft(Assignment)
    if not any(msgspec.structs.astuple(assignment.points)):
        spec.problem(("points",), "At least one share of the points must be more than 0")
    if assignment.points.starts and not assignment.assignment.starts:
        spec.problem(("points", "starts"), "There are points for starts, but starts = 0")
    if problem := pattern_problem(assignment.assignment.pattern):
        spec.problem(("assignment", "pattern"), problem)
    return assignment


def plan_grading(
    file: Given, submissions: Path, *, file_times: bool = False, late_anyway: bool = False
) -> tuple[Manifest, dict[str, str]]:
    """Return what to run for an assignment, and the texts of levels and programs by digest.

    `submissions` is a folder or an archive with one folder, file or archive per student. Where
    the platform does not say when they were handed in, `file_times` takes the times of files;
    `late_anyway` believes times that are suspicious. Raises TomlFileError, InputError.
    """
    if submissions.suffix == ".toml":
        hint = "The assignment comes first: logical-robots grade assignment.toml submissions -o out"
        raise InputError(
            "This is where the submissions should be", place=str(submissions), hint=hint
        )
    spec = TomlFile(file)
    assignment = read_assignment(spec)
    levels, starters = read_levels(spec, assignment)
    roster, late, extensions, by_hand = tables = [_table(spec, assignment, p) for p in _TABLES]
    rows = extensions.rows
    longer = extensions._replace(rows=[row for row in rows if row.cells.get("days")])
    later_rows = [row for row in rows if row.cells.get("until") or not row.cells.get("days")]
    later = extensions._replace(rows=later_rows)
    terms = _LateTerms(
        assignment.late,
        {row.id for row in late.rows},
        dict(_values(spec, later, "until", _parse_deadline, _DATE_FORM)),
        dict(_values(spec, longer, "days", int, "a whole number")),
        file_times,
    )
    adjustments: dict[str, list[tuple[float, str]]] = defaultdict(list)
    for row in by_hand.rows:
        table = by_hand._replace(rows=[row])
        for student, points in _values(spec, table, "points", number_of, "a number"):
            adjustments[student].append((points, readable(row.cells.get("reason", ""))))
    spec.refuse()
    pattern = assignment.assignment.pattern
    entries = entries_of(submissions, stems_of(levels), pattern, starters, roster.rows)
    if not entries:
        hint = "It should have one folder, file or archive for each student."
        raise InputError("There are no submissions in it", place=str(submissions), hint=hint)
    students, strays = _students(entries, roster.rows, terms, adjustments, late_anyway)
    labels = {student.id: student.label for student in students}
    for table in (late, extensions, by_hand) if roster.rows else (by_hand,):
        for row in table.rows:
            if readable(row.id) not in labels:
                message = f"{printable(row.id)} is not among the students. "
                hint = did_you_mean(row.id, labels)
                spec.problem_in(table.file, row.line, (message + hint).strip())
    spec.refuse()
    manifest, inputs = _manifest(spec, assignment, levels, students, entries)
    gradebook = None
    if roster.rows:
        text, maximum = digest(roster.text), sum(level.points for level in assignment.level)
        gradebook, gradebook_notes = gradebook_of(roster, text, manifest.title, maximum)
        roster.notes.extend(gradebook_notes)
        if gradebook:
            inputs[text] = roster.text
    notes = [f"{table.file}: {note}" for table in tables for note in table.notes]
    for name, entry in entries.items():
        fits = ", ".join(labels[readable(student)] for student in entry.ties)
        notes += [f"{name} fits several: {fits}"] if fits else []
    manifest = msgspec.structs.replace(
        manifest, strays=tuple(strays), notes=tuple(map(readable, notes)), gradebook=gradebook
    )
    return manifest, inputs


def read_levels(
    spec: TomlFile, assignment: Assignment
) -> tuple[dict[str, tuple[str, int]], dict[str, str]]:
    """Return texts and ticks of levels, and their starters as they are compared, by name."""
    levels: dict[str, tuple[str, int]] = {}
    starters: dict[str, str] = {}
    for number, level_table in enumerate(assignment.level):
        path, ticks = ("level", number, "name"), assignment.assignment.ticks
        level_run = level_to_run(spec, path, level_table.name, ("assignment", "ticks"), ticks)
        if level_run is None:
            continue
        level, text, last = level_run
        if level.name in levels:
            spec.problem(path, f'The level "{level.name}" is there twice')
        levels[level.name] = text, last
        if starter := shipped_texts().get(level.starter):
            starters[level.name] = normalise(starter)
        for key in ("time_home", "ticks", "size"):
            if getattr(assignment.points, key) and reference_for(level) is None:
                message = f"{level.name} has no reference program to compare {key} with"
                spec.problem(("points", key), message)
    return levels, starters


def _values(
    spec: TomlFile, table: StudentTable, column: str, parse: Callable[[str], T], form: str
) -> Iterator[tuple[str, T]]:
    """Yield ids with the values of a column; report values that are not of its form."""
    for row in table.rows:
        try:
            yield row.id, parse(row.cells.get(column, ""))
        except ValueError:
            message = f"{column} for {printable(row.id)} must be {form}"
            spec.problem_in(table.file, row.line, message)


def _parse_deadline(text: str) -> datetime:
    deadline = datetime.fromisoformat(text)
    if deadline.tzinfo is None:
        raise ValueError
    return deadline


def _table(spec: TomlFile, assignment: Assignment, path: tuple[str, str]) -> StudentTable:
    """Return the table that a key names, which may be none; report what is wrong with it."""
    file: str = getattr(getattr(assignment, path[0]), path[1])
    empty = StudentTable(file, [], [])
    if not file:
        return empty
    heads = msgspec.structs.asdict(assignment.assignment.columns)
    columns = {role: head for role, head in heads.items() if head} if path == _ROSTER else None
    try:
        content = read_ordinary(spec.folder / file, MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise ValueError("it is larger than 1 MB")
        table = read_table(file, content, *_TABLES[path], columns)
    except TableError as error:
        spec.problem_in(file, 1, printable(str(error)))
        return empty
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or str(error)
        spec.problem(path, f"{file} can't be read: {reason}")
        return empty
    lines = {row.id: row.line for row in reversed(table.rows)}
    for row in table.rows if path != _BY_HAND else ():
        if row.line != lines[row.id]:
            spec.problem_in(file, row.line, f"{printable(row.id)} is there twice")
    return table


class _LateTerms(NamedTuple):
    """What decides who is late: the rule, ids, and by id later deadlines and grace days."""

    late: Late
    ids: set[str]
    deadlines: Mapping[str, datetime]
    days: Mapping[str, int]
    file_times: bool

    def moment(self, entry: Submission, row: StudentRow | None) -> datetime | None:
        """Return when something was handed in, as the platform says, or its files if asked."""
        time = (parse_date(row.time) if row else None) or entry.time
        if time is None and self.file_times and entry.mtime:
            return datetime.fromtimestamp(entry.mtime, UTC)
        return time

    def apply(self, student: Student, entry: Submission, time: datetime | None) -> Student:
        """Return a student with how late the submission is, or a remark that it is unknown."""
        deadline = self.deadlines.get(student.id, self.late.after)
        is_late, late_by, days, remarks = bool(entry.is_late), 0.0, 0, student.remarks
        if deadline and time:
            zone = time.tzinfo or deadline.tzinfo
            late_by = max(0.0, (time.replace(tzinfo=zone) - deadline).total_seconds())
            days = self.days.get(student.id, self.late.days)
            is_late = late_by > max(60 * self.late.grace, days * _DAY)
        elif deadline and (entry.is_late is None or (is_late and student.id in self.deadlines)):
            is_late, remarks = False, (*remarks, _UNTIMED)
        changes = {"late": student.id in self.ids or is_late, "late_by": late_by}
        return msgspec.structs.replace(student, **changes, grace_days=days, remarks=remarks)

    def check(self, students: Sequence[Student], times: Collection[datetime | None]) -> None:
        """Raise InputError if times are unknown, all the same, or of too many late students."""
        late = [student for student in students if student.late and student.id not in self.ids]
        problem, hint = "", "If the times are right, add --late-anyway."
        if students and all(_UNTIMED in student.remarks for student in students):
            problem = "When the submissions were handed in is not known"
            hint = "Add --file-times to take the times of files, or name late students in a list."
        elif self.late.after and len(times) > 1 and len({*times}) == 1 and None not in times:
            problem = f"All submissions are of {min(filter(None, times))}, perhaps of the download"
        elif len(late) > max(1, len(students) / 2):
            problem = f"{len(late)} of {len(students)} submissions are late"
        if problem:
            raise InputError(problem, place="[late]", hint=hint)


def _students(
    entries: Mapping[str, Submission],
    roster: Sequence[StudentRow],
    terms: _LateTerms,
    adjustments: Mapping[str, list[tuple[float, str]]],
    is_sure: bool,
) -> tuple[list[Student], list[str]]:
    """Return the students of the roster and others who submitted, and files that are nobody's."""
    names = {student: name for name, entry in entries.items() for student in entry.students}
    unlisted = [name for name, entry in entries.items() if not entry.students]
    strays = [name for name in unlisted if entries[name].is_stray]
    other_names = [name for name in unlisted if name not in strays]
    listed = [(names.get(row.id, ""), row) for row in roster]
    students, times = [], []
    for name, row in [*listed, *((name, None) for name in other_names)]:
        entry = entries.get(name)
        remarks = [NOT_IN_ROSTER] if roster and not row else []
        if entry is None:
            is_told = row is not None and row.time == NO_TIME
            remarks.append(UNMATCHED if (other_names or strays) and not is_told else NOTHING)
        else:
            remarks += entry.remarks
        if (excess := len(remarks) - _MOST_REMARKS) > 0:
            remarks[_MOST_REMARKS:] = [f"and {excess:,} more"]
        people = entry.owner.people if entry else ()
        student_id = readable(row.id if row else name)
        student = Student(
            student_id,
            readable((row.name if row else "") or ", ".join(p.name for p in people if p.name)),
            name,
            remarks=tuple(map(readable, remarks)),
            added=tuple(adjustments.get(row.id if row else name, ())),
            group=readable(row.group if row else ""),
            is_unclear=bool(entry and entry.is_unclear),
        )
        if entry:
            times.append(terms.moment(entry, row))
            student = terms.apply(student, entry, times[-1])
        students.append(student)
    if not is_sure:
        terms.check([student for student in students if student.submission], times)
    return students, [top for name in strays for top in map(readable, entries[name].tops)]


def warning_of(manifest: Manifest) -> str:
    """Return a sentence if fewer than half of the students can be graded, or ""."""
    students = [s for s in manifest.students if NOT_IN_ROSTER not in s.remarks]
    gradable = {cell.student for cell in manifest.cells}
    gradable |= {s.id for s in students if NOTHING in s.remarks}
    gradable |= {s.id for s in students if s.submission and not s.is_unclear}
    if 2 * (number := len(gradable & {s.id for s in students})) >= len(students):
        return ""
    count = f"only {number:,}" if number else "none"
    hint = "Compare the roster with the names of the submissions, or give a pattern."
    return f"Of {count_of(len(students), 'student')} {count} can be graded. {hint}"


def account_of(manifest: Manifest) -> list[str]:
    """Summarise submissions: counts by roster, files of nobody, and remarks on oddities."""
    students = manifest.students
    unlisted = [student for student in students if NOT_IN_ROSTER in student.remarks]
    roster = [student for student in students if NOT_IN_ROSTER not in student.remarks]
    missing = [student.label for student in roster if not student.submission]
    if manifest.assignment["assignment"]["roster"]:
        summary = f"{len(roster):,} in the roster, {len(roster) - len(missing):,} matched"
    else:
        summary = f"{count_of(len(roster), 'submission')}"
    strays = [*(student.submission for student in unlisted), *manifest.strays]
    if missing:
        phrase = "not matched:" if strays else "nothing was handed in by"
        summary += f"; {phrase} {', '.join(missing)}"
    lines = [warning] if (warning := warning_of(manifest)) else []
    lines += [summary + (f"; files matched to no student: {', '.join(strays)}" if strays else "")]
    return [*lines, *manifest.notes] + [
        f"{student.label}: {'; '.join(student.remarks)}"
        for student in roster
        if student.submission and student.remarks
    ]


def _manifest(
    spec: TomlFile,
    assignment: Assignment,
    levels: Mapping[str, tuple[str, int]],
    students: list[Student],
    entries: Mapping[str, Submission],
) -> tuple[Manifest, dict[str, str]]:
    """Return the manifest and its inputs; programs of a level that are the same run once."""
    inputs = {digest(text): text for text, _ in levels.values()}
    cells: list[Cell] = []
    first_digests: dict[tuple[str, str], str] = {}
    for student in students:
        programs = entries[student.submission].programs if student.submission else {}
        for level, (level_text, ticks) in levels.items():
            text = programs.get(level, programs.get(""))
            if text is None:
                continue
            text_digest = digest(text)
            program = first_digests.setdefault((level, normalise(text)), text_digest)
            inputs[text_digest] = text
            name = level + SUFFIX if level in programs else student.submission + SUFFIX
            variant = "" if text_digest == program else text_digest
            cells.append(
                Cell(digest(level_text), program, level, name, ticks, {}, student.id, variant)
            )
    table, limits = assignment.assignment, assignment.limits
    document = msgspec.to_builtins(assignment)
    for level_table, name in zip(document["level"], levels, strict=True):
        # Shipped levels may go by a number or a part of their names.
        suffix = Path(level_table["name"]).suffix
        level_table["name"] = name + (suffix if suffix in SUFFIXES else "")
    manifest = Manifest(
        "grade",
        table.title or spec.file.stem,
        spec.text,
        table.starts,
        table.given_first,
        (*BUILT_IN, "home", "time_home"),
        (),
        limits.steps,
        limits.seconds,
        tuple(cells),
        tuple(students),
        document,
        run_steps=limits.run_steps,
    )
    return manifest, inputs
