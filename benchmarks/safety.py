"""What it costs to survive anything: the supervisor, charging, storms and long replays."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from random import Random
from time import perf_counter
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

from benchmarks.measure import (
    Effort,
    Measurement,
    at_most,
    best_of,
    need,
    processor_seconds_for,
    ratio_of_bests,
    seconds_for,
    summed_up,
)
from benchmarks.subjects import solution_of
from logical_robots_tui import load_level
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.mind.sqlite import registry
from tests.e2e.test_supervisor import playing, type_hello
from tests.memory_use import memory_use
from tests.terminal import Terminal
from tests.tui.terminal.test_flood import ONE_FRAME
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager

    from logical_robots_tui import Level, Program
    from logical_robots_tui.mind.sqlite.budget import AggregateFunction, MeteredWork

__all__ = ["safety"]

LEVELS = {
    "01-first-steps": 300,
    "07-station-management": 150,
    "10-distributed-mapping": 60,
    "13-swarm": 12,
}
"""Ticks that are measured of each."""

STARTS = """
from time import perf_counter
import logical_robots_tui
began = perf_counter()
from logical_robots_tui import supervisor
status = supervisor._supervise()
if status is None:
    print(1000 * (perf_counter() - began))
"""
"""What the command does before it loads the game."""

GETS_STUCK = """
import sys
from logical_robots_tui import supervisor
supervise = supervisor._supervise
def get_stuck(self):
    str(10**10**9)
def supervise_what_gets_stuck():
    status = supervise()
    if status is None:
        from logical_robots_tui.tui.app.app import LogicalRobotsApp
        LogicalRobotsApp.action_interrupt = get_stuck
    return status
supervisor._supervise = supervise_what_gets_stuck
sys.exit(supervisor.main())
"""
STORMS = {"60 sizes": 4, "200 mouse events": 3}
LONG = 100_000  # ticks of a replay


def safety(effort: Effort) -> Iterator[Measurement]:
    """Measure what protection costs, and how long it takes when it is needed."""
    need("/proc", Path("/proc/self/status").exists())
    target = at_most(5)
    yield best_of("supervisor", "at the start", "ms", effort.repeats, _start, target=target)
    yield from _charging(effort)
    with tempfile.TemporaryDirectory() as folder:
        yield from _storms(Path(folder))
        yield _long_replay(Path(folder))
        if not effort.is_quick:
            yield from _stuck(Path(folder))


def _start() -> float:
    as_installed = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    command = [sys.executable, "-c", STARTS]
    done = subprocess.run(
        command, env=as_installed, capture_output=True, check=True, timeout=PATIENCE
    )
    return float(done.stdout)


def _charging(effort: Effort) -> Iterator[Measurement]:
    """Ticks by turns with charging and without."""
    for name, ticks in LEVELS.items():
        level, program = load_level(name), solution_of(name)
        charged, free = [], []
        for _ in range(2 * effort.repeats + 2):
            charged.append(_seconds(level, program, ticks))
            with _uncharged():
                free.append(_seconds(level, program, ticks))
        subject = f"ticks, {name}"
        yield ratio_of_bests("charging", subject, "times", charged, free, target=at_most(1.02))


def _seconds(level: Level, program: Program, ticks: int) -> float:
    return processor_seconds_for(partial(play_through, level, program, ticks))


def _uncharged() -> AbstractContextManager[object]:
    """Register functions and aggregates as they are, but for what null in means."""

    def function(
        call: Callable[..., Any], _: MeteredWork, *, null_safe: bool = False, **__: object
    ) -> Callable[..., Any]:
        if not null_safe:
            return call
        return lambda *arguments: None if None in arguments else call(*arguments)

    def aggregate(make: Callable[[], AggregateFunction], _: MeteredWork) -> AggregateFunction:
        return make()

    return patch.multiple(registry, charged=function, ChargedAggregate=aggregate)


def _storms(folder: Path) -> Iterator[Measurement]:
    """Seconds from the end of a storm to the answer to a key."""
    command = [sys.executable, "-m", "logical_robots_tui", "play", "04-everybody-home"]
    found = Random(30)
    for what, times in STORMS.items():
        seconds = []
        for number in range(times):
            data = folder / f"{what} {number}"
            with Terminal([*command, "--data-dir", data], size=(100, 30)) as terminal:
                terminal.wait_for("· applied")
                terminal.send(" ")
                terminal.wait_for("RUNNING")
                for _ in range(int(what.split()[0])):
                    if "sizes" in what:
                        terminal.resize(found.randint(1, 240), found.randint(1, 80))
                    else:
                        # Pressed outside of the screen only, so that no dialog takes the key.
                        button = found.choice((0, 32, 35, 64))
                        place = found.randint(101 if button == 0 else 1, 400)
                        terminal.send(f"\x1b[<{button};{place};{found.randint(0, 400)}M")
                    terminal.read_for(ONE_FRAME)
                terminal.resize(100, 30)
                began = perf_counter()
                terminal.send("?")
                came = terminal.arrival_of(lambda: "letters filter" in terminal.text)
                seconds.append(came - began)
        subject = f"{times} of {what}, until it answers"
        yield summed_up("storm", subject, "s", seconds, value=max)


def _long_replay(folder: Path) -> Measurement:
    """Seconds of `replay show` on the longest replay that there may be."""
    program, path = folder / "still.l", folder / "long.replay"
    program.write_text(
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, "
        'memory: "") :- Sensor(robot_name:);\n'
    )
    robots = [sys.executable, "-m", "logical_robots_tui", "replay"]
    run = partial(subprocess.run, check=True, capture_output=True, timeout=10 * PATIENCE)
    run([*robots, "record", "01-first-steps", program, "-o", path, "--ticks", str(LONG)])
    show = partial(run, [*robots, "show", path])
    subject = f"{LONG:,} ticks"
    return summed_up("replay show", subject, "s", [seconds_for(show)], target=at_most(10))


def _stuck(folder: Path) -> Iterator[Measurement]:
    """Memory of the supervisor, and seconds from the key that makes a game stuck to the shell."""
    with playing(folder, ["-c", GETS_STUCK]) as terminal:
        type_hello(terminal)
        held = memory_use(terminal.process.pid) / 1e6
        yield summed_up("supervisor", "memory", "MB", [held], target=at_most(12))
        terminal.send("\x03")
        seconds = seconds_for(terminal.finish)
    subject = "until it is ended and the terminal is back"
    yield summed_up("stuck game", subject, "s", [seconds], target=at_most(20))
