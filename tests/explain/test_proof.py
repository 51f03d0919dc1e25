"""A whole proof: from a row down to rays, fields of sensors and memories."""

from tests.explain.asking import below, find, proof


def test_every_call_is_followed_down_to_what_was_sensed() -> None:
    text = """
    Wall(robot_name:, distance: ray.distance) :-
      Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "none";
    Near(robot_name:, d? Min= distance) distinct :- Wall(robot_name:, distance:);
    Speed(d) = (if d > 20 then 1 else 0);
    Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: d) :-
      Near(robot_name:, d:);
    """
    found = proof(text)
    assert found.complete
    (root,) = found.nodes
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
    text = """
    Edge(1, 2); Edge(2, 1);
    Reach(a:, b:) distinct :- Edge(a, b);
    Reach(a:, b:) distinct :- Edge(a, m), Reach(a: m, b:);"""
    found = proof(text, "Reach", given={"a": 1, "b": 1})
    (root,) = found.nodes
    assert found.complete
    assert find(root, "m").values == (2,)
    assert [r.text.split(" :-")[1].strip() for r in below(root, "rule") if ":-" in r.text] == [
        "Edge(a, m), Reach(a: m, b:)",
        "Edge(a, b)",
    ]


def test_a_shortest_way_is_proved_step_by_step() -> None:
    text = """
    Edge(0, 1, 5); Edge(1, 2, 1); Edge(0, 2, 9); Edge(2, 0, 1);
    Far(x: 0, d? Min= 0) distinct;
    Far(x: y, d? Min= e + w) distinct :- Far(x:, d: e), Edge(x, y, w), e < 20;"""
    found = proof(text, "Far", given={"x": 2})
    assert found.explanation.row == {"x": 2, "d": 6}
    assert [n.values for n in below(found.nodes[0], "aggregate")] == [(6,), (5,), (0,)]


def test_a_recursion_through_a_sum_is_shown_one_step_deep_and_says_so() -> None:
    text = """
    Edge(0, 1); Edge(1, 2);
    Ways(x: 0, n? += 1) distinct;
    Ways(x: y, n? += m) distinct :- Ways(x:, n: m), Edge(x, y);"""
    found = proof(text, "Ways", given={"x": 2})
    assert found.explanation.row == {"x": 2, "n": 1}
    assert not found.complete or found.nodes[0].kind in ("rule", "note")


def test_a_row_that_is_not_there_is_refuted_down_to_the_reason() -> None:
    found = proof("A(x) :- x in [1, 2], x > 5; B(x) :- A(x);", "B")
    assert found.explanation.rows == 0
    assert find(found.nodes[0], "x > 5").holds is False
