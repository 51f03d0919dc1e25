"""Whatever is wrong gets one message that names the place, and status 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.running import Command
from tests.short import AHEAD, LEVEL

LEVELS = {
    "no robots": (LEVEL.partition("[[robots]]")[0], "robots"),
    "two robots of one name": (LEVEL + '[[robots]]\nname = "Pip"\nx = 20\ny = 12\n', "Pip"),
    "a row of the wrong length": (LEVEL.replace("#..........#\n", "#...#\n", 1), "row 2"),
    "a goal for an unknown robot": (LEVEL.replace('["Pip"]', '["Pop"]'), "areas[0].goal_for"),
    "a switch by an unknown beacon": (LEVEL + 'on_beacon = "Moon"\n', "areas[0].on_beacon"),
    "no TOML": ("walls = = 3", "line 1"),
    "binary rubbish": ("\x00\x01\udcff\udcfe", "line 1"),
}

PROGRAMS = {
    "nothing": ("", "1:1:"),
    "no Robot": ("Walker(x: 1);\n", "Robot"),
    "a mistake on line 3": (AHEAD + "Oops(x: ;\n", ":3:"),
    "an undefined predicate": (AHEAD.replace("Sensor(", "Senser("), "Senser"),
    "more than 1 MB": (AHEAD + "# " + "x" * 1_000_000, "1 MB"),
    "binary rubbish": ("\x7fELF\x00\udcff", "line 1"),
}


@pytest.mark.parametrize("wrong", LEVELS)
def test_a_level_with_something_wrong_is_refused_by_naming_the_place(
    wrong: str, command: Command, level: Path, ahead: Path
) -> None:
    text, place = LEVELS[wrong]
    level.write_bytes(text.encode("utf-8", "surrogateescape"))
    told = command("run", level, ahead)
    assert told.status == 2
    assert told.err.startswith(f"logical-robots: {level}")
    assert place in told.err
    assert "Traceback" not in told.err
    assert str(level) in told.data["error"]["place"]
    assert told.data["error"]["message"] in told.err


@pytest.mark.parametrize("wrong", PROGRAMS)
def test_a_program_with_something_wrong_is_refused_by_naming_the_place(
    wrong: str, command: Command, level: Path, ahead: Path
) -> None:
    text, place = PROGRAMS[wrong]
    ahead.write_bytes(text.encode("utf-8", "surrogateescape"))
    told = command("run", level, ahead)
    assert told.status == 2
    assert told.err.startswith(f"logical-robots: {ahead}")
    assert place in told.err
    assert "Traceback" not in told.err
    assert str(ahead) in told.data["error"]["place"]


def test_mistakes_in_a_program_are_told_as_a_compiler_does(
    command: Command, level: Path, ahead: Path
) -> None:
    ahead.write_text(AHEAD + "Oops(x: ;\n")
    told = command("run", level, ahead, "--json")
    (found, *_) = told.data["error"]["diagnostics"]
    assert found["line"] == 3
    position = f"{ahead}:{found['line']}:{found['column']}: {found['message']}"
    assert told.err.splitlines()[0] == f"logical-robots: {position}"
    assert found["hint"] in told.err


@pytest.mark.parametrize("which", [0, 1])
def test_a_missing_file_is_named(which: int, command: Command, level: Path, ahead: Path) -> None:
    (level, ahead)[which].unlink()
    told = command("run", level, ahead)
    assert told.status == 2
    assert str((level, ahead)[which]) in told.err


@pytest.mark.parametrize("which", [0, 1])
def test_a_folder_is_named(
    which: int, command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    given = [level, ahead]
    given[which] = tmp_path
    told = command("run", *given)
    assert told.status == 2
    assert told.err.startswith(f"logical-robots: {tmp_path}")
    assert "folder" in told.err


def test_a_mistyped_name_is_answered_with_one_that_exists(command: Command, ahead: Path) -> None:
    known = command("levels", "--json").data[0]["name"]
    told = command("run", known[:-1] + "x", ahead)
    assert told.status == 2
    assert known in told.err


def test_control_characters_in_a_message_are_made_harmless(
    command: Command, level: Path, tmp_path: Path
) -> None:
    told = command("run", level, tmp_path / "a\x1b[2Jb.l")
    assert told.status == 2
    assert "\x1b" not in told.err
    assert r"a\x1b[2Jb.l" in told.err


@pytest.mark.parametrize("ticks", ["0", "-3", "many", "1.5"])
def test_ticks_must_be_a_whole_number_from_1_up(
    ticks: str, command: Command, level: Path, ahead: Path
) -> None:
    told = command("run", level, ahead, f"--ticks={ticks}")
    assert told.status == 2
    assert "not an integer" in told.err
