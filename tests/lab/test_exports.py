"""A class of 22 in the export of each platform, with rosters in each language: nobody is lost."""

import csv
import re
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.lab.platforms.dates import parse_date
from logical_robots_tui.lab.platforms.names import plain
from logical_robots_tui.lab.platforms.tables import read_table
from logical_robots_tui.lab.submissions import plan_grading
from tests.installed import CHECKOUT
from tests.lab.laboratory import write_files
from tests.lab.test_handins import zipped

CASES = tomllib.loads(Path(__file__).with_name("exports.toml").read_text("utf-8"))
PAGE = CHECKOUT / "docs/grading.md"
MARKS = ("<!-- exports: made by tests/lab/test_exports.py -->\n", "<!-- end of exports -->\n")
FILES = {"01-first-steps": "01-first-steps.l", "02-open-space": "02-open-space.l"}
LATE = "Lena"
PROGRAM = 'A("{} {}");'


def class_for(times: list[str]) -> list[dict[str, str]]:
    students = []
    for n, line in enumerate(CASES["students"].splitlines(), 1):
        first, last = line.split("|")
        fields = {"first": first, "last": last, "sid": f"s{1000 + n}", "user": f"student{n:02}"}
        fields |= {"moodle": f"{398020 + n}", "canvas": f"{4100 + n}", "number": f"{70000 + n}"}
        fields |= {"flat": plain(last + first), "LATE": "LATE_" * (first == LATE)}
        fields |= {"secret": f"{n:05}", "copy": f"({n}) ", "time": times[first == LATE]}
        students.append(fields)
    return students


def packed(export: dict[str, Any]) -> bytes:
    files: dict[str, str] = dict.fromkeys(export.get("others", ()), "")
    for fields in class_for(export.get("times", ["", ""])):
        for level, file in FILES.items():
            name = export["file"].format(**fields, file=file)
            if "{last}" in export["file"]:
                name = re.sub('[<>:"|?*]', "", name)  # as platforms do
            files[name] = PROGRAM.format(fields["sid"], level)
            if "earlier" in export:
                files[export["earlier"].format(**fields, file=file)] = PROGRAM.format(
                    "earlier", level
                )
        if "metadata" in export:
            name = export["metadata_file"].format(**fields)
            files[name] = files.get(name, "") + export["metadata"].format(**fields)
    inner: dict[str, dict[str, str]] = {}
    for name in [name for name in files if ".zip/" in name]:
        archive, _, path = name.partition(".zip/")
        inner.setdefault(f"{archive}.zip", {})[path] = files.pop(name)
    return zipped(files | {name: zipped(texts) for name, texts in inner.items()})


def roster_of(roster: dict[str, Any]) -> bytes:
    students = class_for(roster.get("times", ["", ""]))
    lines = [roster["head"], *(roster["row"].format(**fields) for fields in students)]
    return "\r\n".join([*lines, ""]).encode(roster.get("encoding", "utf-8"))


def count_read(folder: Path, export: dict[str, Any], roster: str) -> int:
    """Plan a grading; return how many students have their own programs, and nobody another's."""
    text = '[assignment]\nroster = "roster.csv"\n'
    text += "".join(f'[[level]]\nname = "{level}"\n' for level in FILES)
    if "late" in export:
        text += "[late]\nafter = 2026-10-19T23:59:00Z\n"
    files: dict[str, str | bytes] = {
        "a.toml": text,
        "roster.csv": roster_of(CASES["rosters"][roster]),
    }
    write_files(folder, {**files, "class.zip": packed(export)})
    manifest, inputs = plan_grading(folder / "a.toml", folder / "class.zip")
    programs = {(cell.student, cell.level_name): inputs[cell.program] for cell in manifest.cells}
    count = 0
    for student, fields in zip(manifest.students, class_for(["", ""]), strict=False):
        own = [PROGRAM.format(fields["sid"], level) for level in FILES]
        graded = [programs.get((student.id, level)) for level in FILES]
        assert graded in (own, [None, None])
        assert graded == own or "no submission could be matched to this student" in student.remarks
        count += graded == own
    assert count < 22 or len(manifest.students) == 22
    late = [student.name for student in manifest.students[:22] if student.late]
    assert (len(late), LATE in "".join(late)) == (("late" in export),) * 2
    return count


def test_the_table_of_exports_says_what_is_read(
    tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    rows = ["", "| export | in it | roster | read | late by |", "|---|---|---|---|---|"]
    for export in CASES["exports"]:
        rosters = [name for name in CASES["rosters"] if re.fullmatch(export["rosters"], name)]
        (count,) = {count_read(tmp_path, export, roster) for roster in rosters}
        reason = f": {export['refused']}" if "refused" in export else ""
        assert (count == 22) != bool(reason), export["title"]
        names = ", ".join(rosters).replace(", worksheet, ", ", ")
        fields = class_for(export.get("times", ["", ""]))[0]
        name = export["file"].format(**fields, file="program.l")
        rows.append(
            f"| {export['title']} | `{name}` | {names} | {count} of 22{reason} "
            f"| {export.get('late', '`--file-times`' if count else '-')} |"
        )
    table = "\n".join([*rows, "", ""])
    before, begin, rest = PAGE.read_text("utf-8").partition(MARKS[0])
    written, end, after = rest.partition(MARKS[1])
    assert begin
    if pytestconfig.getoption("--update-snapshots"):
        PAGE.write_text(before + begin + table + end + after, "utf-8")
    else:
        assert written == table


@given(
    st.text('idname;,\t"\n sep=1aé\0', max_size=60),
    st.sampled_from(["utf-8", "utf-16", "cp1252"]),
    st.text(st.sampled_from("0123456789-: ,.JanMaiPMZ+ł"), max_size=30),
)
def test_any_table_and_any_date_is_read_or_refused(text: str, encoding: str, date: str) -> None:
    with suppress(ValueError, csv.Error):
        for row in read_table("r.csv", text.encode(encoding), ["id"], ["name"], {}).rows:
            assert row.id
    parse_date(date)
    parse_date(f"2026-10-18 20:15:02{date}")
