"""``logical-robots query``: any question about one tick."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest

from tests.cli.running import in_terminal, shown

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command


def test_a_question_is_answered_for_its_tick(command: Command, level: Path, ahead: Path) -> None:
    query = "Sensor(robot_name:, sensor:), clock == sensor.clock"
    told = command("query", level, ahead, "--tick", 7, query)
    assert told.status == 0
    data = told.data
    assert data["tick"] == 7
    clock = data["columns"].index("clock")
    assert [row[clock] for row in data["rows"]] == [7]
    assert data["minds"] == ["Pip"]


def test_the_start_can_be_asked(command: Command, level: Path, ahead: Path) -> None:
    told = command("query", level, ahead, "--tick", 0, "Memory")
    assert told.data["rows"] == [["Pip", ""]]


def test_a_tick_after_victory_can_be_asked(command: Command, level: Path, ahead: Path) -> None:
    query = "c == AnyValue{sensor.clock :- Sensor(sensor:)}"
    assert command("query", level, ahead, "--tick", 150, query).data["rows"] == [[150]]


def test_no_rows_is_status_1(command: Command, level: Path, ahead: Path) -> None:
    told = command("query", level, ahead, "--tick", 1, "Sensor(robot_name:), robot_name == 3")
    assert told.status == 1
    assert told.data["rows"] == []


def test_a_wrong_question_is_told_with_its_place_before_the_run(
    command: Command, level: Path, ahead: Path
) -> None:
    told = command("query", level, ahead, "--tick", 10**9, "Sensor(robot_nam:)")
    assert told.status == 2
    assert "query:1:8: Sensor has no column robot_nam" in told.err
    assert "Did you mean robot_name?" in told.err


def test_a_failing_question_says_why(command: Command, level: Path, ahead: Path) -> None:
    told = command("query", level, ahead, "--tick", 1, 'x in ["a"], x.field == 2')
    assert told.status == 2
    assert "neither a record nor a list" in told.err


def test_in_a_terminal_it_is_a_table(level: Path, ahead: Path) -> None:
    told = shown("query", level, ahead, "--tick", 1, "Robot(robot_name:, desire:)")
    assert told.status == 0
    assert "IN THE MIND OF  robot_name  desire" in told.text
    assert '"Pip"' in told.text


@pytest.mark.slow
def test_a_long_way_to_the_tick_is_shown(level: Path, ahead: Path) -> None:
    with in_terminal("query", level, ahead, "--tick", 10**6, "Robot") as terminal:
        terminal.wait_for("of 1000000")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.finish() == 130
        assert "Traceback" not in terminal.everything
