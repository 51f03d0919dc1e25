"""``logical-robots origin``: in which tick and by which rule a value was made."""

from pathlib import Path

import pytest

from tests.cli.running import Command, shown

# A program that notes the clock once, and keeps it.
KEEPER = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {at:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  at = (if sensor.clock == 3 then sensor.clock else memory.at);
"""
HALF = """\
Half(robot_name:, x:) :- Sensor(robot_name:, sensor:), x == sensor.clock / 2;
Robot(robot_name:, desire: {left_engine: x + 1, right_engine: 0}) :-
  Half(robot_name:, x:);
"""


@pytest.fixture
def asked(level: Path, ahead: Path) -> tuple[object, ...]:
    ahead.write_text(KEEPER)
    return ("origin", level, ahead, "--tick", 8, "--robot", "Pip")


def test_tick_line_and_what_was_read_are_told(command: Command, asked: tuple[object, ...]) -> None:
    (link,) = command(*asked, "--value", "memory.at", status=0).data["links"]
    assert (link["value"], link["tick"], link["until"], link["rule_line"]) == (3, 3, 8, 1)
    assert [(read["name"], read["value"]) for read in link["from"]] == [("sensor.clock", 3)]
    seen = shown(*asked, "--value", "memory.at")
    assert "1. Pip's memory.at = 3" in seen.text
    assert "the same since tick 3, set then by the rule in line 1" in seen.text
    assert "read from Pip's sensor.clock = 3" in seen.text


def test_a_value_of_a_predicate_is_traced(
    command: Command, asked: tuple[object, ...], ahead: Path
) -> None:
    ahead.write_text(HALF)
    engine, x = command(*asked, "--value", "desire.left_engine").data["links"]
    told = (engine["name"], engine["value"], engine["text"])
    assert told == ("Pip's desire.left_engine", 5, "x + 1")
    assert (x["name"], x["text"], x["from"][0]["value"]) == ("x", "sensor.clock / 2", 8)
    (half,) = command(*asked, "--predicate", "Half").data["links"]
    assert (half["name"], half["value"]) == ("Pip's Half.x", 4)


def test_a_part_that_is_not_there_is_named(command: Command, asked: tuple[object, ...]) -> None:
    assert "'at[x]' is not a part" in command(*asked, "--value", "at[x]").refusal
    assert "This value has no part of" in command(*asked, "--value", "memory.of").refusal
