"""The law of explanations: nothing false is said, of any row of any program."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import Phase, given, settings

from logical_robots_tui.mind import Limits, Mind, Program
from tests.mind.rows import row
from tests.mind.why.checking import Checker, false_claims
from tests.mind.why.generated import programs

if TYPE_CHECKING:
    from logical_robots_tui.mind import Node

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
        proof = mind.explainer("Ada", ROWS, {}).proof(name, given_row, nodes=3_000)
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
    for values in table.rows[:2]:
        other = dict(zip(table.columns, values, strict=True))
        other[table.columns[0]] = 77
        assert mind.explainer("Ada", ROWS, {}).why(name, other).rows == 0
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


@given(programs())
@settings(max_examples=12, phases=SEARCH)
def test_nothing_false_is_said(text: str) -> None:
    asked(text)


@pytest.mark.proof
def test_nothing_false_is_said_in_five_thousand_questions() -> None:
    total = 0

    @given(programs())
    @settings(max_examples=100, phases=SEARCH)
    def ask(text: str) -> None:
        nonlocal total
        total += asked(text)

    while total < 5_000:
        ask()
