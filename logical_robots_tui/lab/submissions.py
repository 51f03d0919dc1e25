"""From an assignment and a folder of submissions to programs in levels."""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, TypeAlias, TypeVar

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.game.victory import reference_for
from logical_robots_tui.lab.folder import BUILT_IN, Cell, Manifest, Student, digest
from logical_robots_tui.lab.handins import (
    MOST_BYTES,
    Submission,
    entries_of,
    match_roster,
    pattern_problem,
    readable,
    stems_of,
)
from logical_robots_tui.lab.sweeping import Name, Positive, RunLimit, Starts, level_to_run
from logical_robots_tui.language.diagnostics import printable
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.paths import did_you_mean, read_text
from logical_robots_tui.toml_files import Bounds, Given, TomlFile
from logical_robots_tui.wording import count_of

T = TypeVar("T")

_MOST_REMARKS = 20
_MOST_COLUMNS = 100  # of a table of students
_BY_HAND = ("assignment", "by_hand")
_TABLES: dict[tuple[str, str], tuple[tuple[str, ...], tuple[str, ...]]] = {
    ("assignment", "roster"): (("id",), ("name", "submission")),
    ("late", "students"): (("id",), ()),
    ("late", "extensions"): (("id", "until"), ()),
    _BY_HAND: (("id", "points"), ("reason",)),
}
"""By the keys that name tables, the columns that they need and those that they may have."""

_COLUMNS = {"identifier": "id", "full name": "name", "student": "name"}  # of Moodle and Canvas


class _StudentTable(NamedTuple):
    """A table of students: its rows by line, and notes on its columns."""

    file: str
    rows: dict[int, dict[str, str]]
    notes: list[str]


Share: TypeAlias = Annotated[float, Bounds(0)]


class LevelTable(msgspec.Struct, frozen=True):
    name: Name
    points: Share = 10.0


class Split(msgspec.Struct, frozen=True):
    """``[points]``: how the points of a level are split; only the proportions matter."""

    won: Share = 1.0
    starts: Share = 0.0
    ticks: Share = 0.0
    size: Share = 0.0


class Late(msgspec.Struct, frozen=True):
    """``[late]``: deadlines or a file of late students, and the share of points they keep."""

    after: datetime | None = None
    students: str = ""
    extensions: str = ""
    keep: Annotated[float, Bounds(0, 1)] = 1.0


NOTHING = "nothing was submitted"
UNMATCHED = "no submission could be matched to this student"
NOT_IN_ROSTER = "not in the roster"


class AssignmentTable(msgspec.Struct, frozen=True):
    title: str = ""
    pattern: str = ""
    by_hand: str = ""
    starts: Starts = 20
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = True
    roster: str = ""
    show: list[Literal["won", "starts", "ticks", "size", "distance"]] = msgspec.field(
        default_factory=lambda: ["won", "starts", "ticks", "size"]
    )


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
    names = [level.name for level in assignment.level]
    for number, name in enumerate(names):
        if name in names[:number]:
            spec.problem(("level", number, "name"), f'The level "{name}" is there twice')
    return assignment


def plan_grading(file: Given, submissions: Path) -> tuple[Manifest, dict[str, str]]:
    """Return what to run for an assignment, and the texts of levels and programs by digest.

    `submissions` is a folder or an archive with one folder, file or archive per student. Raises
    TomlFileError, InputError.
    """
    if submissions.suffix == ".toml":
        hint = "The assignment comes first: logical-robots grade assignment.toml submissions -o out"
        raise InputError(
            "This is where the submissions should be", place=str(submissions), hint=hint
        )
    spec = TomlFile(file)
    assignment = read_assignment(spec)
    levels = _levels(spec, assignment)
    tables = {path: _table(spec, assignment, path) for path in _TABLES}
    roster, late, extensions, by_hand = tables.values()
    example = "like 2026-01-31T23:59:00+01:00"
    extended_rows = _parse_column(spec, extensions, "until", _parse_deadline, example)
    deadlines = {row["id"]: deadline for row, deadline in extended_rows}
    adjustments: dict[str, list[tuple[float, str]]] = defaultdict(list)
    for row, points in _parse_column(spec, by_hand, "points", _parse_points, "a number"):
        adjustments[row["id"]].append((points, readable(row.get("reason", ""))))
    spec.refuse()
    entries = entries_of(submissions, stems_of(levels), assignment.assignment.pattern)
    if not entries:
        hint = "It should have one folder, file or archive for each student."
        raise InputError("There are no submissions in it", place=str(submissions), hint=hint)
    is_late = {row["id"] for row in late.rows.values()}
    rows = [*roster.rows.values()]
    students, strays = _students(assignment, entries, rows, is_late, deadlines, adjustments)
    ids = dict.fromkeys(student.id for student in students)
    for table in (late, extensions, by_hand) if rows else (by_hand,):
        for line, row in table.rows.items():
            if (name := row["id"]) not in ids:
                message = f"{printable(name)} is not among the students. "
                spec.problem_in(table.file, line, (message + did_you_mean(name, ids)).strip())
    spec.refuse()
    manifest, inputs = _manifest(spec, assignment, levels, students, entries)
    notes = tuple(readable(note) for table in tables.values() for note in table.notes)
    return msgspec.structs.replace(manifest, strays=tuple(strays), notes=notes), inputs


def _levels(spec: TomlFile, assignment: Assignment) -> dict[str, tuple[str, int]]:
    levels: dict[str, tuple[str, int]] = {}
    for number, level_table in enumerate(assignment.level):
        path, ticks = ("level", number, "name"), assignment.assignment.ticks
        level_run = level_to_run(spec, path, level_table.name, ("assignment", "ticks"), ticks)
        if level_run is None:
            continue
        level, text, last = level_run
        levels[level.name] = text, last
        for key in ("ticks", "size"):
            if getattr(assignment.points, key) and reference_for(level) is None:
                message = f"{level.name} has no reference program to compare {key} with"
                spec.problem(("points", key), message)
    return levels


def _parse_column(
    spec: TomlFile, table: _StudentTable, column: str, parse: Callable[[str], T], form: str
) -> Iterator[tuple[dict[str, str], T]]:
    """Yield rows with the value of a column; report values that are not of its form."""
    for line, row in table.rows.items():
        try:
            yield row, parse(row.get(column, ""))
        except ValueError:
            message = f"{column} for {printable(row['id'])} must be {form}"
            spec.problem_in(table.file, line, message)


def _parse_deadline(text: str) -> datetime:
    deadline = datetime.fromisoformat(text.strip())
    if deadline.tzinfo is None:
        raise ValueError
    return deadline


def _parse_points(text: str) -> float:
    if not math.isfinite(points := float(text)):
        raise ValueError
    return points


def _table(spec: TomlFile, assignment: Assignment, path: tuple[str, str]) -> _StudentTable:
    """Return the table that a key names, which may be none; report what is wrong with it."""
    file: str = getattr(getattr(assignment, path[0]), path[1])
    table = _StudentTable(file, {}, [])
    if not file:
        return table
    try:
        lines = read_text(spec.folder / file, MOST_BYTES).splitlines()
        separator = max(",;\t", key=lines[0].count) if lines else ","
        reader = csv.DictReader(lines, restval="", delimiter=separator)
        heads = [head.strip().casefold() for head in reader.fieldnames or ()]
        if len(heads) > _MOST_COLUMNS:
            raise ValueError(f"it has more than {_MOST_COLUMNS} columns")
        heads = reader.fieldnames = [_COLUMNS.get(head, head) for head in heads]
        rows = [(reader.line_num, row) for row in reader]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or str(error)
        spec.problem(path, f"{file} can't be read: {reason}")
        return table
    required, optional = _TABLES[path]
    for column in required if rows else ():
        if column not in heads:
            message = f'There is no column "{column}"; the first line names the columns: '
            spec.problem_in(file, 1, message + printable(", ".join(heads)))
            return table
    unused_columns = [column for column in optional if column not in heads]
    for head in heads:
        if head not in (*required, *optional) and (hint := did_you_mean(head, unused_columns)):
            table.notes.append(f'{file}: The column "{head}" is not known. {hint}')
    ids: set[str] = set()
    for line, row in rows:
        if row["id"] in ids and path != _BY_HAND:
            spec.problem_in(file, line, f"{printable(row['id'])} is there twice")
        elif row["id"].strip():
            ids.add(row["id"])
            table.rows[line] = row
    return table


def _students(
    assignment: Assignment,
    entries: Mapping[str, Submission],
    roster: list[dict[str, str]],
    late_ids: set[str],
    deadlines: Mapping[str, datetime],
    adjustments: Mapping[str, list[tuple[float, str]]],
) -> tuple[list[Student], list[str]]:
    """Return the students of the roster and others who submitted, and files that are nobody's."""
    matches = match_roster(roster, entries)
    used_names = set(matches.values())
    roster_entries = [(matches.get(row["id"], ""), row) for row in roster]
    strays = [name for name in entries if name not in used_names and entries[name].is_stray]
    used_names.update(strays)
    other_names = [name for name in entries if name not in used_names]
    students = []
    for name, row in [*roster_entries, *((name, dict[str, str]()) for name in other_names)]:
        entry = entries.get(name)
        remarks = [] if entry is None else list(entry.remarks)
        if entry is None:
            remarks.append(UNMATCHED if other_names or strays else NOTHING)
        if roster and not row:
            remarks.append(NOT_IN_ROSTER)
        student_id = readable(row.get("id") or name)
        if (excess := len(remarks) - _MOST_REMARKS) > 0:
            remarks[_MOST_REMARKS:] = [f"and {excess:,} more"]
        is_late, late_by = student_id in late_ids, 0.0
        deadline = deadlines.get(student_id, assignment.late.after)
        if entry is not None and deadline is not None:
            handed_in_at = datetime.fromtimestamp(entry.mtime, UTC)
            late_by = max(0.0, (handed_in_at - deadline).total_seconds())
        elif entry is not None:
            is_late = is_late or entry.is_late
        students.append(
            Student(
                student_id,
                readable(row.get("name") or (entry.owner.name if entry else "")),
                name,
                is_late or late_by > 0,
                tuple(map(readable, remarks)),
                late_by,
                tuple(adjustments.get(student_id, ())),
            )
        )
    return students, [top for name in strays for top in map(readable, entries[name].tops)]


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
    lines = [summary + (f"; files matched to no student: {', '.join(strays)}" if strays else "")]
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
    """Return the manifest and its inputs; programs that normalise to the same text run once."""
    inputs = {digest(text): text for text, _ in levels.values()}
    cells: list[Cell] = []
    first_digests: dict[str, str] = {}
    for student in students:
        programs = entries[student.submission].programs if student.submission else {}
        for level, (level_text, ticks) in levels.items():
            text = programs.get(level, programs.get(""))
            if text is None:
                continue
            text_digest = digest(text)
            program = first_digests.setdefault(normalise(text), text_digest)
            inputs[text_digest] = text
            name = level + SUFFIX if level in programs else student.submission + SUFFIX
            variant = "" if text_digest == program else text_digest
            cells.append(
                Cell(digest(level_text), program, level, name, ticks, {}, student.id, variant)
            )
    table, limits = assignment.assignment, assignment.limits
    manifest = Manifest(
        "grade",
        table.title or spec.file.stem,
        spec.text,
        table.starts,
        table.given_first,
        BUILT_IN,
        (),
        limits.steps,
        limits.seconds,
        tuple(cells),
        tuple(students),
        msgspec.to_builtins(assignment),
        run_steps=limits.run_steps,
    )
    return manifest, inputs


def normalise(text: str) -> str:
    source = prepare(text)
    if source.problems or '"""' in source.text:
        return text
    characters: list[str] = []
    is_quoted = False
    for character, bare in zip(source.text, source.skeleton, strict=True):
        if character == '"' and bare == " ":
            is_quoted = not is_quoted
        if is_quoted or not character.isspace():
            characters.append(character)
        elif characters and characters[-1] != " ":
            characters.append(" ")
    return "".join(characters).strip()
