"""The nearest miss: each change that is suggested is true, and gives the rule a row."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.explain.why.nearest import MOST, Suggestion
from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import row

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

ROWS = [row("Ada", sees={0: (50, "beacon", "Green"), 1: (36, "wall", "wall")}), row("Bo")]
MEMORIES: dict[str, Value] = {"Ada": {"place": 3, "flag": True, "phase": "out"}, "Bo": {"place": 4}}

ROBOT = """
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-
  Sensor(robot_name:), Near(robot_name:);
"""


@dataclass(frozen=True)
class Case:
    """A rule that gives nothing, and what is missed."""

    rules: str
    said: str
    was: str
    change: str


CASES = {
    "a threshold": Case(
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), ray in sensor.radar, "
        "ray.distance < 20;",
        "`ray.distance < 20` fails: ray.distance is 16 too much.",
        "20",
        "36.017",
    ),
    "a threshold in a function": Case(
        "IsFar(x) :- x > 500;\n"
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), IsFar(sensor.forward_distance);",
        "`x > 500` fails: x is 300 too little.",
        "500",
        "199.699",
    ),
    "upper case": Case(
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), ray in sensor.radar, "
        'ray.label == "green";',
        'ray.label is "Green", not "green".',
        '"green"',
        '"Green"',
    ),
    "a text for a number": Case(
        'Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == "3";',
        'memory.place is 3, not "3".',
        '"3"',
        "3",
    ),
    "a text for a truth": Case(
        'Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag == "true";',
        'memory.flag is 1, not "true".',
        '"true"',
        "1",
    ),
    "another field": Case(
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.places == 3;",
        "memory has no field places; it has place.",
        "places",
        "place",
    ),
    "one column of a join": Case(
        'Kind(robot_name:, kind: "out") :- Sensor(robot_name:);\n'
        'Near(robot_name:) :- Kind(robot_name:, kind: "aut");',
        'Kind has kind "out", not "aut".',
        'kind: "aut"',
        'kind: "out"',
    ),
    "a denial": Case(
        "Seen(robot_name:) :- Sensor(robot_name:);\n"
        "Near(robot_name:) :- Sensor(robot_name:), ~Seen(robot_name:);",
        "`Seen(robot_name:)` has rows; without ~ the rule holds.",
        "~",
        "",
    ),
    "a denial that is missing": Case(
        "Seen(robot_name:) :- Sensor(robot_name:), 1 == 2;\n"
        "Near(robot_name:) :- Sensor(robot_name:), Seen(robot_name:);",
        "`Seen(robot_name:)` has no rows; with ~ before it the rule holds.",
        "Seen(robot_name:)",
        "~",
    ),
    "one of two operands": Case(
        "Near(robot_name:) :- Memory(robot_name:, memory:), memory.flag && memory.place > 5;",
        "`memory.place > 5` fails: memory.place is 2 too little.",
        "5",
        "2.997",
    ),
}


def ask(rules: str, robot: str = "Ada") -> tuple[str, tuple[Suggestion, ...]]:
    text = f"{rules}{ROBOT}"
    with closing(Mind(Program.compile(text))) as mind:
        found = Explainer(mind, robot, ROWS, MEMORIES).nearest("Near")
    return text, tuple(each for _, each in found)


def has_row(text: str, robot: str) -> bool:
    mind = Mind(Program.compile(text))
    try:
        table = mind.query("Near", ROWS, MEMORIES)
    finally:
        mind.close()
    return any(robot in row for row in table.rows)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_nearest_miss_is_named(case: Case) -> None:
    _, found = ask(case.rules)
    told = [(each.text, each.span.text, each.change) for each in found]
    assert (case.said, case.was, case.change) in told


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_with_each_change_the_rule_has_a_row_and_without_it_none(case: Case) -> None:
    text, found = ask(case.rules)
    assert 0 < len(found) <= MOST
    assert not has_row(text, "Ada")
    for each in found:
        span = each.span
        changed = text[: span.start] + each.change + text[span.stop :]
        if not each.change:  # an argument or a part goes with its comma
            changed = changed.replace("(,", "(").replace(",)", ")").replace(", ;", ";")
        assert has_row(changed, "Ada"), each


def test_the_smallest_change_comes_first() -> None:
    _, found = ask(
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), ray in sensor.radar, "
        'ray.label == "Wall";'
    )
    assert [each.change for each in found][:1] == ['"wall"']


def test_a_rule_that_gave_a_row_misses_nothing() -> None:
    assert ask("Near(robot_name:) :- Sensor(robot_name:);")[1] == ()


def test_what_no_single_change_would_have_helped_gets_no_suggestion() -> None:
    rules = "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place > 5, memory.place < 1;"
    assert ask(rules)[1] == ()


def test_it_is_asked_in_the_reasoning_of_one_robot() -> None:
    rules = "Near(robot_name:) :- Memory(robot_name:, memory:), memory.place == 4;"
    assert ask(rules, "Bo")[1] == ()
    assert ask(rules, "Ada")[1] != ()
