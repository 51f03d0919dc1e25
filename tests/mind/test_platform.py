"""What programs of the web platform do and this game once refused, or understood otherwise."""

import math
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from typing import Any

import pytest

from logical_robots_tui.mind import Mind, Program, ProgramError
from tests.mind.rows import ROBOT, cases, remembered, row, think

SEEN = {3: (40, "robot", "Bo"), 4: (33, "beacon", "A"), 5: (50, "beacon", "B")}
ANGLE = row("Ada")["sensor"]["radar"][4]["angle"]


def exactly(expressions: Sequence[str], rules: str = "") -> dict[str, list[Any]]:
    """What a robot remembers of each expression, decided the quick way and the plain one."""
    functions, calls = cases(expressions)
    record = ", ".join(f"{name}: {call}" for name, call in calls.items())
    text = f"{rules}{functions}{ROBOT} Memory(robot_name:, memory:), m = {{{record}}};"
    program = Program.compile(text)
    memories: list[Any] = []
    for plain in (False, True):
        with closing(Mind(program, plain=plain)) as mind:
            (decision,) = mind.think([row("Ada", sees=SEEN)], {"Ada": {"x": ANGLE}})
            assert not decision.notices
            memories.append(decision.memory)
    names = dict(zip(expressions, calls, strict=True))
    return {text: [memory[name] for memory in memories] for text, name in names.items()}


ANGLES = """
V() = {x: r.angle} :- Sensor(sensor:), r in sensor.radar, r.label == 'A';
@Ground(P); P(r: {x: a.angle}) :- Sensor(sensor:), a in sensor.radar, a.label == 'A';
"""


def test_a_number_keeps_all_of_its_digits() -> None:
    expressions = [
        "{x: Element(sensor.radar, 4).angle}.x",
        "V().x",
        "Max{r.x :- P(r:)}",
        "ArgMin{ {x: r.angle} -> r.distance :- r in sensor.radar}.x",
        "Element(List{r.angle :- r in sensor.radar, r.label == 'A'}, 0)",
        "Element([memory.x], 0)",
        "{y: {x: memory.x}}.y.x",
        "TryCast({x: memory.x}, {x: 0}).x",
    ]
    assert exactly(expressions, ANGLES) == {text: [ANGLE, ANGLE] for text in expressions}
    nested = [f"{{a: [{{b: ({text})}}]}}" for text in expressions]
    assert exactly(nested, ANGLES) == {text: [{"a": [{"b": ANGLE}]}] * 2 for text in nested}


def test_a_truth_in_a_record_is_a_truth() -> None:
    text = "{near: sensor.clock < 5, far: sensor.clock > 5, no: null is null && null}"
    for truths in exactly([text])[text]:
        assert (truths["near"], truths["far"], truths["no"]) == (True, False, None)
        assert isinstance(truths["near"], bool)


def test_an_example_may_be_known_in_the_tick_only() -> None:
    text = 'TryCast("12", Element(memory.example, 0))'
    assert remembered(text, {"example": [1]}) == 12
    assert remembered(text, {"example": ["x"]}) == "12"
    cast = remembered("TryCast(memory, memory.example)", {"example": {"a": None, "b": []}})
    assert cast == {"a": None, "b": None}


def engines(expressions: Sequence[str]) -> dict[str, tuple[float, list[str]]]:
    """By what is written for its power: that of an engine, and what is told about it."""
    text = "".join(
        f'Robot(robot_name: "{n}", desire: {{left_engine: {left}, right_engine: 1}}, memory: 0)'
        f' :- Sensor(robot_name: "{n}");\n'
        for n, left in enumerate(expressions)
    )
    decisions = think(text, [row(str(number)) for number in range(len(expressions))], {})
    return {
        left: (decision.desire.left_engine, [notice.message for notice in decision.notices])
        for left, decision in zip(expressions, decisions, strict=True)
        if decision.desire is not None
    }


def test_an_engine_may_be_a_text_that_spells_a_number_and_any_other_text_stands_still() -> None:
    numbers = ['"0.5"', '" 0.5 "', '".5"', '"+5e-1"']
    others = ['""', '"half"', '"0.5x"', '"nan"', '"1_0"', '"٣"']
    told = engines([*numbers, *others])
    assert [told[text] for text in numbers] == [(0.5, [])] * 4
    for text in others:
        power, (notice,) = told[text]
        assert power == 0, text
        assert "it stops" in notice, text


def test_a_number_without_end_stops_an_engine_and_stays_one_in_a_record() -> None:
    assert engines(["1 / 0"]) == {"1 / 0": (0, ["left_engine is infinite: it stops."])}
    assert remembered("{a: 5 / 0, b: [-5 / 0]}") == {"a": math.inf, "b": [-math.inf]}


def test_what_a_value_does_not_need_may_be_left_out_and_is_missed_where_it_does() -> None:
    love = "Love(radar, name) = Size(radar);"
    assert not Program.compile(f"{love} {ROBOT} m = Love(sensor.radar);").warnings
    assert remembered("Love(sensor.radar)", rules=love) == 31
    sum_ = "Sum2(x, y) = x + y;"
    assert not Program.compile(f"{sum_} Unused(x) :- x = Sum2(1); {ROBOT} m = 1;").warnings
    with pytest.raises(ProgramError, match="Sum2 takes 2 arguments; 1 is given"):
        Program.compile(f"{sum_} {ROBOT} m = Sum2(1);")


REACH = """
Sees(a: robot_name, b: x.label) distinct :-
  Sensor(robot_name:, sensor:), x in sensor.radar, x.object == "robot";
Reach(a:, b:) distinct :- Sees(a:, b:);
Reach(a:, b: c) distinct :- Reach(a:, b:), Reach(a: b, b: c);
"""
CHAIN = [
    row("Ada", sees={1: (40, "robot", "Bo")}),
    row("Bo", sees={2: (40, "robot", "Cy")}),
    row("Cy", sees={2: (40, "robot", "Di")}),
    row("Di"),
]


def test_a_recursion_that_mentions_itself_twice_goes_as_far_as_there_is_something_new() -> None:
    text = f"{REACH}{ROBOT} m = List{{b :- Reach(a: robot_name, b:)}};"
    alone = [["Bo"], ["Cy"], ["Di"], None]
    together = [["Bo", "Cy", "Di"], ["Cy", "Di"], ["Di"], None]
    assert [d.memory for d in think(text, CHAIN, {})] == alone
    assert [d.memory for d in think(text, CHAIN, {}, sensor="all")] == together
    assert [d.memory for d in think(text, CHAIN, {}, sensor="all", memory="all")] == together


def test_a_functor_of_such_a_recursion_is_one_too() -> None:
    rules = (
        f"{REACH} Linked(a: 'Ada', b: 'Di'); Linked(a: 'Di', b: 'Bo'); Way := Reach(Sees: Linked);"
    )
    text = f"{rules} {ROBOT} m = List{{b :- Way(a: robot_name, b:)}};"
    assert [d.memory for d in think(text, CHAIN, {})] == [["Bo", "Di"], None, None, ["Bo"]]
    with closing(Mind(Program.compile(text))) as mind:
        rows = mind.query("Way", CHAIN[:1], {}).rows
    assert set(rows) == {("Ada", "Di"), ("Ada", "Bo"), ("Di", "Bo")}


def test_it_says_so_when_it_was_still_growing() -> None:
    text = f"@Recursive(Reach, 1); {REACH}{ROBOT} m = List{{b :- Reach(a: robot_name, b:)}};"
    (first, *_) = think(text, CHAIN, {}, sensor="all")
    assert [notice.kind for notice in first.notices] == ["recursion"]
    assert "after 1 steps" in asdict(first.notices[0])["message"]


def test_its_rows_can_be_looked_at() -> None:
    program = Program.compile(f"{REACH}{ROBOT} m = 1;")
    with closing(Mind(program, sensor="all", memory="all")) as mind:
        table = mind.query("Reach", CHAIN, {})
    assert (table.columns, len(table.rows)) == (("a", "b"), 6)


WAY = """
@Recursive(Reach, 3);
Step(from: "a", to: "b", order: 1);
Step(from: "b", to: "c", order: 2);
Far(to:, order? Max= order, set? List= from) distinct :- Step(from:, to:, order:);
Reach(from:, to:) distinct :- Step(from:, to:) | Step(from:, to: x), Reach(from: x, to:);
"""

TEXT = f"""{WAY}{ROBOT}
  Far(to:, order:, set:), to == "c",
  values == List{{x :- Reach(from: "a", to: x)}},
  where == Sum{{n :- Step(order: n)}},
  m = {{to:, order:, set:, values:, where:}};"""


def test_such_columns_are_columns_like_any_other_also_in_the_inspector() -> None:
    decisions = think(TEXT, [row("Ada"), row("Bo")], {})
    expected = {"to": "c", "order": 2, "set": ["b"], "values": ["b", "c"], "where": 3}
    assert [d.memory for d in decisions] == [expected, expected]
    for plain in (True, False):
        with closing(Mind(Program.compile(TEXT), plain=plain)) as mind:
            table = mind.query("Reach", [row("Ada")], {})
        assert table.columns == ("from", "to")
        assert set(table.rows) == {("a", "b"), ("a", "c"), ("b", "c")}
