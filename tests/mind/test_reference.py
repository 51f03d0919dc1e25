"""The help on functions: complete, true, and readable without the compiler."""

import json
import math
from typing import Any

import pytest

from logical_robots_tui.language.definitions import built_in_names, definitions, prelude
from logical_robots_tui.language.reference import REFERENCE, find_help, similar
from logical_robots_tui.mind.compiling.dialect import runs as runs_here
from tests.mind.rows import all_remembered, python

SPELT = {"Agg+": "+=", "Agg++": "++=", "1": "1="}


def same(value: Any, expected: Any) -> bool:
    if isinstance(expected, int | float) and isinstance(value, int | float):
        return math.isclose(value, expected, abs_tol=1e-9)
    return bool(value == expected)


@pytest.mark.sampled
@pytest.mark.parametrize("start", range(14))
def test_each_example_gives_the_result_that_is_told(start: int) -> None:
    entries = REFERENCE[start::14]  # more in one program are slower
    values = all_remembered([entry.example for entry in entries])
    for entry in entries:
        assert same(values[entry.example], json.loads(entry.result)), entry.name


def test_everything_that_compiles_is_explained_and_nothing_else() -> None:
    runs = {SPELT.get(name, name) for name in built_in_names() if runs_here(name)}
    library = {name for name in definitions(prelude()) if name.isidentifier()}
    assert {entry.name for entry in REFERENCE} == runs | library | {"->", "=>", "~", "if"}


def test_each_entry_is_one_short_line_and_mentions_its_name() -> None:
    assert len({entry.name for entry in REFERENCE}) == len(REFERENCE)
    for entry in REFERENCE:
        assert entry.name in entry.signature
        assert entry.summary
        assert max(map(len, (entry.signature, entry.summary, entry.example))) <= 100


def test_help_is_found_whatever_the_case_of_the_letters() -> None:
    assert find_help("argmin") == find_help("ArgMin")
    assert find_help("Wings") is None
    assert similar("Squrt") == "Sqrt"
    assert similar("Xyzzyx") == ""


def test_the_tables_of_the_docs_are_made_from_the_data() -> None:
    from docs.reference import PAGES

    for path, text in PAGES.items():
        assert path.read_text(encoding="utf-8") == text(), "run `make reference`"


def test_reading_the_help_needs_no_compiler() -> None:
    script = (
        "import sys, logical_robots_tui.language.reference as r; "
        "print(len(r.REFERENCE), 'logica' in sys.modules)"
    )
    assert python(script).split() == [str(len(REFERENCE)), "False"]
