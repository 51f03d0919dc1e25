"""The law of explanations: nothing false is said, of any row of any program."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import strategies as st

from logical_robots_tui.explain import Ask
from tests.explain.asking import REST
from tests.explain.checking import Checker
from tests.explain.generated import programs
from tests.explain.judging import false_in, judge_until
from tests.explain.questions import Asked, Scene, alone, asked, missed, together
from tests.explain.teams import team

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.explain import Node

SCENES: dict[str, st.SearchStrategy[AbstractContextManager[Scene]]] = {
    "one robot": programs().map(alone),
    "a team": st.integers(0, 10**9).map(lambda seed: together(team(seed))),
}


def find_nothing_false(
    ask_of: Callable[[Scene], Asked], kind: str, number: int, programs_at_once: int
) -> None:
    """Ask of generated programs until so many answers are judged."""

    def ask(scene: AbstractContextManager[Scene]) -> int:
        with scene as entered:
            answers = ask_of(entered)
        assert not answers.false, (entered.mind.program.text, answers.false)
        return answers.number

    judge_until(number, SCENES[kind], programs_at_once, ask)


@pytest.mark.parametrize("kind", SCENES)
@pytest.mark.parametrize(
    ("questions", "programs_at_once"),
    [
        (40, 2),
        pytest.param(200, 4, marks=pytest.mark.slow),
        pytest.param(2_500, 50, marks=pytest.mark.proof),
    ],
)
def test_nothing_false_is_said(kind: str, questions: int, programs_at_once: int) -> None:
    find_nothing_false(asked, kind, questions, programs_at_once)


@pytest.mark.parametrize("kind", SCENES)
@pytest.mark.parametrize(
    ("changes", "programs_at_once"),
    [
        (5, 2),
        pytest.param(30, 4, marks=pytest.mark.slow),
        pytest.param(300, 50, marks=pytest.mark.proof),
    ],
)
def test_each_change_that_is_advised_gives_a_row(
    kind: str, changes: int, programs_at_once: int
) -> None:
    find_nothing_false(missed, kind, changes, programs_at_once)


@pytest.mark.parametrize("aggregate", ["y? List= a", "y? Set= a", "y? += a", "y? Count= a"])
def test_nothing_false_is_said_of_more_elements_than_are_shown(aggregate: str) -> None:
    pairs = "A(x: a, y:), A(x: b, y:), A(x: c, y:)"
    facts = "; ".join(f"A(x: {x}, y: 1)" for x in range(6))
    with alone(f"{facts}; P0(x: 1, {aggregate}) distinct :- {pairs};{REST}") as scene:
        answers = asked(scene)
    assert answers.number
    assert not answers.false


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
    with alone(f"{facts} {rule}{REST}") as scene:
        assert not asked(scene).false


RULES = "Num(x: 1); Num(x: 4); Big(x:) :- Num(x:), y == x + 1, y > 3;"


def lies(node: Node, said: Callable[[Node], Node]) -> Node:
    return said(replace(node, children=tuple(lies(each, said) for each in node.children)))


@pytest.mark.parametrize(
    ("given", "lie"),
    [
        ({}, lambda n: replace(n, values=(2,)) if n.text.startswith("y ==") else n),
        ({}, lambda n: replace(n, values=(1,)) if n.kind == "column" else n),
        ({"x": 1}, lambda n: replace(n, span=None, text="y > 1") if n.text == "y > 3" else n),
        ({"x": 1}, lambda n: replace(n, values=(3,)) if n.text == "x" else n),
    ],
    ids=["of a value", "of a row", "of what fails", "of what holds before"],
)
def test_a_lie_would_be_found(given: dict[str, Any], lie: Callable[[Node], Node]) -> None:
    with alone(f"{RULES}{REST}") as scene:
        proof = scene.explainer().proof(Ask("Big", given))
        told = proof.explanation.asked
        checker = Checker(scene.mind.program, scene.mind, scene.rows, scene.memories)
        assert not list(false_in(proof.nodes, told, checker, {}))
        changed = [lies(node, lie) for node in proof.nodes]
        assert list(false_in(changed, told, checker, {}))
