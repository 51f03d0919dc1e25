"""Of elements from other robots it is said whose memory or sensor they are from."""

from __future__ import annotations

import pytest

from logical_robots_tui.values import Value
from tests.explain.asking import below, the_rule
from tests.mind.rows import row

ROWS = [row("Ada"), row("Bo"), row("Cy")]
MEMORIES: dict[str, Value] = {"Ada": {"at": 3}, "Bo": {"at": 4}, "Cy": {"at": 5}}
MINE = "Memory(robot_name: o, memory: m)"
EACH: list[tuple[Value, str]] = [(3, "Ada's memory"), (4, "Bo's memory"), (5, "Cy's memory")]
AT = "At(robot_name:, at: m.at) :- Memory(robot_name:, memory: m);"
BOTH = f'o == "Bo", {MINE}, Sensor(robot_name: o, sensor: x)'


@pytest.mark.parametrize(
    ("rules", "elements"),
    [
        (f"Tot(s? += m.at) distinct :- {MINE};", EACH),
        (f"Tot(s) :- s == Sum{{m.at :- {MINE}}};", EACH),
        (f"Tot(s) :- s == Sum{{m.at :- Sensor(robot_name: o), {MINE}}};", EACH),
        (
            f'{AT} Tot(s) :- s == Sum{{at :- At(robot_name: o, at:), o != "Bo"}};',
            [(3, "Ada's At"), (5, "Cy's At")],
        ),
        (f"Tot(s) :- s == List{{m.at + x.clock :- {BOTH}}};", [(5, "Bo's memory and sensor")]),
        (f"Tot(s) :- s == Max{{m.at :- {MINE}}};", [(5, "Cy's memory; chosen from 3 rows")]),
        ('Tot(s) :- s == Sum{x.clock :- Sensor(robot_name: "Ada", sensor: x)};', [(1, "")]),
    ],
    ids=["in a head", "sum", "join", "predicate", "memory and sensor", "decides", "own sensor"],
)
def test_of_each_element_it_is_said_whose_it_is(
    rules: str, elements: list[tuple[Value, str]]
) -> None:
    rule = the_rule(rules, "Tot", rows=ROWS, memories=MEMORIES, memory="all", sensor="all")
    told = [(node.values[0], node.said) for node in below(rule.node, "contributor")]
    assert told == elements
