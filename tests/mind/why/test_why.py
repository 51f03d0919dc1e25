"""For each rule: did it give a row, with which values; if not, what was the first part to fail."""

from __future__ import annotations

import pytest

from logical_robots_tui.mind import QueryError
from tests.mind.rows import row
from tests.mind.why.asking import REST, part, why

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
    assert stopped.part.span.text == "d < 40"
    assert stopped.part.span.line == 5
    assert [(side.text, values) for side, values in stopped.sides] == [("d", (200,))]
    assert part(rule, "d == ").new == {"d": 200}


def test_a_place_is_that_in_the_text() -> None:
    (rule,) = why(FRONT).rules
    for found in rule.found:
        span = found.part.span
        assert FRONT[span.start : span.stop] == span.text


def test_a_rule_that_gives_a_row_tells_its_values() -> None:
    (rule,) = why(FRONT.replace("< 40", "> 40")).rules
    assert rule.rows == 1
    assert rule.stopped_by is None
    (example,) = rule.examples
    assert example["memory"] == 200
    assert example["desire"] == {"left_engine": 1, "right_engine": 1}


def test_parts_are_asked_when_what_they_need_is_known_whatever_their_order() -> None:
    backwards = FRONT.replace("Sensor(robot_name:, sensor:),\n", "").replace(
        "d < 40;", "d < 40, Sensor(robot_name:, sensor:);"
    )
    (rule,) = why(backwards).rules
    assert [f.part.span.text for f in rule.found] == [
        "Sensor(robot_name:, sensor:)",
        "d == sensor.forward_distance",
        "d < 40",
    ]


def test_a_list_is_gone_through_in_many_ways() -> None:
    text = f"""
    Wall(robot_name:) distinct :-
      Sensor(robot_name:, sensor:), r in sensor.radar, r.object == "wall";
    {REST}"""
    (rule,) = why(text, "Wall").rules
    assert part(rule, "r in").ways == 31
    stopped = rule.stopped_by
    assert stopped is not None
    assert [(side.text, values) for side, values in stopped.sides] == [("r.object", ("none",))]


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
    assert (mine.rows, mine.fixed) == (1, {})
    assert (other.rows, other.fixed) == (0, {"robot_name": "Bo"})


def test_what_holds_for_others_only_is_told_where_all_is_visible() -> None:
    text = f'Named(robot_name:) :- Sensor(robot_name:), robot_name != "Ada";{REST}'
    rows = [row("Ada"), row("Bo"), row("Cy")]
    (rule,) = why(text, "Named", rows=rows, memory="all", sensor="all").rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert (stopped.ways, stopped.elsewhere) == (0, 2)


def test_negation_tells_what_there_is_that_must_not_be() -> None:
    text = f"Seen(x) :- x in [1, 2]; None_(y) :- y in [2], ~(Seen(x), x >= y);{REST}"
    (rule,) = why(text, "None_").rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert stopped.part.kind == "denial"
    (denied,) = stopped.inside
    assert denied.inside.kind == "denied"
    assert denied.ways == 1
    assert [f.part.span.text for f in denied.found] == ["Seen(x)", "x >= y"]


def test_negation_that_holds_tells_which_part_of_it_does_not() -> None:
    text = f"Seen(x) :- x in [1, 2]; None_(y) :- y in [3], ~(Seen(x), x >= y);{REST}"
    (rule,) = why(text, "None_").rules
    assert rule.rows == 1
    (denied,) = part(rule, "~").inside
    assert denied.found[-1].part.span.text == "x >= y"
    assert denied.found[-1].ways == 0


def test_an_implication_is_a_denial_of_a_counterexample() -> None:
    text = f"Item(x) :- x in [1, 2]; Small(y) :- y in [1], (Item(x) => x < y);{REST}"
    (rule,) = why(text, "Small").rules
    assert rule.stopped_by is not None
    assert rule.stopped_by.part.kind == "denial"


def test_each_alternative_is_told() -> None:
    text = f"Odd(x) :- x in [7], (x < 3 | x > 5, x != 7);{REST}"
    (rule,) = why(text, "Odd").rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert stopped.part.kind == "choice"
    first, second = stopped.inside
    assert [f.part.span.text for f in first.found] == ["x < 3"]
    assert [(f.part.span.text, f.ways) for f in second.found] == [("x > 5", 1), ("x != 7", 0)]


def test_an_aggregate_tells_what_it_goes_over() -> None:
    text = f"""
    Near(d) :- Sensor(sensor:),
      d == Min{{r.distance :- r in sensor.radar, r.object == "wall"}}, d < 50;
    {REST}"""
    (rule,) = why(text, "Near").rules
    (collected,) = part(rule, "d ==").inside
    assert [(f.part.span.text, f.ways) for f in collected.found] == [
        ("r in sensor.radar", 31),
        ('r.object == "wall"', 0),
    ]
    assert part(rule, "d ==").new == {"d": None}
    assert [values for _, values in part(rule, "d <").sides] == [(None,)]


def test_variables_of_two_aggregates_are_not_mixed_up() -> None:
    text = f"Two(a, b) :- a == Sum{{x :- x in [1, 2]}}, b == Sum{{x :- x in [3, 4], x > a}};{REST}"
    (rule,) = why(text, "Two").rules
    (second,) = part(rule, "b ==").inside
    assert [(f.part.span.text, f.ways) for f in second.found] == [("x in [3, 4]", 2), ("x > a", 1)]
    assert rule.examples == ({"col0": 3, "col1": 4},)


def test_the_conditions_of_an_if_are_told_with_their_truth() -> None:
    text = FRONT.replace(
        "d < 40;", 'speed = (if d < 40 then 0 else if robot_name == "Ada" then 1 else 2);'
    )
    (rule,) = why(text).rules
    truths = {s.text: v for s, v in part(rule, "speed").sides if s.is_truth}
    assert truths == {"d < 40": (0,), 'robot_name == "Ada"': (1,)}


def test_the_if_of_a_head_is_told() -> None:
    text = """
    Robot(robot_name:, desire: if sensor.clock > 3 then {left_engine: 1, right_engine: 1}
      else {left_engine: 0, right_engine: 0}, memory: 0) :- Sensor(robot_name:, sensor:);
    """
    (rule,) = why(text).rules
    (truth,) = [(s.text, v) for s, v in rule.found[-1].sides if s.is_truth]
    assert truth == ("sensor.clock > 3", (0,))


def test_one_step_deeper_goes_on_with_the_arguments() -> None:
    text = """
    Speed(d) = 1 :- d > 500;
    Robot(robot_name:, desire: {left_engine: Speed(sensor.forward_distance), right_engine: 1},
      memory: 0) :- Sensor(robot_name:, sensor:);
    """
    (rule,) = why(text).rules
    stopped = rule.stopped_by
    assert stopped is not None
    assert stopped.part.kind == "head"
    (asked,) = stopped.asked
    assert (asked.predicate, asked.given) == ("Speed", {"col0": 200})
    (deeper,) = why(text, asked.predicate, given=dict(asked.given)).rules
    assert deeper.stopped_by is not None
    assert deeper.stopped_by.part.span.text == "d > 500"
    assert [values for _, values in deeper.stopped_by.sides] == [(200,)]


def test_a_function_with_patterns_tells_which_pattern_does_not_fit() -> None:
    text = f'Name(0) = "none"; Name(1) = "one";{REST}'
    first, second = why(text, "Name", given={"col0": 1}).rules
    assert (first.rows, second.rows) == (0, 1)
    assert second.examples[0]["logica_value"] == "one"


def test_a_function_without_its_arguments_is_refused_by_name() -> None:
    with pytest.raises(QueryError, match="Speed is a function of col0: give a value"):
        why(f"Speed(d) = d + 1;{REST}", "Speed")


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
    (rule,) = made.rules
    assert rule.examples == ({"col0": "blue"},)
    (asked,) = part(rule, "Wanted").asked
    assert asked.within == "PickBlue"


def test_what_leans_on_a_filled_in_predicate_is_told_within() -> None:
    text = f"""
    Wanted("red");
    Blue("blue");
    Good(x) :- x in ["red", "blue"], Wanted(x);
    Pick(x) :- Good(x);
    PickBlue := Pick(Wanted: Blue);
    {REST}
    """
    (plain,) = why(text, "Good").rules
    (within,) = why(text, "Good", within="PickBlue").rules
    assert plain.examples == ({"col0": "red"},)
    assert within.examples == ({"col0": "blue"},)


def test_a_recursive_predicate_can_be_asked() -> None:
    text = f"Up(1); Up(x + 1) :- Up(x), x < 5;{REST}"
    first, second = why(text, "Up").rules
    assert first.rows == 1
    assert second.rows is not None
    assert second.rows > 0


def test_an_unknown_robot_or_predicate_is_named() -> None:
    with pytest.raises(QueryError, match="no robot Zed"):
        why(FRONT, robot="Zed")
    with pytest.raises(QueryError, match="no rules for Nothing"):
        why(FRONT, "Nothing")
    with pytest.raises(QueryError, match="no rules for Sensor"):
        why(FRONT, "Sensor")


def test_a_failing_part_is_told_and_does_not_hide_the_other_rules() -> None:
    text = f'Bad(x) :- x in [1], y == "text", y.field == 1; Bad(2);{REST}'
    first, second = why(text, "Bad").rules
    assert second.rows == 1
    assert "neither a record nor a list" in first.found[-1].problem
    assert first.rows is None
