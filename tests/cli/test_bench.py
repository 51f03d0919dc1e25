"""``logical-robots bench``: how fast the levels run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.cli.running import in_terminal

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command


def test_it_tells_how_fast_a_level_runs(command: Command) -> None:
    told = command("bench", "01-first-steps", "--seconds", 0.1, "--json")
    assert told.status == 0
    (found,) = told.data
    assert (found["level"], found["robots"]) == ("01-first-steps", 1)
    assert found["ticks"] > 0
    assert found["seconds"] >= 0.1
    assert found["ticks_per_second"] == found["ticks"] / found["seconds"]
    assert 0 < found["think_milliseconds"] < 1000 * found["seconds"]


def test_in_a_terminal_it_is_a_table() -> None:
    with in_terminal("bench", "02-open-space", "--seconds", "0.1") as terminal:
        assert terminal.finish() == 0
        head, line = terminal.text.splitlines()
    assert head.split()[:3] == ["LEVEL", "ROBOTS", "TICKS/S"]
    assert line.split()[:2] == ["02-open-space", "1"]


def test_a_level_without_a_reference_program_is_refused(command: Command, level: Path) -> None:
    told = command("bench", level)
    assert told.status == 2
    assert "names no reference program" in told.data["error"]["message"]


def test_seconds_must_be_a_number(command: Command) -> None:
    for wrong in ("soon", "0", "-1", "nan", "1e9"):
        told = command("bench", "--seconds", wrong)
        assert told.status == 2
        assert "not a number of seconds" in told.err
