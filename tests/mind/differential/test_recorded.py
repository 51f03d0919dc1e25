"""Our own programs decide the same on both engines, on what robots really met."""

from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import Frame, Game, list_programs, load_program
from logical_robots_tui.mind import Program
from logical_robots_tui.world import list_levels, load_level
from tests.mind.differential.comparing import same
from tests.mind.differential.duckdb_reference import answer
from tests.mind.differential.whole_programs import ASKED

TICKS = (1, 40, 300)
ROBOTS = 3
"""No more are compared: DuckDB is asked for each alone, compiling included."""

ANY_OF_EQUAL_ONES = {"lighthouse-starter", "breadcrumbs-starter"}
"""Go for the nearest of several things; of equally near ones DuckDB may take any."""


def pairs() -> list[tuple[str, str]]:
    """Each level with its programs, and a level with those that belong to none.

    Left out are those that read memories: the package's DuckDB has no TryCast, and wants every
    memory to be of one type, which the empty text of the first tick is not.
    """
    levels = [load_level(name) for name in list_levels()]
    found = [(level.name, name) for level in levels for name in (level.starter, level.solution)]
    free = set(list_programs()).difference(name for _, name in found)
    found += [("02-open-space", name) for name in sorted(free)]
    return [
        (level, name)
        for level, name in found
        if name not in ANY_OF_EQUAL_ONES and "Memory(" not in load_program(name).text
    ]


def is_large(level: str, program: str) -> bool:
    return level == "13-swarm" or len(load_program(program).text) > 1_000


def robot_rows(text: str, frame: Frame, name: str, folder: Path) -> dict[str, Any]:
    rows = [row for row in frame.sensors if row["robot_name"] == name]
    memories = {name: frame.memories_before[name]}
    ((_, desire, memory),) = answer(ASKED.format(text), "Answer", rows, memories, folder)
    return {"desire": desire, "memory": memory}


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("level_name", "program_name"),
    [pytest.param(*pair, marks=[pytest.mark.slow] * is_large(*pair)) for pair in pairs()],
)
async def test_a_program_decides_as_on_duckdb(
    level_name: str, program_name: str, tmp_path: Path
) -> None:
    text = load_program(program_name).text
    game = Game(load_level(level_name), Program.compile(text))
    last = (await game.run_until(tick=max(TICKS))).tick
    for tick in (min(tick, last) for tick in TICKS):
        frame = game.frame_at(tick)
        for decision in frame.decisions[:ROBOTS]:
            theirs = robot_rows(text, frame, decision.robot_name, tmp_path)
            assert decision.desire is not None
            ours = {
                "desire": {
                    "left_engine": decision.desire.left_engine,
                    "right_engine": decision.desire.right_engine,
                },
                "memory": decision.memory,
            }
            assert same(ours, theirs), f"tick {tick}, {decision.robot_name}"
    await game.close()
