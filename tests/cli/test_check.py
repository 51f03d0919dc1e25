"""``logical-robots check``: errors and warnings in programs, printed like a compiler's."""

from __future__ import annotations

from pathlib import Path

import pytest

from logical_robots_tui.cli.check import diagnostics
from tests.cli.running import Command

BROKEN = """\
Robot(robot_name:, desire:, memory: "") :-
  Sensor(robot_name:, sensor:),
\tdesire = {left_engine: sensor.clok, right_engine: Sqrtt(2)};
"""
DOUBTFUL = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}) :- Sensor(robot_name:);
"""
HERE = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1},
  memory: {order: 1}) :- Sensor(robot_name:);
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_program_that_can_run_is_met_with_silence(command: Command, ahead: Path) -> None:
    told = command("check", ahead)
    assert (told.status, told.out, told.err) == (0, "", "")


def test_all_that_is_wrong_is_told_with_its_line_a_caret_and_a_hint(
    command: Command, tmp_path: Path
) -> None:
    path = written(tmp_path, "broken.l", BROKEN)
    told = command("check", path)
    assert told.status == 2
    assert told.out.splitlines() == [
        f"{path}:3:32: error: A sensor has no field clok",
        "   desire = {left_engine: sensor.clok, right_engine: Sqrtt(2)};",
        "                                 ^^^^",
        "  Did you mean clock?",
        f"{path}:3:52: error: Sqrtt is not defined",
        "   desire = {left_engine: sensor.clok, right_engine: Sqrtt(2)};",
        "                                                     ^^^^^",
        "  Did you mean Sqrt?",
    ]


def test_what_the_web_platform_would_not_do_is_told_on_request(
    command: Command, tmp_path: Path
) -> None:
    path = written(tmp_path, "here.l", HERE)
    assert command("check", path).out == ""
    told = command("check", path, "--web")
    assert told.status == 0
    assert told.out.splitlines() == [
        f"{path}:2:12: warning: order is a word of SQL, "
        "which the web platform can't read as a field",
        "    memory: {order: 1}) :- Sensor(robot_name:);",
        "             ^^^^^",
        "  Choose another name.",
    ]
    assert command("check", path, "--web", "--json").data["ok"] is True


NAMED = """\
Robot(robot_name:, desire: {left_engine: speed, right_engine: 1}, memory: "") :-
  Sensor(robot_name:, sensor:),
  short = sensor.forward_distance < 60, speed = (if short then 1 else 0);
"""


@pytest.mark.parametrize("options", [(), ("--web",), ("--level", "01-first-steps")])
def test_a_comparison_that_gets_a_name_without_parentheses_is_told_once(
    command: Command, tmp_path: Path, options: tuple[str, ...]
) -> None:
    path = written(tmp_path, "named.l", NAMED)
    told = command("check", path, *options)
    assert told.status == 0
    assert told.out.splitlines() == [
        f"{path}:3:3: warning: '=' is read before '<': "
        "this means (short = sensor.forward_distance) < 60",
        "    short = sensor.forward_distance < 60, speed = (if short then 1 else 0);",
        "    ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^",
        "  Put the comparison in parentheses: short = (sensor.forward_distance < 60).",
    ]


SEEKING = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") :-
  Sensor(robot_name:, sensor:), sensor.forward_label != "Hrbour";
"""


def test_a_name_that_a_level_lacks_is_told_with_that_level_only(
    command: Command, tmp_path: Path
) -> None:
    path = written(tmp_path, "seeking.l", SEEKING)
    assert command("check", path).out == ""
    told = command("check", path, "--level", "05-lighthouse")
    assert told.status == 0
    assert told.out.splitlines() == [
        f'{path}:2:57: warning: No robot, beacon or solid area of this level is called "Hrbour"',
        '    Sensor(robot_name:, sensor:), sensor.forward_label != "Hrbour";',
        "                                                          ^^^^^^^^",
        '  Did you mean "Harbour"?',
    ]


def test_a_warning_is_told_but_the_program_is_fine(command: Command, tmp_path: Path) -> None:
    told = command("check", written(tmp_path, "doubtful.l", DOUBTFUL))
    assert told.status == 0
    assert ":1:1: warning: Robot sets no memory" in told.out


def test_several_programs_are_checked_and_one_mistake_is_enough(
    command: Command, tmp_path: Path, ahead: Path
) -> None:
    broken = written(tmp_path, "broken.l", BROKEN)
    told = command("check", ahead, broken, "--json")
    assert told.status == 2
    assert told.data["ok"] is False
    fine, wrong = told.data["programs"]
    assert fine == {"file": str(ahead), "diagnostics": []}
    assert wrong["diagnostics"][0] == {
        "line": 3,
        "column": 32,
        "message": "A sensor has no field clok",
        "hint": "Did you mean clock?",
        "excerpt": "clok",
        "severity": "error",
    }


def test_a_file_that_is_not_there_is_told_in_one_line(command: Command, tmp_path: Path) -> None:
    told = command("check", tmp_path / "none.l")
    assert told.status == 2
    assert told.err.count("\n") == 1


def test_a_very_long_line_is_shown_around_its_mistake(command: Command, tmp_path: Path) -> None:
    text = f'A("{"x" * 300}", Wings(1), "{"x" * 300}");\n' + DOUBTFUL
    lines = command("check", written(tmp_path, "long.l", text)).out.splitlines()
    assert max(map(len, lines[1:3])) <= 102
    assert lines[1][lines[2].index("^") :].startswith("Wings")


def test_text_of_a_program_can_not_reach_the_terminal_as_codes(
    command: Command, tmp_path: Path
) -> None:
    text = 'A("\x1b[31m", Wings(1));\n' + DOUBTFUL
    assert "\x1b" not in command("check", written(tmp_path, "nasty.l", text)).out


@pytest.mark.slow
def test_the_shipped_programs_are_without_a_warning() -> None:
    from logical_robots_tui.game import list_programs, load_program

    for name in list_programs(None):
        assert diagnostics(load_program(name, None).text) == (), name
