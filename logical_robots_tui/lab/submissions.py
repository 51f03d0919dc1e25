"""From an assignment and a folder of submissions to programs in levels."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.game.victory import reference_for
from logical_robots_tui.lab.folder import BUILT_IN, Cell, Manifest, Student, digest
from logical_robots_tui.lab.sweeping import Limit, Name, Positive, Starts, level_to_run
from logical_robots_tui.language.diagnostics import printable
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.paths import is_folder, read_text
from logical_robots_tui.toml_files import Bounds, TomlFile
from logical_robots_tui.world import Level

_MOST_BYTES = 1_000_000
_LONGEST_NAME = 200
_MOST_REMARKS = 20


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
    """``[late]``: the deadline or a file of late students, and the share of points they keep."""

    after: datetime | None = None
    students: str = ""
    keep: Annotated[float, Bounds(0, 1)] = 1.0


class AssignmentTable(msgspec.Struct, frozen=True):
    title: str = ""
    starts: Starts = 20
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = True
    roster: str = ""
    show: list[Literal["won", "starts", "ticks", "size", "distance"]] = msgspec.field(
        default_factory=lambda: ["won", "starts", "ticks", "size"]
    )


class Assignment(msgspec.Struct, frozen=True):
    assignment: AssignmentTable
    level: Annotated[list[LevelTable], Bounds(1)]
    points: Split = Split()
    late: Late = Late()
    limits: Limit = Limit()


def read_assignment(spec: TomlFile) -> Assignment:
    """Return an assignment, without looking up names, or raise TomlFileError."""
    found = spec.read(Assignment)
    if not any(msgspec.structs.astuple(found.points)):
        spec.problem(("points",), "at least one share of the points must be more than 0")
    if found.points.starts and not found.assignment.starts:
        spec.problem(("points", "starts"), "there are points for starts, but starts = 0")
    names = [level.name for level in found.level]
    for number, name in enumerate(names):
        if name in names[:number]:
            spec.problem(("level", number, "name"), f'the level "{name}" is there twice')
    spec.refuse()
    return found


class Submission:
    """A submission: its texts by level's name ("" for all levels), with remarks on oddities."""

    def __init__(self, path: Path, stems: Mapping[str, str]) -> None:
        is_single = not path.is_dir()
        self.name = path.name.removesuffix(SUFFIX) if is_single else path.name
        self.programs: dict[str, str] = {}
        self.remarks: list[str] = []
        self.changed = 0.0
        for file in [path] if is_single else self._files(path):
            level = "" if is_single else stems.get(file.name.removesuffix(SUFFIX), "?")
            if file.name.startswith(".") or (not is_single and file.suffix != SUFFIX):
                continue
            if level == "?":
                self.remarks.append(f"{file.name}: it is not named like a level here")
            else:
                self._read(file, level)
        if not self.programs and not self.remarks:
            self.remarks.append(f"there is no program in it; their names end with {SUFFIX}")

    def _files(self, folder: Path) -> list[Path]:
        try:
            if folder.is_symlink():
                raise OSError(None, "it is a link")
            return sorted(folder.iterdir())
        except OSError as error:
            self.remarks.append(f"{folder.name}: {error.strerror}")
            return []

    def _read(self, file: Path, level: str) -> None:
        try:
            if file.is_symlink():
                raise OSError(None, "it is a link")
            text = read_text(file, _MOST_BYTES)
            if "\0" in text:
                raise OSError(None, "it is not text")
        except OSError as error:
            self.remarks.append(f"{file.name}: {error.strerror}")
        else:
            self.programs[level] = text
            self.changed = max(self.changed, file.stat().st_mtime)


def plan_grading(file: Path, submissions: Path) -> tuple[Manifest, dict[str, str]]:
    """Return what to run for an assignment, and the texts of levels and programs by digest.

    `submissions` has one folder or file per student. Raises TomlFileError, InputError.
    """
    spec = TomlFile(file)
    assignment = read_assignment(spec)
    levels = _levels(spec, assignment)
    roster = _table(spec, ("assignment", "roster"), assignment.assignment.roster)
    late = _table(spec, ("late", "students"), assignment.late.students)
    spec.refuse()
    entries = entries_of(submissions, stems_of(levels))
    students = _students(assignment, entries, roster, {row["id"] for row in late})
    return _manifest(spec, assignment, levels, students, entries)


def _levels(spec: TomlFile, assignment: Assignment) -> dict[str, tuple[str, int]]:
    levels: dict[str, tuple[str, int]] = {}
    for number, each in enumerate(assignment.level):
        path, ticks = ("level", number, "name"), assignment.assignment.ticks
        found = level_to_run(spec, path, each.name, ("assignment", "ticks"), ticks)
        if found is not None:
            level, text, last = found
            _check_reference(spec, assignment, level)
            levels[level.name] = text, last
    return levels


def _check_reference(spec: TomlFile, assignment: Assignment, level: Level) -> None:
    for key in ("ticks", "size"):
        if getattr(assignment.points, key) and reference_for(level) is None:
            said = f"{level.name} has no reference program to compare {key} with"
            spec.problem(("points", key), said)


def _table(spec: TomlFile, path: tuple[str, str], name: str) -> list[dict[str, str]]:
    if not name:
        return []
    try:
        lines = read_text(spec.folder / name, _MOST_BYTES).splitlines()
        rows = list(csv.DictReader(lines, restval=""))
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or str(error)
        spec.problem(path, f"{name} can't be read: {reason}")
        return []
    if rows and "id" not in rows[0]:
        spec.problem(path, f'{name} has no column "id"; its first line names the columns')
        return []
    ids = [row["id"] for row in rows]
    for twice in sorted({each for each in ids if ids.count(each) > 1}):
        spec.problem(path, f"{name} has {printable(twice)} twice")
    return rows


def stems_of(levels: Iterable[str]) -> dict[str, str]:
    stems = {name: name for name in levels}
    return stems | {name.partition("-")[2]: name for name in levels if name[:2].isdecimal()}


def entries_of(folder: Path, stems: Mapping[str, str]) -> dict[str, Submission]:
    """Return submissions by names to show; raises InputError if unreadable or names are equal."""
    if not is_folder(folder):
        hint = "It has one folder or file for each student or player."
        raise InputError("this is not a folder", place=str(folder), hint=hint)
    found: dict[str, Submission] = {}
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or not (path.is_dir() or path.suffix == SUFFIX):
            continue
        each = Submission(path, stems)
        name = _readable(each.name)
        if name in found and name == each.name:
            hint = "Keep one of the two."
            message = "there is a folder and a file of this name"
            raise InputError(message, place=str(folder / each.name), hint=hint)
        while name in found:  # what can't be shown in them may be all that differs
            name += "'"
        found[name] = each
    return found


def _students(
    assignment: Assignment,
    entries: Mapping[str, Submission],
    roster: list[dict[str, str]],
    late: set[str],
) -> list[Student]:
    """Return the students of the roster, then those who submitted without being on it."""
    known: list[tuple[str, dict[str, str]]]
    known = [(row.get("submission") or row["id"], row) for row in roster]  # several may share one
    used = {name for name, _ in known}
    after = assignment.late.after
    students = []
    for name, row in [*known, *((name, {}) for name in entries if name not in used)]:
        entry = entries.get(name)
        remarks = [] if entry is None else list(entry.remarks)
        if entry is None:
            remarks.append("nothing was submitted")
        if roster and not row:
            remarks.append("not in the roster")
        changed = datetime.fromtimestamp(entry.changed, UTC) if entry else None
        mine = _readable(row.get("id") or name)
        students.append(
            Student(
                mine,
                _readable(row.get("name") or ""),
                name if entry else "",
                mine in late or (after is not None and changed is not None and changed > after),
                tuple(_readable(remark) for remark in _first(remarks)),
            )
        )
    return students


def _first(remarks: list[str]) -> list[str]:
    more = len(remarks) - _MOST_REMARKS
    return remarks if more <= 0 else [*remarks[:_MOST_REMARKS], f"and {more:,} more"]


def _readable(name: str) -> str:
    return printable(os.fsencode(name).decode(errors="replace"))[:_LONGEST_NAME]


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
    first: dict[str, str] = {}
    for student in students:
        programs = entries[student.submission].programs if student.submission else {}
        for level, (level_text, ticks) in levels.items():
            text = programs.get(level, programs.get(""))
            if text is None:
                continue
            own = digest(text)
            program = first.setdefault(normalise(text), own)
            inputs[own] = text
            name = level + SUFFIX if level in programs else student.submission + SUFFIX
            same = "" if own == program else own
            cells.append(
                Cell(digest(level_text), program, level, name, ticks, {}, student.id, same)
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
    )
    return manifest, inputs


def normalise(text: str) -> str:
    source = prepare(text)
    if source.problems or '"""' in source.text:
        return text
    kept: list[str] = []
    is_quoted = False
    for character, bare in zip(source.text, source.skeleton, strict=True):
        if character == '"' and bare == " ":
            is_quoted = not is_quoted
        if is_quoted or not character.isspace():
            kept.append(character)
        elif kept and kept[-1] != " ":
            kept.append(" ")
    return "".join(kept).strip()
