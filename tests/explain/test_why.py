"""For each rule: the row that it gives, or the first part to fail; questions with values."""

from contextlib import closing
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.explain import Ask, calls
from logical_robots_tui.explain.why.explanation import read_call, spell_call
from logical_robots_tui.language.diagnostics import ProgramError
from logical_robots_tui.mind import Mind, Program, QueryError
from logical_robots_tui.values import Value
from tests.explain.asking import REST, asked, below, find, stop, texts, the_rule, why
from tests.mind.rows import row

FRONT = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: d) :-
  Sensor(robot_name:, sensor:),
  d == sensor.forward_distance,
  d < 40;
"""


def test_a_rule_without_a_row_tells_which_part_failed_what_that_compared_and_where() -> None:
    rule = the_rule(FRONT)
    stopped = stop(rule)
    assert (rule.rows, stopped.text) == (0, "d < 40")
    assert stopped.span is not None
    assert stopped.span.line == 5
    assert [(node.text, node.values) for node in stopped.children] == [("d", (200,))]
    assert find(rule.node, "d == ").values == (200,)
    for _, node in rule.node.walk():
        if node.span is not None and node.kind in ("call", "condition", "value"):
            assert FRONT[node.span.start : node.span.stop] == node.text


def test_a_rule_that_gives_a_row_tells_its_values_and_what_they_were_read_of() -> None:
    text = """Robot(robot_name:, desire: {left_engine: memory.speed, right_engine: 1}, memory: d) :-
      Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), sensor.clock > 3, d == 200;"""
    explanation = why(text, rows=[row("Ada", clock=5)], memories={"Ada": {"speed": 0.5}})
    (rule,) = explanation.rules
    assert rule.rows == explanation.rows == 1
    assert rule.stopped_by is None
    assert rule.row is not None
    assert rule.row["memory"] == 200
    assert rule.row["desire"] == {"left_engine": 0.5, "right_engine": 1}
    reads = {node.text: node.values for node in below(rule.node, "read")}
    assert reads == {"sensor.clock": (5,), "memory.speed": (0.5,)}
    assert find(rule.node, "Sensor").robot == "Ada"


def test_parts_are_asked_when_what_they_need_is_known_whatever_their_order() -> None:
    sensor = "Sensor(robot_name:, sensor:)"
    backwards = FRONT.replace(f"{sensor},\n", "").replace("d < 40;", f"d < 40, {sensor};")
    parts = the_rule(backwards).node.children
    assert texts(parts) == [sensor, "d == sensor.forward_distance", "d < 40"]


def test_all_values_are_listed_or_counted() -> None:
    radar = [{"angle": 0.0, "distance": n, "object": f"kind{n}", "label": ""} for n in range(107)]
    rows = [{**row("Ada"), "sensor": {**row("Ada")["sensor"], "radar": radar}}]
    text = """Wall(robot_name:) distinct :- Sensor(robot_name:, sensor:), r in sensor.radar,
      r.object == "wall";"""
    rule = the_rule(text, "Wall", rows=rows)
    assert find(rule.node, "r in").remark == "1 of 107 matches"
    (values,) = stop(rule).children
    assert (values.text, values.excess) == ("r.object", 7)
    assert values.values == tuple(f"kind{n}" for n in range(100))


def test_every_rule_is_told_and_one_about_another_robot_says_so() -> None:
    rules = why("Big(x) :- x in [1, 2], x > 1; Big(x) :- x in [3], x > 5;", "Big").rules
    assert [rule.rows for rule in rules] == [1, 0]
    text = """Robot(robot_name: "Ada", desire: {left_engine: 0, right_engine: 0}, memory: 1);
    Robot(robot_name: "Bo", desire: {left_engine: 1, right_engine: 1}, memory: 2);"""
    mine, other = why(text, rows=[row("Ada"), row("Bo")]).rules
    assert mine.rows == 1
    assert (other.rows, other.node.remark) == (0, "does not apply to these values")
    assert (other.node.children[0].text, other.node.children[0].values) == ("robot_name", ("Bo",))


def test_of_several_rows_of_robot_the_last_one_is_explained_because_it_counts() -> None:
    rules = REST + REST.replace('""', "2")
    explanation = why(rules)
    with closing(Mind(Program.compile(rules))) as mind:
        (decision,) = mind.think([row("Ada")], {})
    assert explanation.row is not None
    assert explanation.row["memory"] == decision.memory == 2
    told = [rule.node.remark for rule in explanation.rules]
    assert told == ["gives 1 row, but not the last", "gives 1 row; this is the last"]


def test_what_holds_for_others_only_is_told_where_all_is_visible() -> None:
    text = 'Named(robot_name:) :- Sensor(robot_name:), robot_name != "Ada";'
    robots = [row("Ada"), row("Bo"), row("Cy")]
    rule = the_rule(text, "Named", rows=robots, memory="all", sensor="all")
    assert stop(rule).remark == "not here, but 2 matches elsewhere"


DENIALS = """
Seen(x) :- x in [1, 2];
There(y) :- y in [2], ~(Seen(x), x >= y);
Absent(y) :- y in [3], ~(Seen(x), x >= y);
Small(y) :- y in [1], (Seen(x) => x < y);
Num(1); Num(2); Num(4);
Most(x:) :- Num(x), ~(Num(y), y > x);
"""


def test_negation_tells_what_there_is_that_must_not_be() -> None:
    stopped = stop(the_rule(DENIALS, "There"))
    assert (stopped.kind, stopped.remark) == ("denial", "there is a match")
    assert texts(stopped.children) == ["Seen(x)", "x >= y"]
    assert find(stopped, "x").values == (2,)
    assert stop(the_rule(DENIALS, "Small")).kind == "denial"  # an implication: of a counterexample


def test_negation_that_holds_tells_which_part_of_it_does_not_for_the_row_that_is_there() -> None:
    rule = the_rule(DENIALS, "Absent")
    assert rule.rows == 1
    denied = find(rule.node, "~")
    assert denied.holds
    assert (denied.children[-1].text, denied.children[-1].holds) == ("x >= y", False)
    rule = the_rule(DENIALS, "Most")
    assert rule.row == {"x": 4}
    assert find(rule.node, "x").values == (4,)
    assert find(rule.node, "~").remark == "no match"
    assert find(rule.node, "y > x").holds is False


def test_each_alternative_is_told_and_the_one_that_gives_the_row_is_named() -> None:
    text = "Odd(x) :- x in [7], (x < 3 | x > 5, x != 7);"
    rule = the_rule(text, "Odd")
    assert stop(rule).text == "x != 7"
    first, second = below(rule.node, "alternative")
    assert texts(first.children) == ["x < 3"]
    assert [(n.text, n.holds) for n in second.children] == [("x > 5", True), ("x != 7", False)]
    rule = the_rule(text.replace("x != 7", "x != 8"), "Odd")
    (taken,) = below(rule.node, "alternative")
    assert taken.text == "x > 5, x != 8"
    assert texts(taken.children) == ["x > 5", "x != 8"]


SUMS = """
Num(1); Num(2); Num(3); Num(4);
Low(d) :- d == Min{x :- x in [3, 1, 2], x > 0};
Tot(s? += x) distinct :- Num(x);
Least(d? Min= x) distinct :- Num(x);
Two(a, b) :- a == Sum{x :- x in [1, 2]}, b == Sum{x :- x in [3, 4], x > a};
"""


def test_an_aggregate_over_nothing_tells_why() -> None:
    text = """Near(d) :- Sensor(sensor:),
      d == Min{r.distance :- r in sensor.radar, r.object == "wall"}, d < 50;"""
    rule = the_rule(text, "Near")
    aggregate = find(rule.node, "d ==")
    assert aggregate.values == (None,)
    assert find(aggregate, "aggregates no rows").children[-1].text == 'r.object == "wall"'
    assert stop(rule).text == "d < 50"


def test_the_elements_that_an_aggregate_is_made_of_are_told() -> None:
    (decides,) = below(the_rule(SUMS, "Low").node, "contributor")
    assert (decides.values, decides.remark) == ((1,), "chosen from 3 rows")
    rule = the_rule(SUMS, "Tot")
    assert (rule.rows, rule.row) == (1, {"s": 10})
    assert [n.values for n in below(rule.node, "contributor")] == [(1,), (2,), (3,), (4,)]
    rule = the_rule(SUMS, "Two")
    assert rule.row == {"col0": 3, "col1": 4}
    assert [n.values for n in below(find(rule.node, "b =="), "contributor")] == [(4,)]


def test_what_did_not_come_out_of_an_aggregate_is_denied() -> None:
    for least in (5, 999):
        explanation = why(SUMS, "Least", given={"d": least})
        assert (explanation.rows, explanation.row) == (0, None)
        stopped = stop(explanation.rules[0])
        assert (stopped.remark, stopped.values) == ("actual value", (1,))


def test_values_are_those_of_the_row_which_counts_once_where_rows_are_distinct() -> None:
    text = """Pair(1, 2); Pair(1, 3); One(x) distinct :- Pair(x, y); Bag(x) :- Pair(x, y);
    Num(1); Num(2); Num(4); Inj(x, y) :- y == x - 1; Use(x:) :- Num(x), Inj(x, 3);"""
    assert [the_rule(text, predicate).rows for predicate in ("One", "Bag")] == [1, 2]
    rule = the_rule(text, "Use")  # not of the first way
    assert rule.row == {"x": 4}
    assert {n.values for _, n in rule.node.walk() if n.text == "x"} == {(4,)}
    assert why(text, "Inj", given=dict(asked(find(rule.node, "Inj")).given)).rows == 1


def test_the_conditions_of_an_if_are_told_as_far_as_they_are_looked_at_also_in_a_head() -> None:
    text = """Robot(robot_name:, desire: if sensor.clock > 3 then {left_engine: 1, right_engine: 1}
      else {left_engine: 0, right_engine: 0}, memory: 0) :- Sensor(robot_name:, sensor:),
      d == sensor.forward_distance,
      speed = (if d < 40 then 0 else if robot_name == "Ada" then 1 else 2);"""
    rule = the_rule(text)
    low, named, taken, *_ = find(rule.node, "speed").children
    assert (low.text, low.holds) == ("d < 40", False)
    assert (named.text, named.holds) == ('robot_name == "Ada"', True)
    assert (taken.text, taken.remark) == ("1", "this branch is taken")
    assert find(rule.node, "sensor.clock > 3").holds is False
    assert find(rule.node, "{left_engine: 0").remark == "this branch is taken"


def test_one_step_deeper_goes_on_with_the_arguments() -> None:
    text = """Speed(d) = 1 :- d > 500;
    Robot(robot_name:, desire: {left_engine: Speed(sensor.forward_distance), right_engine: 1},
      memory: 0) :- Sensor(robot_name:, sensor:);"""
    deeper = asked(stop(the_rule(text)))
    assert (deeper.predicate, dict(deeper.given)) == ("Speed", {"col0": 200})
    stopped = stop(the_rule(text, deeper.predicate, given=dict(deeper.given)))
    assert stopped.text == "d > 500"
    assert [node.values for node in stopped.children] == [(200,)]


FUNCTIONS = """
Num(x: 1);
Speed(d) = d + 1;
Name(0) = "none"; Name(1) = "one";
Use(y, Name(1)) :- y == Speed(2);
Bad(x) :- x in [1], y == "text", y.field == 1; Bad(2);
"""


def test_a_function_is_asked_with_its_arguments() -> None:
    speed = why(FUNCTIONS, "Speed", given={"col0": 0.5})
    assert speed.row == {"col0": 0.5, "logica_value": 1.5}
    assert why(FUNCTIONS, "Speed", given={"col0": 1, "value": 3}).rows == 0
    first, second = why(FUNCTIONS, "Name", given={"col0": 1}).rules
    assert (first.rows, second.rows) == (0, 1)
    assert second.row == {"col0": 1, "logica_value": "one"}


def test_what_can_not_be_asked_is_refused_by_name_and_a_predicate_that_fails_says_so() -> None:
    refused: list[tuple[dict[str, Any], str]] = [
        ({"predicate": "Speed"}, "Speed is a function of d: give a value"),
        ({"predicate": "Num", "given": {"y": 1}}, "Num has no column y; it has x"),
        ({"robot": "Zed"}, "no robot Zed"),
        ({"predicate": "Nothing"}, "no rules for Nothing"),
        ({"predicate": "Sensor"}, "Sensor has no rules: its rows are what the robots sense"),
        ({"predicate": "Bad"}, "neither a record nor a list"),
    ]
    for question, message in refused:
        with pytest.raises(QueryError, match=message):
            why(FUNCTIONS, **question)


def test_what_is_made_from_another_and_what_that_uses_are_told_as_filled_in() -> None:
    text = """Wanted("red"); Blue("blue");
    Good(x) :- x in ["red", "blue"], Wanted(x);
    Pick(x) :- Good(x), Wanted(x); PickBlue := Pick(Wanted: Blue);
    Limit() = 3; Low(x) :- x in [1, 5], x < Limit(); High := Low(Limit: 9);"""
    made = why(text, "PickBlue")
    assert (made.made_from, made.row) == ("Pick", {"col0": "blue"})
    assert asked(find(made.rules[0].node, "Wanted")).predicate == "Blue"
    good = asked(find(made.rules[0].node, "Good"))
    assert (good.predicate, good.within) == ("Good", "PickBlue")
    assert why(text, "Good").row == {"col0": "red"}
    assert why(text, "Good", within="PickBlue").row == {"col0": "blue"}
    assert (why(text, "Low").rows, why(text, "High").rows) == (1, 2)  # a constant


TYPES = [
    ("kind == 12", 'string "12" is not the number 12'),
    ("Wanted(kind)", 'string "12" is not the number 12'),
    ("kind == 13", "no match"),
    ('word == true, kind == "12"', 'string "true" is not true'),
    ("word == [1]", "no match"),
]


def test_a_condition_that_fails_by_types_alone_says_so() -> None:
    rules = "\n".join(
        f"Match{n}() :- Kind(kind:, word:), {condition};" for n, (condition, _) in enumerate(TYPES)
    )
    text = f'Kind(kind: "12", word: "true");\nWanted(12);\n{rules}\n'
    told = [stop(the_rule(text, f"Match{n}")).remark for n in range(len(TYPES))]
    assert told == [said for _, said in TYPES]


def test_literals_are_not_said_to_have_their_values() -> None:
    text = "A(x: [1, 2], y: {a: true}) :- [1, 2] == [1, 2], b == 3, b in [3, 4];"
    (root,) = why(text, "A").nodes
    columns = [("x", ([1, 2],)), ("y", ({"a": True},))]
    steps = [("[1, 2] == [1, 2]", ()), ("b == 3", (3,)), ("b in [3, 4]", ()), ("b", (3,))]
    assert [(node.text, node.values) for _, node in root.walk()][1:] == [*columns, *steps]


def test_booleans_are_true_or_false() -> None:
    text = "N(d: 1);\nFar(d) = d > 2;\n" + "\n".join(
        f"Is{n}(d:, far:) :- N(d:), far = ({condition});"
        for n, condition in enumerate(("d > 2", "d > 2 && d < 9", "Far(d)"))
    )
    for n in range(3):
        (node,) = why(text, f"Is{n}").nodes
        assert find(node, "far").values == (False,)
        assert find(node, "far = ").values == (False,)


NAMES = st.text(st.sampled_from("az_09"), max_size=6).map(lambda rest: f"n{rest}")
LEAVES = (
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(-1e9, 1e9).map(lambda x: round(x, 6))
    | st.text(
        st.sampled_from("aZ09äß☃\U0001d538 \u00a0\n\t\x01\x7f\x85\u2028\"'`\\#/(){}[],.:;=-"),
        max_size=12,
    )
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, min_size=1, max_size=3)
    ),
    max_leaves=6,
)


@given(st.lists(VALUES, max_size=3), st.dictionaries(NAMES, VALUES, max_size=3))
def test_a_written_question_can_be_read_again(
    in_place: list[Value], named: dict[str, Value]
) -> None:
    columns = {f"col{place}": value for place, value in enumerate(in_place)}
    asked = Ask("Pred", {**columns, **named})
    called = calls.read_call(spell_call(asked))
    assert (called.predicate, called.given) == (asked.predicate, asked.given)


def test_what_has_no_value_is_left_open() -> None:
    for text, question in {
        "Robot": Ask("Robot"),
        "Next(robot_name:, ray:)": Ask("Next"),
        "Speed(d)": Ask("Speed"),
        'Next(robot_name: "Crow", ray:)': Ask("Next", {"robot_name": "Crow"}),
        "Speed(-0.5) == 3": Ask("Speed", {"col0": -0.5, "logica_value": 3}),
    }.items():
        assert read_call(text) == question


def test_nonsense_is_refused_with_the_reason() -> None:
    for text, message in {
        "": "The query is empty",
        "x > 5": "This is not a predicate with values",
        "12": "This is not a predicate with values",
        "A(1), B(2)": "These are several conditions",
        "Speed(1 + 2)": "This is not a value",
        "Speed(F(2))": "This is not a value",
        "Speed(1": "bracket",
        'Speed("a)': "This string is never closed",
        "Speed(1).x == 2": "This is not a predicate with values",
    }.items():
        with pytest.raises(ProgramError, match=message):
            read_call(text)
