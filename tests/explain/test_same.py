"""The rules taken apart give what the program gives: every shipped program, every predicate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from typing import Any

import pytest

from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.explain.why.derivations import MOST_ROWS
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.world import World, list_levels, load_level
from tests.explain.checking import Checker
from tests.explain.judging import false_of
from tests.mind.rows import nearly_same

TICKS = 40
CROWD = 10


def level_for(program: str) -> str:
    """The name of the level that a program is for, or of one that it can be tried in."""
    name = program.removesuffix("-starter")
    return next((level for level in list_levels() if level[3:] == name), "06-breadcrumbs")


def moments(name: str, ticks: Sequence[int]) -> Iterator[tuple[Mind, Any, Any]]:
    """A mind with a program, and sensor rows and memories at some ticks of its level."""
    level = load_level(level_for(name))
    world = World(level)
    memories: dict[str, Any] = {}
    sees = level.visibility
    program = Program.compile(load_program(name).text)
    limits = Limits(query_seconds=60)
    with closing(Mind(program, memory=sees.memory, sensor=sees.sensor, limits=limits)) as mind:
        for tick in range(1, max(ticks) + 1):
            rows = world.sense()
            if tick in ticks:
                yield mind, rows, memories
            decisions = mind.think(rows, memories)
            memories = {d.robot_name: d.memory for d in decisions}
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})


def last_tick(name: str) -> int:
    return TICKS if len(load_level(level_for(name)).robots) < CROWD else 2


QUICK = "steering"


def marks(name: str) -> list[pytest.MarkDecorator]:
    """A starter has much of what its solution has, so only a long proof tries it."""
    return [pytest.mark.slow] * (name != QUICK) + [pytest.mark.proof] * name.endswith("-starter")


PROGRAMS = [pytest.param(name, marks=marks(name)) for name in list_programs()]


@pytest.mark.parametrize("name", PROGRAMS)
def test_each_row_of_a_predicate_has_a_true_proof_and_no_other_has(name: str) -> None:
    for mind, rows, memories in moments(name, [last_tick(name)]):
        robots = [row["robot_name"] for row in rows][:2]
        for predicate in mind.program.predicates:
            if predicate.kind != "program" or not predicate.has_rows:
                continue
            table = mind.query(predicate.name, rows, memories)
            column = table.columns.index("robot_name") if "robot_name" in table.columns else None
            for robot in robots:
                proof = Explainer(mind, robot, rows, memories).proof(Ask(predicate.name))
                found = proof.explanation
                mine = [
                    row
                    for number, row in enumerate(table.rows)
                    if (not table.viewers or table.viewers[number] == robot)
                    and (column is None or row[column] == robot)
                ]
                assert found.rows == min(len(mine), MOST_ROWS), (predicate.name, robot)
                if mine:
                    giving = [rule for rule in found.rules if rule.row is not None]
                    assert giving, (predicate.name, robot)
                    assert all(node.holds for node in proof.nodes)
                if predicate.name == "Robot":
                    (row,) = mine
                    decided = dict(zip(table.columns, row, strict=True))
                    assert found.row is not None
                    assert nearly_same(dict(found.row), decided)
        check_proofs(mind, rows, memories, 3)


def check_proofs(mind: Mind, rows: Any, memories: Any, most: int) -> None:
    """Put what proofs of decisions say into their rules."""
    checked = 0
    checker = Checker(mind.program, mind, rows, memories)
    for robot in [row["robot_name"] for row in rows][:2]:
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
