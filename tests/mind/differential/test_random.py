"""Random expressions mean the same on both engines."""

import json
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.mind.differential.comparing import here, program, same, there
from tests.mind.differential.typed_expressions import call, choice, expressions, infix, recursions

Text = st.SearchStrategy[str]

COUNTED = "Counted(memory) = TryCast(memory, {count: 0}).count;"
OBJECTS = st.sampled_from(["wall", "beacon", "none", "cat"])


def one_of_calls(names: list[str], *arguments: Text) -> Text:
    return st.sampled_from(names).flatmap(lambda name: call(name, *arguments))


def one_of_infixes(operators: list[str], left: Text, right: Text) -> Text:
    return st.sampled_from(operators).flatmap(lambda operator: infix(operator, left, right))


def numbers(depth: int) -> Text:
    """Expressions that are numbers or null; never so large that DuckDB's whole numbers end."""
    leaves = st.integers(0, 20).map(str) | st.sampled_from(
        [
            *("0.5", "2.25", "sensor.clock", "sensor.forward_distance"),
            *("Counted(memory)", "(memory.count / 3)"),
        ]
    )
    if not depth:
        return leaves
    inner = numbers(depth - 1)
    aggregates = st.sampled_from(["Sum", "Min", "Max", "Avg"])
    return st.one_of(
        leaves,
        one_of_infixes([*"+-*"], inner, inner),
        infix("/", inner, st.integers(1, 9).map(str)),
        one_of_calls(["Abs", "Floor", "Sin", "Cos", "Atan"], inner),
        one_of_calls(["Least", "Greatest", "Coalesce"], inner, inner),
        choice(truths(depth - 1), inner, inner),
        st.tuples(aggregates, st.sampled_from(["ray.distance", "ray.angle"]), OBJECTS).map(
            lambda t: f'{t[0]}{{{t[1]} :- ray in sensor.radar, ray.object == "{t[2]}"}}'
        ),
        inner.map(lambda number: f"{{a: {number}, b: 1}}.a"),
        call("Element", st.integers(1, 9).map("Range({})".format), st.integers(-1, 9).map(str)),
        call("Length", texts(depth - 1)),
    )


def truths(depth: int) -> Text:
    leaves = st.sampled_from(
        ["true", "false", "(memory.plan.done == true)", "sensor.self.has_battery"]
    )
    if not depth:
        return leaves
    inner, number = truths(depth - 1), numbers(depth - 1)
    return st.one_of(
        leaves,
        one_of_infixes(["<", "<=", "==", "!=", ">"], number, number),
        one_of_infixes(["&&", "||"], inner, inner),
        inner.map("(!{})".format),
        one_of_calls(["StartsWith", "EndsWith"], texts(depth - 1), texts(0)),
    )


def texts(depth: int) -> Text:
    leaves = st.sampled_from(['"a"', '""', '"Zoë b"', "memory.name", "sensor.forward_label"])
    if not depth:
        return leaves
    inner = texts(depth - 1)
    return st.one_of(
        leaves,
        infix("++", inner, inner),
        one_of_calls(["Upper", "Lower", "Reverse"], inner),
        call("Substr", inner, st.integers(1, 4).map(str), st.integers(0, 4).map(str)),
        call("ToString", st.integers(-99, 99).map(str)),
        choice(truths(depth - 1), inner, inner),
    )


def programs() -> Text:
    ray = st.sampled_from(["x.distance", "x.angle", "x.distance * x.angle", "x.distance / 4"])
    number = numbers(2)
    return st.fixed_dictionaries(
        {
            "function": st.sampled_from(["x * 2", "x / 3", "Coalesce(x, 0) + 1", "Abs(x) + 0.25"]),
            "ray": ray,
            "other": ray,
            "kind": OBJECTS,
            "aggregate": st.sampled_from(["Min", "Max", "Sum", "Avg", "Count"]),
            "choose": st.sampled_from(["ArgMin", "ArgMax"]),
            "given": st.sampled_from(["P", "Q1"]),
            "condition": truths(1),
            "left": number,
            "right": numbers(1),
            "number": number,
            "text": texts(2),
            "truth": truths(2),
            "example": st.sampled_from(
                [
                    *("{count: 0}", '{count: "", name: ""}', "{plan: {done: true}, name: 0}"),
                    *('{seen: [{u: "", d: 0}]}', '{missing: {deep: ""}, count: 0}'),
                ]
            ),
        }
    ).map(lambda parts: WHOLE.format(**parts, counted=COUNTED))


WHOLE = Path(__file__).with_name("random.txt").read_text("utf-8")


def _shorter(value: Any) -> Any:
    """A value with no more than one zero at the end of decimals in texts: DuckDB writes more."""
    if isinstance(value, dict):
        return {name: _shorter(of) for name, of in value.items()}
    if isinstance(value, list | tuple):
        return [_shorter(of) for of in value]
    return re.sub(r"(\.\d+?)0+\b", r"\1", value) if isinstance(value, str) else value


def compared(
    batch: list[tuple[str, str]], folder: Path, counts: Counter[str]
) -> Iterator[tuple[str, str, Any, Any]]:
    """Yield the rules and expressions that differ, with their values here and there."""
    try:
        theirs: Any = there(_asking(batch), folder)[0]
    except Exception:  # DuckDB's or the package's
        if len(batch) > 1:  # ask each alone: what is an error there, is none here
            for each in batch:
                yield from compared([each], folder, counts)
        counts["errors there"] += len(batch) == 1
        return
    ours = here(_asking(batch))[0]
    for (rules, expression), one, other in zip(batch, ours, theirs, strict=True):
        counts["compared"] += 1
        if not same(_shorter(one), as_here(_shorter(other), one)):
            yield rules, expression, one, other


def _asking(batch: list[tuple[str, str]]) -> str:
    columns = {f"c{number}": expression for number, (_, expression) in enumerate(batch)}
    return program("\n".join(rules for rules, _ in batch), **columns)


def as_here(theirs: Any, ours: Any) -> Any:
    """A value of DuckDB in which texts that spell a record or a list in JSON are that."""
    if isinstance(theirs, str) and isinstance(ours, dict | list):
        return json.loads(theirs)
    if isinstance(theirs, dict) and isinstance(ours, dict):
        return {name: as_here(value, ours.get(name)) for name, value in theirs.items()}
    if isinstance(theirs, list) and isinstance(ours, list) and len(theirs) == len(ours):
        return list(map(as_here, theirs, ours))
    return theirs


MOST_IN_TESTS = 100
relaxed = settings(
    deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


def some(most: int, share: int, in_a_proof: int) -> settings:
    """As many examples as this, but no more than a share of what is usual, if it is no proof."""
    usual = settings().max_examples
    count = in_a_proof if usual > MOST_IN_TESTS else min(most, usual // share)
    return settings(relaxed, max_examples=count)


@some(20, 2, 1_000)
@given(
    st.fixed_dictionaries(
        {"a": numbers(3), "b": numbers(2), "c": truths(2), "d": texts(2), "e": numbers(2)}
    )
)
def test_random_expressions_mean_the_same(tmp_path: Path, expressions: dict[str, str]) -> None:
    text = program(COUNTED, **expressions)
    (ours,), (theirs,) = here(text), there(text, tmp_path)
    pairs = zip(expressions.values(), ours, theirs, strict=True)
    assert [(text, one, other) for text, one, other in pairs if not same(one, other)] == []


@settings(some(12, 3, 400), phases=[Phase.explicit, Phase.generate])
@given(programs())
def test_random_robot_programs_mean_the_same(tmp_path: Path, text: str) -> None:
    asked = f"{text}\nAnswer(desire:, memory:) :- Robot(robot_name:, desire:, memory:);"
    ours, theirs = here(asked), there(asked, tmp_path)
    assert same(_shorter(ours), _shorter(theirs)), f"{text}\nhere {ours}\non DuckDB {theirs}"


graphs = recursions(0).map(lambda recursion: [recursion])


def typed(count: int) -> st.SearchStrategy[list[tuple[str, str]]]:
    rules_and_expression = expressions.map(lambda expression: ("", expression))
    return st.lists(rules_and_expression, min_size=count, max_size=count)


@some(8, 2, 8)
@given(graphs | typed(4))
def test_random_recursions_mean_the_same(tmp_path: Path, batch: list[tuple[str, str]]) -> None:
    assert not list(compared(batch, tmp_path, Counter()))


@pytest.mark.proof
def test_5000_random_casts_texts_records_and_recursions_mean_the_same(tmp_path: Path) -> None:
    counts = Counter[str]()

    @settings(relaxed, max_examples=100)
    @given(typed(10) | graphs)
    def compare(batch: list[tuple[str, str]]) -> None:
        assert not list(compared(batch, tmp_path, counts))

    while counts["compared"] < 5_000:  # a batch may hold one recursion, or ten expressions
        compare()
    assert counts["errors there"] < counts["compared"] / 10
