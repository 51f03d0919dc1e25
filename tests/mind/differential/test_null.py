"""Null goes in, null comes out: every function here and on DuckDB, at each of its places."""

from pathlib import Path

import pytest

from logical_robots_tui.language import types
from logical_robots_tui.language.definitions import arity
from logical_robots_tui.language.types import Kind, ListOf, Plain
from tests.mind.differential.comparing import here, program, there
from tests.mind.differential.corpus import DIFFERENCES, in_one

AGGREGATES = {"Avg", "Count", "CumulativeSum", "ExactCount", "StringAgg", "Sum"}
NO_FUNCTIONS = {"GenerateArray", "Num", "Str", "UniqueNumber", "WeightedAverage", "in", "is"}
OURS_ALONE = {"Sort", "TruthToString", "Unique"}
"""Which the package's release does not have on DuckDB, or not for null."""
OF_NULL = {"Fingerprint", "IsNull", "NaturalHash"}
"""Which have a value for null there."""

SAMPLES: dict[Kind, str] = {
    Plain.ANY: '"a"',
    Plain.REAL: "2",
    Plain.TEXT: '"ab"',
    Plain.TRUTH: "true",
    ListOf(Plain.ANY): '["a", "b"]',
    ListOf(Plain.TEXT): '["a", "b"]',
}


def calls(name: str) -> list[str]:
    """Calls of a function with null at one place each."""
    function = types.FUNCTIONS[name]
    least = 2 if name == "Split" else int(arity(name)[0])
    places = range(max(len(function.arguments), least))
    samples = [SAMPLES[function.argument(place)] for place in places]
    return [
        f"{name}({', '.join([*samples[:place], 'null', *samples[place + 1 :]])})"
        for place in places
    ]


SCALARS = sorted(
    name
    for name in types.FUNCTIONS.keys() - AGGREGATES - NO_FUNCTIONS - OURS_ALONE - OF_NULL
    if name.isalnum() and name != "If"
)
KNOWN = {expression for expression, _, _ in DIFFERENCES}


@pytest.mark.parametrize("part", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_function_of_null_is_null_unless_the_page_says_otherwise(
    part: int, tmp_path: Path
) -> None:
    expressions = [call for name in SCALARS[part::2] for call in calls(name) if call not in KNOWN]
    assert len(expressions) > 20
    rules, columns = in_one([("", "", expression) for expression in expressions])
    text = program(rules, **columns)
    ((*ours,),), ((*theirs,),) = here(text), there(text, tmp_path)
    values = zip(expressions, ours, theirs, strict=True)
    assert [value for value in values if value[1:] != (None, None)] == []


def test_what_is_about_null_or_not_there_has_a_value_or_is_null_too() -> None:
    expected = {"IsNull(null)": 1}
    expressions = [f"{name}(null)" for name in sorted(OF_NULL | OURS_ALONE)]
    ((*values,),) = here(program(**{f"c{n}": text for n, text in enumerate(expressions)}))
    assert values == [expected.get(expression) for expression in expressions]
