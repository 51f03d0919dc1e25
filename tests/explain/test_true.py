"""The law of explanations: nothing false is said, of any row of any program."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any

import pytest

from logical_robots_tui.explain import Ask, Node
from tests.explain.asking import REST
from tests.explain.checking import Checker
from tests.explain.generated import program
from tests.explain.judging import claims_in, judge_until
from tests.explain.questions import Asked, Scene, alone, asked, missed, together
from tests.explain.teams import team


def one_robot(seed: int) -> AbstractContextManager[Scene]:
    return alone(program(seed))


def a_team(seed: int) -> AbstractContextManager[Scene]:
    return together(team(seed))


Maker = Callable[[int], AbstractContextManager[Scene]]


def numbers(one: tuple[int, int], team: tuple[int, int], proof: int) -> list[Any]:
    """How many answers are judged of one robot's programs and of teams', and from which seed on."""
    made = ((one_robot, *one, 14), (a_team, *team, 6))
    return [
        *((maker, few, first) for maker, few, _, first in made),
        *(pytest.param(maker, many, 0, marks=pytest.mark.slow) for maker, _, many, _ in made),
        *(pytest.param(maker, proof, 0, marks=pytest.mark.proof) for maker, *_ in made),
    ]


def find_nothing_false(
    ask_of: Callable[[Scene], Asked], maker: Maker, number: int, first: int
) -> None:
    """Ask of generated programs until so many answers are judged."""

    def ask(seed: int) -> int:
        with maker(seed) as scene:
            answers = ask_of(scene)
        assert not answers.false, (scene.mind.program.text, answers.false)
        return answers.number

    judge_until(number, ask, first)


@pytest.mark.parametrize(("maker", "answers", "first"), numbers((20, 60), (10, 40), 2_500))
def test_nothing_false_is_said(maker: Maker, answers: int, first: int) -> None:
    find_nothing_false(asked, maker, answers, first)


@pytest.mark.parametrize(("maker", "changes", "first"), numbers((3, 8), (1, 5), 300))
def test_each_change_that_is_advised_gives_a_row(maker: Maker, changes: int, first: int) -> None:
    find_nothing_false(missed, maker, changes, first)


def test_nothing_false_is_said_of_more_elements_than_are_shown() -> None:
    pairs = "A(x: a, y:), A(x: b, y:), A(x: c, y:)"
    facts = "; ".join(f"A(x: {x}, y: 1)" for x in range(6))
    rules = "\n".join(
        f"P{n}(x: 1, y? {operator}= a) distinct :- {pairs};"
        for n, operator in enumerate(("List", "Set", "+", "Count"))
    )
    with alone(f"{facts}; {rules}{REST}") as scene:
        answers = asked(scene)
    assert answers.number > 4
    assert not answers.false


def test_nothing_false_is_said_of_alternatives() -> None:
    text = """A(x: 0, y: 1); A(x: 1, y: 2); A(x: 2, y: 3); A(x: 3, y: 4);
    P(x: v, y: w + 1) :- A(x: v, y: w), (v > 0 | w > 3), w < 9;
    Q(x: v, y: w) :- A(x: v, y: u), (v > 0 | u > 3), (u == 2, w == 4 | u == 3, w == 5);
    R(x: v, y: w) :- A(x: v, y: w), (v > 9 | w > 2, v > 5), w < 9;
    S(x: v, y: w) :- A(x: v, y: w), (v > 0, w > 1 | w > 0), (A(x: w) | v == 7), ~A(x: v);"""
    with alone(f"{text}{REST}") as scene:
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
        checker = Checker(scene.mind.program, scene.mind, scene.rows, scene.memories)
        for nodes, is_false in ((proof.nodes, False), ([lies(n, lie) for n in proof.nodes], True)):
            claims, false = claims_in(nodes, proof.explanation.asked, checker, {})
            assert bool([*checker.false(claims), *false]) == is_false
