"""What is said about the web platform, compared with what one statement of DuckDB does."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import duckdb
import pytest
from logica.compiler.rule_translate import RuleCompileException
from logica.type_inference.research.infer import TypeErrorCaughtException

from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.definitions import Model
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.web import _SQL_WORDS, web_remarks
from logical_robots_tui.paths import shipped_folder
from tests.mind.differential.duckdb_reference import answer_in_one
from tests.mind.rows import row, slow

FAILS = (RuleCompileException, TypeErrorCaughtException, duckdb.Error, TypeError, KeyError)
COUNTING = "T(0) distinct; T(x + 1) distinct :- T(x), x < 60; P(n? Max= x) distinct :- T(x);"
CIRCLE = "A(0) distinct; A(x + 1) distinct :- B(x), x < 60; B(x) distinct :- A(x);"
EDGES = {"Ada": {"edges": [{"from": 1, "begin": 1}], "variable": 1, "values": [1]}}
MEMORY = "Memory(memory:)"

AS_THE_HINT_SAYS = f"@Recursive(T, 30, iterative: false); {COUNTING}"
REASONS = {
    text: reason
    for line in Path(__file__).with_name("web.txt").read_text("utf-8").splitlines()
    for reason, _, text in [line.partition("@@ ")]
}
"""Why the platform refuses a program; nothing is said of one that it accepts."""
REFUSED = {text: reason.strip() for text, reason in REASONS.items() if reason}
ACCEPTED = [text for text, reason in REASONS.items() if not reason] + [AS_THE_HINT_SAYS]


def remarks(text: str) -> list[Diagnostic]:
    parsed = parse(prepare(text))
    assert not parsed.problems
    return web_remarks(Model(parsed.statements, parsed.source))


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
    assert [remark.excerpt for remark in remarks(text)] == ["A"]


def is_refused(connection: duckdb.DuckDBPyConnection, expression: str) -> bool:
    try:
        connection.execute(f"SELECT {expression}")
    except duckdb.Error:
        return True
    return False


def test_the_words_of_sql_are_those_that_duckdb_refuses() -> None:
    with duckdb.connect() as connection:
        keywords = connection.execute("SELECT keyword_name FROM duckdb_keywords()").fetchall()
        refused = {word for (word,) in keywords if is_refused(connection, f"{{{word}: 1}}")}
    assert refused == set(_SQL_WORDS.split())


@pytest.mark.sampled
@pytest.mark.parametrize("file", sorted(shipped_folder("programs").rglob("*.l")), ids=str)
def test_nothing_is_said_about_the_shipped_programs(file: Path) -> None:
    assert remarks(file.read_text(encoding="utf-8")) == []
