"""How long the command line takes to answer questions about a run, as whole processes."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import (
    Effort,
    Measurement,
    at_most,
    repeated,
    seconds_for,
    summed_up,
)
from benchmarks.subjects import LARGEST
from logical_robots_tui import load_level
from logical_robots_tui.caching import FOLDER_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["answers"]

TICKS = 3  # to run, for each of the effort
WHY_AT = 300
ORIGIN_AT = 2000
ORIGINS = {
    "11-the-gate": "memory.phase",
    "06-breadcrumbs": "memory.visited",
    "10-distributed-mapping": "memory.rung",
    "13-swarm": "memory.settled",
}


def answers(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds of the first and of later questions about a late tick."""
    level, last = load_level(LARGEST), TICKS * effort.ticks
    run = [level.name, level.solution]
    at = ["--tick", str(last)]
    again = {
        "query": ["query", *run, *at, "Robot"],
        "why": ["why", *run, *at, "--robot", level.robots[0].name],
        "when": ["when", *run, "--ticks", str(last), "Memory(memory:), memory == 1"],
    }
    computing = []
    for name in [*ORIGINS][: 1 if effort.is_quick else None]:
        yield _origin(effort, name)
    yield _first_why(effort, run, level.robots[0].name)
    with tempfile.TemporaryDirectory() as folder:
        first = _milliseconds(folder, *again["query"])
        yield summed_up("first answer", f"{level.name}, tick {last}", "ms", [first])
        for what, command in again.items():
            _milliseconds(folder, *command)
            subject = f"{level.name}, {what}"
            took = repeated(effort.repeats, partial(_both_milliseconds, folder, *command))
            passed, computed = zip(*took, strict=True)
            yield summed_up("next answer", subject, "ms", passed, target=at_most(500), value=min)
            computing.append(
                summed_up("next answer, computing", subject, "ms", computed, value=min)
            )
    yield from computing


def _first_why(effort: Effort, run: list[str], robot: str) -> Measurement:
    """Measure the first why where the run is on disk, and nothing is decomposed."""
    at = ["--tick", str(WHY_AT)]
    took = []
    with tempfile.TemporaryDirectory() as folder:
        _milliseconds(folder, "query", *run, *at, "Robot")
        for number in range(effort.repeats):
            place = Path(folder) / f"first {number}"
            shutil.copytree(folder, place, ignore=shutil.ignore_patterns("first *"))
            took.append(_milliseconds(str(place), "why", *run, *at, "--robot", robot))
    subject = f"{run[0]}, tick {WHY_AT}, run on disk"
    return summed_up("first why", subject, "ms", took, target=at_most(1200), value=min)


def _origin(effort: Effort, name: str) -> Measurement:
    """Measure the origin of a value late in a run that is on disk."""
    level = load_level(name)
    run = [name, level.solution, "--tick", str(ORIGIN_AT)]
    command = ["origin", *run, "--robot", level.robots[0].name, "--value", ORIGINS[name]]
    with tempfile.TemporaryDirectory() as folder:
        _milliseconds(folder, *command)
        took = repeated(effort.repeats, partial(_both_milliseconds, folder, *command))
    subject = f"{name}, tick {ORIGIN_AT}, run on disk"
    computed = [processor for _, processor in took]
    return summed_up("origin", subject, "ms", computed, target=at_most(1000), value=min)


def _milliseconds(folder: str, *command: str) -> float:
    """Return the milliseconds that one process takes."""
    arguments = [sys.executable, "-m", "logical_robots_tui", *command]
    environment = {**os.environ, FOLDER_VARIABLE: folder}
    run = partial(
        subprocess.run, arguments, env=environment, stdout=subprocess.DEVNULL, check=False
    )
    return 1000 * seconds_for(run)


def _both_milliseconds(folder: str, *command: str) -> tuple[float, float]:
    """Return the time that passes and the processor time that one process takes."""
    before = _children()
    return _milliseconds(folder, *command), 1000 * (_children() - before)


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
