"""``logical-robots query``: any question about one tick."""

from pathlib import Path

import pytest

from tests.cli.running import Ask, shown


def test_a_question_is_answered_for_its_tick(short: Ask, level: Path, ahead: Path) -> None:
    told = short("query", "--tick", 7, "Sensor(robot_name:, sensor:), clock == sensor.clock")
    assert (told.status, told.data["tick"], told.data["minds"]) == (0, 7, ["Pip"])
    clock = told.data["columns"].index("clock")
    assert [row[clock] for row in told.data["rows"]] == [7]
    table = shown("query", level, ahead, "--tick", 1, "Robot(robot_name:, desire:)")
    assert "IN THE MIND OF  robot_name  desire" in table.text
    assert '"Pip"' in table.text


@pytest.mark.parametrize(
    ("tick", "query", "rows"),
    [
        (0, "Memory", [["Pip", ""]]),  # the start
        (150, "c == AnyValue{sensor.clock :- Sensor(sensor:)}", [[150]]),  # after victory
        (1, "Sensor(robot_name:), robot_name == 3", []),
    ],
)
def test_no_rows_is_status_1(tick: int, query: str, rows: list[object], short: Ask) -> None:
    told = short("query", "--tick", tick, query)
    assert (told.status, told.data["rows"]) == (int(not rows), rows)


def test_a_wrong_question_is_told_with_its_place_and_a_failing_one_with_why(short: Ask) -> None:
    refusal = short("query", "--tick", 10**9, "Sensor(robot_nam:)").refusal  # before the run
    assert "query:1:8: Sensor has no column robot_nam" in refusal
    assert "Did you mean robot_name?" in refusal
    failure = short("query", "--tick", 1, 'x in ["a"], x.field == 2').refusal
    assert "neither a record nor a list" in failure
