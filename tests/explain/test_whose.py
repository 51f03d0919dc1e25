"""Of elements from other robots it is said whose memory or sensor they are from."""

from __future__ import annotations

import pytest

from logical_robots_tui.values import Value
from tests.explain.asking import REST, below, why
from tests.mind.rows import row

ROWS = [row("Ada"), row("Bo"), row("Cy")]
MEMORIES: dict[str, Value] = {"Ada": {"at": 3}, "Bo": {"at": 4}, "Cy": {"at": 5}}


def whose(rules: str) -> list[tuple[Value, str]]:
    found = why(f"{rules}{REST}", "Tot", rows=ROWS, memories=MEMORIES, memory="all", sensor="all")
    (rule,) = found.rules
    return [(node.values[0], node.said) for node in below(rule.node, "contributor")]


@pytest.mark.parametrize(
    "rules",
    [
        "Tot(s? += m.at) distinct :- Memory(robot_name: o, memory: m);",
        "Tot(s) :- s == Sum{m.at :- Memory(robot_name: o, memory: m)};",
        "Tot(s) :- s == Sum{m.at :- Sensor(robot_name: o), Memory(robot_name: o, memory: m)};",
    ],
)
def test_a_sum_over_memories_says_whose_each_is(rules: str) -> None:
    assert whose(rules) == [(3, "Ada's memory"), (4, "Bo's memory"), (5, "Cy's memory")]


def test_what_is_read_through_a_predicate_is_named_by_that() -> None:
    rules = "At(robot_name:, at: m.at) :- Memory(robot_name:, memory: m);"
    found = whose(f'{rules} Tot(s) :- s == Sum{{at :- At(robot_name: o, at:), o != "Bo"}};')
    assert found == [(3, "Ada's At"), (5, "Cy's At")]


def test_both_of_memory_and_sensor_are_named() -> None:
    rules = """
    Tot(s) :- s == List{m.at + x.clock :- o == "Bo", Memory(robot_name: o, memory: m),
      Sensor(robot_name: o, sensor: x)};
    """
    assert [said for _, said in whose(rules)] == ["Bo's memory and sensor"]


def test_the_one_that_decides_is_told_with_its_robot() -> None:
    rules = "Tot(s) :- s == Max{m.at :- Memory(robot_name: o, memory: m)};"
    assert whose(rules) == [(5, "Cy's memory; chosen from 3 rows")]


def test_of_its_own_sensor_nothing_is_said() -> None:
    rules = 'Tot(s) :- s == Sum{x.clock :- Sensor(robot_name: "Ada", sensor: x)};'
    assert [said for _, said in whose(rules)] == [""]
