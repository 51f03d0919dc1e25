"""Programs in closed loop on both engines, each with the memories that it left itself.

The world is driven by what is decided here; both sides meet the same sensors.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from logical_robots_tui import Desire, World, load_level
from logical_robots_tui.mind import Limits, Mind, Program
from tests.mind.differential.comparing import same
from tests.mind.differential.duckdb_reference import Reference
from tests.mind.differential.whole_programs import ASKED, engines

__all__ = ["PROGRAMS", "differences", "fields", "same_memory"]

_FOLDER = Path(__file__).with_suffix("")

PROGRAMS = {path.stem: path.read_text("utf-8") for path in sorted(_FOLDER.glob("*.l"))}

ROBOTS = 3
"""No more of the level's think: DuckDB is asked for all of them in each tick."""


def differences(text: str, ticks: int, folder: Path) -> Iterator[str]:
    """Yield what robots decide or remember otherwise than on DuckDB, tick by tick."""
    world = World(load_level("10-distributed-mapping"))
    mind = Mind(Program.compile(text), "all", "all", Limits(think_seconds=10))
    names = [robot.name for robot in world.level.robots[:ROBOTS]]
    ours: dict[str, Any] = dict.fromkeys(names, "")
    theirs = dict(ours)
    reference = Reference(ASKED.format(text), "Answer", folder)
    for tick in range(1, ticks + 1):
        rows: Any = [row for row in world.sense() if row["robot_name"] in names]
        found = reference.answer(rows, theirs)
        there = {name: (engines(desire), memory) for name, desire, memory in found}
        decisions = mind.think(rows, ours)
        for decision in decisions:
            here = engines(fields(decision.desire)), decision.memory
            if not same_memory(here, there[decision.robot_name]):
                yield f"tick {tick}: here {here}, on DuckDB {there[decision.robot_name]}"
        ours = {d.robot_name: d.memory for d in decisions}
        theirs = {name: memory for name, (_, memory) in there.items()}
        world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
    reference.close()
    mind.close()


def fields(desire: Desire | None) -> dict[str, float] | None:
    if desire is None:
        return None
    return {"left_engine": desire.left_engine, "right_engine": desire.right_engine}


def same_memory(ours: Any, theirs: Any, tolerance: float = 1e-9) -> bool:
    """Compare decisions; JSON in a text is here what it spells."""
    if isinstance(theirs, tuple):
        return all(map(same_memory, ours, theirs))
    if isinstance(theirs, str) and isinstance(ours, dict | list):
        theirs = json.loads(theirs)
    return same(ours, theirs, tolerance)
