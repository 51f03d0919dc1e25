"""How long a whole run takes to be diagnosed, as a process, with the run on disk or not."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import tempfile
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, repeated, seconds_for, summed_up
from benchmarks.subjects import LARGEST
from logical_robots_tui import load_level
from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.clock import CLOCK
from logical_robots_tui.game import Run, load_program
from logical_robots_tui.game.diagnosing import diagnose_run
from logical_robots_tui.mind import Program
from logical_robots_tui.world import list_levels

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["diagnosing"]

TICKS = 3000


def diagnosing(effort: Effort) -> Iterator[Measurement]:
    """Measure seconds until all findings are there, and until the first ones are."""
    for name in list_levels():
        with tempfile.TemporaryDirectory() as folder:
            is_large = name == LARGEST
            command = ("diagnose", name, str(load_level(name).solution), "--ticks")
            target = at_most(15 if is_large else 6)
            first = _seconds(folder, *command, str(TICKS))
            yield summed_up("diagnosis and run", name, "s", [first], target=target)
            # Of each number of ticks, because the result is kept.
            fewer = range(TICKS - 1, TICKS - 1 - effort.repeats, -1)
            took = [_seconds(folder, *command, str(ticks)) for ticks in fewer]
            target = at_most(5 if is_large else 2)
            yield summed_up("diagnosis", name, "s", took, target=target, value=min)
            again = _seconds(folder, *command, str(TICKS))
            yield summed_up("diagnosis again", name, "s", [again], target=at_most(1))
    took = repeated(effort.repeats, _first_findings)
    yield summed_up("first findings", LARGEST, "s", took, target=at_most(2), value=min)


def _seconds(folder: str, *command: str) -> float:
    arguments = [sys.executable, "-m", "logical_robots_tui", *command]
    environment = {**os.environ, FOLDER_VARIABLE: folder}
    return seconds_for(
        partial(subprocess.run, arguments, env=environment, stdout=subprocess.DEVNULL, check=False)
    )


def _first_findings() -> float:
    """Return the seconds until something can be shown of a run on disk."""

    async def look() -> float:
        level = load_level(LARGEST)
        run = Run(level, Program.compile(load_program(str(level.solution)).text))
        shown = asyncio.Event()
        try:
            await run.to_end(TICKS)
            began = CLOCK.now()
            task = asyncio.create_task(diagnose_run(run, TICKS, show=lambda _found: shown.set()))
            await shown.wait()
            took = CLOCK.now() - began
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        finally:
            await run.close()
        return took

    return asyncio.run(look())
