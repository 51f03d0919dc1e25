"""Measure the reference programs of all levels and write ``levels/reference.csv``.

``python -m benchmarks.reference LEVEL...`` measures only these levels and keeps the others.
"""

from __future__ import annotations

import asyncio
import csv
import sys

from logical_robots_tui.game import load_program
from logical_robots_tui.game.measuring import Trial, measure
from logical_robots_tui.game.victory import FIELDS, FILE_NAME, reference_table
from logical_robots_tui.mind import Program
from logical_robots_tui.progress import Measures
from logical_robots_tui.shipped import shipped_folder
from logical_robots_tui.world import Level, list_levels, load_level

__all__ = ["measure_reference"]


async def measure_reference(level: Level) -> Measures:
    """Measure the reference program of a level from its start and from shifted starts."""

    def show(trial: Trial) -> None:
        print(f"\r{level.name}: {trial.wins} of {trial.tried}", end="", file=sys.stderr)

    program = await asyncio.to_thread(Program.compile, load_program(level.solution).text)
    found = await measure(level, program, None, show)
    print(file=sys.stderr)
    assert found is not None, f"{level.solution} does not win {level.name}"
    return Measures(found.ticks, found.rules, round(found.distance, 1), found.wins, found.starts)


async def main(names: list[str]) -> None:
    """Measure the named levels, or all, and write the table."""
    table = dict(reference_table())
    solved = [level for level in map(load_level, list_levels()) if level.solution]
    for level in solved:
        if not names or level.name in names:
            table[level.name] = await measure_reference(level)
    path = shipped_folder("levels") / FILE_NAME
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        for level in solved:
            if level.name in table:
                found = table[level.name]
                writer.writerow(
                    [level.name, *(getattr(found, field) for field in FIELDS if field != "level")]
                )


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1:]))
