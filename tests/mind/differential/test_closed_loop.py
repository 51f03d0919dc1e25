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
from tests.mind.differential.duckdb_reference import Reference
from tests.mind.differential.whole_programs import ASKED, engines, same_memory, told

PROGRAMS = sorted((Path(__file__).parent / "closed_loop").glob("*.l"))
TICKS = [min(40, 2 * settings().max_examples), pytest.param(1_000, marks=pytest.mark.proof)]
ROBOTS = 3
"""No more of the level's think: DuckDB is asked for all of them in each tick."""


@pytest.mark.sampled
@pytest.mark.parametrize("ticks", TICKS)
@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_a_robot_remembers_and_decides_as_on_duckdb(path: Path, ticks: int, tmp_path: Path) -> None:
    text = path.read_text("utf-8")
    world = World(load_level("10-distributed-mapping"))
    mind = Mind(Program.compile(text), "all", "all", Limits(think_seconds=10))
    names = [robot.name for robot in world.level.robots[:ROBOTS]]
    ours: dict[str, Any] = dict.fromkeys(names, "")
    theirs = dict(ours)
    reference = Reference(ASKED.format(text), "Answer", tmp_path)
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
