"""Which element decides an aggregate: what is shown has the value that the engine's result has."""

from contextlib import closing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.explain import Ask, Explainer, Node
from logical_robots_tui.mind import Mind, Program
from tests.explain.asking import REST, below
from tests.mind.rows import row

KEYS = {
    "numbers": ["0", "1", "1.5", "-2", "1000000", "null"],
    "texts": ['"a"', '"B"', '"10"', '"9"', '"{"', '"[2]"', '"[10]"', '""', "null"],
    "records": ["{k: 2}", "{k: 10}", "{k: -1}", "null"],
    "lists": ["[2]", "[10]", "[2, 1]", "[1, 2]", "null"],
    "texts in lists": ['["b"]', '["a", "z"]', '["a"]', "null"],
    "truths": ["true", "false", "null"],
}

INSIDE = """
P(x: Best{a :- A(a:)});
Q(x: Best{a -> k :- A(a:, k:)});
"""
IN_HEADS = """
P(x? Best= a) distinct :- A(a:);
Q(x? Best= a -> k) distinct :- A(a:, k:);
"""
IN_TWO_RULES = """
P(x? Best= a) distinct :- A(a:, k:);
P(x? Best= k) distinct :- A(a: k, k: a);
Q(x? Best= a -> k) distinct :- A(a:, k:), k is not null;
Q(x? Best= k -> a) distinct :- A(a: k, k: a);
"""


@st.composite
def questions(draw: st.DrawFn) -> tuple[str, str]:
    """A program whose predicate P or Q, with a column x, is the best of some facts, and which."""
    arguments, keys = (draw(st.sampled_from(sorted(KEYS))) for _ in range(2))
    chosen = draw(st.sampled_from(["Min", "Max", "AnyValue", "ArgMin", "ArgMax"]))
    text = draw(st.sampled_from([INSIDE, IN_HEADS, IN_TWO_RULES]))
    if text == IN_TWO_RULES:
        keys = arguments
    one = st.tuples(*(st.sampled_from(KEYS[kind]) for kind in (arguments, keys)))
    pairs = draw(st.lists(one, min_size=1, max_size=5))
    facts = " ".join(f"A(a: {argument}, k: {key});" for argument, key in pairs)
    name = "Q" if chosen.startswith("Arg") else "P"
    rules = [line for line in text.splitlines() if line.startswith(name)]
    return "\n".join([facts, *rules, REST]).replace("Best", chosen), name


def deciding(text: str, name: str) -> tuple[object, list[Node]]:
    with closing(Mind(Program.compile(text))) as mind:
        (row_asked,) = mind.query(name, [row("Ada")], {}).rows
        proof = Explainer(mind, "Ada", [row("Ada")], {}).proof(Ask(name))
    assert proof.explanation.row is not None
    assert proof.explanation.row["x"] == row_asked[0]
    nodes = [each for node in proof.nodes for each in below(node, "contributor")]
    return row_asked[0], [each for each in nodes if each.said.startswith(("chosen", "is the"))]


@pytest.mark.parametrize("examples", [5, pytest.param(100, marks=pytest.mark.slow)])
def test_the_element_that_decides_has_the_value_of_the_result(examples: int) -> None:
    @given(questions())
    @settings(max_examples=examples)
    def ask(question: tuple[str, str]) -> None:
        result, found = deciding(*question)
        if result is not None:
            assert found
        for each in found:
            assert each.values == (result,)

    ask()


@pytest.mark.parametrize(
    ("one", "other", "asked", "keys"),
    [
        ('1, k: "9"', '1, k: "10"', "ArgMin", ['"10"']),
        ("1, k: {k: 10}", "1, k: {k: 9}", "ArgMin", ["{k: 9}"]),
        ("1, k: [10]", "1, k: [9, 1]", "ArgMax", ["[10.0]"]),
        ("1, k: null", "1, k: 2", "ArgMin", ["2"]),
        ("1, k: null", "null, k: null", "ArgMin", []),
    ],
)
def test_among_equal_arguments_the_engine_chooses_by_the_key(
    one: str, other: str, asked: str, keys: list[str]
) -> None:
    facts = f"A(a: {one}); A(a: {other});"
    result, found = deciding(f"{facts} Q(x: {asked}{{a -> k :- A(a:, k:)}});{REST}", "Q")
    assert [each.text for each in found] == [f"a -> {key}" for key in keys]
    assert (result is None) == (not keys)
