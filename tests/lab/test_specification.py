"""Specifications: what is wrong with one is said at once, each with its line."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.competing import plan_tournament
from logical_robots_tui.lab.handins import normalise
from logical_robots_tui.lab.submissions import plan_grading
from logical_robots_tui.lab.sweeping import (
    Case,
    Experiment,
    ExperimentTable,
    Query,
    RunLimit,
    SampleTable,
    Vary,
    plan_sweep,
    read_experiment,
)
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.toml_files import TomlFile, TomlFileError
from logical_robots_tui.world.levels.load import read_level
from tests.lab.laboratory import FIRST_STEPS, write_experiment, write_files

BEGIN = '[experiment]\nlevel = "01-first-steps"\nprogram = "first.l"\n'
TANGLED = Path(__file__).with_name("tangled.toml").read_text("utf-8")
TOURNAMENTS = {
    '[tournament]\nlevel = "16-nope"\ntitel = "x"\n': ["2: ", "3: "],
    '[tournament]\nformat = "knockout"\nstarts = -1\nseats = 2\n': ["1: ", "2: ", "3: ", "4: "],
    '[tournament]\nlevel = "01-first-steps"\n': ["2: "],
    '[tournament]\nstarts = 3\nlevel = "nowhere"\n': ["3: "],
}
EXPERIMENTS = {
    TANGLED: [
        *('2: "experiment.program" is missing', '4: "experiment.starts" must'),
        '5: "tics" is not a known key. Did you mean "ticks"?',
        *('8: "vary[0].values" must', '11: "frm" is not', '13: "measure.won" must'),
        '14: "limit" is not a known key. Did you mean "limits"?',
    ],
    '[experiment]\nlevel = ["01-first-step", "02-open-space"]\nprogram = "frist.l"\n'
    'ticks = "reference-1"\n': [
        '2: There is no level called "01-first-step"',
        "3: frist.l: There is no such program",
        '4: "ticks" is a number or like',
    ],
    '[experiment]\ntics = 3\nlevel = ["01-first-steps", 2]\nprogram = "wrong.l"\n'
    "[[vary]]\nvalues = [1]\n[[vary]]\nbetween = [1, []]\n": [
        *('2: "tics" is not a known key. Did you mean "ticks"?', '3: "experiment.level[1]"'),
        *("4: wrong.l:1:1: Robot", "4: wrong.l:1:23: Snesor", "5: Name either", "8: "),
    ],
    BEGIN + '[[vary]]\nconstant = "Far"\nvalues = [1]\n': ["4: first.l: Far is not a constant"],
    BEGIN + '[[vary]]\nlevel = "robots.*.batery"\nvalues = [1]\n': ["4: 01-first-steps: robots[0]"],
    BEGIN + '[measure]\nnear = {query = "Nearer(x:)"}\n': ["5: first.l: Nearer is not"],
    "[experiment]\nlevel = \n": ["2: This is not valid TOML: Invalid value"],
    **{
        f'{BEGIN}[[vary]]\nconstant = "Near"\nrange = [{bounds}]\n': [
            "6: A range is [from, to, step], at most 10,000"
        ]
        for bounds in ("0, 1, 0", "0, 1, -1", "0, 1e9, 1", "-1e308, 1e308, 1")
    },
}


@pytest.mark.parametrize(
    ("plan", "text", "beginnings"),
    [
        (
            plan_grading,
            '[assignment]\ntitel = "x"\nstarts = -3\n[[level]]\nname = "99-none"\n',
            ["2: ", "3: ", "5: "],
        ),
        *((plan_tournament, text, beginnings) for text, beginnings in TOURNAMENTS.items()),
        *((lambda file, _: plan_sweep(file), *case) for case in EXPERIMENTS.items()),
    ],
)
def test_all_that_is_wrong_is_said_with_its_line(
    tmp_path: Path, plan: Callable[[Path, Path], object], text: str, beginnings: list[str]
) -> None:
    wrong = "Robot(robot_name:) :- Snesor(robot_name:);\n"
    file = (
        write_files(tmp_path, {"first.l": FIRST_STEPS, "wrong.l": wrong, "e.toml": text}) / "e.toml"
    )
    with pytest.raises(TomlFileError) as caught:
        plan(file, tmp_path)
    for problem, beginning in zip(caught.value.problems, beginnings, strict=True):
        assert problem.startswith(f"{file}:{beginning}")


def test_the_page_names_every_key_of_an_experiment(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "lab.md").read_text("utf-8")
    _, text, *_ = page.partition("## What an experiment can say")[2].split("```")
    spec = TomlFile(write_files(tmp_path, {"e.toml": text.removeprefix("toml")}) / "e.toml")
    read_experiment(spec)
    assert spec.problems == ()
    kinds = (Experiment, ExperimentTable, Vary, SampleTable, Case, Query, RunLimit)
    named = {key for kind in kinds for key in kind.__struct_fields__} - {"title", "steps"}
    assert {key for key in named if f"{key} =" not in text and f"{key}]" not in text} == set()
    with pytest.raises(TomlFileError, match="can't be read"):
        plan_sweep(tmp_path / "missing.toml")


def test_what_is_varied_is_crossed_and_cases_are_not(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=[20, 40])
    with file.open("a") as text:
        text.write('[[vary]]\nlevel = "robots.*.heading"\nrange = [0, 90, 45]\n')
        text.write("[[case]]\nconstants = {Near = 55.5}\n")
    manifest, inputs = plan_sweep(file)
    settings = [tuple(cell.settings.values()) for cell in manifest.cells]
    assert settings == [*[(near, heading) for near in (20, 40) for heading in (0, 45, 90)], (55.5,)]
    program = inputs[manifest.cells[-1].program]
    assert program == FIRST_STEPS.replace("Near() = 40;", "Near() = 55.5;")
    assert "heading = 45" in inputs[manifest.cells[1].level]


def test_a_level_of_the_web_platform_can_be_varied(tmp_path: Path) -> None:
    theirs = tmp_path / "theirs.json"
    assert main(["level", "convert", "12-power-line", str(theirs)]) == 0
    table = {"level": theirs, "program": FIRST_STEPS, "ticks": 5}
    vary = [{"level": "robots.*.battery_capacity", "values": [7]}]
    manifest, inputs = plan_sweep({"experiment": table, "vary": vary})
    level = read_level(inputs[manifest.cells[0].level], "theirs")
    assert [robot.battery_capacity for robot in level.robots] == [7] * len(level.robots)


@pytest.mark.parametrize("value", ["60", "-0.5", "true", '"a b"', "[1, 2]"])
def test_a_constant_is_replaced_in_the_parsed_program(value: str) -> None:
    text = "# Near() = 1;\nNear() = 1 + \n 2; Text() = 'Near() = 4;';  # Near() = 5;\n"
    assert Program.with_constants(text, {"Near": value}) == text.replace("1 + \n 2", f"{value}\n")


@pytest.mark.parametrize(
    "rule", ["Near(x) = 1;", "Near() = x :- x == 1;", "Near() Sum= 1;", "Far() = 1;", "Near(1);"]
)
def test_only_a_predicate_without_arguments_and_body_is_a_constant(rule: str) -> None:
    with pytest.raises(ProgramError, match="Near is not a constant"):
        Program.with_constants(rule, {"Near": "2"})


def test_programs_are_the_same_but_for_comments_and_space() -> None:
    text = 'A("x  y") = 1;  # remark\nB() :- A( "x  y" );\n'
    assert normalise(text) == normalise('\nA("x  y")   =\n1; B() :-\tA( "x  y" );')
    assert normalise(text) != normalise(text.replace("x  y", "x y"))


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        (
            '[assignment]\nroster = "r.csv"\nshow = ["won", "grade"]\nstarts = 0\n'
            '[[level]]\nname = "01-first-steps"\npoints = -1\n'
            "[late]\nafter = 2026-01-01T00:00:00\n",
            r".*:2: .*\n.*:3: .*\n.*:7: .*\n.*:9: ",
        ),
        (
            '[assignment]\n[[level]]\nname = "mine.toml"\n',
            "mine has no reference .* such as ticks = 2000",
        ),
        (
            '[assignment]\nroster = "ids.csv"\nstarts = 0\n'
            '[[level]]\nname = "01-first-steps"\n[points]\nstarts = 1\n',
            r"a\.toml:7: There are points for starts",
        ),
        (
            '[assignment]\n[[level]]\nname = "1"\n[[level]]\nname = "first-steps"\n',
            'a\\.toml:5: The level "01-first-steps" is there twice',
        ),
    ],
)
def test_what_is_wrong_with_an_assignment_is_said(tmp_path: Path, text: str, problems: str) -> None:
    level = (shipped_folder("levels") / "01-first-steps.toml").read_bytes()
    mine = level.replace(b"First steps", b"Mine")
    write_files(tmp_path, {"a.toml": text, "mine.toml": mine, "ids.csv": "id\n1\n1\n"})
    with pytest.raises(TomlFileError) as caught:
        plan_grading(tmp_path / "a.toml", tmp_path)
    assert re.search(problems, "\n".join(caught.value.problems))
    assert len(caught.value.problems) <= 4
