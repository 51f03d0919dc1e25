"""Grades for the teacher, the student and other programs: gradebook, feedback, exports."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from shlex import quote
from typing import Any, TypeAlias
from xml.etree import ElementTree

import msgspec

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
from logical_robots_tui.lab.folder import Folder, digest
from logical_robots_tui.lab.grading import Grade, LevelGrade, assignment_of, duplicates, grades_of
from logical_robots_tui.lab.handins import readable
from logical_robots_tui.lab.platforms.archives import pack
from logical_robots_tui.lab.platforms.gradebooks import Gradebook, feedback_files, fill_in
from logical_robots_tui.lab.submissions import Assignment
from logical_robots_tui.wording import count_of
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.load import read_level

_LONGEST_FILE = 60
_MOST_ENDS = 8  # robots of a level of which feedback tells the end

Draw: TypeAlias = Callable[[Level, Mapping[str, Sequence[tuple[float, float]]]], str]
"""Draws a level with the paths of robots as SVG."""


def export_grades(folder: Folder, records: RunRecords, draw: Draw | None = None) -> list[str]:
    """Write gradebook, feedback and exports; return what was written, or raise InputError."""
    manifest, grades = records.manifest, grades_of(records)
    assignment = assignment_of(manifest)
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
    parts = _feedback(grade, assignment_of(records.manifest))
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
