"""Grades of students, for the teacher, the student and other programs."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import ROUND_HALF_UP, Decimal
from shlex import quote
from typing import Any, TypeAlias
from xml.etree import ElementTree

import msgspec

from logical_robots_tui.game.victory import reference_table
from logical_robots_tui.lab.archives import pack
from logical_robots_tui.lab.exporting import (
    SPREADSHEET_MARK,
    Parts,
    ResultTable,
    Row,
    RunRecord,
    RunRecords,
    as_page,
    harmless_text,
    parts_as_html,
    parts_as_markdown,
    write_tables,
)
from logical_robots_tui.lab.folder import Folder, Manifest, Student, digest
from logical_robots_tui.lab.handins import readable
from logical_robots_tui.lab.platforms.gradebooks import Gradebook, feedback_files, fill_in
from logical_robots_tui.lab.submissions import NOTHING, UNCLEAR, UNMATCHED, Assignment
from logical_robots_tui.lab.tasks import Result
from logical_robots_tui.wording import count_of
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.load import read_level

_LONGEST_FILE = 60
_MOST_ENDS = 8  # robots of a level of which feedback tells the end
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

Draw: TypeAlias = Callable[[Level, Mapping[str, Sequence[tuple[float, float]]]], str]
"""Draws a level with the paths of robots as SVG."""


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
    assignment = _assignment_of(manifest)
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


def _assignment_of(manifest: Manifest) -> Assignment:
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


def export_grades(folder: Folder, records: RunRecords, draw: Draw | None = None) -> list[str]:
    """Write gradebook, feedback and exports; return what was written, or raise InputError."""
    manifest, grades = records.manifest, grades_of(records)
    assignment = _assignment_of(manifest)
    show: list[str] = [*assignment.assignment.show]
    names = _file_names([grade.student.id for grade in grades])
    given_runs = [run for run in records.finished if not run.start]
    runs_by_level = {(run.cell.student, run.cell.level_name): run for run in given_runs}
    pages: dict[tuple[str, str], str] = {}  # by id and name
    texts: dict[str, str] = {}
    for grade, name in zip(grades, names, strict=True):
        record = {**msgspec.to_builtins(grade), "title": manifest.title}
        for level in record["levels"]:
            del level["last"]
            for key in {"won", "ticks", "size", "distance"} - set(show):
                del level[key]
            if "won" not in show:
                del level["outcome"], level["ends"], level["questions"]
            if "starts" not in show:
                del level["wins"], level["starts"], level["lost"]
            level["parts"] = [part for part in level["parts"] if part["name"] in show]
        parts = _feedback(grade, assignment)
        runs = [runs_by_level.get((grade.student.id, level.level)) for level in grade.levels]
        pictures = ["", *(_picture(folder, run, draw if "won" in show else None) for run in runs)]
        page = as_page(manifest.title, parts_as_html(parts, pictures))
        if grade.points is not None:
            texts[grade.student.id] = "".join(parts_as_html(parts, [""] * len(parts)))
            pages[grade.student.id, grade.student.name] = page
        files: dict[str, str | bytes] = {
            f"feedback/{name}.md": parts_as_markdown(manifest.title, parts),
            f"feedback/{name}.html": page,
            f"feedback/{name}.json": _json(record),
            f"gradescope/{name}.json": _json(_gradescope(grade, parts)),
        }
        if len(grades) == 1:
            files["results.json"] = files[f"gradescope/{name}.json"]
        for file, content in files.items():
            folder.put(folder.path / file, content)
    for old_file in (*folder.path.glob("feedback/*"), *folder.path.glob("gradescope/*")):
        if old_file.stem not in names:
            old_file.unlink()  # of an earlier class list
    name_of = {student.id: student.name for student in manifest.students}
    duplicate_rows: list[Row] = [
        (level, len(ids), ", ".join(ids), ", ".join(name_of[s] for s in ids), text)
        for level, text, ids in duplicates(manifest)
    ]
    table = ResultTable(("level", "students", "ids", "names", "program"), duplicate_rows)
    tables = {"gradebook": gradebook(grades), "duplicates": table}
    file_names = write_tables(folder, tables, SPREADSHEET_MARK)
    folder.put(folder.path / "junit.xml", _junit(manifest.title, grades))
    file_names += ["junit.xml", "feedback/", "gradescope/"]
    uploads = _uploads(folder, manifest.gradebook, grades, texts, pages)
    file_names += ["upload/"] * bool(uploads)
    for file, content in uploads.items():
        folder.put(folder.path / "upload" / file, content)
    for old_file in folder.path.glob("upload/*"):
        if old_file.name not in uploads:
            old_file.unlink()
    return file_names + ["results.json"] * (len(grades) == 1)


def _uploads(
    folder: Folder,
    table: Gradebook | None,
    grades: list[Grade],
    texts: Mapping[str, str],
    pages: Mapping[tuple[str, str], str],
) -> dict[str, bytes]:
    """Return the files that the platform of a gradebook takes back, by name."""
    if table is None:
        return {}
    points = {grade.student.id: grade.points for grade in grades}
    files = {table.file: fill_in(table, folder.text(table.text), points, texts, readable)}
    return files | ({"feedback.zip": pack(feedback_files(pages))} if table.is_moodle else {})


def _file_names(ids: list[str]) -> list[str]:
    names: list[str] = []
    used_names: set[str] = set()
    for student_id in ids:
        name = re.sub(r"[^A-Za-z0-9_.-]", "_", student_id).strip(".")
        if name != student_id or len(name) > _LONGEST_FILE or name.casefold() in used_names:
            name = f"{name[:_LONGEST_FILE]}-{digest(student_id)[:8]}"
        used_names.add(name.casefold())
        names.append(name)
    return names


def gradebook(grades: list[Grade]) -> ResultTable:
    levels = [level.level for level in grades[0].levels] if grades else []
    head = ("id", "name", "submission", "late", "by_hand", "points", "most", "ungraded")
    rows = [
        (
            grade.student.id,
            grade.student.name,
            grade.student.submission,
            grade.student.late,
            sum(points for points, _ in grade.student.added),
            grade.points,
            grade.most,
            grade.ungraded,
            *(level.points for level in grade.levels),
            "; ".join(grade.remarks),
        )
        for grade in grades
    ]
    return ResultTable((*head, *levels, "remarks"), list(rows))


def feedback_of(records: RunRecords, student: str) -> str:
    """Return what a student gets to read, as Markdown."""
    (grade,) = (grade for grade in grades_of(records) if grade.student.id == student)
    parts = _feedback(grade, _assignment_of(records.manifest))
    return parts_as_markdown(records.manifest.title, parts)


def _feedback(grade: Grade, assignment: Assignment) -> list[tuple[str, list[str]]]:
    """Return headings and the sentences below each; the first one is about the student."""
    student, show = grade.student, assignment.assignment.show
    head = f"{student.name or student.id}: {grade.points_text}"
    if student.lateness:
        head += f" ({student.lateness}; {assignment.late.rule(student)[1]})"
    parts = [(head, grade.remarks)]
    for level in grade.levels:
        points = "not graded yet"
        if level.points is not None:
            points = f"{level.points:g} of {level.most:g} points"
        parts.append((f"{level.level}: {points}", _level_feedback(level, show)))
    return parts


def _picture(folder: Folder, run: RunRecord | None, draw: Draw | None) -> str:
    """Return a picture of a run that was not won, or ""."""
    if run is None or draw is None or not run.result.paths:
        return ""
    level = read_level(folder.text(run.cell.level), run.cell.level_name)
    caption = "The ways of the robots from the given start, with a circle where each ended."
    picture = draw(level, run.result.paths)
    return f"<figure>{picture}<figcaption>{caption}</figcaption></figure>"


def _ending(level: LevelGrade) -> str:
    """Return how a level's run from the given start ended, or why there was none, as a sentence."""
    if level.is_missing:
        return f"{level.outcome[0].upper()}{level.outcome[1:]}."
    if level.outcome == "does not compile":
        return "Your program does not compile:"
    if level.outcome == "nothing changes":
        return f"The run ended at tick {level.last:,}: nothing could change any more."
    return f"From the given start: {level.outcome}."


def _level_feedback(level: LevelGrade, show: Sequence[str]) -> list[str]:
    parts = {part.name: part for part in level.parts if part.name in show and len(level.parts) > 1}
    sentences = [str(part) for part in parts.values() if level.outcome != "does not compile"]
    if level.failure:
        sentences.append(f"Not graded yet, because a run could not be finished: {level.failure}.")
        if not level.last:
            return sentences
    has_part = "won" in parts and level.won
    if ("won" in show and not has_part) or level.is_missing or level.outcome == "does not compile":
        sentences.append(_ending(level))
        sentences += (*level.ends[:_MOST_ENDS], *level.questions)
        if level.ends:
            sentences.append(f"To see that: logical-robots play {quote(level.file)} YOUR-PROGRAM")
    if "ticks" in show and "ticks" not in parts and level.ticks is not None:
        sentences.append(f"Won in {level.ticks:,} ticks.")
    if "size" in show and "size" not in parts and level.size is not None:
        sentences.append(f"{count_of(level.size, 'symbol')}.")
    if "distance" in show and level.distance:
        sentences.append(f"{level.distance:,.0f} units driven.")
    if "starts" in show and level.starts and (level.wins or level.lost):
        if "starts" not in parts:
            sentences.append(f"Won from {level.wins} of {level.starts} varied starts.")
        if level.lost:
            sentences.append(f"Lost from varied start {', '.join(map(str, level.lost))}.")
            program = f"YOUR-PROGRAM --start {level.lost[0]}"
            sentences.append(f"To see that: logical-robots play {quote(level.file)} {program}")
    return sentences + list(level.messages)


def _gradescope(grade: Grade, parts: Parts) -> dict[str, Any]:
    """Return results in Gradescope's format; without any score while a level is ungraded."""
    texts = ["\n".join(map(harmless_text, (head, *sentences))) for head, sentences in parts]
    tests: list[dict[str, Any]] = []
    for level, text in zip(grade.levels, texts[1:], strict=True):
        score = {} if grade.points is None else {"score": level.points}
        test = {"name": level.level, **score, "max_score": level.most, "output": text}
        tests.append({**test, "output_format": "text", "visibility": "visible"})
    score = {} if grade.points is None else {"score": grade.points}
    return {**score, "output": texts[0], "output_format": "text", "tests": tests}


def _json(document: Any) -> bytes:
    return msgspec.json.format(msgspec.json.encode(document), indent=2) + b"\n"


def _junit(title: str, grades: list[Grade]) -> bytes:
    top = ElementTree.Element("testsuites", name=harmless_text(title))
    for grade in grades:
        label = harmless_text(grade.student.label)
        suite = ElementTree.SubElement(top, "testsuite", name=label)
        counts = dict.fromkeys(("failures", "errors", "skipped"), 0)
        for level in grade.levels:
            case = ElementTree.SubElement(suite, "testcase", classname=label, name=level.level)
            kind = "" if level.won else "failure"
            if level.points is None or level.is_missing:
                kind = "error" if level.points is None else "skipped"
            if kind:
                counts[{"failure": "failures", "error": "errors"}.get(kind, kind)] += 1
                element = ElementTree.SubElement(case, kind, message=level.failure or level.outcome)
                element.text = "\n".join(map(harmless_text, level.messages))
        suite.set("tests", str(len(grade.levels)))
        for kind, count in counts.items():
            suite.set(kind, str(count))
    ElementTree.indent(top)
    return bytes(ElementTree.tostring(top, encoding="utf-8", xml_declaration=True)) + b"\n"
