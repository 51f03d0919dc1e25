"""``logical-robots origin``: in which tick and by which rule a value was made."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.running import Command, shown


@pytest.fixture
def keeper(tmp_path: Path) -> Path:
    """A program that notes the clock once, and keeps it."""
    path = tmp_path / "keeper.l"
    path.write_text(
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {at:}) :-\n"
        "  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),\n"
        "  at = (if sensor.clock == 3 then sensor.clock else memory.at);\n"
    )
    return path


def test_the_tick_the_line_and_what_was_read_are_told(
    command: Command, level: Path, keeper: Path
) -> None:
    told = command("origin", level, keeper, "--tick", 8, "--robot", "Pip", "--value", "memory.at")
    assert told.status == 0
    (link,) = told.data["links"]
    assert (link["value"], link["tick"], link["until"], link["rule_line"]) == (3, 3, 8, 1)
    assert [(each["name"], each["value"]) for each in link["from"]] == [("sensor.clock", 3)]


def test_in_a_terminal_it_is_told_in_words(level: Path, keeper: Path) -> None:
    told = shown("origin", level, keeper, "--tick", 8, "--robot", "Pip", "--value", "memory.at")
    assert told.status == 0
    assert "1. Pip's memory.at = 3" in told.text
    assert "the same since tick 3, set then by the rule in line 1" in told.text
    assert "read from Pip's sensor.clock = 3" in told.text


def test_any_value_of_a_predicate_is_traced(command: Command, level: Path, tmp_path: Path) -> None:
    path = tmp_path / "half.l"
    path.write_text(
        "Half(robot_name:, x:) :- Sensor(robot_name:, sensor:), x == sensor.clock / 2;\n"
        "Robot(robot_name:, desire: {left_engine: x + 1, right_engine: 0}) :-\n"
        "  Half(robot_name:, x:);\n"
    )
    asked = ("origin", level, path, "--tick", 8, "--robot", "Pip")
    engine, x = command(*asked, "--value", "desire.left_engine").data["links"]
    assert (engine["name"], engine["value"], engine["text"]) == (
        "Pip's desire.left_engine",
        5,
        "x + 1",
    )
    assert (x["name"], x["text"], x["from"][0]["value"]) == ("x", "sensor.clock / 2", 8)
    (half,) = command(*asked, "--predicate", "Half").data["links"]
    assert (half["name"], half["value"]) == ("Pip's Half.x", 4)


@pytest.mark.parametrize(
    ("value", "message"),
    [("at[x]", "'at[x]' is not a part"), ("memory.of", "This value has no part of")],
)
def test_a_part_that_is_not_there_is_named(
    command: Command, level: Path, keeper: Path, value: str, message: str
) -> None:
    told = command("origin", level, keeper, "--tick", 8, "--robot", "Pip", "--value", value)
    assert told.status == 2
    assert message in told.err
