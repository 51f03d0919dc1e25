"""The rules taken apart give what the program gives: every shipped program, every predicate."""

from __future__ import annotations

from contextlib import closing

import pytest

from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.mind.why.derivations import MOST_ROWS
from logical_robots_tui.world import World, list_levels, load_level
from tests.mind.rows import nearly_same

TICKS = 40
CROWD = 10


def level_for(program: str) -> str:
    """The name of the level that a program is for, or of one that it can be tried in."""
    name = program.removesuffix("-starter")
    return next((level for level in list_levels() if level[3:] == name), "06-breadcrumbs")


@pytest.mark.parametrize("name", list_programs())
def test_rules_give_the_rows_of_their_predicate(name: str) -> None:
    level = load_level(level_for(name))
    program = Program.compile(load_program(name).text)
    world = World(level)
    memories: dict[str, object] = {}
    sees = level.visibility
    with closing(Mind(program, memory=sees.memory, sensor=sees.sensor)) as mind:
        ticks = TICKS if len(level.robots) < CROWD else 2
        for _ in range(ticks):
            decisions = mind.think(world.sense(), memories)  # type: ignore[arg-type] # Values
            memories = {d.robot_name: d.memory for d in decisions}
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
        rows = world.sense()
        robots = [robot.name for robot in level.robots][:2]
        for predicate in program.predicates:
            if predicate.kind != "program" or not predicate.has_rows:
                continue
            table = mind.query(predicate.name, rows, memories)  # type: ignore[arg-type] # Values
            column = table.columns.index("robot_name") if "robot_name" in table.columns else None
            for robot in robots:
                proof = mind.explainer(robot, rows, memories).proof(predicate.name)  # type: ignore[arg-type]
                found = proof.explanation
                mine = [
                    row
                    for number, row in enumerate(table.rows)
                    if (not table.viewers or table.viewers[number] == robot)
                    and (column is None or row[column] == robot)
                ]
                assert found.rows == min(len(mine), MOST_ROWS), (predicate.name, robot)
                if mine:
                    assert any(rule.row is not None for rule in found.rules), (
                        predicate.name,
                        robot,
                    )
                    assert all(node.holds for node in proof.nodes)
                if predicate.name == "Robot":
                    (row,) = mine
                    decided = dict(zip(table.columns, row, strict=True))
                    assert found.row is not None
                    assert nearly_same(dict(found.row), decided)
