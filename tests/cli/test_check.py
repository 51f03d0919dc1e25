"""Whatever is wrong gets a message that names the place; ``check`` prints as a compiler does."""

import json
import re
import sys
from pathlib import Path

import pytest
import yaml

from tests.cli.running import Ask, Command
from tests.installed import CHECKOUT
from tests.processes import run_command
from tests.short import AHEAD, LEVEL

CHECKED = {
    name: case.split("-- told\n")
    for name, _, case in (
        part.partition("\n")
        for part in Path(__file__).with_name("checked.txt").read_text("utf-8").split("== ")[1:]
    )
}
"""Programs by name, each with what is told about it."""

DOUBTFUL = "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}) :- Sensor(robot_name:);\n"


@pytest.fixture
def program(tmp_path: Path) -> Path:
    return tmp_path / "program.l"


@pytest.mark.parametrize(
    ("name", "options", "status", "is_told"),
    [
        *(("broken", (), 2, True), ("here", (), 0, False), ("here", ("--web",), 0, True)),
        *(("named", (), 0, True), ("named", ("--web",), 0, True)),
        ("named", ("--level", "01-first-steps"), 0, True),
        *(("seeking", (), 0, False), ("seeking", ("--level", "05-lighthouse"), 0, True)),
    ],
)
def test_what_is_wrong_is_told_with_its_line_a_caret_and_a_hint(
    command: Command, program: Path, name: str, options: tuple[str, ...], status: int, is_told: bool
) -> None:
    text, lines = CHECKED[name]
    program.write_text(text)
    told = command("check", program, *options)
    assert (told.status, told.out) == (status, lines.format(program, program) if is_told else "")


def test_a_program_that_can_run_is_met_with_silence_or_warnings_and_one_that_is_missing_is_told(
    command: Command, program: Path, ahead: Path
) -> None:
    told = command("check", ahead)
    assert (told.status, told.out, told.err) == (0, "", "")
    assert command("check", program).refusal.count("\n") == 1
    program.write_text(DOUBTFUL)
    assert ":1:1: warning: Robot sets no memory" in command("check", program).success
    program.write_text(CHECKED["here"][0])
    assert command("check", program, "--web", "--json").data["ok"] is True


def test_one_mistake_of_several_is_enough(command: Command, program: Path, ahead: Path) -> None:
    program.write_text(CHECKED["broken"][0])
    told = command("check", ahead, program, "--json")
    assert (told.status, told.data["ok"]) == (2, False)
    fine, wrong = told.data["programs"]
    assert fine == {"file": str(ahead), "diagnostics": []}
    words = {"message": "A sensor has no field clok", "hint": "Did you mean clock?"}
    place = {"line": 3, "column": 32, "excerpt": "clok", "severity": "error"}
    correction = {"start": 106, "stop": 110, "text": "clock"}
    others = {"fix": correction, "has_effect": True, "related": []}
    assert wrong["diagnostics"][0] == place | words | others


def test_other_tools_get_their_formats_also_of_standard_input(program: Path) -> None:
    text, words = CHECKED["broken"][0], [sys.executable, "-m", "logical_robots_tui", "check", "-"]
    program.write_text(text)
    told = run_command([*words, program, "--format=github"], input=text)
    lines = [line for file in ("-", program) for line in (f"::error file={file},line=3,col=32::",)]
    assert [line for line in told.stdout.splitlines() if line.startswith(tuple(lines))] == [
        f"{line}A sensor has no field clok. Did you mean clock?" for line in lines
    ]
    data = json.loads(run_command([*words, "--format=json"], input=text).stdout)
    assert data["programs"][0]["diagnostics"][0]["excerpt"] == "clok"
    told = run_command([*words, "--format=json", "--level", "99"], input=text)
    assert "99" in json.loads(told.stdout)["error"]["message"]
    (hook,) = yaml.safe_load((CHECKOUT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    assert hook["entry"].split() == ["logical-robots", "check"]
    assert re.search(hook["files"], program.name)


def test_without_pygls_it_is_said_what_to_install(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("logical_robots_tui.errors.is_installed", lambda _module: False)
    assert "pip install 'logical-robots-tui[lsp]'" in command("lsp").refusal


def test_a_long_line_is_shown_around_its_mistake(command: Command, program: Path) -> None:
    program.write_text(f'A("{"x" * 300}", Wings(1), "{"x" * 300}");\n' + DOUBTFUL)
    lines = command("check", program).out.splitlines()
    assert max(map(len, lines[1:3])) <= 102
    assert lines[1][lines[2].index("^") :].startswith("Wings")
    program.write_text('A("\x1b[31m", Wings(1));\n' + DOUBTFUL)
    assert "\x1b" not in command("check", program).out


LEVELS = {
    "no robots": (LEVEL.partition("[[robots]]")[0], "robots"),
    "a row of the wrong length": (LEVEL.replace("#..........#\n", "#...#\n", 1), "row 2"),
    "no TOML": ("walls = = 3", "line 1"),
    "a level of binary rubbish": ("\x00\x01\udcff\udcfe", "line 1"),
}
PROGRAMS = {
    "nothing": ("", "1:1:"),
    "a mistake on line 3": (AHEAD + "Oops(x: ;\n", ":3:"),
    "an undefined predicate": (AHEAD.replace("Sensor(", "Senser("), "Senser"),
    "more than 1 MB": (AHEAD + "# " + "x" * 1_000_000, "1 MB"),
    "a program of binary rubbish": ("\x7fELF\x00\udcff", "line 1"),
}


@pytest.mark.parametrize("wrong", [*LEVELS, *PROGRAMS])
def test_a_wrong_file_is_told_by_place(wrong: str, short: Ask, level: Path, ahead: Path) -> None:
    file = level if wrong in LEVELS else ahead
    text, place = {**LEVELS, **PROGRAMS}[wrong]
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    told = short("run")
    refusal, error = told.refusal, told.data["error"]
    assert refusal.startswith(f"logical-robots: {file}")
    assert place in refusal
    assert "Traceback" not in refusal
    assert str(file) in error["place"]
    assert wrong in PROGRAMS or error["message"] in refusal
    if place == ":3:":
        mistake = error["diagnostics"][0]
        assert mistake["line"] == 3
        position = f"{file}:3:{mistake['column']}: {mistake['message']}"
        assert refusal.splitlines()[0] == f"logical-robots: {position}"
        assert mistake["hint"] in refusal


@pytest.mark.parametrize("which", [0, 1])
def test_a_missing_file_and_a_folder_are_named(
    which: int, command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    files = [level, ahead]
    files[which] = tmp_path
    told = command("run", *files).refusal
    assert told.startswith(f"logical-robots: {tmp_path}")
    assert "folder" in told
    files[which] = tmp_path / ("missing" + files[which].suffix)
    assert str(files[which]) in command("run", *files).refusal


def test_a_mistyped_name_is_answered_with_one_that_exists_and_codes_are_made_harmless(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    known = command("levels", "--json").data[0]["name"]
    assert known in command("run", known[:-1] + "x", ahead).refusal
    told = command("run", level, tmp_path / "a\x1b[2Jb.l").refusal
    assert "\x1b" not in told
    assert r"a\x1b[2Jb.l" in told


def test_ticks_must_be_a_whole_number_from_1_up(short: Ask) -> None:
    for ticks in ("0", "-3", "many", "1.5"):
        assert "not an integer" in short("run", f"--ticks={ticks}").refusal
