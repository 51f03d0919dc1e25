"""The nearest miss: each change that is suggested is true, and gives the rule a row."""

from contextlib import closing

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

CASES = {
    "a threshold": (
        f"Near(robot_name:) :- {SEES}, ray.distance < 20;",
        "Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much.",
    ),
    "a threshold on the left": (
        f"Near(robot_name:) :- {SEES}, 20.5 > ray.distance;",
        "Change `20.5` to `36.1` in line 1: `ray.distance` is 36, 15.5 too much.",
    ),
    "parentheses around a comparison": (
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), n = sensor.forward_distance < 60,\n"
        "  n == false || Sqrt(n) > 0;",
        "Put `sensor.forward_distance < 60` in line 1 in parentheses: `=` is read before `<`.",
    ),
    "a threshold in a function": (
        "IsFar(x) :- x > 500;\n"
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), IsFar(sensor.forward_distance);",
        "Change `500` to `199` in line 1: `x` is 200, 300 too little.",
    ),
    "a threshold that is a constant": (
        f"Close() = 20;\nNear(robot_name:) :- {SEES}, ray.distance < Close();",
        "Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much.",
    ),
    "exactly the limit": (
        f"Near(robot_name:) :- {SEES}, ray.distance < 36;",
        "Change `<` to `<=` in line 1: `ray.distance` is 36, exactly the limit.",
    ),
    "upper case": (
        f'Near(robot_name:) :- {SEES}, ray.label == "green";',
        'Change `"green"` to `"Green"` in line 1: `ray.label` is "Green".',
    ),
    "a text for a number": (
        'Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == "3";',
        'Change `"3"` to `3` in line 1: `memory.place` is the number 3.',
    ),
    "a text for a truth": (
        'Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag == "true";',
        'Change `"true"` to `true` in line 1: `memory.flag` is a Boolean, not a string.',
    ),
    "another field": (
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.places == 3;",
        "Change `places` to `place` in line 1: the memory has no field places, but place.",
    ),
    "the field beside it": (
        f'Near(robot_name:) :- {SEES}, ray.object == "Green";',
        'Change `object` to `label` in line 1: `label` is "Green".',
    ),
    "the field beside one in a call": (
        f'Post("Green");\nNear(robot_name:) :- {SEES}, Post(ray.object);',
        'Change `object` to `label` in line 2: `label` is "Green".',
    ),
    "a text within an expression": (
        'Near(robot_name:) :- Memory(robot_name:, memory:), now in ["out", "home"], '
        'now == Coalesce(memory.gone, "Out");',
        'Change `"Out"` to `"out"` in line 1: `now` is "out".',
    ),
    "a text in a call": (
        'Kind(robot_name:, kind: "out") :- Sensor(robot_name:);\n'
        'Near(robot_name:) :- Kind(robot_name:, kind: "aut");',
        'Change `"aut"` to `"out"` in line 2: Kind has kind "out".',
    ),
    "a text in a call by place": (
        'Kind("out", 1);\nNear(robot_name:) :- Sensor(robot_name:), Kind("aut", 1);',
        'Change `"aut"` to `"out"` in line 2: Kind has "out".',
    ),
    "a column of a join too many": (
        "Place(robot_name:, at: 5) :- Sensor(robot_name:);\n"
        "Near(robot_name:) :- Sensor(robot_name:), at in [1], Place(robot_name:, at:);",
        "Remove `at:` in line 2: Place fails in the column at alone, which has 5.",
    ),
    "a denial": (
        "Seen(robot_name:) :- Sensor(robot_name:);\n"
        "Near(robot_name:) :- Sensor(robot_name:), ~Seen(robot_name:);",
        "Remove `~` in line 2: `Seen(robot_name:)` has rows.",
    ),
    "a denial that is missing": (
        "Seen(robot_name:) :- Sensor(robot_name:), 1 == 2;\n"
        "Near(robot_name:) :- Sensor(robot_name:), Seen(robot_name:);",
        "Put `~` before `Seen(robot_name:)` in line 2: there is no such row.",
    ),
    "one of two operands": (
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag && memory.place > 5;",
        "Change `5` to `2` in line 1: `memory.place` is 3, 2 too little.",
    ),
    "a condition that nothing else helps": (
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == 30;",
        "Remove `memory.place == 30` in line 1: all the rest of the rule holds.",
    ),
}

ALL_THAT_IS_SENSIBLE = {
    "a text that differs wholly": (
        f'Near(robot_name:) :- {SEES}, ray.label == "nowhere";',
        ['Remove `ray.label == "nowhere"` in line 1: all the rest of the rule holds.'],
    ),
    "a variable that is compared": (
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == memory.phase;",
        ["Remove `memory.place == memory.phase` in line 1: all the rest of the rule holds."],
    ),
    "a function in a head": (
        "Far(x) = x :- x > 9000;\n"
        "Near(robot_name:, far: Far(sensor.forward_distance)) :- Sensor(robot_name:, sensor:);",
        ["Change `9000` to `199` in line 1: `x` is 200, 8800 too little."],
    ),
    "a call that gives a variable": (
        "Seen(robot_name:, x: 1) :- Sensor(robot_name:), 1 == 2;\n"
        "Near(robot_name:, x:) :- Sensor(robot_name:), Seen(robot_name:, x:);",
        [],
    ),
    "a denial of a table of facts": (
        f'Post("Mine");\nNear(robot_name:) :- {SEES}, Post(ray.object);',
        ["Remove `Post(ray.object)` in line 2: all the rest of the rule holds."],
    ),
    "a condition beside a threshold that would help": (
        f"Near(robot_name:) :- {SEES}, ray.distance < 20;",
        ["Change `20` to `37` in line 1: `ray.distance` is 36, 16 too much."],
    ),
}


def ask(rules: str, robot: str = "Ada", **given: Value) -> tuple[str, tuple[Suggestion, ...]]:
    text = f"{rules}{ROBOT}"
    with closing(Mind(Program.compile(text))) as mind:
        found = Explainer(mind, robot, ROWS, MEMORIES).nearest(Ask("Near", given))
    return text, tuple(each for _, each in found)


def has_row(text: str, robot: str) -> bool:
    with closing(Mind(Program.compile(text))) as mind:
        return any(robot in row for row in mind.query("Near", ROWS, MEMORIES).rows)


VARIANTS = {  # of another case
    "a threshold on the left",
    "a threshold that is a constant",
    "a text for a truth",
    "the field beside one in a call",
    "a text in a call by place",
}


@pytest.mark.parametrize(
    ("rules", "sentence"),
    [
        pytest.param(*case, id=name, marks=[pytest.mark.slow] * (name in VARIANTS))
        for name, case in CASES.items()
    ],
)
def test_the_nearest_miss_is_named_and_with_each_change_alone_there_is_a_row(
    rules: str, sentence: str
) -> None:
    text, found = ask(rules)
    assert sentence in [each.text for each in found]
    assert len(found) <= MOST
    assert not has_row(text, "Ada")
    for each in found:
        span = each.span
        changed = text[: span.start] + each.change + text[span.stop :]
        if not each.change:  # an argument or a part goes with its comma
            changed = changed.replace("(,", "(").replace(",)", ")").replace(", ;", ";")
        assert has_row(changed, "Ada"), each


@pytest.mark.parametrize(
    ("rules", "sentences"), ALL_THAT_IS_SENSIBLE.values(), ids=ALL_THAT_IS_SENSIBLE
)
def test_nothing_else_is_advised(rules: str, sentences: list[str]) -> None:
    assert [each.text for each in ask(rules)[1]] == sentences


def test_the_smallest_change_comes_first() -> None:
    _, found = ask(f'Near(robot_name:) :- {SEES}, ray.label == "Wall";')
    assert found[0].change == '"wall"'


def test_of_a_row_with_certain_values_the_changes_are_told_that_give_that_row() -> None:
    rules = (
        'Post(name: "Mine", far: 30); Post(name: "Well", far: 90);\n'
        "Near(robot_name:, name:) :- Sensor(robot_name:), Post(name:, far:), far < 50;"
    )
    assert ask(rules)[1] == ()
    assert [each.change for each in ask(rules, name="Well")[1]] == ["91"]
    assert ask(rules, name="Mine")[1] == ()


@pytest.mark.parametrize(
    "body",
    [
        "Sensor(robot_name:)",  # gives a row
        "Sensor(robot_name:), (x == 1 | x == 2, x > 1, x > 9)",  # its shortest alternative holds
        "Memory(robot_name:, memory:), memory.place > 5, memory.place < 1",  # takes two changes
    ],
)
def test_what_no_single_change_would_have_helped_misses_nothing(body: str) -> None:
    assert ask(f"Near(robot_name:) :- {body};")[1] == ()


def test_it_is_asked_in_the_reasoning_of_one_robot() -> None:
    rules = "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == 4;"
    assert ask(rules, "Bo")[1] == ()
    assert ask(rules, "Ada")[1] != ()
