"""Broken programs, and all that a player is told about each.

In the data, ``ROBOT`` stands for the head of a rule whose memory is ``m``, and ``FINE`` for a rule
without a mistake. What is told follows each program: line, column, severity, offending text,
message and, below, the hint.
"""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Diagnostic, Program, ProgramError
from tests.mind.checking import problems

ENGINES = "desire: {left_engine: 0, right_engine: 0}"
ROBOT = f"Robot(robot_name:, {ENGINES}, memory: m) :- Sensor(robot_name:, sensor:),"
FINE = f'Robot(robot_name:, {ENGINES}, memory: "") :- Sensor(robot_name:);'
DATA = (Path(__file__).parent / "broken" / "programs.txt").read_text(encoding="utf-8")


def expand(text: str) -> str:
    return re.sub(r"^FINE$", FINE, re.sub(r"^ROBOT$", ROBOT, text, flags=re.M), flags=re.M)


def programs() -> dict[str, tuple[str, str]]:
    found = {}
    for entry in re.split(r"^== ", DATA, flags=re.M)[1:]:
        title, _, rest = entry.partition("\n")
        text, told = re.split(r"^(?=-- )", rest.rstrip(), maxsplit=1, flags=re.M)
        found[title] = (expand(text.removesuffix("\n")), told)
    return found


PROGRAMS = programs()


def diagnostics(text: str) -> tuple[Diagnostic, ...]:
    try:
        return Program.compile(text).warnings
    except ProgramError as error:
        return error.diagnostics


def told(found: tuple[Diagnostic, ...]) -> str:
    return "\n".join(
        f"-- {d.line}:{d.column} {d.severity} [{d.excerpt}] {d.message}\n   {d.hint}" for d in found
    )


WHEN_COMPILED = {
    "alternatives in an aggregate",
    "a variable without a value",
    "a variable without a value that looks like another",
    "two rules that need a value from their caller",
    "two rules with a value that need one from their caller",
    "a condition beside rules with rows",
    "alternatives that need a value from their caller",
    "alternatives of which one has a value",
    "a distinct rule that needs a value from its caller",
    "two rules of which one forgets its parameter",
    "different aggregates",
    "aggregation without distinct",
    "a recursion without a beginning",
    "two predicates that lean on each other only",
    "a functor over what is not used",
    "a visibility that does not exist",
    "a cast to a list of which nothing tells what it holds",
    "a cast whose example is said to be of what is not a type",
    "a cast to nothing",  # tests of DuckDB give the package a TryCast of its own in this process
    "branches with different fields",
    "a parameter in a text",
    "an aggregate that is called in a condition",
    "an aggregate that is called and compared later",
}
"""Programs whose mistakes are found after all checks."""


def test_the_checks_explain_what_they_find() -> None:
    for title in PROGRAMS.keys() - WHEN_COMPILED:
        assert_explained(title, problems(PROGRAMS[title][0]))


@pytest.mark.parametrize(
    "title",
    [pytest.param(t, marks=[pytest.mark.slow] * (t not in WHEN_COMPILED)) for t in PROGRAMS],
)
def test_a_broken_program_is_explained(title: str) -> None:
    assert_explained(title, diagnostics(PROGRAMS[title][0]))


def assert_explained(title: str, found: tuple[Diagnostic, ...]) -> None:
    text, expected = PROGRAMS[title]
    assert told(found) == expected, title
    lines = text.split("\n")
    for diagnostic in found:
        place = lines[diagnostic.line - 1][diagnostic.column - 1 :]
        assert place.startswith(diagnostic.excerpt), title


def test_no_message_holds_codes_sql_or_a_traceback_and_every_hint_is_short() -> None:
    assert len(PROGRAMS) >= 60
    for title, (_, expected) in PROGRAMS.items():
        assert expected.replace("\n", "").isprintable(), title
        for word in ("Traceback", "SELECT", "json_extract", "sqlite", "logica_value", "Error("):
            assert word not in expected, title
        hints = [line for line in expected.split("\n") if line.startswith("   ")]
        assert all(3 < len(hint) <= 123 for hint in hints), title


@settings(deadline=None)
@given(st.data())
def test_a_program_with_a_piece_cut_out_never_gives_a_traceback(data: st.DataObject) -> None:
    text, _ = data.draw(st.sampled_from(sorted(PROGRAMS.values())))
    start = data.draw(st.integers(0, len(text)))
    damaged = text[:start] + text[data.draw(st.integers(start, min(len(text), start + 12))) :]
    lines = damaged.split("\n")
    for diagnostic in diagnostics(damaged):
        assert 1 <= diagnostic.line <= len(lines)
        assert 1 <= diagnostic.column <= len(lines[diagnostic.line - 1]) + 1
        assert "\x1b" not in str(diagnostic)
        assert len(diagnostic.hint) <= 120
