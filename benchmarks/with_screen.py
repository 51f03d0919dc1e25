"""Running with a screen in a real pseudo-terminal: speed, key latency, traffic."""

from __future__ import annotations

import re
import statistics
import sys
import tempfile
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_least, at_most, summed_up
from benchmarks.whole_game import ticks_per_second
from logical_robots_tui import Program, load_level
from logical_robots_tui.game import load_program
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["SIZE", "opened", "traffic", "with_screen"]

SIZE = (120, 40)
LEVEL, PROGRAM = "02-open-space", "open-space-starter"  # never wins
FIRST = "Freedom(radar)"  # the text at the editor's cursor
FASTEST = 12  # presses of "faster" that reach full speed
TRAFFIC = (
    ("07-station-management", "station-management", "3 robots", (120, 40), 60),
    ("10-distributed-mapping", "distributed-mapping", "6 robots", (120, 40), 100),
    ("07-station-management", "station-management", "3 robots", (80, 24), 30),
)
"""Level, program, robots, screen size, and the most kB per second."""
QUIET = 0.5  # seconds without output, after which a paused game has nothing more to say
SECONDS = 0.0025  # of running, for each repeat and each tick that is to be measured


def with_screen(effort: Effort) -> Iterator[Measurement]:
    """Measure the speed relative to that without a screen, and ms from key to screen."""
    level, program = load_level(LEVEL), Program.compile(load_program(PROGRAM).text)
    seconds = SECONDS * effort.ticks
    shares, keys = [], []
    for _ in range(min(2, effort.repeats)):
        alone = ticks_per_second(level, program, seconds)
        with _running() as terminal:
            shares.append(100 * _ticks_per_second(terminal, seconds) / alone)
            keys += _key_milliseconds(terminal, max(6, effort.ticks // 25))
    group, subject = "with a screen", f"{SIZE[0]}x{SIZE[1]}, 1 robot, flat out"
    yield summed_up(group, subject, "% of without", shares, target=at_least(70))
    yield summed_up("key to screen, p99", subject, "ms", keys, value=_p99, target=at_most(50))


def traffic(effort: Effort) -> Iterator[Measurement]:
    """Measure the kB per second that a running and a paused game send to the terminal."""
    seconds = SECONDS * effort.ticks
    for level, program, robots, size, allowed in TRAFFIC:
        with opened(level, program, size) as terminal:
            terminal.send(" ")
            terminal.wait_for("RUNNING")
            running = _kilobytes_per_second(terminal, seconds)
            terminal.send(" ")
            terminal.wait_for("PAUSED")
            terminal.wait_for_quiet(QUIET)
            paused = _kilobytes_per_second(terminal, seconds)
        columns, rows = size
        for state, found, most in (("running", running, allowed), ("paused", paused, 0)):
            subject = f"{columns}x{rows}, {robots}, {state}"
            yield summed_up("traffic", subject, "kB/s", [found], target=at_most(most))


def _p99(values: Sequence[float]) -> float:
    return statistics.quantiles(values, n=100)[98]


def _kilobytes_per_second(terminal: Terminal, seconds: float) -> float:
    """Return the rate of output over a time."""
    terminal.read_for(0.0)
    before, began = terminal.traffic, perf_counter()
    terminal.read_for(seconds)
    return (terminal.traffic - before) / 1000 / (perf_counter() - began)


@contextmanager
def opened(level: str, program: str, size: tuple[int, int] = SIZE) -> Iterator[Terminal]:
    """Open the game in a terminal, with the focus in the labyrinth."""
    with tempfile.TemporaryDirectory() as data_dir:
        game = [sys.executable, "-m", "logical_robots_tui", "play", level, program]
        with Terminal([*game, "--data-dir", data_dir], size=size) as terminal:
            terminal.wait_for("· applied")
            terminal.wait_for_quiet()
            yield terminal


@contextmanager
def _running() -> Iterator[Terminal]:
    """Run the game in a terminal at full speed, with the focus in the editor."""
    with opened(LEVEL, PROGRAM, SIZE) as terminal:
        terminal.send("+" * FASTEST)
        terminal.wait_for("flat out")
        terminal.send("1 ")
        terminal.wait_for("RUNNING")
        terminal.send("2")
        terminal.wait_for("Leave")
        yield terminal


def _ticks_per_second(terminal: Terminal, seconds: float) -> float:
    first, began = _tick(terminal), perf_counter()
    terminal.wait_for(lambda: perf_counter() - began > seconds)
    return (_tick(terminal) - first) / (perf_counter() - began)


def _tick(terminal: Terminal) -> int:
    found = re.search(r"tick (\d+)", terminal.text)
    assert found, terminal.text
    return int(found[1])


def _key_milliseconds(terminal: Terminal, presses: int) -> list[float]:
    """Type and delete single letters."""
    row, line = next((y, line) for y, line in enumerate(terminal.screen.display) if FIRST in line)
    column = line.index(FIRST)
    found = []
    for press in range(presses):
        key, shown = ("x", "x") if press % 2 == 0 else ("\x7f", FIRST[0])
        terminal.read_for(0.1)  # leaves no unread output when the key is pressed
        began = perf_counter()
        terminal.send(key)
        came = terminal.arrival_of(lambda: terminal.screen.buffer[row][column].data == shown)  # noqa: B023 - called in this turn only
        found.append(1000 * (came - began))
    return found
