"""Specifications: what is wrong with one is said at once, each with its line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.competing import plan_tournament
from logical_robots_tui.lab.submissions import normalise, plan_grading
from logical_robots_tui.lab.sweeping import (
    Case,
    Experiment,
    ExperimentTable,
    Query,
    RunLimit,
    Sample,
    Vary,
    plan_sweep,
    read_experiment,
)
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.toml_files import TomlFile, TomlFileError
from logical_robots_tui.world.levels.load import read_level
from tests.lab.laboratory import FIRST_STEPS, write_experiment


def problems(folder: Path, text: str) -> list[str]:
    """All that is wrong with an experiment, without the folder."""
    (folder / "first.l").write_text(FIRST_STEPS, "utf-8")
    file = folder / "e.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(TomlFileError) as caught:
        plan_sweep(file)
    return [problem.removeprefix(f"{folder}/") for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("plan", "text", "lines"),
    [
        (
            plan_grading,
            '[assignment]\ntitel = "x"\nstarts = -3\n[[level]]\nname = "99-none"\n',
            ["2", "3", "5"],
        ),
        (plan_tournament, '[tournament]\nlevel = "16-nope"\ntitel = "x"\n', ["2", "3"]),
    ],
)
def test_unknown_keys_and_wrong_names_are_told_together(
    tmp_path: Path, plan: Callable[[Path, Path], object], text: str, lines: list[str]
) -> None:
    file = tmp_path / "a.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(TomlFileError) as caught:
        plan(file, tmp_path)
    assert [problem.split(":")[-2] for problem in caught.value.problems] == lines


def test_all_that_is_wrong_is_said_with_its_line(tmp_path: Path) -> None:
    found = problems(
        tmp_path,
        """
[experiment]
level = "01-first-steps"
starts = -1
tics = 20
[[vary]]
constant = "Near"
values = 3
[[vary]]
values = [1]
frm = 2
[measure]
won = 3
[limit]
""",
    )
    lines = [problem.split(": ")[0].removeprefix("e.toml:") for problem in found]
    assert lines == ["2", "4", "5", "8", "11", "13", "14"]
    assert '"experiment.program" is missing' in found[0]
    assert 'Did you mean "ticks"?' in found[2]


@pytest.mark.parametrize("bounds", ["0, 1, 0", "0, 1, -1", "0, 1e9, 1", "-1e308, 1e308, 1"])
def test_a_range_is_finite_and_not_too_long(tmp_path: Path, bounds: str) -> None:
    begin = '[experiment]\nlevel = "01-first-steps"\nprogram = "first.l"\n'
    (said,) = problems(tmp_path, f'{begin}[[vary]]\nconstant = "Near"\nrange = [{bounds}]\n')
    assert said.startswith("e.toml:6: A range is [from, to, step], at most 10,000")


def test_names_are_looked_up_with_the_line_that_names_them(tmp_path: Path) -> None:
    found = problems(
        tmp_path,
        '[experiment]\nlevel = ["01-first-step", "02-open-space"]\nprogram = "frist.l"\n'
        'ticks = "reference-1"\n',
    )
    assert len(found) == 3
    assert found[0].startswith('e.toml:2: There is no level called "01-first-step"')
    assert found[1].startswith("e.toml:3: frist.l: There is no such program")
    assert found[2].startswith('e.toml:4: "ticks" is a number or like')


def test_unknown_keys_and_wrong_programs_are_said_together(tmp_path: Path) -> None:
    (tmp_path / "wrong.l").write_text("Robot(robot_name:) :- Snesor(robot_name:);\n")
    found = problems(
        tmp_path,
        '[experiment]\ntics = 3\nlevel = ["01-first-steps", 2]\nprogram = "wrong.l"\n'
        "[[vary]]\nvalues = [1]\n[[vary]]\nbetween = [1, []]\n",
    )
    assert [problem.split(": ")[0] for problem in found] == [
        *("e.toml:2", "e.toml:3"),
        *["e.toml:4"] * (len(found) - 4),
        *("e.toml:5", "e.toml:8"),
    ]
    assert any("wrong.l:1:" in problem and "Snesor" in problem for problem in found)


def test_a_constant_a_field_and_a_question_must_exist(tmp_path: Path) -> None:
    begin = '[experiment]\nlevel = "01-first-steps"\nprogram = "first.l"\n'
    assert (
        "Far is not a constant"
        in problems(tmp_path, begin + '[[vary]]\nconstant = "Far"\nvalues = [1]\n')[0]
    )
    assert problems(tmp_path, begin + '[[vary]]\nlevel = "robots.*.batery"\nvalues = [1]\n')
    (said,) = problems(tmp_path, begin + '[measure]\nnear = {query = "Nearer(x:)"}\n')
    assert said.startswith("e.toml:5: first.l: ")
    assert "Nearer" in said


def test_the_page_names_every_key_of_an_experiment(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "lab.md").read_text("utf-8")
    _, text, *_ = page.partition("## What an experiment can say")[2].split("```")
    file = tmp_path / "e.toml"
    file.write_text(text.removeprefix("toml"), "utf-8")
    spec = TomlFile(file)
    read_experiment(spec)
    assert spec.problems == ()
    kinds = (Experiment, ExperimentTable, Vary, Sample, Case, Query, RunLimit)
    named = {key for kind in kinds for key in kind.__struct_fields__} - {"title", "steps"}
    assert {key for key in named if f"{key} =" not in text and f"{key}]" not in text} == set()


def test_what_is_not_toml_is_said_with_its_line(tmp_path: Path) -> None:
    (said,) = problems(tmp_path, "[experiment]\nlevel = \n")
    assert said.startswith("e.toml:2: This is not valid TOML: Invalid value")
    with pytest.raises(TomlFileError, match="can't be read"):
        plan_sweep(tmp_path / "missing.toml")


def test_what_is_varied_is_crossed_and_cases_are_not(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=[20, 40])
    with file.open("a") as text:
        text.write('[[vary]]\nlevel = "robots.*.heading"\nrange = [0, 90, 45]\n')
        text.write("[[case]]\nconstants = {Near = 55.5}\n")
    manifest, inputs = plan_sweep(file)
    settings = [tuple(cell.settings.values()) for cell in manifest.cells]
    crossed = [(near, heading) for near in (20, 40) for heading in (0, 45, 90)]
    assert settings == [*crossed, (55.5,)]
    program = inputs[manifest.cells[-1].program]
    assert program == FIRST_STEPS.replace("Near() = 40;", "Near() = 55.5;")
    assert "heading = 45" in inputs[manifest.cells[1].level]


def test_a_level_of_the_web_platform_can_be_varied(tmp_path: Path) -> None:
    theirs = tmp_path / "theirs.json"
    assert main(["level", "convert", "12-power-line", str(theirs)]) == 0
    (tmp_path / "first.l").write_text(FIRST_STEPS)
    file = tmp_path / "e.toml"
    file.write_text(
        '[experiment]\nlevel = "theirs.json"\nprogram = "first.l"\nticks = 5\n'
        '[[vary]]\nlevel = "robots.*.battery_capacity"\nvalues = [7]\n'
    )
    manifest, inputs = plan_sweep(file)
    level = read_level(inputs[manifest.cells[0].level], "theirs")
    assert [robot.battery_capacity for robot in level.robots] == [7] * len(level.robots)


@pytest.mark.parametrize("value", ["60", "-0.5", "true", '"a b"', "[1, 2]"])
def test_a_constant_is_replaced_in_the_parsed_program(value: str) -> None:
    text = "# Near() = 1;\nNear() = 1 + \n 2; Text() = 'Near() = 4;';  # Near() = 5;\n"
    changed = Program.with_constants(text, {"Near": value})
    assert changed == text.replace("1 + \n 2", f"{value}\n")


@pytest.mark.parametrize(
    "rule", ["Near(x) = 1;", "Near() = x :- x == 1;", "Near() Sum= 1;", "Far() = 1;", "Near(1);"]
)
def test_only_a_predicate_without_arguments_and_body_is_a_constant(rule: str) -> None:
    with pytest.raises(ProgramError, match="Near is not a constant"):
        Program.with_constants(rule, {"Near": "2"})


def test_programs_are_the_same_but_for_comments_and_space() -> None:
    text = 'A("x  y") = 1;  # remark\nB() :- A( "x  y" );\n'
    same = '\nA("x  y")   =\n1; B() :-\tA( "x  y" );'
    assert normalise(text) == normalise(same)
    assert normalise(text) != normalise(text.replace("x  y", "x y"))


def test_what_is_wrong_with_an_assignment_is_said(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(
        '[assignment]\nroster = "r.csv"\nshow = ["won", "grade"]\nstarts = 0\n'
        '[[level]]\nname = "01-first-steps"\npoints = -1\n[late]\nafter = 2026-01-01T00:00:00\n'
    )
    with pytest.raises(TomlFileError) as caught:
        plan_grading(file, tmp_path)
    lines = [problem.split(": ")[0].removeprefix(f"{file}:") for problem in caught.value.problems]
    assert lines == ["2", "3", "7", "9"]
    mine = (shipped_folder("levels") / "01-first-steps.toml").read_bytes()
    (tmp_path / "mine.toml").write_bytes(mine.replace(b"First steps", b"Mine"))
    file.write_text('[assignment]\n[[level]]\nname = "mine.toml"\n')
    with pytest.raises(TomlFileError, match=r"mine has no reference .* such as ticks = 2000"):
        plan_grading(file, tmp_path)
    (tmp_path / "r.csv").write_text("id\n1\n1\n")
    file.write_text(
        '[assignment]\nroster = "r.csv"\nstarts = 0\n[[level]]\nname = "01-first-steps"\n'
        "[points]\nstarts = 1\n"
    )
    with pytest.raises(TomlFileError, match=r"a\.toml:7: There are points for starts"):
        plan_grading(file, tmp_path)
