"""``logical-robots check``: errors and warnings in programs, printed like a compiler's."""

from pathlib import Path

import pytest

from tests.cli.running import Command

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
    assert wrong["diagnostics"][0] == place | words


def test_a_long_line_is_shown_around_its_mistake(command: Command, program: Path) -> None:
    program.write_text(f'A("{"x" * 300}", Wings(1), "{"x" * 300}");\n' + DOUBTFUL)
    lines = command("check", program).out.splitlines()
    assert max(map(len, lines[1:3])) <= 102
    assert lines[1][lines[2].index("^") :].startswith("Wings")
    program.write_text('A("\x1b[31m", Wings(1));\n' + DOUBTFUL)
    assert "\x1b" not in command("check", program).out
