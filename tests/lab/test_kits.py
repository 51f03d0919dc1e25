"""Kits of learning platforms: their scripts are run as the platforms run them."""

import base64
import json
import os
import sys
import sysconfig
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml

from logical_robots_tui.cli.main import main
from tests.cli.running import Command
from tests.lab.laboratory import FIRST_STEPS, STANDING, lane, write_files
from tests.processes import run_command

ASSIGNMENT = """
# Ada may be late
[assignment]
starts = 0
ticks = 150
roster = "roster.csv"
pattern = "{id}_{level}.l"
[[level]]
name = "maps/lane.toml"
[[level]]
name = "01-first-steps"
[late]
after = 2026-01-31T12:00:00Z
extensions = "extensions.csv"
keep = 0.5
"""
CLASS = {
    "week.toml": ASSIGNMENT,
    "maps/lane.toml": lane("Lane"),
    "roster.csv": "id,name\nada,Ada\n",
    "extensions.csv": "id,days\nada,9\n",
}
IN_TIME, LATE = "2026-01-31T11:59:59.365935+00:00", "2026-01-31T04:00:01.365935-08:00"
LEFT_OUT = "assignment.roster, assignment.pattern, late.extensions\n"
KEYS = {"score", "max_score", "name", "output", "output_format", "visibility"}
VISIBILITY = {"hidden", "after_due_date", "after_published", "visible"}
FORMATS = {"text", "html", "simple_format", "md", "ansi"}

SUBMISSIONS: dict[str, tuple[dict[str, str], str, float | None, str]] = {
    "loose files": ({"my lane.l": FIRST_STEPS, "1.l": STANDING}, IN_TIME, 10, "Ada, Ben: 10 of 20"),
    "nested folders": ({"a/b/lane.l": FIRST_STEPS, "c/d.txt": "-"}, LATE, 5, "late; 50% counts"),
    "one program": ({"final.l": FIRST_STEPS}, IN_TIME, 10, "Ada, Ben: 10 of 20"),
    "a program in a document": ({"lane.docx": "-"}, IN_TIME, None, "Ada, Ben: not graded yet"),
    "no time": ({"lane.l": FIRST_STEPS}, "", None, "When the submissions were handed in is not"),
}
"""What is handed in and when, the points, and a part of what is said of it."""

QUICK = ("nested folders", "a program in a document")


def run_bash(words: Sequence[object], folder: Path, **variables: object) -> None:
    """Run as in a container without a network, in which pip finds everything installed."""
    path = f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    env = {"PIP_NO_INDEX": "1", "PATH": path, **variables}
    env = os.environ | {name: str(value) for name, value in env.items()}
    done = run_command(["bash", *map(str, words)], cwd=folder, env=env, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


def check_results(results: dict[str, Any], points: float | None) -> None:
    """Check what gradescope-autograders.readthedocs.io/en/latest/specs says of results.json."""
    tests = results["tests"]
    assert results["output_format"] in FORMATS
    assert results.get("score") == points
    for test in tests:
        assert {*test} <= KEYS
        assert (test["visibility"] in VISIBILITY, test["output_format"] in FORMATS) == (True, True)
        assert ("score" in test) == (points is not None)


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write_files(tmp_path_factory.mktemp("kit"), CLASS)
    words = ["grade", "kit", "gradescope", f"{folder}/week.toml", "-o", f"{folder}/kit.zip"]
    assert [main(words), main(words)] == [0, 2]  # it is not replaced
    with zipfile.ZipFile(folder / "kit.zip") as kit:
        names = ["assignment.toml", "levels/lane.toml", "run_autograder", "setup.sh"]
        assert sorted(kit.namelist()) == names
        assert kit.getinfo("run_autograder").external_attr >> 16 == 0o755
        kit.extractall(folder / "source")
    run_bash(["source/setup.sh"], folder, PYTHON=sys.executable)
    return folder / "source"


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, marks=[pytest.mark.slow] * (case not in QUICK)) for case in SUBMISSIONS],
)
def test_gradescope_gets_points_or_the_reason_why_there_are_none(
    case: str, source: Path, tmp_path: Path
) -> None:
    files, time, points, sentence = SUBMISSIONS[case]
    people = [{"id": 1, "email": "a@x.org", "name": name} for name in ("Ada", "Ben")]
    metadata = {"users": people} | ({"created_at": time} if time else {})
    write_files(tmp_path, {"submission_metadata.json": json.dumps(metadata)})
    write_files(tmp_path / "submission", files)
    (tmp_path / "source").symlink_to(source)
    run_bash(["source/run_autograder"], tmp_path, AUTOGRADER=tmp_path, PYTHON=sys.executable)
    results = json.loads((tmp_path / "results/results.json").read_text("utf-8"))
    check_results(results, points)
    assert sentence in results["output"]


@pytest.mark.parametrize(
    ("files", "pushed", "points", "states"),
    [
        ({"lane.l": FIRST_STEPS}, "2026-01-31T12:00:01Z", 5, ["pass", "fail", "fail"]),
        pytest.param(
            {"lane.l": FIRST_STEPS, "1.l": STANDING},
            *("1769860799", 10, ["pass", "fail"]),
            marks=pytest.mark.slow,
        ),
        pytest.param({"README.md": "-"}, "1769860799", None, ["error"], marks=pytest.mark.slow),
    ],
)
def test_github_classroom_gets_points_and_a_summary(
    files: dict[str, str],
    pushed: str,
    points: float | None,
    states: list[str],
    tmp_path: Path,
    command: Command,
) -> None:
    write_files(tmp_path, CLASS)
    repository = write_files(tmp_path / "repository", {".git/config": "", **files})
    kit = ("grade", "kit", "github", tmp_path / "week.toml", "-o", repository)
    assert command(*kit).success.endswith(LEFT_OUT)
    assert "already exists" in command(*kit).refusal
    (workflow,) = repository.glob(".github/workflows/*")
    (job,) = yaml.safe_load(workflow.read_text("utf-8"))["jobs"].values()
    variables = {"GITHUB_WORKSPACE": repository, "GITHUB_REPOSITORY": "school/week-1-ada"}
    variables |= {f"GITHUB_{name}": tmp_path / name for name in ("OUTPUT", "STEP_SUMMARY")}
    for step in job["steps"]:
        if "run" in step:
            env = dict.fromkeys(step.get("env", ()), pushed)
            words = ["--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
            run_bash(words, repository, **variables, **env, RUNNER_TEMP=tmp_path)
    assert job["steps"][-1]["env"] == {"GRADE_RESULTS": "${{ steps.grade.outputs.result }}"}
    key, _, encoded = (tmp_path / "OUTPUT").read_text().partition("=")
    report = json.loads(base64.b64decode(encoded))
    # What the reporter reads: it adds up the scores if there is a maximum, and prints the messages.
    assert (key, report["version"], report["status"]) == ("result", 1, states[-1])
    assert [test["status"] for test in report["tests"]] == states
    assert all(test["name"] and test["message"] for test in report["tests"])
    assert report["max_score"] == (20 if points else 0)
    assert sum(test["score"] for test in report["tests"]) == (points or 0)
    summary = (tmp_path / "STEP_SUMMARY").read_text("utf-8")
    sentence = f"{points} of 20 points" if points else "not graded yet"
    assert summary.startswith(f"# week\n\nweek-1-ada: {sentence}")
