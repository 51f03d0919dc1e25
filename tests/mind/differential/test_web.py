"""What is said about the web platform, compared with what one statement of DuckDB does."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import duckdb
import pytest
from hypothesis import given
from hypothesis import strategies as st
from logica.compiler.rule_translate import RuleCompileException
from logica.type_inference.research.infer import TypeErrorCaughtException

from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.web import _SQL_WORDS, web_remarks
from logical_robots_tui.paths import shipped_folder
from tests.mind.differential.duckdb_reference import answer_in_one
from tests.mind.marks import slow
from tests.mind.rows import row

FAILS = (RuleCompileException, TypeErrorCaughtException, duckdb.Error, TypeError, KeyError)
COUNTING = "T(0) distinct; T(x + 1) distinct :- T(x), x < 60; P(n? Max= x) distinct :- T(x);"
CIRCLE = "A(0) distinct; A(x + 1) distinct :- B(x), x < 60; B(x) distinct :- A(x);"
EDGES = {"Ada": {"edges": [{"from": 1, "begin": 1}], "variable": 1, "values": [1]}}
MEMORY = "Memory(memory:)"

REFUSED = {
    '@Visible(Memory, "all"); P(x: 1);': "no @Visible",
    "P(r: {order: 1});": "order is a word of SQL",
    "P(r: {Left: 1});": "Left is a word of SQL",
    f"P(x:) :- {MEMORY}, {{from: x}} in memory.edges;": "from is a word of SQL",
    f"P(x: TryCast(memory, {{end: 0}})) :- {MEMORY};": "end is a word of SQL",
    "P(r: {variable: 1});": "can't have a field named variable",
    f"P(x: memory.variable) :- {MEMORY};": "can't have a field named variable",
    'P(x: Format("%d%d%d%d%d%d%d", 1, 2, 3, 4, 5, 6, 7));': "at most 6 values",
    "P(x: 100000 * 100000);": "32 bits",
    "P(x: 2147483647 + 1);": "32 bits",
    "P(x: -2147483647 - 2);": "32 bits",
    "Big() = 100000; P(x: Big() * Big());": "32 bits",
    "Q(100000); P(x: y * y) :- Q(y);": "32 bits",
    "P(x: y * 70000) :- y = 69999;": "32 bits",
    "P(x: (if 1 == 1 then 100000 else 2) * 100000);": "32 bits",
    "P(x: []);": "type of the elements of []",
    "P(x: {visited: [], n: 1});": "type of the elements of []",
    f"P(x: Coalesce(memory.values, [])) :- {MEMORY};": "type of the elements of []",
    f"P(x: TryCast(memory, {{values: []}})) :- {MEMORY};": "type of the elements of []",
    "F(l) = Size(l); P(x: F([]));": "type of the elements of []",
    "P(x: [[1], [2]]);": "no lists of lists",
    "P(x: {plan: [[1]]});": "no lists of lists",
    "P(x: List{[y] :- y in [1, 2]});": "no lists of lists",
    "P(x: List{List{z :- z in [y]} :- y in [1, 2]});": "no lists of lists",
    "P(x: List{r.l :- r in [{l: [1]}]});": "no lists of lists",
}

AS_THE_HINT_SAYS = f"@Recursive(T, 30, iterative: false); {COUNTING}"
ACCEPTED = (
    "P(order: 1);",
    f"P(x: memory.edges) :- {MEMORY};",
    f"P(x: e.from) :- {MEMORY}, e in memory.edges;",
    "P(r: {values: 1, map: 2, date: 3});",
    'P(x: Format("%d%d%d%d%d%d", 1, 2, 3, 4, 5, 6));',
    "P(x: 100000 * 10000);",
    "P(x: 3000000000 * 2);",
    "P(x: 100000.0 * 100000);",
    "P(x: sensor.clock * 100000 * 100000) :- Sensor(sensor:);",
    "P(x: y * 100000) :- y in Range(3);",
    "P(x: l) :- l = (if 1 == 2 then [1] else []);",
    "P(x: l) :- l = [], l ~ [Num];",
    f"P(x: Coalesce(TryCast(memory.values, [1]), [])) :- {MEMORY};",
    "P(x: [{items: [1]}]);",
    "@Recursive(T, 4); " + COUNTING,
    AS_THE_HINT_SAYS,
)


def remarks(text: str) -> list[Diagnostic]:
    source = prepare(text)
    parsed = parse(source)
    assert not parsed.problems
    return web_remarks(parsed.statements, source)


def there(text: str, folder: Path) -> list[tuple[Any, ...]]:
    return answer_in_one(text, "P", [row("Ada")], EDGES, folder)


def test_what_the_platform_refuses_is_marked_and_nothing_else() -> None:
    for text, reason in REFUSED.items():
        found = remarks(text)
        assert found, text
        assert all(reason in remark.message for remark in found), text
        assert all(remark.severity == "warning" and remark.hint for remark in found), text
    assert {text: found for text in ACCEPTED if (found := remarks(text))} == {}


@pytest.mark.sampled
@pytest.mark.parametrize("text", [*REFUSED, *ACCEPTED])
def test_the_platform_refuses_what_is_marked_and_nothing_else(text: str, tmp_path: Path) -> None:
    with pytest.raises(FAILS) if text in REFUSED else nullcontext():
        there(text, tmp_path)


@pytest.mark.parametrize("option", ["", slow("@Recursive(T, 10);"), slow("@Recursive(T, 2);")])
def test_a_recursion_that_ends_early_there_is_marked_once(option: str, tmp_path: Path) -> None:
    text = f"{option}\n{COUNTING}"
    ((steps,),) = there(text, tmp_path)
    assert steps in (4, 5)
    (found,) = remarks(text)
    assert "ends this recursion after four to six steps" in found.message
    assert found.excerpt == ("@Recursive" if option else "T")
    if not option:
        assert there(AS_THE_HINT_SAYS, tmp_path) == [(30,)]


def test_a_circle_of_predicates_is_marked_once(tmp_path: Path) -> None:
    text = f"{CIRCLE} P(n? Max= x) distinct :- A(x);"
    ((steps,),) = there(text, tmp_path)
    assert steps < 7
    assert [each.excerpt for each in remarks(text)] == ["A"]


def is_refused(
    connection: duckdb.DuckDBPyConnection, expression: str, error: type[duckdb.Error] = duckdb.Error
) -> bool:
    try:
        connection.execute(f"SELECT {expression}")
    except error:
        return True
    return False


def test_the_words_of_sql_are_those_that_duckdb_refuses() -> None:
    with duckdb.connect() as connection:
        keywords = connection.execute("SELECT keyword_name FROM duckdb_keywords()").fetchall()
        refused = {word for (word,) in keywords if is_refused(connection, f"{{{word}: 1}}")}
    assert refused == set(_SQL_WORDS.split())


def test_a_choice_by_counts_is_marked_once_as_ties_are_likely_and_one_by_measures_is_not() -> None:
    for value in ("1", "Size(sensor.radar)", "sensor.clock", "n", "if x < 3 then 1 else 0"):
        choice = f"ArgMin{{x -> {value} :- x in [1, 2], n = Size([x])}}"
        found = remarks(f"P(a: {choice}, b: {choice}) :- Sensor(sensor:);")
        assert [remark.message for remark in found] == [
            "If values tie, ArgMin may choose another one on the web platform"
        ], value
    for value in ("ray.distance", "x * 0.5", "Abs(ray.angle)"):
        text = f"P(ArgMax{{ray -> {value} :- ray in sensor.radar, x = 1}}) :- Sensor(sensor:);"
        assert remarks(text) == [], value


@pytest.mark.sampled
@pytest.mark.parametrize("file", sorted(shipped_folder("programs").rglob("*.l")), ids=str)
def test_nothing_is_said_about_the_shipped_programs(file: Path) -> None:
    assert remarks(file.read_text(encoding="utf-8")) == []


NUMBERS = st.integers(-(2**31) + 1, 2**31 - 1) | st.integers(-70_000, 70_000)


@given(NUMBERS, NUMBERS, st.sampled_from("+-*"))
def test_a_calculation_is_marked_if_and_only_if_it_fails_there(
    left: int, right: int, operator: str
) -> None:
    with duckdb.connect() as connection:
        fails = is_refused(connection, f"({left}) {operator} ({right})", duckdb.OutOfRangeException)
    assert bool(remarks(f"P(x: ({left}) {operator} ({right}));")) == fails
