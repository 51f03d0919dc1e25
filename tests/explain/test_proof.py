"""Proofs down to what was sensed, refutations, calls in both, and rows with many derivations."""

from contextlib import closing
from itertools import pairwise

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.explain.why.explanation import Subject
from logical_robots_tui.mind import Limits, Mind, Program, QueryError
from logical_robots_tui.values import Value
from tests.explain.asking import REST, asked, below, find, proof, stop, texts, the_rule, why
from tests.mind.rows import row

ITEMS = "Item(x: 1, y: 2); Item(x: 2, y: 3);"
REACH = """Edge(1, 2); Edge(2, 1);
Reach(a:, b:) distinct :- Edge(a, b);
Reach(a:, b:) distinct :- Edge(a, m), Reach(a: m, b:);"""
COUNTING = """
Number(x: 0) distinct;
Number(x: x + 1) distinct :- Number(x:), x < {most};
@Recursive(Number, 5);
Robot(robot_name:, desire: {{left_engine: x, right_engine: x}}, memory: "") :-
  Sensor(robot_name:), x == Max{{n :- Number(x: n)}};
"""


def test_an_alternative_that_holds_is_not_said_to_fail_when_what_fails_stands_behind_it() -> None:
    text = f"""{ITEMS} P(x:) :- Item(x:), (x > 1 | x < 0), x > 5;
    Q(x:) :- x in [1, 2], (x == 1 | x == 2), x > 5;"""
    rule = the_rule(text, "P")
    told = {node.text: node.remark for node in below(rule.node, "alternative")}
    assert told == {"x < 0": "this alternative does not hold", "x > 1": "this alternative holds"}
    assert stop(rule) is rule.node.children[-1]
    assert stop(rule).text == "x > 5"
    rule = the_rule(text, "Q")
    said = "this alternative holds, but not what comes after it"
    for node, text in zip(below(rule.node, "alternative"), ("x == 1", "x == 2"), strict=True):
        assert (node.text, node.remark, node.holds) == (text, said, None)
        assert node.children[-1].text == "x > 5"


def test_of_choices_only_the_one_that_fails_is_said_to_fail_and_what_fails_before_once() -> None:
    text = """P(x:) :- x in [1], (x == 1 | x == 2), (x == 3 | x == 4);
    Q(x:) :- x in [1], y == x, y > 5, (y == 7 | y == 8);"""
    rule = the_rule(text, "P")
    failed = [node.text for node in below(rule.node, "alternative") if node.holds is False]
    assert failed == ["x == 3", "x == 4", "x == 2"]
    assert find(rule.node, "x == 1").remark != "this alternative does not hold"
    assert texts(the_rule(text, "Q").node.children) == ["x in [1]", "y == x", "y > 5"]


def test_what_holds_before_the_part_that_fails_is_explained_by_its_own_values() -> None:
    text = """P(y:) :- x in [1], y == (if x == 1 then Coalesce(x + 1, x) else 9), z == F(x + 2, x),
      x > 5; F(a, b) = a + b;"""
    rule = the_rule(text, "P")
    taken = find(rule.node, "Coalesce(x + 1, x)")
    assert (taken.remark, taken.values) == ("this branch is taken", (2,))
    assert texts(taken.children) == ["x + 1"]
    call = find(rule.node, "F(x + 2, x)")
    assert asked(call).given == {"col0": 3, "col1": 1, "logica_value": 4}


def test_a_computed_column_that_came_out_otherwise_is_told_so() -> None:
    rule = the_rule(f"{ITEMS} P(x:, z: y + 1) :- Item(x:, y:);", "P", given={"x": 1, "z": 1})
    call, column = rule.node.children
    assert (call.text, call.holds) == ("Item(x:, y:)", True)
    assert (column.text, column.remark, column.values) == ("z: y + 1", "actual value", (3,))
    assert rule.stopped_by is column


def test_what_came_out_otherwise_is_named_and_a_fact_tells_which_column_is_another() -> None:
    rules = f"""{ITEMS} P(x:, z:) :- Item(x:, y:), z == y + 1;
    Q(x:, z: y + 1) :- Item(x:, y:), y > 10;
    F(a) = a + 1; R(x:, z: F(x)) :- Item(x:);"""
    result = stop(the_rule(rules, "R", given={"x": 1, "z": 1}))
    assert (result.remark, result.values) == ("actual value", (2,))
    assert asked(result).given == {"col0": 1, "logica_value": 2}
    column = stop(the_rule(rules, "P", given={"z": 1}))  # that an equation gives
    condition = stop(the_rule(rules, "Q", given={"x": 1, "z": 1}))  # before columns
    assert (column.text, column.values) == ("z", (3, 4))
    assert (condition.text, condition.values) == ("y > 10", ())
    near, other = why(ITEMS, "Item", given={"x": 1, "y": 7}).rules
    assert [(n.text, n.remark, n.values) for n in near.node.children] == [
        ("y", "actual value", (2,))
    ]
    assert near.node.remark == "gives no row"
    assert other.node.remark == "does not apply to these values"


def test_a_failed_call_shows_all_it_was_asked_for_nearest_first() -> None:
    text = """Kind(object: "wall", label: "Blue"); Kind(object: "robot", label: "Bo");
    P(object:) :- object in ["beacon", "wall"], label in ["Red", "Blues"], Kind(object:, label:);"""
    stopped = stop(the_rule(text, "P"))
    assert texts(stopped.children) == [
        f'Kind(object: "{kind}", label: "{label}")'
        for kind in ("wall", "beacon")
        for label in ("Blues", "Red")
    ]
    assert all(node.query is not None for node in stopped.children)
    assert stopped.query == stopped.children[0].query


def test_of_many_calls_only_the_nearest_is_proved_and_those_that_are_too_many_are_counted() -> None:
    text = "Even(2); Even(4); Odd(11); Odd(7); Odd(5); P(x) :- Odd(x), Even(x);"
    call = find(proof(text, "P").nodes[0], "Even(x)")
    assert texts(call.children) == ["Even(5)", "Even(7)", "Even(11)"]
    assert [bool(node.children) for node in call.children] == [True, False, False]
    stopped = stop(the_rule("Even(200); P(x) :- x in Range(100), Even(x);", "P"))
    assert texts(stopped.children)[::10] == ["Even(99)", "and 90 more"]


def test_a_circle_in_a_refutation_is_named() -> None:
    refuted = proof(REACH, "Reach", a=1, b=9)
    notes = [note.text for root in refuted.nodes for note in below(root, "note")]
    assert notes == ["Reach(a: 1, b: 9) is asked above; no row follows from itself."]
    assert (refuted.complete, refuted.is_cut) == (True, False)


def test_a_recursion_that_was_cut_off_is_named_where_a_row_is_missing() -> None:
    expected = (
        "The recursion of Number was cut off after 5 steps, so later rows are missing; "
        "@Recursive(Number, 10) would allow more."
    )
    text = f"{COUNTING.format(most=100)} Big(x) :- Number(x:), x > 20;"
    assert why(text, "Number", given={"x": 50}).nodes[-1].text == expected
    assert why(text, "Big").nodes[-1].text == expected
    assert why(text, "Number", given={"x": 3}).nodes[-1].text != expected
    whole = f"{COUNTING.format(most=3)} Big(x) :- Number(x:), x > 20;"
    assert [rule.node.kind for rule in why(whole, "Big").rules] == ["rule"]


def test_a_larger_depth_is_promised_only_where_it_shows_more() -> None:
    text = "A(1); A(2); B(x) :- A(x), x > 1; C(x) :- B(x), ~A(x + 1); D(x) :- C(x), x > 5;"
    for shown, more in pairwise(proof(text, "D", depth=depth) for depth in range(1, 8)):
        assert shown.is_cut == (more.nodes != shown.nodes)


def test_calls_come_before_conditions_and_what_is_not_in_a_list_is_told_with_it() -> None:
    text = f"""{ITEMS} G(a) = a + 1; P(v) :- (v == 1 | v > 2), v == G(w), Item(x: w);
    Q(x:) :- Item(x:, y:), x + y in [9, 10];"""
    rule = the_rule(text, "P", given={"col0": 7})
    stops = [node.text for _, node in rule.node.walk() if node.kind == "value" and not node.holds]
    assert "v == G(w)" in stops
    told = [(node.text, node.values) for node in stop(the_rule(text, "Q")).children]
    assert told == [("[9, 10]", ([9, 10],)), ("x + y", (3, 5))]


def test_a_row_that_a_rule_gives_is_not_said_to_fail_where_it_was_cut_off() -> None:
    limited = 'Num(x: 1); Num(x: 2); @OrderBy(Num, "x"); @Limit(Num, 1);'
    first, second = why(limited, "Num", given={"x": 2}).rules
    assert first.node.remark == "does not apply to these values"
    assert second.node.remark == "gives this row, but it was left out, as by @Limit"
    assert second.node.holds is None
    rules = why(COUNTING.format(most=100), "Number", given={"x": 6}).rules
    assert rules[1].node.remark == "would give this row in a later step"


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


def test_depth_says_how_many_predicates_deep_and_a_missing_row_is_refuted_all_the_way() -> None:
    text = "A(1); B(x) :- A(x); C(x) :- B(x); D(x) :- x in [1, 2], x > 5; E(x) :- D(x);"
    assert len(below(proof(text, "C").nodes[0], "rule")) == 3
    shallow = proof(text, "C", depth=2)
    assert len(below(shallow.nodes[0], "rule")) == 2
    assert not shallow.complete
    refuted = proof(text, "E")
    assert refuted.explanation.rows == 0
    assert find(refuted.nodes[0], "x > 5").holds is False


def test_a_recursion_is_not_proved_by_itself() -> None:
    reached = proof(REACH, "Reach", a=1, b=1)
    (root,) = reached.nodes
    assert reached.complete
    assert find(root, "m").values == (2,)
    rules = [rule.text.partition(" :- ")[2] for rule in below(root, "rule") if ":-" in rule.text]
    assert rules == ["Edge(a, m), Reach(a: m, b:)", "Edge(a, b)"]


def test_a_shortest_way_is_proved_step_by_step_and_a_sum_one_step_deep() -> None:
    text = """Edge(0, 1, 5); Edge(1, 2, 1); Edge(0, 2, 9); Edge(2, 0, 1);
    Link(0, 1); Link(1, 2);
    Ways(x: 0, n? += 1) distinct;
    Ways(x: y, n? += m) distinct :- Ways(x:, n: m), Link(x, y);
    Far(x: 0, d? Min= 0) distinct;
    Far(x: y, d? Min= e + w) distinct :- Far(x:, d: e), Edge(x, y, w), e < 20;"""
    far = proof(text, "Far", x=2)
    assert far.explanation.row == {"x": 2, "d": 6}
    assert [node.values for node in below(far.nodes[0], "aggregate")] == [(6,), (5,), (0,)]
    ways = proof(text, "Ways", x=2)
    assert ways.explanation.row == {"x": 2, "n": 1}
    assert not ways.complete or ways.nodes[0].kind in ("rule", "note")


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
        assert [(one.values[0], one.remark) for one in below(node, "contributor")] == elements


EDGES = "E(x, x + 1) :- x in [1, 2, 3, 4];"
AS_ALTERNATIVES = "Way(x, y) distinct :- E(x, y) | Way(x, z), Way(z, y);"
AS_RULES = "Way(x, y) distinct :- E(x, y); Way(x, y) distinct :- Way(x, z), Way(z, y);"


@pytest.mark.parametrize("rules", [AS_ALTERNATIVES, AS_RULES])
@pytest.mark.parametrize(
    ("end", "middles"),
    # From rows of earlier steps: of 1 to 5 there is one, by two ways of the same length.
    [(2, []), (3, [2]), (4, [2, 3]), (5, [3])],
)
def test_the_derivations_of_a_row_are_counted_and_shown(
    rules: str, end: int, middles: list[int]
) -> None:
    explanation = why(EDGES + rules, "Way", given={"x": 1, "y": end})
    (rule,) = (rule for rule in explanation.rules if rule.row is not None)
    remark = "; first of 2 derivations" if len(middles) > 1 else ""
    assert rule.node.remark == f"gives this row{remark}"
    assert [n.values[0] for _, n in rule.node.walk() if n.text == "z"] == middles
    proved = proof(EDGES + rules, "Way", x=1, y=end)
    others = [n for top in proved.nodes for _, n in top.walk() if n.kind == "derivation"]
    assert len(others) == max(len(middles) - 1, 0)


def test_other_rules_that_give_the_row_can_be_opened_in_its_proof() -> None:
    text = "E(x) distinct :- x in [1, 2]; E(x) distinct :- x in [2, 3];"
    proved = proof(text, "E", col0=2)
    (first, other) = proved.nodes
    assert [first.kind, other.kind, *proved.alternatives] == ["rule", "derivation"]
    assert [first.remark, other.remark] == ["gives this row", "also gives this row"]
    assert "x in [2, 3]" in [child.text for child in other.children]


NULL_FIELDS = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: {a: 1, of: [{x: 1}]}) :-
  Sensor(robot_name:), robot_name != "Bob";
Robot(robot_name: "Bob", desire: {left_engine: 1, right_engine: 1}, memory: {a: 1, b: 2, of: of}) :-
  Sensor(robot_name: "Bob"), of = [{x: 1, y: 2}];
"""


def test_a_row_is_the_rules_though_another_rule_has_more_fields() -> None:
    explanation = why(NULL_FIELDS)
    assert explanation.row is not None
    assert explanation.row["memory"] == {"a": 1, "b": None, "of": [{"x": 1, "y": None}]}
    assert [rule.row is not None for rule in explanation.rules] == [True, False]
    assert why(NULL_FIELDS, given={"memory": {"a": 1, "of": [{"x": 1}]}}).rows == 1
    with closing(Mind(Program.compile(NULL_FIELDS))) as mind:
        missing = Explainer(mind, "Ada", [row("Ada")], {}).source(Subject(path=("b",)))
    assert (missing.value, missing.inputs) == (None, ())


def test_derivations_that_take_long_to_count_are_not() -> None:
    """The steps for the rows, and as many again for a count, would be too many for a query."""
    text = "N(i) :- i in Range(70); S(s) distinct :- N(a), N(b), N(c), a + b == c * 138, s = 0;"
    (rule,) = why(text, "S", limits=Limits(query_steps=4_500_000)).rules
    assert rule.row is not None
    assert "derivation" not in [node.kind for _, node in rule.node.walk()]
