"""Of elements from other robots it is said whose memory or sensor they are from."""

from logical_robots_tui.values import Value
from tests.explain.asking import below, the_rule
from tests.mind.rows import row

ROWS = [row("Ada"), row("Bo"), row("Cy")]
MEMORIES: dict[str, Value] = {"Ada": {"at": 3}, "Bo": {"at": 4}, "Cy": {"at": 5}}
MINE = "Memory(robot_name: o, memory: m)"
EACH: list[tuple[Value, str]] = [(3, "Ada's memory"), (4, "Bo's memory"), (5, "Cy's memory")]
AT = "At(robot_name:, at: m.at) :- Memory(robot_name:, memory: m);"
BOTH = f'o == "Bo", {MINE}, Sensor(robot_name: o, sensor: x)'


TOLD: dict[str, list[tuple[Value, str]]] = {
    f"Head(s? += m.at) distinct :- {MINE};": EACH,
    f"Inside(s) :- s == Sum{{m.at :- {MINE}}};": EACH,
    f"Join(s) :- s == Sum{{m.at :- Sensor(robot_name: o), {MINE}}};": EACH,
    'Ats(s) :- s == Sum{at :- At(robot_name: o, at:), o != "Bo"};': [
        (3, "Ada's At"),
        (5, "Cy's At"),
    ],
    f"Both(s) :- s == List{{m.at + x.clock :- {BOTH}}};": [(5, "Bo's memory and sensor")],
    f"Best(s) :- s == Max{{m.at :- {MINE}}};": [(5, "Cy's memory; chosen from 3 rows")],
    'Own(s) :- s == Sum{x.clock :- Sensor(robot_name: "Ada", sensor: x)};': [(1, "")],
}


def test_of_each_element_it_is_said_whose_it_is() -> None:
    text = "\n".join([AT, *TOLD])
    for rule, elements in TOLD.items():
        asked = {"rows": ROWS, "memories": MEMORIES, "memory": "all", "sensor": "all"}
        node = the_rule(text, rule.partition("(")[0], **asked).node
        assert [(each.values[0], each.said) for each in below(node, "contributor")] == elements
