"""Every construct means here what the package makes of it on DuckDB."""

import math
import re
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.mind import Limits, Program
from logical_robots_tui.mind.program import STEPS
from logical_robots_tui.mind.sqlite.budget import QueryBudget
from logical_robots_tui.mind.sqlite.inputs import Inputs
from logical_robots_tui.mind.sqlite.tables import TunedTables
from tests.mind.differential.comparing import MEMORIES, ROWS, here, program, same, there
from tests.mind.differential.corpus import BATCHES, CASES, DIFFERENCES, Case, in_one
from tests.mind.rows import ROBOT

SLOW = pytest.mark.slow
PAGE = Path(__file__).parents[3] / "docs" / "dialect.md"


def test_the_corpus_is_large_enough() -> None:
    assert len(CASES) >= 150
    assert len(set(CASES)) == len(CASES)


def compare(rules: str, expressions: dict[str, str], cases: list[Case], folder: Path) -> None:
    text = program(rules, **expressions)
    (ours,), (theirs,) = here(text), there(text, folder)
    different = [
        (case, one, other)
        for case, one, other in zip(cases, ours, theirs, strict=True)
        if not same(one, other)
    ]
    assert different == []
    assert_the_quick_way_answers(Program.compile(f"{text}\n{ROBOT}m = 1;"))


@pytest.mark.sampled
@pytest.mark.parametrize("batch", BATCHES, ids=range(len(BATCHES)))
def test_constructs_mean_the_same_on_duckdb_and_quickly(batch: list[Case], tmp_path: Path) -> None:
    compare(*in_one(batch), batch, tmp_path)


@pytest.mark.proof
@pytest.mark.parametrize("case", CASES)
def test_each_construct_alone_means_what_it_means_on_duckdb(case: Case, tmp_path: Path) -> None:
    compare(case[1], {"value": case[2]}, [case], tmp_path)


def assert_the_quick_way_answers(compiled: Program) -> None:
    if STEPS in compiled.statements["Answer"]:
        assert "Answer" not in compiled.tuned  # a recursion has the plain way only
        return
    moment = Inputs(ROWS, MEMORIES, "own", "own")
    with closing(TunedTables(Limits())) as tables:
        (view,) = moment.views
        answer = tables.ask(
            compiled.tuned["Answer"], moment, view, QueryBudget(10**9, 10, 1000, None)
        )
        assert len(answer[1]) == 1


@pytest.mark.sampled
@pytest.mark.parametrize(("expression", "ours", "theirs"), DIFFERENCES)
def test_a_difference_is_told(expression: str, ours: Any, theirs: Any, tmp_path: Path) -> None:
    text = program(value=expression)
    assert here(text) == [(ours,)]
    try:
        found = there(text, tmp_path)[0][0]
    except Exception as error:  # whatever DuckDB or the package raises is named
        found = type(error).__name__
    both_nan = isinstance(found, float) and isinstance(theirs, float) and math.isnan(found)
    assert both_nan or found == theirs
    assert f"`{expression}`" in PAGE.read_text(encoding="utf-8")


def test_the_page_tells_of_no_other_differences() -> None:
    _, _, section = PAGE.read_text(encoding="utf-8").partition("## What differs from DuckDB")
    rows = [line for line in section.partition("## ")[0].splitlines() if line.startswith("| `")]
    told = {code for row in rows for code in re.findall(r"`([^`]+)`", row.split(" | ")[0])}
    assert len(rows) > 15
    assert told <= {expression for expression, _, _ in DIFFERENCES}


def test_pairs_without_an_argument_are_passed_over(tmp_path: Path) -> None:
    rules = "V(null, 0); V(3, 1); V(4, 2); V(null, 9);"
    aggregates = {name: f"{name}{{x -> y :- V(x, y)}}" for name in ("ArgMin", "ArgMax")}
    text = program(rules, **{name.lower(): text for name, text in aggregates.items()})
    assert here(text) == there(text, tmp_path) == [(3, 4)]


TRY_CASTS = [
    ("memory", "{count: Num, name: Str}", "STRUCT(count DOUBLE, name VARCHAR)"),
    ("memory.plan", "{spot: Str, done: Bool}", "STRUCT(spot VARCHAR, done BOOLEAN)"),
    ("memory", "{plan: {spot: Str}}", "STRUCT(plan STRUCT(spot VARCHAR))"),
    ("memory.seen", "[{u: Str, d: Num}]", "STRUCT(u VARCHAR, d DOUBLE)[]"),
    ("memory.seen", "[{u: Num, d: Int}]", "STRUCT(u DOUBLE, d BIGINT)[]"),
    ("memory.name", "{count: Num}", "STRUCT(count DOUBLE)"),
    ('"I am a robot"', "{count: Num}", "STRUCT(count DOUBLE)"),
    ('""', "[Num]", "DOUBLE[]"),
    ('"12"', "Num", "DOUBLE"),
    ('"2.5"', "Int", "BIGINT"),
    ('"x"', "Int", "BIGINT"),
    ('"1e300"', "Int", "BIGINT"),
    ("-1e300", "Int", "BIGINT"),
    ("9223372036854775807", "Int", "BIGINT"),
    ("1.5", "Str", "VARCHAR"),
    ("memory.count", "Bool", "BOOLEAN"),
    (
        "sensor.self",
        "{battery_level: Int, wings: Num}",
        "STRUCT(battery_level BIGINT, wings DOUBLE)",
    ),
]


def test_try_cast_means_what_duckdb_means_by_it(tmp_path: Path) -> None:
    # The package's release has no TryCast; DuckDB's own is the measure.
    names = [f"c{number}" for number in range(len(TRY_CASTS))]
    duckdb, by_example, by_name = (
        dict(zip(names, casts, strict=True))
        for casts in (
            [f'SqlExpr("TRY_CAST({{x}} AS {sql})", {{x: {value}}})' for value, _, sql in TRY_CASTS],
            [f"TryCast({value}, {kind})" for value, kind, _ in TRY_CASTS],
            [f'TryCast({value}, "{sql}")' for value, _, sql in TRY_CASTS],
        )
    )
    (expected,) = there(program(**duckdb), tmp_path)
    for expressions in (by_example, by_name):
        (ours,) = here(program(**expressions))
        for cast, one, other in zip(TRY_CASTS, ours, expected, strict=True):
            assert same(one, other), cast


@pytest.mark.parametrize("depth", [1, pytest.param(3, marks=SLOW), 4, pytest.param(7, marks=SLOW)])
def test_a_recursion_ends_where_it_is_told_to(depth: int, tmp_path: Path) -> None:
    rules = f"@Recursive(S, {depth}); S(0); S(n + 1) :- S(n), n < 100;"
    text = program(rules, value="Max{n :- S(n)}")
    assert here(text) == [(depth,)]
    ((theirs,),) = there(text, tmp_path)
    assert theirs == depth if depth >= 4 else depth <= theirs <= depth + 2
    assert "fewer than four steps" in PAGE.read_text(encoding="utf-8")


def test_what_was_cast_is_a_record_to_go_on_with() -> None:
    rules = "M(m) :- Memory(memory:), m = TryCast(memory, {count: Num, seen: [{d: Num}]});"
    assert here(f"{rules} Answer(value: m.count + Sum{{e.d :- e in m.seen}}) :- M(m);") == [(8.75,)]


def test_a_hash_is_another_number_but_of_the_same_kind(tmp_path: Path) -> None:
    values = ['"abc"', '""', "7", '"Zoë"']
    text = program(**{f"c{n}": f"NaturalHash({value})" for n, value in enumerate(values)})
    (ours,), (theirs,) = here(text), there(text, tmp_path)
    for number in (*ours, *theirs):
        assert isinstance(number, int)
        assert 0 <= number < 2**63
    assert here(text) == [ours]
