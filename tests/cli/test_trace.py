"""``logical-robots trace``: one JSON line per tick."""

import json
from pathlib import Path
from typing import Any

from logical_robots_tui.world import load_level
from tests.cli.running import Ask, Command

NEAR = """
Near(robot_name:, d: sensor.forward_distance) :- Sensor(robot_name:, sensor:), sensor.clock > 1;
"""


def lines(told: str) -> list[Any]:
    return [json.loads(line) for line in told.splitlines()]


def test_every_tick_is_told_until_the_end(
    short: Ask, command: Command, level: Path, still: Path
) -> None:
    told = short("trace")
    found = lines(told.out)
    assert (told.status, told.err) == (0, "")
    assert [line["tick"] for line in found] == list(range(1, len(found) + 1))
    assert [line["won"] for line in found] == [False] * (len(found) - 1) + [True]
    last = found[-1]
    (pip,) = last["robots"]
    assert (pip["name"], pip["right_engine"]) == ("Pip", 0.5)
    assert len(last["sensors"]["Pip"]["radar"]) == 31
    assert last["memories"] == {"Pip": "on my way"}
    (decision,) = last["decisions"]
    assert decision["desire"] == {"left_engine": 0.5, "right_engine": 0.5}
    assert last["areas"] == [{"name": "Door", "active": True, "visitors": ["Pip"]}]
    told = command("trace", level, still, "--ticks", 3)
    assert (told.status, len(lines(told.out))) == (1, 3)


def test_the_rows_of_predicates_are_told(short: Ask, ahead: Path) -> None:
    ahead.write_text(ahead.read_text() + NEAR)
    first, second = lines(short("trace", "--ticks", 2, "--predicates", "Near, Robot").out)
    assert first["predicates"]["Near"]["rows"] == []
    near = second["predicates"]["Near"]
    assert near["columns"] == ["robot_name", "d"]
    assert near["rows"] == [["Pip", second["sensors"]["Pip"]["forward_distance"]]]
    assert near["minds"] == ["Pip"]
    assert set(second["predicates"]) == {"Near", "Robot"}


def test_one_robot_only(command: Command, ahead: Path) -> None:
    _, second, *_ = [robot.name for robot in load_level("04-everybody-home").robots]
    told = command("trace", "04-everybody-home", ahead, "--ticks", 1, "--robot", second)
    (line,) = lines(told.out)
    assert [robot["name"] for robot in line["robots"]] == [second]
    assert [decision["robot"] for decision in line["decisions"]] == [second]
    assert list(line["sensors"]) == list(line["memories"]) == [second]


def test_unknown_names_are_refused_before_the_run(short: Ask) -> None:
    for option, name in (("--robot", "Pop"), ("--predicates", "Robbot")):
        told = short("trace", option, name).refusal
        assert f"no {option[2:].removesuffix('s')} {name}" in told
        assert "There is" in told or "There are" in told
