"""Programs that are right get no diagnostic, whatever they are made of."""

import pytest

from logical_robots_tui.game import list_programs, load_program
from tests.mind.checking import problems
from tests.mind.differential.corpus import CASES
from tests.mind.rows import PAPER, ROBOT

SUBTLE = [
    # A function that is given a ray here and something else there.
    "F(x) = x.dist; A(y) :- Memory(memory:), y = F(memory);",
    "P(x) :- Memory(memory: x); P(x) :- Sensor(sensor: x); A(y) :- P(x), y = x.anything;",
    "P(x) :- Sensor(sensor: x) | Memory(memory: x); A(y) :- P(x), y = x.anything;",
    # One name for different things in different rules and aggregates.
    "A(x) :- Sensor(sensor:), x = sensor.clock; B(y) :- Memory(memory: x), y = x.anything;",
    "A(s) :- Sensor(sensor:), s = Sum{r.angle :- r in sensor.radar} + Sum{r.u :- r in [{u: 1}]};",
    # A functor puts another predicate in the place of the one that is written.
    "P(x) :- Sensor(sensor: x); Q(x) :- Memory(memory: x); F(y) :- P(x), y = x.clock; "
    "G := F(P: Q); H(y) :- G(y);",
    # Names that differ by one letter and mean different things.
    "A(left_x) :- B(left_x, left_y); B(1, 2);",
    "A(edge) :- Memory(memory:), edges = memory.edges, edge in memory.edges;",
    "A(beacon1) :- B(beacon1, beacon2); B(1, 2);",
    "A(node_a) :- B(node_a, node_b); B(1, 2);",
    "A(robot) :- Memory(robot_name: robot, memory:);",
    # Predicates with the names of built-in functions that are only conditions.
    "Time(1); A(x) :- Time(x);",
    # Columns by their hidden names, the rest of a row, projections.
    "P(1, 2); A(x) :- P(col0: x); B(y) :- P(y);",
    "P(a: 1, b: 2); A(a) :- P(a:); B(a:, b:) :- P(a:, b:);",
    # Records that are remembered, with the names of engines among others.
    "A(m) :- m = {left_engine: 1, last: 2};",
    "A(x) :- Sensor(sensor: {clock: x});",
    "A(x) :- Sensor(sensor:), {angle: x} in sensor.radar;",
    "A(x) :- x ~ Num, x = 1;",
    "@Recursive(A, 5); A(1); A(x + 1) :- A(x), x < 3;",
    "@Recursive(A); A(1); A(x + 1) :- A(x), x < 3;",
    '@OrderBy(A, "col0", "DESC"); @Limit(A, 2); A(1); A(2);',
    "Go(a) = {left_engine: a, right_engine: a}; A(x) :- x = Go(1).left_engine;",
]


def found(text: str) -> list[str]:
    return [str(problem) for problem in problems(text)]


@pytest.mark.sampled
@pytest.mark.parametrize("topic", sorted({topic for topic, _, _ in CASES}))
def test_a_construct_of_the_language_is_met_with_silence(topic: str) -> None:
    texts = [
        f"{rules}\n{ROBOT}Memory(robot_name:, memory:), m = ({expression});"
        for of, rules, expression in CASES
        if of == topic
    ]
    assert {text: told for text in texts if (told := found(text))} == {}


def test_subtle_programs_are_met_with_silence() -> None:
    texts = [PAPER, *(f"{rules}\n{ROBOT}m = 1;" for rules in SUBTLE)]
    assert {text: told for text in texts if (told := found(text))} == {}


@pytest.mark.sampled
@pytest.mark.parametrize("name", list_programs())
def test_a_shipped_program_is_met_with_silence(name: str) -> None:
    assert found(load_program(name).text) == []
