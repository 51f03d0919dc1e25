"""For each rule: the row that it gives and from what; if none, the first part to fail."""

from __future__ import annotations

import pytest

from logical_robots_tui.mind import QueryError
from tests.explain.asking import REST, below, find, texts, why
from tests.mind.rows import row

FRONT = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: d) :-
  Sensor(robot_name:, sensor:),
  d == sensor.forward_distance,
  d < 40;
"""


def test_a_rule_without_a_row_tells_which_part_failed_and_what_that_compared() -> None:
    (rule,) = why(FRONT).rules
    stopped = rule.stopped_by
    assert rule.rows == 0
    assert stopped is not None
    assert stopped.text == "d < 40"
    assert stopped.span is not None
    assert stopped.span.line == 5
    assert [(node.text, node.values) for node in stopped.children] == [("d", (200,))]
    assert find(rule.node, "d == ").values == (200,)


def test_a_place_is_that_in_the_text() -> None:
    (rule,) = why(FRONT).rules
    for _, node in rule.node.walk():
        if node.span is not None and node.kind in ("call", "condition", "value"):
            assert FRONT[node.span.start : node.span.stop] == node.text


def test_a_rule_that_gives_a_row_tells_its_values() -> None:
    found = why(FRONT.replace("< 40", "> 40"))
    (rule,) = found.rules
    assert rule.rows == found.rows == 1
    assert rule.stopped_by is None
    assert rule.row is not None
    assert rule.row["memory"] == 200
    assert rule.row["desire"] == {"left_engine": 1, "right_engine": 1}


def test_what_is_read_of_a_sensor_and_a_memory_is_shown() -> None:
    text = """
    Robot(robot_name:, desire: {left_engine: memory.speed, right_engine: 1}, memory: 0) :-
      Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), sensor.clock > 3;
    """
    rows = [{**row("Ada"), "sensor": {**row("Ada")["sensor"], "clock": 5}}]
    (rule,) = why(text, rows=rows, memories={"Ada": {"speed": 0.5}}).rules
    reads = {node.text: node.values for node in below(rule.node, "read")}
    assert reads == {"sensor.clock": (5,), "memory.speed": (0.5,)}
    assert find(rule.node, "Sensor").robot == "Ada"


def test_parts_are_asked_when_what_they_need_is_known_whatever_their_order() -> None:
    backwards = FRONT.replace("Sensor(robot_name:, sensor:),\n", "").replace(
        "d < 40;", "d < 40, Sensor(robot_name:, sensor:);"
    )
    (rule,) = why(backwards).rules
    assert texts(rule.node.children) == [
        "Sensor(robot_name:, sensor:)",
        "d == sensor.forward_distance",
        "d < 40",
    ]


def test_all_values_are_listed_or_counted() -> None:
    radar = [{"angle": 0.0, "distance": n, "object": f"kind{n}", "label": ""} for n in range(107)]
    rows = [{**row("Ada"), "sensor": {**row("Ada")["sensor"], "radar": radar}}]
    text = f"""
    Wall(robot_name:) distinct :-
      Sensor(robot_name:, sensor:), r in sensor.radar, r.object == "wall";
    {REST}"""
    (rule,) = why(text, "Wall", rows=rows).rules
    assert find(rule.node, "r in").said == "1 of 107 matches"
    assert rule.stopped_by is not None
    (values,) = rule.stopped_by.children
    assert values.text == "r.object"
    assert values.values == tuple(f"kind{n}" for n in range(100))
    assert values.more == 7


def test_every_rule_is_told() -> None:
    text = f"Big(x) :- x in [1, 2], x > 1; Big(x) :- x in [3], x > 5;{REST}"
    first, second = why(text, "Big").rules
    assert (first.rows, second.rows) == (1, 0)


def test_a_rule_about_another_robot_says_so() -> None:
    text = """
    Robot(robot_name: "Ada", desire: {left_engine: 0, right_engine: 0}, memory: 1);
    Robot(robot_name: "Bo", desire: {left_engine: 1, right_engine: 1}, memory: 2);
    """
    mine, other = why(text, rows=[row("Ada"), row("Bo")]).rules
    assert mine.rows == 1
    assert (other.rows, other.node.said) == (0, "does not apply to these values")
    assert [(n.text, n.values) for n in other.node.children][:1] == [("robot_name", ("Bo",))]


def test_what_holds_for_others_only_is_told_where_all_is_visible() -> None:
    text = f'Named(robot_name:) :- Sensor(robot_name:), robot_name != "Ada";{REST}'
    rows = [row("Ada"), row("Bo"), row("Cy")]
    (rule,) = why(text, "Named", rows=rows, memory="all", sensor="all").rules
    assert rule.stopped_by is not None
    assert rule.stopped_by.said == "not here, but 2 matches elsewhere"


def test_negation_tells_what_there_is_that_must_not_be() -> None:
    text = f"Seen(x) :- x in [1, 2]; None_(y) :- y in [2], ~(Seen(x), x >= y);{REST}"
    (rule,) = why(text, "None_").rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert (stopped.kind, stopped.said) == ("denial", "there is a match")
    assert texts(stopped.children) == ["Seen(x)", "x >= y"]
    assert find(stopped, "x").values == (2,)


def test_negation_that_holds_tells_which_part_of_it_does_not() -> None:
    text = f"Seen(x) :- x in [1, 2]; None_(y) :- y in [3], ~(Seen(x), x >= y);{REST}"
    (rule,) = why(text, "None_").rules
    assert rule.rows == 1
    denied = find(rule.node, "~")
    assert denied.holds
    assert denied.children[-1].text == "x >= y"
    assert denied.children[-1].holds is False


def test_negation_is_told_for_the_row_that_is_there() -> None:
    text = f"Num(1); Num(2); Num(4); Most(x:) :- Num(x), ~(Num(y), y > x);{REST}"
    found = why(text, "Most")
    assert found.row == {"x": 4}
    (rule,) = found.rules
    assert find(rule.node, "x").values == (4,)
    assert find(rule.node, "~").said == "no match"
    assert find(rule.node, "y > x").holds is False


def test_an_implication_is_a_denial_of_a_counterexample() -> None:
    text = f"Item(x) :- x in [1, 2]; Small(y) :- y in [1], (Item(x) => x < y);{REST}"
    (rule,) = why(text, "Small").rules
    assert rule.stopped_by is not None
    assert rule.stopped_by.kind == "denial"


def test_each_alternative_is_told() -> None:
    text = f"Odd(x) :- x in [7], (x < 3 | x > 5, x != 7);{REST}"
    (rule,) = why(text, "Odd").rules
    assert rule.stopped_by is not None
    assert rule.stopped_by.text == "x != 7"
    first, second = below(rule.node, "alternative")
    assert texts(first.children) == ["x < 3"]
    assert [(n.text, n.holds) for n in second.children] == [("x > 5", True), ("x != 7", False)]


def test_the_alternative_that_gives_the_row_is_named() -> None:
    text = f"Odd(x) :- x in [7], (x < 3 | x > 5, x != 8);{REST}"
    (rule,) = why(text, "Odd").rules
    (taken,) = below(rule.node, "alternative")
    assert taken.text == "x > 5, x != 8"
    assert texts(taken.children) == ["x > 5", "x != 8"]


def test_an_aggregate_over_nothing_tells_why() -> None:
    text = f"""
    Near(d) :- Sensor(sensor:),
      d == Min{{r.distance :- r in sensor.radar, r.object == "wall"}}, d < 50;
    {REST}"""
    (rule,) = why(text, "Near").rules
    aggregate = find(rule.node, "d ==")
    assert aggregate.values == (None,)
    assert find(aggregate, "aggregates no rows").children[-1].text == 'r.object == "wall"'
    assert rule.stopped_by is not None
    assert rule.stopped_by.text == "d < 50"


def test_the_element_that_decides_a_minimum_is_told() -> None:
    text = f"Low(d) :- d == Min{{x :- x in [3, 1, 2], x > 0}};{REST}"
    (rule,) = why(text, "Low").rules
    (decides,) = below(rule.node, "contributor")
    assert (decides.values, decides.said) == ((1,), "chosen from 3 rows")


def test_an_aggregate_in_a_head_is_told_as_it_came_out() -> None:
    text = f"Num(1); Num(2); Num(3); Num(4); Tot(s? += x) distinct :- Num(x);{REST}"
    found = why(text, "Tot")
    assert (found.rows, found.row) == (1, {"s": 10})
    (rule,) = found.rules
    assert [n.values for n in below(rule.node, "contributor")] == [(1,), (2,), (3,), (4,)]


@pytest.mark.parametrize("given", [5, 999])
def test_what_did_not_come_out_of_an_aggregate_is_denied(given: int) -> None:
    text = f"Num(1); Num(2); Low(d? Min= x) distinct :- Num(x);{REST}"
    found = why(text, "Low", given={"d": given})
    assert (found.rows, found.row) == (0, None)
    stopped = found.rules[0].stopped_by
    assert stopped is not None
    assert (stopped.said, stopped.values) == ("actual value", (1,))


def test_a_row_that_is_the_same_twice_counts_once_where_rows_are_distinct() -> None:
    text = f"Pair(1, 2); Pair(1, 3); One(x) distinct :- Pair(x, y); Bag(x) :- Pair(x, y);{REST}"
    assert why(text, "One").rules[0].rows == 1
    assert why(text, "Bag").rules[0].rows == 2


def test_values_are_those_of_the_row_and_not_of_the_first_way() -> None:
    text = f"Num(1); Num(2); Num(4); Inj(x, y) :- y == x - 1; Use(x:) :- Num(x), Inj(x, 3);{REST}"
    found = why(text, "Use")
    assert found.row == {"x": 4}
    (rule,) = found.rules
    assert {n.values for _, n in rule.node.walk() if n.text == "x"} == {(4,)}
    asked = find(rule.node, "Inj").asked
    assert asked is not None
    assert why(text, "Inj", given=dict(asked.given)).rows == 1


def test_variables_of_two_aggregates_are_not_mixed_up() -> None:
    text = f"Two(a, b) :- a == Sum{{x :- x in [1, 2]}}, b == Sum{{x :- x in [3, 4], x > a}};{REST}"
    found = why(text, "Two")
    assert found.row == {"col0": 3, "col1": 4}
    second = find(found.rules[0].node, "b ==")
    assert [n.values for n in below(second, "contributor")] == [(4,)]


def test_the_conditions_of_an_if_are_told_as_far_as_they_are_looked_at() -> None:
    text = FRONT.replace(
        "d < 40;",
        'speed = (if d < 40 then 0 else if robot_name == "Ada" then 1 else 2);',
    )
    (rule,) = why(text).rules
    speed = find(rule.node, "speed")
    assert [(n.text, n.holds) for n in speed.children[:2]] == [
        ("d < 40", False),
        ('robot_name == "Ada"', True),
    ]
    assert (speed.children[2].said, speed.children[2].text) == ("this branch is taken", "1")


def test_the_if_of_a_head_is_told() -> None:
    text = """
    Robot(robot_name:, desire: if sensor.clock > 3 then {left_engine: 1, right_engine: 1}
      else {left_engine: 0, right_engine: 0}, memory: 0) :- Sensor(robot_name:, sensor:);
    """
    (rule,) = why(text).rules
    assert find(rule.node, "sensor.clock > 3").holds is False
    assert find(rule.node, "{left_engine: 0").said == "this branch is taken"


def test_one_step_deeper_goes_on_with_the_arguments() -> None:
    text = """
    Speed(d) = 1 :- d > 500;
    Robot(robot_name:, desire: {left_engine: Speed(sensor.forward_distance), right_engine: 1},
      memory: 0) :- Sensor(robot_name:, sensor:);
    """
    (rule,) = why(text).rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert stopped.asked is not None
    asked = stopped.asked
    assert (asked.predicate, dict(asked.given)) == ("Speed", {"col0": 200})
    (deeper,) = why(text, asked.predicate, given=dict(asked.given)).rules
    assert deeper.stopped_by is not None
    assert deeper.stopped_by.text == "d > 500"
    assert [node.values for node in deeper.stopped_by.children] == [(200,)]


def test_a_function_without_any_condition_can_be_asked() -> None:
    text = f"Speed(d) = d + 1; Use(y) :- y == Speed(2);{REST}"
    found = why(text, "Speed", given={"col0": 0.5})
    assert found.row == {"col0": 0.5, "logica_value": 1.5}
    assert why(text, "Speed", given={"col0": 1, "value": 3}).rows == 0


def test_a_function_with_patterns_tells_which_pattern_does_not_fit() -> None:
    text = f'Name(0) = "none"; Name(1) = "one"; Use(y) :- y == Name(1);{REST}'
    first, second = why(text, "Name", given={"col0": 1}).rules
    assert (first.rows, second.rows) == (0, 1)
    assert second.row == {"col0": 1, "logica_value": "one"}


def test_a_function_without_its_arguments_is_refused_by_name() -> None:
    with pytest.raises(QueryError, match="Speed is a function of d: give a value"):
        why(f"Speed(d) = d + 1;{REST}", "Speed")


def test_a_column_that_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(QueryError, match="Num has no column y; it has x"):
        why(f"Num(x: 1);{REST}", "Num", given={"y": 1})


def test_what_is_made_from_another_is_told_with_its_rules_filled_in() -> None:
    text = f"""
    Wanted("red");
    Blue("blue");
    Pick(x) :- x in ["red", "blue"], Wanted(x);
    PickBlue := Pick(Wanted: Blue);
    {REST}
    """
    made = why(text, "PickBlue")
    assert made.made_from == "Pick"
    assert made.row == {"col0": "blue"}
    asked = find(made.rules[0].node, "Wanted").asked
    assert asked is not None
    assert asked.predicate == "Blue"


def test_what_leans_on_a_filled_in_predicate_is_told_within() -> None:
    text = f"""
    Wanted("red");
    Blue("blue");
    Good(x) :- x in ["red", "blue"], Wanted(x);
    Pick(x) :- Good(x);
    PickBlue := Pick(Wanted: Blue);
    {REST}
    """
    assert why(text, "Good").row == {"col0": "red"}
    assert why(text, "Good", within="PickBlue").row == {"col0": "blue"}
    asked = find(why(text, "PickBlue").rules[0].node, "Good").asked
    assert asked is not None
    assert (asked.predicate, asked.within) == ("Good", "PickBlue")


def test_a_constant_can_be_filled_in() -> None:
    text = f"Limit() = 3; Low(x) :- x in [1, 5], x < Limit(); High := Low(Limit: 9);{REST}"
    assert why(text, "Low").rows == 1
    assert why(text, "High").rows == 2


def test_an_unknown_robot_or_predicate_is_named() -> None:
    with pytest.raises(QueryError, match="no robot Zed"):
        why(FRONT, robot="Zed")
    with pytest.raises(QueryError, match="no rules for Nothing"):
        why(FRONT, "Nothing")
    with pytest.raises(QueryError, match="Sensor has no rules: its rows are what the robots sense"):
        why(FRONT, "Sensor")


def test_a_predicate_that_fails_says_so() -> None:
    text = f'Bad(x) :- x in [1], y == "text", y.field == 1; Bad(2);{REST}'
    with pytest.raises(QueryError, match="neither a record nor a list"):
        why(text, "Bad")


@pytest.mark.parametrize(
    ("condition", "said"),
    [
        ("kind == 12", 'string "12" is not the number 12'),
        ("Wanted(kind)", 'string "12" is not the number 12'),
        ("kind == 13", "no match"),
        ('word == true, kind == "12"', 'string "true" is not true'),
        ("word == [1]", "no match"),
    ],
)
def test_a_condition_that_fails_by_types_alone_says_so(condition: str, said: str) -> None:
    text = f"""
Kind(kind: "12", word: "true");
Wanted(12);
Match() :- Kind(kind:, word:), {condition};
{REST}"""
    stopped = why(text, "Match").rules[0].stopped_by
    assert stopped is not None
    assert stopped.said == said


def test_literals_are_not_said_to_have_their_values() -> None:
    text = f"A(x: [1, 2], y: {{a: true}}) :- [1, 2] == [1, 2], b == 3, b in [3, 4];{REST}"
    (node,) = why(text, "A").nodes
    assert [(n.text, n.values) for _, n in node.walk()][1:] == [
        ("x", ([1, 2],)),
        ("y", ({"a": True},)),
        ("[1, 2] == [1, 2]", ()),
        ("b == 3", (3,)),
        ("b in [3, 4]", ()),
        ("b", (3,)),
    ]


@pytest.mark.parametrize("condition", ["d > 2", "d > 2 && d < 9", "Far(d)"])
def test_booleans_are_true_or_false(condition: str) -> None:
    text = f"N(d: 1);\nFar(d) = d > 2;\nIs(d:, far:) :- N(d:), far = ({condition});{REST}"
    (node,) = why(text, "Is").nodes
    assert find(node, "far").values == (False,)
    assert find(node, "far = ").values == (False,)
