"""Whatever is wrong gets one message that names the place, and status 2."""

from pathlib import Path

import pytest

from tests.cli.running import Ask, Command
from tests.short import AHEAD, LEVEL

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
