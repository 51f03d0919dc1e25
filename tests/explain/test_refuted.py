"""The law of refutations: what is said to fail fails, what is said to hold holds."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings

from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.mind import Limits, Mind, Program
from tests.explain.asking import REST
from tests.explain.checking import Checker, equal, head_columns
from tests.explain.generated import programs
from tests.explain.test_true import ROWS, SEARCH

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.explain import Node

KINDS = (*(f"P{number}" for number in range(9)), "A", "B", "R", "P")
STEPS = ("call", "condition", "denial", "element", "value")


def refuted(text: str) -> int:
    """Ask why-not of every predicate of a program; how many claims were checked."""
    program = Program.compile(text)
    with closing(Mind(program, limits=Limits(query_seconds=60))) as mind:
        checker = Checker(program, mind, ROWS, {})
        for predicate in program.predicates:
            # What holds in the rules of P9, which are copies, can't be asked for sure.
            if predicate.kind == "program" and predicate.has_rows and predicate.name[:2] in KINDS:
                for asked in absent(predicate.name, mind):
                    for node in Explainer(mind, "Ada", ROWS, {}).why(asked).nodes:
                        wrong = list(false_refutation(node, asked, checker))
                        assert not wrong, (asked, wrong)
    return checker.asked


def absent(name: str, mind: Mind) -> Iterator[Ask]:
    """Rows that a predicate does not have, each like one that it has, and all of them."""
    table = mind.query(name, ROWS, {})
    if not table.rows:
        yield Ask(name)
    first, last = table.rows[:1], table.rows[-1:]
    for column in range(len(table.columns)) if table.rows else ():
        for value in (77, last[0][column]):
            row = [*first[0]]
            row[column] = value
            if tuple(row) not in table.rows:
                yield Ask(name, dict(zip(table.columns, row, strict=True)))


def ends(nodes: Sequence[Node]) -> Iterator[tuple[list[str], Node]]:
    """For each way in which a rule fails: the parts that hold, and what ends them."""
    held: list[str] = []
    for node in nodes:
        if node.kind == "alternative" and node.holds:
            held += [each.text for each in node.children]
        elif node.kind == "alternative":
            yield from (([*held, *parts], end) for parts, end in ends(node.children))
        elif node.holds is False:
            yield held, node
            return
        elif node.kind in STEPS and node.span is not None and node.holds:
            held.append(node.text)


def false_refutation(rule: Node, asked: Ask, checker: Checker) -> Iterator[str]:
    """What is false about a rule that is said to give no row."""
    if rule.kind != "rule" or rule.holds is not False:
        return
    head = dict(head_columns(rule.text.partition(":-")[0]))
    if not head:
        return  # of another form than the generated rules
    wanted = [
        claim
        for column, expression in head.items()
        if column in asked.given and (claim := equal(expression, asked.given[column]))
    ]
    for held, end in ends(rule.children):
        if end.kind == "column":
            values = end.values if end.text.partition(":")[0] in head else ()
            claims = [equal(head[end.text.partition(":")[0]], value) for value in values]
            for claim in claims:
                if claim and held and checker.holds([*held, claim], "") is False:
                    yield f"{claim} is said to come out of {held}"
            is_whole = asked.given.keys() <= head.keys()
            if is_whole and held and wanted and checker.holds([*held, *wanted], ""):
                yield f"{held} hold with {wanted}"
            continue
        if held and checker.holds(held, "") is False:
            yield f"{held} are said to hold"
        failing = [*held, end.text, *([] if end.said.startswith("in no") else wanted)]
        if not end.text.startswith("not:") and checker.holds(failing, ""):
            yield f"{end.text} is said to fail after {held}, with {wanted}: {end.said}"


@pytest.mark.parametrize(
    ("claims", "programs_at_once"),
    [
        (60, 2),
        pytest.param(400, 4, marks=pytest.mark.slow),
        pytest.param(5_000, 50, marks=pytest.mark.proof),
    ],
)
def test_nothing_false_is_said_of_what_is_not_there(claims: int, programs_at_once: int) -> None:
    total = 0

    @given(programs())
    @settings(max_examples=programs_at_once, phases=SEARCH)
    def ask(text: str) -> None:
        nonlocal total
        total += refuted(text)

    while total < claims:
        ask()


@pytest.mark.parametrize(
    "rule",
    [
        "P(x: v, y: w + 1) :- A(x: v, y: w), (v > 0 | w > 3), w < 9;",
        "P(x: v, y: w) :- A(x: v, y: u), (v > 0 | u > 3), (u == 2, w == 4 | u == 3, w == 5);",
        "P(x: v, y: w) :- A(x: v, y: w), (v > 9 | w > 2, v > 5), w < 9;",
        "P(x: v, y: w) :- A(x: v, y: w), (v > 0, w > 1 | w > 0), (A(x: w) | v == 7), ~A(x: v);",
    ],
)
def test_nothing_false_is_said_of_alternatives(rule: str) -> None:
    facts = "A(x: 0, y: 1); A(x: 1, y: 2); A(x: 2, y: 3); A(x: 3, y: 4);"
    assert refuted(f"{facts} {rule}{REST}")
