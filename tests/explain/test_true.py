"""The law of explanations: nothing false is said, of any row of any program."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import Phase, given, settings

from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.explain.why.spelling import read_call, spell_call
from logical_robots_tui.mind import Limits, Mind, Program
from tests.explain.asking import REST
from tests.explain.checking import Checker, false_claims
from tests.explain.generated import programs
from tests.mind.rows import row

if TYPE_CHECKING:
    from logical_robots_tui.explain import Node

ROWS = [row("Ada")]
MOST_ROWS = 6
SEARCH = (Phase.explicit, Phase.reuse, Phase.generate)  # to shrink takes far longer than to find


def asked(text: str) -> int:
    """Ask why of every predicate of a program; how many questions that were."""
    program = Program.compile(text)
    number = 0
    with closing(Mind(program, limits=Limits(query_seconds=60))) as mind:
        checker = Checker(program, mind, ROWS, {})
        for predicate in program.predicates:
            if predicate.kind != "program" or not predicate.has_rows or predicate.name == "Robot":
                continue
            number += _check(predicate.name, mind, checker)
        assert checker.unknown < max(10, checker.asked / 4)
    return number


def _check(name: str, mind: Mind, checker: Checker) -> int:
    table = mind.query(name, ROWS, {})
    seen: list[dict[str, Any]] = []
    for values in table.rows[:MOST_ROWS]:
        given_row = dict(zip(table.columns, values, strict=True))
        if given_row in seen:
            continue
        seen.append(given_row)
        proof = Explainer(mind, "Ada", ROWS, {}).proof(Ask(name, given_row), nodes=3_000)
        explanation = proof.explanation
        assert explanation.rows > 0, (name, given_row)
        assert explanation.row is not None
        giving = [found for found in explanation.rules if found.row is not None]
        assert giving, (name, given_row, explanation)
        for node in proof.nodes:
            for found in _rules(node):
                made = "A: B" if name == "P9" else ""
                wrong = list(false_claims(found, checker, made)) if found.holds else []
                assert not wrong, (name, given_row, wrong)
            assert _is_founded(node, ()), (name, given_row)
            for asked in (each.asked for _, each in node.walk() if each.asked is not None):
                assert read_call(spell_call(asked), asked.within) == asked
    for values in table.rows[:2]:
        other = dict(zip(table.columns, values, strict=True))
        other[table.columns[0]] = 77
        assert Explainer(mind, "Ada", ROWS, {}).why(Ask(name, other)).rows == 0
    return max(1, len(seen)) + min(2, len(table.rows))


def _rules(node: Node) -> list[Node]:
    return [each for _, each in node.walk() if each.kind == "rule"]


def _is_founded(node: Node, above: tuple[str, ...]) -> bool:
    """Whether no row is proved by itself."""
    mine = above
    if node.kind == "rule":
        columns = [
            f"{c.text}={c.values}" for c in node.children if c.kind in ("column", "aggregate")
        ]
        key = f"{node.text} {columns}"
        if columns and key in above:
            return False
        mine = (*above, key)
    return all(_is_founded(child, mine) for child in node.children)


@pytest.mark.parametrize(
    ("questions", "programs_at_once"),
    [
        (40, 2),
        pytest.param(200, 4, marks=pytest.mark.slow),
        pytest.param(5_000, 50, marks=pytest.mark.proof),
    ],
)
def test_nothing_false_is_said(questions: int, programs_at_once: int) -> None:
    total = 0

    @given(programs())
    @settings(max_examples=programs_at_once, phases=SEARCH)
    def ask(text: str) -> None:
        nonlocal total
        total += asked(text)

    while total < questions:
        ask()


@pytest.mark.parametrize("aggregate", ["y? List= a", "y? Set= a", "y? += a", "y? Count= a"])
def test_nothing_false_is_said_of_more_elements_than_are_shown(aggregate: str) -> None:
    pairs = "A(x: a, y:), A(x: b, y:), A(x: c, y:)"
    facts = "; ".join(f"A(x: {x}, y: 1)" for x in range(6))
    assert asked(f"{facts}; P0(x: 1, {aggregate}) distinct :- {pairs};{REST}")


def test_a_lie_would_be_found() -> None:
    text = f"Num(x: 1); Num(x: 4); Big(x:) :- Num(x:), y == x + 1, y > 3;{REST}"
    program = Program.compile(text)
    with closing(Mind(program)) as mind:
        checker = Checker(program, mind, ROWS, {})
        (node,) = Explainer(mind, "Ada", ROWS, {}).why(Ask("Big")).nodes
        assert not list(false_claims(node, checker))
        lies = tuple(
            replace(child, values=(2,)) if child.text.startswith("y ==") else child
            for child in node.children
        )
        assert list(false_claims(replace(node, children=lies), checker))
