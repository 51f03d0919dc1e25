"""Calls of our own functions that become SQLite's own expressions, and mean the same."""

import math
from contextlib import closing
from dataclasses import asdict, replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import ROBOT, nearly_same, row, think

NATIVE = {
    "half": "(memory.a + memory.b) / 2",
    "ratio": "(memory.a + 0) / (memory.b - 1)",
    "nested": "(Sum{r.distance :- r in sensor.radar} / 3 - memory.a) / 0.25",
    "least": "Least(memory.a, 75)",
    "greatest": "Greatest(memory.a - 1, 0)",
    "first": "Least(1, memory.a * 2)",
    "second": "Greatest(0, memory.a * 2)",
}
"""Expressions of what a robot remembers as ``a`` and ``b``."""

STAYS = {
    "what may be a text": "memory.a / 2",
    "what may be a list": "Least(memory.a, memory.b)",
    "three": "Greatest(memory.a + 1, 2, 3)",
    "subqueries": "Sum{r.distance :- r in sensor.radar} / (if memory.a > 1 then 2 else 3)",
}

CALLS = ("DIVIDE(", "LEAST(", "GREATEST(")


def calls(expression: str) -> int:
    """How many calls of ours are left where they are evaluated each time."""
    text = f"{ROBOT} Memory(robot_name:, memory:), m = ({expression});"
    sql = Program.compile(text).tuned["Robot"].sql
    return sum(sql.count(call) - sql.count(f"ELSE {call}") for call in CALLS)


def test_numbers_are_divided_without_a_call_and_what_may_mean_something_else_is_not() -> None:
    left = {name: calls(expression) for name, expression in NATIVE.items()}
    # A field of a memory may be a list.
    assert left == {**dict.fromkeys(NATIVE, 0), "least": 1}
    assert all(calls(expression) > 0 for expression in STAYS.values())


def test_constants_are_exact() -> None:
    text = f"{ROBOT} m = [0.3 * (0 - 1), 0.25 - 0.1 * 2, 0.5 * 2, 1.1 * 1.1];"
    assert [d.memory for d in think(text, [row("Ada")], {})] == [[-0.3, 0.05, 1.0, 1.21]]


NUMBERS = st.one_of(
    st.none(),
    st.integers(-(2**62), 2**62),
    st.integers(-3, 3),
    st.floats(-1e300, 1e300),
    st.sampled_from([0, -0.0, 0.0, 75, 75.0, 1, 1.0, 2**53 + 1]),
)


@settings(deadline=None, max_examples=3 * settings().max_examples)
@given(a=NUMBERS, b=NUMBERS)
def test_the_result_is_the_same(both: tuple[Mind, Mind], a: Any, b: Any) -> None:
    memories = {"Ada": {"a": a, "b": b}}
    quick, plain = (mind.think([row("Ada", clock=2)], memories)[0] for mind in both)
    assert nearly_same(asdict(replace(quick, weight=0)), asdict(replace(plain, weight=0)))


@pytest.fixture(scope="module")
def both() -> Any:
    fields = ", ".join(f"{name}: {expression}" for name, expression in NATIVE.items())
    program = Program.compile(f"{ROBOT} Memory(robot_name:, memory:), m = {{{fields}}};")
    with closing(Mind(program)) as quick, closing(Mind(program, plain=True)) as plain:
        yield quick, plain


def test_texts_are_divided_by_nobody() -> None:
    (decision,) = think(f'{ROBOT} m = ("abc" ++ sensor.clock) / 2;', [row("Ada")], {})
    assert "failed" in [notice.kind for notice in decision.notices]


def test_a_subquery_that_is_a_column_is_the_same_as_one_inside_another() -> None:
    text = """
    Room(radar) = Avg{r.distance :- r in radar};
    Robot(robot_name:, desire: {left_engine: a + b, right_engine: a - b}, memory: a) :-
      Sensor(robot_name:, sensor:), b = Room(sensor.radar),
      a = Coalesce(Min{r.distance :- r in sensor.radar, r.label == "A"}, Room(sensor.radar));
    """
    assert Program.compile(text).tuned["Robot"].sql.count("FROM Ray") == 2
    (decision,) = think(text, [row("Ada")], {})
    assert decision.desire is not None
    assert math.isclose(decision.desire.left_engine, 400)


@pytest.mark.parametrize("frozen", [False, True])
def test_robots_and_rays_are_replaced_where_there_are_as_many_as_before(*, frozen: bool) -> None:
    text = f'{ROBOT} m = List{{r.distance :- r in sensor.radar, r.label != "none"}};'
    mind, fresh = Mind(Program.compile(text), frozen=frozen), Program.compile(text)
    near, far = row("Ada", sees={3: (4, "wall", "wall")}), row("Ada")
    short = {**near, "sensor": {**near["sensor"], "radar": near["sensor"]["radar"][:7]}}
    bo = row("Bo", clock=7)
    many = [row(f"R{number}") for number in range(40)]
    for rows in (
        *([near], [far], [far], [bo, far], [bo, near], [near, bo], [short], [short], [near], [bo]),
        *([*many, near], [*many, far], [near, *many], [near], [near]),
    ):
        with closing(Mind(fresh)) as alone:
            assert mind.think(rows, {}) == alone.think(rows, {})
    mind.close()
