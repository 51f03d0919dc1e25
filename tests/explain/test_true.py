"""The laws of explanations: nothing false is said, of any row of any program."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.explain import Ask, Explainer, ProofNode
from logical_robots_tui.explain.why.derivations import MOST_ROWS
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.world import Level, World, list_levels, load_level
from tests.explain.asking import REST, below
from tests.explain.checking import Checker
from tests.explain.generated import program
from tests.explain.judging import claims_in, false_of, judge_until
from tests.explain.questions import Asked, Scene, alone, asked, missed, together
from tests.explain.teams import team
from tests.mind.rows import nearly_same, row


def one_robot(seed: int) -> AbstractContextManager[Scene]:
    return alone(program(seed))


def a_team(seed: int) -> AbstractContextManager[Scene]:
    return together(team(seed))


Maker = Callable[[int], AbstractContextManager[Scene]]


def numbers(one: int, team: int, proof: int) -> list[Any]:
    """How many answers are judged of one robot's programs and of teams', and from which seed on."""
    return [
        (one_robot, one, 14),
        (a_team, team, 6),
        *(pytest.param(maker, proof, 0, marks=pytest.mark.proof) for maker in (one_robot, a_team)),
    ]


def nothing_is_false(
    ask_of: Callable[[Scene], Asked], maker: Maker, number: int, first: int
) -> None:
    """Ask of generated programs until so many answers are judged."""

    def ask(seed: int) -> int:
        with maker(seed) as scene:
            answers = ask_of(scene)
        assert not answers.false, (scene.mind.program.text, answers.false)
        return answers.number

    judge_until(number, ask, first)


@pytest.mark.parametrize(("maker", "answers", "first"), numbers(20, 10, 2_500))
def test_nothing_false_is_said(maker: Maker, answers: int, first: int) -> None:
    nothing_is_false(asked, maker, answers, first)


@pytest.mark.parametrize(("maker", "changes", "first"), numbers(3, 1, 300))
def test_each_change_that_is_advised_gives_a_row(maker: Maker, changes: int, first: int) -> None:
    nothing_is_false(missed, maker, changes, first)


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


def lies(node: ProofNode, said: Callable[[ProofNode], ProofNode]) -> ProofNode:
    return said(replace(node, children=tuple(lies(each, said) for each in node.children)))


LIES: list[tuple[dict[str, Any], Callable[[ProofNode], ProofNode]]] = [
    ({}, lambda n: replace(n, values=(2,)) if n.text.startswith("y ==") else n),
    ({}, lambda n: replace(n, values=(1,)) if n.kind == "column" else n),
    ({"x": 1}, lambda n: replace(n, span=None, text="y > 1") if n.text == "y > 3" else n),
    ({"x": 1}, lambda n: replace(n, values=(3,)) if n.text == "x" else n),
]


def test_a_lie_would_be_found() -> None:
    with alone(f"{RULES}{REST}") as scene:
        for given, lie in LIES:
            proof = scene.explainer().proof(Ask("Big", given))
            checker = Checker(scene.mind.program, scene.mind, scene.rows, scene.memories)
            changed = [lies(node, lie) for node in proof.nodes]
            for nodes, is_false in ((proof.nodes, False), (changed, True)):
                claims, false = claims_in(nodes, proof.explanation.query, checker, {})
                assert bool([*checker.false(claims), *false]) == is_false


def level_for(program: str) -> Level:
    name = program.removesuffix("-starter")
    return load_level(next((it for it in list_levels() if it[3:] == name), "06-breadcrumbs"))


def moments(name: str, ticks: Sequence[int]) -> Iterator[tuple[Mind, Any, Any]]:
    """A mind with a program, and sensor rows and memories at some ticks of its level."""
    level = level_for(name)
    world = World(level)
    memories: dict[str, Any] = {}
    sees, limits = level.visibility, Limits(query_seconds=60)
    program = Program.compile(load_program(name).text)
    with closing(Mind(program, memory=sees.memory, sensor=sees.sensor, limits=limits)) as mind:
        for tick in range(1, max(ticks) + 1):
            rows = world.sense()
            if tick in ticks:
                yield mind, rows, memories
            decisions = mind.think(rows, memories)
            memories = {d.robot_name: d.memory for d in decisions}
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})


def last_tick(name: str) -> int:
    return 40 if len(level_for(name).robots) < 10 else 2


def marks(name: str) -> list[pytest.MarkDecorator]:
    """A starter has much of what its solution has, so only a long proof tries it."""
    slow = [pytest.mark.slow] * (name != "steering")
    return slow + [pytest.mark.proof] * name.endswith("-starter")


EVERY = 3  # of the shipped programs; a long proof tries all
PROGRAMS = [
    pytest.param(name, marks=[*marks(name), *[pytest.mark.proof] * (place % EVERY > 0)])
    for place, name in enumerate(list_programs())
]


@pytest.mark.parametrize("name", PROGRAMS)
def test_each_row_of_a_predicate_has_a_true_proof_and_no_other_has(name: str) -> None:
    for mind, rows, memories in moments(name, [last_tick(name)]):
        robots = [sensed["robot_name"] for sensed in rows][:2]
        for predicate in mind.program.predicates:
            if predicate.kind != "program" or not predicate.has_rows:
                continue
            table = mind.query(predicate.name, rows, memories)
            column = table.columns.index("robot_name") if "robot_name" in table.columns else None
            for robot in robots:
                proof = Explainer(mind, robot, rows, memories).proof(Ask(predicate.name))
                told = proof.explanation
                seen = table.in_mind_of(robot).rows
                mine = [there for there in seen if column is None or there[column] == robot]
                assert told.rows == min(len(mine), MOST_ROWS), (predicate.name, robot)
                if mine:
                    assert any(rule.row is not None for rule in told.rules), (predicate.name, robot)
                    assert all(node.holds for node in proof.nodes)
                if predicate.name == "Robot":
                    (decided,) = mine
                    assert told.row is not None
                    assert nearly_same(
                        dict(told.row), dict(zip(table.columns, decided, strict=True))
                    )
        check_proofs(mind, rows, memories, 3)


def check_proofs(mind: Mind, rows: Any, memories: Any, most: int) -> None:
    checked = 0
    checker = Checker(mind.program, mind, rows, memories)
    for robot in [sensed["robot_name"] for sensed in rows][:2]:
        proof = Explainer(mind, robot, rows, memories).proof(nodes=2_000)
        rules = [n for root in proof.nodes for _, n in root.walk() if n.kind == "rule" and n.holds]
        for node in {rule.text: rule for rule in rules}.values():
            if checked < most:
                assert not list(false_of(node, checker)), (mind.program.text, robot)
                checked += 1


@pytest.mark.proof
@pytest.mark.parametrize("name", list_programs())
def test_what_proofs_say_holds_in_the_rules_at_many_ticks(name: str) -> None:
    for mind, rows, memories in moments(name, range(5, 10 * last_tick(name), 25)):
        check_proofs(mind, rows, memories, 1_000)


KEYS = {
    "numbers": ["0", "1", "1.5", "-2", "1000000", "null"],
    "texts": ['"a"', '"B"', '"10"', '"9"', '"{"', '"[2]"', '"[10]"', '""', "null"],
    "records": ["{k: 2}", "{k: 10}", "{k: -1}", "null"],
    "lists": ["[2]", "[10]", "[2, 1]", "[1, 2]", "null"],
    "texts in lists": ['["b"]', '["a", "z"]', '["a"]', "null"],
    "truths": ["true", "false", "null"],
}
INSIDE = """
P(x: Best{a :- A(a:)});
Q(x: Best{a -> k :- A(a:, k:)});
"""
IN_HEADS = """
P(x? Best= a) distinct :- A(a:);
Q(x? Best= a -> k) distinct :- A(a:, k:);
"""
IN_TWO_RULES = """
P(x? Best= a) distinct :- A(a:, k:);
P(x? Best= k) distinct :- A(a: k, k: a);
Q(x? Best= a -> k) distinct :- A(a:, k:), k is not null;
Q(x? Best= k -> a) distinct :- A(a: k, k: a);
"""


@st.composite
def questions(draw: st.DrawFn) -> tuple[str, str]:
    """A program whose predicate P or Q, with a column x, is the best of some facts, and which."""
    arguments, keys = (draw(st.sampled_from(sorted(KEYS))) for _ in range(2))
    chosen = draw(st.sampled_from(["Min", "Max", "AnyValue", "ArgMin", "ArgMax"]))
    text = draw(st.sampled_from([INSIDE, IN_HEADS, IN_TWO_RULES]))
    if text == IN_TWO_RULES:
        keys = arguments
    one = st.tuples(*(st.sampled_from(KEYS[kind]) for kind in (arguments, keys)))
    pairs = draw(st.lists(one, min_size=1, max_size=5))
    facts = " ".join(f"A(a: {argument}, k: {key});" for argument, key in pairs)
    name = "Q" if chosen.startswith("Arg") else "P"
    rules = [line for line in text.splitlines() if line.startswith(name)]
    return "\n".join([facts, *rules, REST]).replace("Best", chosen), name


def deciding(text: str, name: str) -> tuple[object, list[ProofNode]]:
    with closing(Mind(Program.compile(text))) as mind:
        (row_asked,) = mind.query(name, [row("Ada")], {}).rows
        proof = Explainer(mind, "Ada", [row("Ada")], {}).proof(Ask(name))
    assert proof.explanation.row is not None
    assert proof.explanation.row["x"] == row_asked[0]
    nodes = [each for node in proof.nodes for each in below(node, "contributor")]
    return row_asked[0], [each for each in nodes if each.remark.startswith(("chosen", "is the"))]


@pytest.mark.parametrize("examples", [5, pytest.param(30, marks=pytest.mark.slow)])
def test_the_element_that_decides_has_the_value_of_the_result(examples: int) -> None:
    @given(questions())
    @settings(max_examples=examples)
    def ask(question: tuple[str, str]) -> None:
        result, found = deciding(*question)
        if result is not None:
            assert found
        for each in found:
            assert each.values == (result,)

    ask()


def test_among_equal_arguments_the_engine_chooses_by_the_key() -> None:
    for one, other, operator, keys in (
        ('1, k: "9"', '1, k: "10"', "ArgMin", ['"10"']),
        ("1, k: {k: 10}", "1, k: {k: 9}", "ArgMin", ["{k: 9}"]),
        ("1, k: [10]", "1, k: [9, 1]", "ArgMax", ["[10.0]"]),
        ("1, k: null", "1, k: 2", "ArgMin", ["2"]),
        ("1, k: null", "null, k: null", "ArgMin", []),
    ):
        facts = f"A(a: {one}); A(a: {other});"
        result, nodes = deciding(f"{facts} Q(x: {operator}{{a -> k :- A(a:, k:)}});{REST}", "Q")
        assert [node.text for node in nodes] == [f"a -> {key}" for key in keys]
        assert (result is None) == (not keys)
