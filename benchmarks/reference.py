"""Measure the reference programs of all levels and write ``levels/reference.csv``.

``python -m benchmarks.reference LEVEL...`` measures only these levels and keeps the others.
"""

from __future__ import annotations

import asyncio
import csv
import sys
from typing import TYPE_CHECKING

from logical_robots_tui.game import load_program
from logical_robots_tui.game.measuring import Trial, measure
from logical_robots_tui.game.source import reference_names
from logical_robots_tui.game.victory import FIELDS, FILE_NAME, reference_table
from logical_robots_tui.mind import Program
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import list_levels, load_level

if TYPE_CHECKING:
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.world import Level

__all__ = ["measure_reference"]


async def measure_reference(level: Level, name: str) -> Measures:
    """Measure a reference program of a level from its start and from varied starts."""

    def show(trial: Trial) -> None:
        print(f"\r{name}: {trial.wins} of {trial.tried}", end="", file=sys.stderr)

    program = await asyncio.to_thread(Program.compile, load_program(name).text)
    found = await measure(level, program, None, show)
    print(file=sys.stderr)
    assert found is not None, f"{name} does not win {level.name}"
    return found._replace(distance=round(found.distance, 1))


async def main(names: list[str]) -> None:
    """Measure the reference programs of the named levels, or of all, and write the table."""
    table = dict(reference_table())
    levels = list_levels()
    for level in map(load_level, names or levels):
        table[level.name] = {
            name: await measure_reference(level, name) for name in reference_names(level.solution)
        }
    path = shipped_folder("levels") / FILE_NAME
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        for name in levels:
            for program, found in table.get(name, {}).items():
                writer.writerow([name, program, *found[:5], "; ".join(found.goals)])


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1:]))
