"""The calls of a function in a robot's reasoning."""

from __future__ import annotations

from contextlib import closing

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.mind import Mind, Program, QueryError
from tests.explain.asking import REST
from tests.mind.rows import row


def calls(text: str, function: str) -> list[tuple[object, ...]]:
    with closing(Mind(Program.compile(text))) as mind:
        return sorted(Explainer(mind, "Ada", [row("Ada")], {}).calls(function).rows, key=repr)


def test_each_call_is_told_once_with_its_result() -> None:
    text = f"F(a) = a + 1; P(x, F(x)) :- x in [1, 2, 1]; Q(F(5));{REST}"
    assert calls(text, "F") == [(1, 2), (2, 3), (5, 6)]


def test_calls_within_functions_and_aggregates_are_found() -> None:
    text = f"F(a) = a + 1; G(a) = F(a) * 2; P(s) :- s == Sum{{G(x) :- x in [1, 2]}};{REST}"
    assert calls(text, "G") == [(1, 4), (2, 6)]
    assert calls(text, "F") == [(1, 2), (2, 3)]


def test_a_function_that_nobody_calls_has_no_rows() -> None:
    assert calls(f"F(a) = a + 1;{REST}", "F") == []


def test_what_is_not_a_function_is_named() -> None:
    with pytest.raises(QueryError, match="P is not a function"):
        calls(f"P(1);{REST}", "P")
