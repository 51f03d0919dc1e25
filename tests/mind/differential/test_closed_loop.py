"""What a program keeps from tick to tick is what it keeps on DuckDB, tick by tick.

The world is driven by what is decided here; both sides meet the same sensors, each with the
memories that it left itself.
"""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from logical_robots_tui import World, load_level
from logical_robots_tui.mind import Limits, Mind, Program
from tests.mind.differential import remembering
from tests.mind.differential.duckdb_reference import Reference
from tests.mind.differential.whole_programs import ASKED, engines, same_memory, told

FILES = sorted((Path(__file__).parent / "closed_loop").glob("*.l"))
PROGRAMS = {**{path.stem: path.read_text("utf-8") for path in FILES}, **remembering.PROGRAMS}
FEW = (*(path.stem for path in FILES), *list(remembering.PROGRAMS)[::8])
"""What is not left to long proofs."""

TICKS = {False: settings().max_examples, True: 8}
"""For programs from files and generated ones, whose lists are filled and emptied in eight."""

ROBOTS = 3
"""No more of the level's think: DuckDB is asked for all of them in each tick."""


@pytest.mark.sampled
@pytest.mark.parametrize("name", FEW)
def test_a_robot_remembers_and_decides_as_on_duckdb(name: str, tmp_path: Path) -> None:
    assert_alike(PROGRAMS[name], TICKS[name in remembering.PROGRAMS], tmp_path)


@pytest.mark.proof
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_robot_goes_on_as_on_duckdb(name: str, tmp_path: Path) -> None:
    assert_alike(PROGRAMS[name], 500, tmp_path)


def assert_alike(text: str, ticks: int, folder: Path) -> None:
    world = World(load_level("10-distributed-mapping"))
    mind = Mind(Program.compile(text), "all", "all", Limits(think_seconds=10))
    names = [robot.name for robot in world.level.robots[:ROBOTS]]
    ours: dict[str, Any] = dict.fromkeys(names, "")
    theirs = dict(ours)
    reference = Reference(ASKED.format(text), "Answer", folder)
    for tick in range(1, ticks + 1):
        rows: Any = [row for row in world.sense() if row["robot_name"] in names]
        answer = reference.answer(rows, theirs)
        there = {name: (engines(desire), memory) for name, desire, memory in answer}
        decisions = mind.think(rows, ours)
        for decision in decisions:
            assert same_memory(told(decision), there[decision.robot_name]), f"tick {tick}"
        ours = {d.robot_name: d.memory for d in decisions}
        theirs = {name: memory for name, (_, memory) in there.items()}
        world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
    reference.close()
    mind.close()
