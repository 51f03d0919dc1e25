"""Gradebooks of platforms that were read as a roster, filled in for the platforms to import.

What importers need is from Moodle's `assignfeedback_offline` and `assignfeedback_file` and from
Canvas's `GradebookImporter`: the heads and the columns that identify students as they were, no
number where there is no grade, and folders named after participants.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping
from pathlib import PurePath

import msgspec

from logical_robots_tui.lab.platforms.names import plain
from logical_robots_tui.lab.platforms.tables import (
    StudentTable,
    lines_of,
    number_of,
    separator_line,
)

_OF_PLATFORM = re.compile(r"(.+?) *(?:\(\d+\)|\[.*\] *\|\d+)", re.S)  # Canvas, Blackboard
_POSSIBLE = "Points Possible"  # the row of Canvas with the maximum of each assignment
_FEEDBACK = re.compile("feedback|kommentar|commen|comentari|opmerking|komentarz")
_MAXIMUM = re.compile("max|bestwertung|massim|maksym")
_PARTICIPANT = re.compile(r"\D{4,}(\d+)")
_PAGE = "feedback.html"


class Gradebook(msgspec.Struct, frozen=True):
    """A roster with a column for points; columns are numbers, `feedback` is -1 if there is none.

    Attributes:
        text: The digest of its text.
        is_moodle: Whether feedback can go back as a zip file of participants' folders.
    """

    file: str
    text: str
    encoding: str
    separator: str
    id: int
    points: int
    feedback: int = -1
    is_moodle: bool = False


def gradebook_of(
    table: StudentTable, text_digest: str, title: str, maximum: float
) -> tuple[Gradebook | None, list[str]]:
    """Return how a roster is filled in, None if it has no column for points, and notes on it."""
    heads, *rows = [cells for _, cells in lines_of(table.text, table.separator) if cells] or [[]]
    heads = [head.strip() for head in heads]
    assignments = {n: m[1] for n, head in enumerate(heads) if (m := _OF_PLATFORM.fullmatch(head))}
    same_title = [n for n, name in assignments.items() if plain(name) == plain(title)]
    points = table.columns.get("points")
    if points is None and assignments:
        if len(same_title or assignments) > 1:
            head = heads[next(iter(assignments))]
            note = f'Which column takes the points? columns = {{points = "{head}"}} says it'
            return None, [note]
        (points,) = same_title or assignments
    if points is None or not (assignments or all(_is_grade(row, points) for row in rows)):
        return None, []
    later_heads = {n: plain(head) for n, head in enumerate(heads) if n > points}
    feedback = next((n for n, head in later_heads.items() if _FEEDBACK.search(head)), -1)
    column = next((n for n, head in later_heads.items() if _MAXIMUM.search(head)), -1)
    maxima = [m[1] for m in [re.search(r"Total Pts: ([\d.,]+)", heads[points])] if m]
    maxima += [row[column] for row in rows if 0 <= column < len(row)]
    maxima += [row[points] for row in rows if row[0].strip() == _POSSIBLE and points < len(row)]
    notes = [
        f"The most is {text.strip()} points, but the assignment has {maximum:g}"
        for text in dict.fromkeys(maxima)
        if re.fullmatch(r" *[\d.,]+ *", text) and number_of(text) != maximum
    ]
    is_moodle = not assignments and all(_PARTICIPANT.fullmatch(row.id) for row in table.rows)
    columns = (table.columns["id"], points, feedback)
    source = (PurePath(table.file).name, text_digest, table.encoding, table.separator)
    return Gradebook(*source, *columns, is_moodle), notes


def _is_grade(row: list[str], column: int) -> bool:
    return column >= len(row) or bool(re.fullmatch(r"[ \d.,-]*", row[column]))


def fill_in(
    gradebook: Gradebook,
    text: str,
    points: Mapping[str, float | None],
    feedback: Mapping[str, str],
    key_of: Callable[[str], str],
) -> bytes:
    """Return a gradebook with points and feedback by student, found by the key of a cell.

    Cells of students who are ungraded, and of feedback that somebody wrote, stay as they were.
    """
    lines = list(lines_of(text, gradebook.separator))
    decimals = [cell for _, cells in lines for cell in cells if re.fullmatch(r"\d+[.,]\d+", cell)]
    mark = "," if any("," in cell for cell in decimals) else "."
    buffer = io.StringIO()
    buffer.write(separator_line(text).replace("\n", "\r\n"))
    writer = csv.writer(buffer, delimiter=gradebook.separator)
    for number, (_, cells) in enumerate(lines):
        width = max(gradebook.id, gradebook.points, gradebook.feedback) + 1
        row = cells + [""] * (width - len(cells)) if number and cells else cells
        student = key_of(row[gradebook.id].strip()) if number and row else ""
        if (sum_of_points := points.get(student)) is not None:
            row[gradebook.points] = f"{sum_of_points:.6g}".replace(".", mark)
        if gradebook.feedback >= 0 and student in feedback and not row[gradebook.feedback].strip():
            row[gradebook.feedback] = feedback[student]
        writer.writerow(row)
    return buffer.getvalue().encode(gradebook.encoding)


def feedback_files(pages: Mapping[tuple[str, str], str]) -> dict[str, str]:
    """Return pages by participant and name by the paths at which Moodle takes them back."""
    files = {}
    for (participant, name), page in pages.items():
        label = re.sub(r'[_/\\<>:"|?*\x00-\x1f]', " ", name).strip() or "-"
        number = _PARTICIPANT.fullmatch(participant)
        folder = f"{label}_{number[1] if number else ''}_assignsubmission_file_"
        files[f"{folder}/{_PAGE}"] = page
    return files
