"""The assignments and the marked submission of docs/teaching.md."""

import re
from pathlib import Path

import pytest

from logical_robots_tui.lab.submissions import plan_grading
from logical_robots_tui.world.levels.load import current_name
from tests.cli.running import Command
from tests.installed import CHECKOUT
from tests.lab.laboratory import program_text, rows, write_files

PAGE = CHECKOUT / "docs/teaching.md"
TEXT = PAGE.read_text("utf-8")
WEEKS = dict(re.findall(r"^\| (\d+) \| ([^|a-z]*\d[^|]*) \| [^|]+ \|$", TEXT, re.M))


def write_week(folder: Path, week: str) -> list[str]:
    """Write a week's assignment and a class in which all hand in the solutions; return levels."""
    (text,) = re.findall(r"`week-1\.toml`:\n\n```toml\n(.*?)```", TEXT, re.S)
    head, *levels, end = re.split(r"(?=^\[\[level\]\]|^\[points\])", text, flags=re.M)
    numbers = re.findall(r"\d+", WEEKS[week])
    tables = [levels[0].replace('"1"', f'"{number}"') for number in numbers]
    assert week != "1" or tables == levels
    text = "".join([head.replace("Week 1", f"Week {week}"), *tables, end])
    names = [str(current_name(number)) for number in numbers]
    files = {f"all/ada/{name}.l": program_text(name.partition("-")[2]) for name in names}
    write_files(folder, {"week.toml": text, "roster.csv": "id,name\n1,Ada\n", **files})
    return names


def test_each_week_has_an_assignment_with_the_levels_of_the_term(tmp_path: Path) -> None:
    assert [*WEEKS] == [str(number) for number in range(1, 11)]
    for week in WEEKS:
        levels = write_week(tmp_path / week, week)
        manifest, _ = plan_grading(tmp_path / week / "week.toml", tmp_path / week / "all")
        assert (manifest.title, [c.level_name for c in manifest.cells]) == (f"Week {week}", levels)


@pytest.mark.slow
@pytest.mark.parametrize("week", WEEKS)
def test_the_solutions_get_all_points_of_a_week(
    week: str, tmp_path: Path, command: Command
) -> None:
    levels = write_week(tmp_path, week)
    assignment = tmp_path / "week.toml"
    text = assignment.read_text("utf-8")
    assignment.write_text(re.sub("^starts = 4$", "starts = 1", text, count=1, flags=re.M), "utf-8")
    command("grade", assignment, tmp_path / "all", "-o", tmp_path / "out", status=0)
    (ada,) = rows(tmp_path / "out/gradebook.csv")
    assert float(ada["points"]) == float(ada["most"]) == 10 * len(levels)


def test_the_marked_submission_is_what_the_student_reads(
    tmp_path: Path, command: Command, pytestconfig: pytest.Config
) -> None:
    page = (CHECKOUT / "docs/grading.md").read_text("utf-8")
    files = re.findall(r"^`([^`\n]+)`:\n\n```\w+\n(.*?)^```$", page, re.M | re.S)
    names = [
        write_files(tmp_path, dict(files)) / name for name in ("assignment.toml", "submissions")
    ]
    out = command("grade", *names, "-o", tmp_path / "out", "--student", "Ben", status=0).out
    _, _, feedback = out.partition("\n# ")
    before, begin, rest = TEXT.partition("<!-- feedback: made by tests/lab/test_teaching.py -->\n")
    written, end, after = rest.partition("<!-- end of feedback -->\n")
    marked = f"\n```text\n# {feedback}```\n\n"
    assert begin
    if pytestconfig.getoption("--update-snapshots"):
        PAGE.write_text(before + begin + marked + end + after, "utf-8")
    else:
        assert written == marked
