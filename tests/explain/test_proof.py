"""A whole proof: from a row down to rays, fields of sensors and memories, and all calls in it."""

from contextlib import closing

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.mind import Mind, Program, QueryError
from logical_robots_tui.values import Value
from tests.explain.asking import REST, below, find, proof, the_rule
from tests.explain.test_refuting import REACH
from tests.mind.rows import row


def test_every_call_is_followed_down_to_what_was_sensed() -> None:
    text = """
    Wall(robot_name:, distance: ray.distance) :-
      Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "none";
    Near(robot_name:, d? Min= distance) distinct :- Wall(robot_name:, distance:);
    Speed(d) = (if d > 20 then 1 else 0);
    Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: d) :-
      Near(robot_name:, d:);
    """
    driving = proof(text)
    assert driving.complete
    (root,) = driving.nodes
    rules = [rule.text.split("(")[0] for rule in below(root, "rule")]
    assert rules == ["Robot", "Speed", "Near", "Wall"]
    assert any(node.ray is not None for _, node in root.walk())
    assert find(root, "Sensor").robot == "Ada"


def test_depth_says_how_many_predicates_deep() -> None:
    text = "A(1); B(x) :- A(x); C(x) :- B(x);"
    assert len(below(proof(text, "C").nodes[0], "rule")) == 3
    shallow = proof(text, "C", depth=2)
    assert len(below(shallow.nodes[0], "rule")) == 2
    assert not shallow.complete


def test_a_recursion_is_not_proved_by_itself() -> None:
    reached = proof(REACH, "Reach", a=1, b=1)
    (root,) = reached.nodes
    assert reached.complete
    assert find(root, "m").values == (2,)
    rules = [rule.text.partition(" :- ")[2] for rule in below(root, "rule") if ":-" in rule.text]
    assert rules == ["Edge(a, m), Reach(a: m, b:)", "Edge(a, b)"]


def test_a_shortest_way_is_proved_step_by_step() -> None:
    text = """Edge(0, 1, 5); Edge(1, 2, 1); Edge(0, 2, 9); Edge(2, 0, 1);
    Far(x: 0, d? Min= 0) distinct;
    Far(x: y, d? Min= e + w) distinct :- Far(x:, d: e), Edge(x, y, w), e < 20;"""
    far = proof(text, "Far", x=2)
    assert far.explanation.row == {"x": 2, "d": 6}
    assert [node.values for node in below(far.nodes[0], "aggregate")] == [(6,), (5,), (0,)]


def test_a_recursion_through_a_sum_is_shown_one_step_deep_and_says_so() -> None:
    text = """Edge(0, 1); Edge(1, 2);
    Ways(x: 0, n? += 1) distinct;
    Ways(x: y, n? += m) distinct :- Ways(x:, n: m), Edge(x, y);"""
    ways = proof(text, "Ways", x=2)
    assert ways.explanation.row == {"x": 2, "n": 1}
    assert not ways.complete or ways.nodes[0].kind in ("rule", "note")


def test_a_row_that_is_not_there_is_refuted_down_to_the_reason() -> None:
    refuted = proof("A(x) :- x in [1, 2], x > 5; B(x) :- A(x);", "B")
    assert refuted.explanation.rows == 0
    assert find(refuted.nodes[0], "x > 5").holds is False


CALLS = f"""
F(a) = a + 1;
G(a) = F(a) * 2;
Unused(a) = a;
P(x, F(x)) :- x in [1, 2, 1];
Q(F(5));
S(s) :- s == Sum{{G(x) :- x in [7, 8]}};
{REST}"""


def test_each_call_is_told_once_with_its_result_also_within_functions_and_aggregates() -> None:
    with closing(Mind(Program.compile(CALLS))) as mind:
        explainer = Explainer(mind, "Ada", [row("Ada")], {})
        assert sorted(explainer.calls("F").rows) == [(1, 2), (2, 3), (5, 6), (7, 8), (8, 9)]
        assert sorted(explainer.calls("G").rows) == [(7, 16), (8, 18)]
        assert not explainer.calls("Unused").rows
        with pytest.raises(QueryError, match="P is not a function"):
            explainer.calls("P")


MEMORIES: dict[str, Value] = {"Ada": {"at": 3}, "Bo": {"at": 4}, "Cy": {"at": 5}}
MINE = "Memory(robot_name: o, memory: m)"
EACH: list[tuple[Value, str]] = [(3, "Ada's memory"), (4, "Bo's memory"), (5, "Cy's memory")]
AT = "At(robot_name:, at: m.at) :- Memory(robot_name:, memory: m);"
BOTH = f'o == "Bo", {MINE}, Sensor(robot_name: o, sensor: x)'
ELEMENTS: dict[str, list[tuple[Value, str]]] = {
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


def test_of_elements_from_other_robots_it_is_said_whose_memory_or_sensor_they_are_from() -> None:
    text, robots = "\n".join([AT, *ELEMENTS]), [row(name) for name in MEMORIES]
    for rule, elements in ELEMENTS.items():
        asked = {"rows": robots, "memories": MEMORIES, "memory": "all", "sensor": "all"}
        node = the_rule(text, rule.partition("(")[0], **asked).node
        assert [(one.values[0], one.said) for one in below(node, "contributor")] == elements
