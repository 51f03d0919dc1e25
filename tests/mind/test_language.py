"""The constructs of Logica, as a robot's program meets them."""

from pathlib import Path

import pytest

from tests.mind.differential.comparing import here
from tests.mind.rows import all_remembered, remembered

EXPRESSIONS = {
    "1 + 2 * 3": 7,
    "9007199254740993 % 10": 3,
    "-9007199254740993 % 10": -3,
    '"it\'s [bold]"': "it's [bold]",
    "List{x * 2 :- x in [4, 2]}": [8, 4],
    'ArgMin{n -> v :- n in ["a", "b"], v = (if n == "a" then 2 else 1)}': "b",
    'ArgMax{n -> v :- n in ["a", "b"], v = (if n == "a" then 2 else 1)}': "a",
}
NULL = [
    *('Join(null, "-")', 'Split(null, ",")', "Sort(null)", "Sqrt(null)", "Sqrt(-1)"),
    *("Log(0)", "(1 / 0) % 2", "Size(null)", "null / 2", "memory.a.b.c"),
    *("Element([1], 7)", "Min{x :- x in []}", "ArgMin{x -> x :- x in []}"),
]


def test_an_expression_has_its_value_and_null_gives_null() -> None:
    assert all_remembered(EXPRESSIONS) == EXPRESSIONS
    assert all_remembered(NULL) == dict.fromkeys(NULL)


RULES = Path(__file__).with_name("rules.l").read_text("utf-8")


def test_rules_mean_what_they_say() -> None:
    expected = {
        "Double(4)": 8,
        "Sum{1 :- P(x)}": 2,
        "List{x :- P(x), ~(x == 1)}": [2],
        "Sum{x :- Or(x)}": 11,
        "Total()": 3,
        "Sum{b :- Most(b:)}": 3,
        "Sum{x :- G(x)}": 5,
        "Best(1)": 4,
        "Size(List{b :- Reach(1, b)})": 2,
        "Sum{x :- Last(x)}": 3,
        "Angle(sensor.radar) > 1": True,
        "Sum{a + b :- Copy(a:, b:)}": 7,
    }
    assert all_remembered(expected, rules=RULES) == expected


def test_lists_of_records_can_be_searched_by_pattern() -> None:
    memory = {"edges": [{"u": "A", "v": "B", "d": 3.5}, {"v": "C", "u": "B", "d": 1}]}
    rules = (
        "Edge(r, u, v, d) :- Memory(robot_name: r, memory:), e in memory.edges, "
        "u = e.u, v = e.v, d = e.d;"
    )
    assert remembered('Sum{d :- Edge("Ada", u, v, d)}', memory, rules=rules) == 4.5


# What only the package of the web platform parses is here as well; it can't compile an implication
# in an aggregate.
ANSWERS: dict[str, list[object]] = {
    'P(x) order_by("col0") limit(2) :- x in [3, 1, 2]; Answer(value: List{x :- P(x)});': [[1, 2]],
    'P(x) distinct order_by("col0 DESC") limit(2) :- x in [3, 1, 2];'
    " Answer(value: Sum{x :- P(x)});": [5],
    "P(7) limit(1) :- x in Range(3); Answer(value: Sum{x :- P(x)});": [7],
    "-+-(left:, right:) = left * 10 + right; Answer(value: 3 -+- 4);": [34],
    "⊕(left:, right:) = left ++ right; Answer(value: 'a' ⊕ 'b');": ["ab"],
    "A(x) :- x in Range(3); B(..r) :- A(..r); Answer(value: Sum{x :- B(x)});": [3],
    "A(x) :- x in Range(3); B(..r) :- A(..r); Answer(x) :- B(x);": [0, 1, 2],
    "A(x) = x + 1 :- x in Range(3); B(..r) :- A(..r); Answer(value: Sum{B(x) :- B(x)});": [6],
    "A(c: 1, d: 2); F(..r) :- T(c:, ..r); G := F(T: A); Answer(value: d) :- G(d:);": [2],
    "T() ++= x :- x in ['ab', 'c']; Answer(value: Size(T()));": [3],
    "P(n: 1, l? ++= []) distinct; Answer(value: l) :- P(l:);": [[]],
    "T('a\\n b'); T('c'); Answer(value: Max{Length(x) :- T(x)});": [4],
    "Answer(value: Sum{x :- x in [1, 2, 3], (x > 1 => x >= 3)});": [4],
}
"""Heads with an order and a limit, operators of one's own, whole rows, texts of several lines."""


@pytest.mark.parametrize("rules", ANSWERS)
def test_rules_have_these_answers(rules: str) -> None:
    assert sorted(here(rules)) == [(value,) for value in ANSWERS[rules]]
