"""The nearest miss: each change that is suggested is true, and gives the rule a row."""

from contextlib import closing
from typing import Any

import pytest

from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.explain.why.nearest import MOST, Suggestion
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.values import Value
from tests.mind.rows import row

ROWS = [row("Ada", sees={0: (50, "beacon", "Green"), 1: (36, "wall", "wall")}), row("Bo")]
MEMORIES: dict[str, Value] = {"Ada": {"place": 3, "flag": True, "phase": "out"}, "Bo": {"place": 4}}
ROBOT = """
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-
  Sensor(robot_name:), Near(robot_name:);
"""
SEES = "Sensor(robot_name:, sensor:), ray in sensor.radar"
CASES = """
# a threshold
Near(robot_name:) :- SEES, ray.distance < 20;
Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much.
# a threshold on the left (a variant)
Near(robot_name:) :- SEES, 20.5 > ray.distance;
Change `20.5` to `36.1` in line 1: `ray.distance` is 36, 15.5 too much.
# parentheses around a comparison
Near(robot_name:) :- Sensor(robot_name:, sensor:), n = sensor.forward_distance < 60,
  n == false || Sqrt(n) > 0;
Put `sensor.forward_distance < 60` in line 1 in parentheses: `=` is read before `<`.
# a threshold in a function
IsFar(x) :- x > 500;
Near(robot_name:) :- Sensor(robot_name:, sensor:), IsFar(sensor.forward_distance);
Change `500` to `199` in line 1: `x` is 200, 300 too little.
# a threshold that is a constant (a variant)
Close() = 20;
Near(robot_name:) :- SEES, ray.distance < Close();
Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much.
# exactly the limit
Near(robot_name:) :- SEES, ray.distance < 36;
Change `<` to `<=` in line 1: `ray.distance` is 36, exactly the limit.
# upper case
Near(robot_name:) :- SEES, ray.label == "green";
Change `"green"` to `"Green"` in line 1: `ray.label` is "Green".
# a text for a number
Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == "3";
Change `"3"` to `3` in line 1: `memory.place` is the number 3.
# a text for a truth (a variant)
Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag == "true";
Change `"true"` to `true` in line 1: `memory.flag` is a Boolean, not a string.
# another field
Near(robot_name:) :- Memory(robot_name:, memory:), memory.places == 3;
Change `places` to `place` in line 1: the memory has no field places, but place.
# the field beside it
Near(robot_name:) :- SEES, ray.object == "Green";
Change `object` to `label` in line 1: `label` is "Green".
# the field beside one in a call (a variant)
Post("Green");
Near(robot_name:) :- SEES, Post(ray.object);
Change `object` to `label` in line 2: `label` is "Green".
# a text within an expression
Near(robot_name:) :- Memory(robot_name:, memory:), now in ["out", "home"],
  now == Coalesce(memory.gone, "Out");
Change `"Out"` to `"out"` in line 2: `now` is "out".
# a text in a call
Kind(robot_name:, kind: "out") :- Sensor(robot_name:);
Near(robot_name:) :- Kind(robot_name:, kind: "aut");
Change `"aut"` to `"out"` in line 2: Kind has kind "out".
# a text in a call by place (a variant)
Kind("out", 1);
Near(robot_name:) :- Sensor(robot_name:), Kind("aut", 1);
Change `"aut"` to `"out"` in line 2: Kind has "out".
# a column of a join too many
Place(robot_name:, at: 5) :- Sensor(robot_name:);
Near(robot_name:) :- Sensor(robot_name:), at in [1], Place(robot_name:, at:);
Remove `at:` in line 2: Place fails in the column at alone, which has 5.
# a denial
Seen(robot_name:) :- Sensor(robot_name:);
Near(robot_name:) :- Sensor(robot_name:), ~Seen(robot_name:);
Remove `~` in line 2: `Seen(robot_name:)` has rows.
# a denial that is missing
Seen(robot_name:) :- Sensor(robot_name:), 1 == 2;
Near(robot_name:) :- Sensor(robot_name:), Seen(robot_name:);
Put `~` before `Seen(robot_name:)` in line 2: there is no such row.
# one of two operands
Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag && memory.place > 5;
Change `5` to `2` in line 1: `memory.place` is 3, 2 too little.
# a condition that nothing else helps
Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == 30;
Remove `memory.place == 30` in line 1: all the rest of the rule holds.
"""
ALL_THAT_IS_SENSIBLE = """
# a text that differs wholly
Near(robot_name:) :- SEES, ray.label == "nowhere";
Remove `ray.label == "nowhere"` in line 1: all the rest of the rule holds.
# a variable that is compared
Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == memory.phase;
Remove `memory.place == memory.phase` in line 1: all the rest of the rule holds.
# a function in a head
Far(x) = x :- x > 9000;
Near(robot_name:, far: Far(sensor.forward_distance)) :- Sensor(robot_name:, sensor:);
Change `9000` to `199` in line 1: `x` is 200, 8800 too little.
# a call that gives a variable
Seen(robot_name:, x: 1) :- Sensor(robot_name:), 1 == 2;
Near(robot_name:, x:) :- Sensor(robot_name:), Seen(robot_name:, x:);
# a denial of a table of facts
Post("Mine");
Near(robot_name:) :- SEES, Post(ray.object);
Remove `Post(ray.object)` in line 2: all the rest of the rule holds.
# a condition beside a threshold that would help
Near(robot_name:) :- SEES, ray.distance < 20;
Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much.
"""


def cases(text: str) -> list[Any]:
    """What stands between two names: rules, and what is advised; variants are slow."""
    found = []
    for case in text.replace("SEES", SEES).removeprefix("\n# ").split("\n# "):
        name, _, rest = case.partition("\n")
        rules, _, sentence = f"{rest}\n".rpartition(";\n")
        marks = [pytest.mark.slow] * name.endswith("(a variant)")
        found.append(pytest.param(f"{rules};", sentence.strip(), id=name, marks=marks))
    return found


def ask(rules: str, robot: str = "Ada", **given: Value) -> tuple[str, tuple[Suggestion, ...]]:
    text = f"{rules}{ROBOT}"
    with closing(Mind(Program.compile(text))) as mind:
        nearest = Explainer(mind, robot, ROWS, MEMORIES).nearest(Ask("Near", given))
    return text, tuple(suggestion for _, suggestion in nearest)


def has_row(text: str) -> bool:
    with closing(Mind(Program.compile(text))) as mind:
        return any("Ada" in row for row in mind.query("Near", ROWS, MEMORIES).rows)


@pytest.mark.parametrize(("rules", "sentence"), cases(CASES))
def test_the_nearest_miss_is_named_and_each_change_gives_a_row(rules: str, sentence: str) -> None:
    text, suggestions = ask(rules)
    assert sentence in [suggestion.text for suggestion in suggestions]
    assert len(suggestions) <= MOST
    assert not has_row(text)
    for suggestion in suggestions:
        span = suggestion.span
        changed = text[: span.start] + suggestion.change + text[span.stop :]
        if not suggestion.change:  # an argument or a part goes with its comma
            changed = changed.replace("(,", "(").replace(",)", ")").replace(", ;", ";")
        assert has_row(changed), suggestion


@pytest.mark.parametrize(("rules", "sentence"), cases(ALL_THAT_IS_SENSIBLE))
def test_nothing_else_is_advised(rules: str, sentence: str) -> None:
    assert [suggestion.text for suggestion in ask(rules)[1]] == [sentence] * bool(sentence)


def test_the_smallest_change_comes_first() -> None:
    assert ask(f'Near(robot_name:) :- {SEES}, ray.label == "Wall";')[1][0].change == '"wall"'


def test_of_a_row_with_certain_values_the_changes_are_told_that_give_that_row() -> None:
    rules = (
        'Post(name: "Mine", far: 30); Post(name: "Well", far: 90);\n'
        "Near(robot_name:, name:) :- Sensor(robot_name:), Post(name:, far:), far < 50;"
    )
    assert ask(rules)[1] == ask(rules, name="Mine")[1] == ()
    assert [suggestion.change for suggestion in ask(rules, name="Well")[1]] == ["91"]


def test_what_no_single_change_would_have_helped_misses_nothing() -> None:
    for body in (
        "Sensor(robot_name:)",  # gives a row
        "Sensor(robot_name:), (x == 1 | x == 2, x > 1, x > 9)",  # its shortest alternative holds
        "Memory(robot_name:, memory:), memory.place > 5, memory.place < 1",  # takes two changes
    ):
        assert ask(f"Near(robot_name:) :- {body};")[1] == ()


def test_it_is_asked_in_the_reasoning_of_one_robot() -> None:
    rules = "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == 4;"
    assert ask(rules, "Bo")[1] == ()
    assert ask(rules, "Ada")[1] != ()
