"""``logical-robots check``: errors and warnings in programs, printed like a compiler's."""

from pathlib import Path

import pytest

from logical_robots_tui.cli.check import diagnostics
from logical_robots_tui.game import list_programs, load_program
from tests.cli.running import Command

ROBOT = "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}"
SENSOR = "Sensor(robot_name:, sensor:)"
BROKEN = f"""\
Robot(robot_name:, desire:, memory: "") :-
  {SENSOR},
\tdesire = {{left_engine: sensor.clok, right_engine: Sqrtt(2)}};
"""
DOUBTFUL = f"{ROBOT}) :- Sensor(robot_name:);\n"
HERE = f"{ROBOT},\n  memory: {{order: 1}}) :- Sensor(robot_name:);\n"
NAMED = f"""\
Robot(robot_name:, desire: {{left_engine: speed, right_engine: 1}}, memory: "") :-
  {SENSOR},
  short = sensor.forward_distance < 60, speed = (if short then 1 else 0);
"""
SEEKING = f'{ROBOT}, memory: "") :-\n  {SENSOR}, sensor.forward_label != "Hrbour";\n'

BROKEN_IS = """\
{}:3:32: error: A sensor has no field clok
   desire = {{left_engine: sensor.clok, right_engine: Sqrtt(2)}};
                                 ^^^^
  Did you mean clock?
{}:3:52: error: Sqrtt is not defined
   desire = {{left_engine: sensor.clok, right_engine: Sqrtt(2)}};
                                                     ^^^^^
  Did you mean Sqrt?
"""
HERE_IS = """\
{}:2:12: warning: order is a word of SQL, which the web platform can't read as a field
    memory: {{order: 1}}) :- Sensor(robot_name:);
             ^^^^^
  Choose another name.
"""
NAMED_IS = """\
{}:3:3: warning: '=' is read before '<': this means (short = sensor.forward_distance) < 60
    short = sensor.forward_distance < 60, speed = (if short then 1 else 0);
    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  Put the comparison in parentheses: short = (sensor.forward_distance < 60).
"""
SEEKING_IS = """\
{}:2:57: warning: No robot, beacon or solid area of this level is called "Hrbour"
    Sensor(robot_name:, sensor:), sensor.forward_label != "Hrbour";
                                                          ^^^^^^^^
  Did you mean "Harbour"?
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    return tmp_path / "program.l"


@pytest.mark.parametrize(
    ("text", "options", "status", "lines"),
    [
        (BROKEN, (), 2, BROKEN_IS),
        (HERE, (), 0, ""),
        (HERE, ("--web",), 0, HERE_IS),
        (NAMED, (), 0, NAMED_IS),
        (NAMED, ("--web",), 0, NAMED_IS),
        (NAMED, ("--level", "01-first-steps"), 0, NAMED_IS),
        (SEEKING, (), 0, ""),
        (SEEKING, ("--level", "05-lighthouse"), 0, SEEKING_IS),
    ],
)
def test_what_is_wrong_is_told_with_its_line_a_caret_and_a_hint(
    command: Command, program: Path, text: str, options: tuple[str, ...], status: int, lines: str
) -> None:
    program.write_text(text)
    told = command("check", program, *options)
    assert (told.status, told.out) == (status, lines.format(program, program))


def test_a_program_that_can_run_is_met_with_silence_or_warnings_and_one_that_is_missing_is_told(
    command: Command, program: Path, ahead: Path
) -> None:
    told = command("check", ahead)
    assert (told.status, told.out, told.err) == (0, "", "")
    assert command("check", program).refusal.count("\n") == 1
    program.write_text(DOUBTFUL)
    assert ":1:1: warning: Robot sets no memory" in command("check", program).success
    program.write_text(HERE)
    assert command("check", program, "--web", "--json").data["ok"] is True


def test_one_mistake_of_several_is_enough(command: Command, program: Path, ahead: Path) -> None:
    program.write_text(BROKEN)
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


@pytest.mark.slow
def test_the_shipped_programs_are_without_a_warning() -> None:
    for name in list_programs(None):
        assert diagnostics(load_program(name, None).text) == (), name
