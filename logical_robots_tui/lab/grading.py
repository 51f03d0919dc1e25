"""Grades of students, from the runs of their programs."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from decimal import ROUND_HALF_UP, Decimal

import msgspec

from logical_robots_tui.game.victory import reference_table
from logical_robots_tui.lab.exporting import (
    RunRecord,
    RunRecords,
)
from logical_robots_tui.lab.folder import Manifest, Student
from logical_robots_tui.lab.submissions import NOTHING, UNCLEAR, UNMATCHED, Assignment
from logical_robots_tui.lab.tasks import Result
from logical_robots_tui.wording import count_of

NOT_RUN = "not run yet"
_UNMEASURED = "an earlier version ran it and did not measure this; grade into another folder"
_NO_PROGRAM = "no program for this level was found"
_MISSING = (NOTHING, UNMATCHED, UNCLEAR, _NO_PROGRAM)

QUESTIONS = {
    "several rows": "Which of the rows should count?",
    "no row": "Which rule should cover that case?",
    "bad engine": "Which part of the value can be missing?",
    "notice": "What was special about that tick?",
    "unknown string": "What are things called in this level?",
    "unused": "Which rule should use it?",
    "same copy": "What should be different in one of them?",
    "memory never written": "Which rule should write this field?",
    "memory never read": "Which rule should read it?",
    "memory lost": "Should the robot still know it then?",
    "no rows": "When should this rule have a row?",
    "always null": "Where should its value come from?",
    "never true": "When should this condition hold?",
    "never false": "When should it fail?",
    "never null": "What was that case meant for?",
    "circle": "What should have ended that?",
    "blocked": "Which rule decided just before that?",
    "still": "What should have made it move on?",
    "unfinished": "Is it heading the right way?",
    "unchanged": "What should change this field?",
}
"""A question to the student for each kind of finding, without the answer."""


class PointsPart(msgspec.Struct, frozen=True):
    """A part of a level's points, such as that for its ticks, and the reason for them."""

    name: str
    points: float
    most: float
    said: str

    def __str__(self) -> str:
        purposes = {"won": "winning", "starts": "varied starts", "home": "robots home"}
        purpose = purposes.get(self.name, self.name.replace("_", " "))
        return f"{self.points:g} of {self.most:g} points for {purpose}: {self.said}."


class LevelGrade(msgspec.Struct, frozen=True):
    """What a student has achieved in a level; `distance` is in map units.

    `points` is None if runs are missing through no fault of the student's; `lost` are numbers
    of varied starts. Outcome, ticks, distance, `last` tick, and of what was not won `ends` and
    `questions` are from the given start. `file` is what plays the level; `failure` says why a run
    could not be done, or is "".
    """

    level: str
    points: float | None
    most: float
    won: bool
    outcome: str
    ticks: int | None
    size: int | None
    distance: float
    wins: int
    starts: int
    lost: tuple[int, ...]
    messages: tuple[str, ...]
    ends: tuple[str, ...] = ()
    parts: tuple[PointsPart, ...] = ()
    questions: tuple[str, ...] = ()
    last: int = 0
    file: str = ""
    failure: str = ""

    @property
    def is_missing(self) -> bool:
        """Whether there was no program to run."""
        return self.outcome in _MISSING


class Grade(msgspec.Struct, frozen=True):
    """What a student has achieved.

    `points` are less what being late costs, None if there are `ungraded` levels, whose runs are
    missing through no fault of the student's; `so_far` are those of the others.
    """

    student: Student
    levels: tuple[LevelGrade, ...]
    points: float | None
    so_far: float
    most: float
    ungraded: int

    @property
    def remarks(self) -> list[str]:
        notes = [f"{points:+g} points by hand: {why or '-'}" for points, why in self.student.added]
        return [*notes, *self.student.remarks]

    @property
    def points_text(self) -> str:
        if self.points is not None:
            return f"{self.points:g} of {self.most:g} points"
        if self.ungraded == len(self.levels) and not self.so_far:
            return "not graded yet"
        pending = count_of(self.ungraded, "level")
        return f"{self.so_far:g} of {self.most:g} points so far, {pending} not graded yet"


def grades_of(records: RunRecords) -> list[Grade]:
    manifest = records.manifest
    assignment = assignment_of(manifest)
    cells = {(cell.student, cell.level_name): cell for cell in manifest.cells}
    runs: dict[tuple[str, str], list[RunRecord]] = defaultdict(list)
    for run in records.finished:
        runs[run.cell.student, run.cell.level_name].append(run)
    failed = {(run.cell.student, run.cell.level_name): run.reason for run in records.failed}
    grades = []
    for student in manifest.students:
        levels = []
        for level_table in assignment.level:
            file = level_table.name.rpartition("/")[2]
            name = re.sub(r"\.(toml|json)$", "", file)
            key = student.id, name
            results = {run.start: run.result for run in runs.get(key, ())}
            missing = "" if key in cells else _NO_PROGRAM
            if not student.submission:  # earlier versions had other words for UNMATCHED
                missing = NOTHING if student.remarks[0] == NOTHING else UNMATCHED
            elif missing and student.is_unclear:
                missing = UNCLEAR
            ticks = cells[key].ticks if key in cells else 0
            level = _level(manifest, assignment, name, level_table.points, ticks, missing, results)
            failure = failed.get(key, level.failure)
            levels.append(msgspec.structs.replace(level, file=file, failure=failure))
        kept_share, _ = assignment.late.rule(student)
        maximum = sum(level_table.points for level_table in assignment.level)
        so_far = sum(level.points or 0 for level in levels) * kept_share
        so_far = _round(so_far + sum(points for points, _ in student.added))
        if student.added and not assignment.assignment.over:
            so_far = min(so_far, maximum)
        ungraded = sum(level.points is None for level in levels)
        points = None if ungraded else so_far
        grades.append(Grade(student, tuple(levels), points, so_far, maximum, ungraded))
    return grades


def assignment_of(manifest: Manifest) -> Assignment:
    """Return the assignment, with ``size`` where earlier versions counted rules."""
    tables = manifest.assignment
    table, points = dict(tables["assignment"]), dict(tables["points"])
    table["show"] = ["size" if name == "rules" else name for name in table["show"]]
    if "rules" in points:
        points["size"] = points.pop("rules")
    return msgspec.convert({**tables, "assignment": table, "points": points}, Assignment)


def _level(
    manifest: Manifest,
    assignment: Assignment,
    name: str,
    maximum: float,
    ticks: int,
    missing: str,
    results: dict[int, Result],
) -> LevelGrade:
    first, is_run = results.get(0, Result("infrastructure")), 0 in results
    won = first.outcome == "won"
    varied = {start: result for start, result in results.items() if start}
    wins = sum(result.outcome == "won" for result in varied.values())
    is_over = is_run and (
        first.outcome == "does not compile"
        or (manifest.given_first and not won)
        or len(varied) == manifest.starts
    )
    points: float | None = 0.0
    parts: tuple[PointsPart, ...] = ()
    points_split = assignment.points
    needs_home = points_split.home or points_split.time_home or points_split.best_start
    is_unmeasured = any(
        result.home is None and result.outcome != "does not compile" for result in results.values()
    )
    failure = _UNMEASURED if needs_home and is_unmeasured else ""
    if missing in (UNMATCHED, UNCLEAR) or not (missing or is_over) or failure:
        points = None
    elif is_run:
        parts = tuple(_parts(assignment, name, maximum, ticks, results, manifest.starts))
        points = sum(part.points for part in parts)
    messages = [f"line {m.line}: {m.message}. {m.hint}".strip() for m in first.mistakes]
    if first.first is not None:
        messages.append("tick {}, {}: {}".format(*first.first))
    outcome: str = first.outcome if is_run else missing or NOT_RUN
    if outcome in ("too slow", "too many steps"):
        outcome += f" at tick {first.ticks:,}"
    questions = []
    for finding in first.findings:
        place = f"Line {finding.line}: " * bool(finding.line)
        questions.append(f"{place}{finding.message} {QUESTIONS.get(finding.kind, '')}".strip())
    return LevelGrade(
        name,
        None if points is None else _round(points),
        maximum,
        won,
        outcome,
        first.ticks if won else None,
        first.size or None,
        first.distance,
        wins,
        manifest.starts,
        tuple(start for start, result in varied.items() if result.outcome != "won"),
        tuple(messages),
        () if won else tuple(_ends(first)),
        tuple(msgspec.structs.replace(part, points=_round(part.points)) for part in parts),
        tuple(questions),
        first.ticks,
        failure=failure,
    )


def _ends(result: Result) -> Iterator[str]:
    if result.peak:
        yield f"{result.peak.capitalize()}."
    for end in result.ends:
        yield end.sentence(result.ticks)


def _parts(
    assignment: Assignment,
    name: str,
    maximum: float,
    ticks: int,
    results: Mapping[int, Result],
    starts: int,
) -> Iterator[PointsPart]:
    """Yield the parts of a level's points that count, not rounded."""
    reference = next(iter(reference_table().get(name, {}).values()), None)  # the solution
    first, is_tried = results[0], len(results) > 1
    is_won = first.outcome == "won"
    wins = sum(bool(start) and result.outcome == "won" for start, result in results.items())
    split: dict[str, float] = msgspec.to_builtins(assignment.points)
    for part in [part for part, share in split.items() if share]:
        share, text = float(is_won), f"{'' if is_won else 'not '}won from the given start"
        if part == "starts":
            share, text = wins / starts, f"won from {wins} of {starts}"
            if not is_tried:
                text = "not tried, because it was not won from the given start"
        elif part in ("ticks", "size"):
            count, best = getattr(first, part), getattr(reference, part, 0)
            share = min(1.0, best / max(count, 1)) if is_won else 0.0
            unit = "tick" if part == "ticks" else "symbol"
            if is_won:
                text = f"{count_of(count, unit)}; the reference program has {best:,}"
        elif part == "time_home":
            # The reference is home with all robots from its victory on, and was with some before.
            best = max(0.0, 1 - (reference.ticks - 1) / ticks) if reference else 1.0
            share = first.time_home or 0.0
            text = f"{share:.1%} of the time; the reference program has at least {best:.1%}"
            share = min(1.0, share / best) if best else float(is_won)
        elif part in ("home", "best_start"):
            considered = [first] if part == "home" else results.values()
            share = max(result.home or 0.0 for result in considered)
            text = f"{share:.0%} of the robots at once; the reference program has 100%"
        worth = maximum * split[part] / sum(split.values())
        yield PointsPart(part, worth * share, _round(worth), text)


def _round(points: float) -> float:
    """Return points rounded to two decimals, halves up."""
    return float(Decimal(f"{points:.9f}").quantize(Decimal("0.01"), ROUND_HALF_UP))


def duplicates(manifest: Manifest) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return programs of several groups: the level, the program's digest, the students."""
    teams = {s.id: s.group or s.submission for s in manifest.students}
    owners: dict[tuple[str, str], list[str]] = defaultdict(list)
    for cell in manifest.cells:
        owners[cell.level_name, cell.program].append(cell.student)
    return [(*key, tuple(ids)) for key, ids in owners.items() if len({teams[s] for s in ids}) > 1]
