"""Over a real sshd: traffic, key latency on slow lines, and processor use."""

from __future__ import annotations

import os
import shlex
import statistics
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path
from shutil import which
from time import perf_counter, process_time
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, at_most, need, summed_up
from benchmarks.subjects import program_text, rows_of
from logical_robots_tui import Program
from logical_robots_tui.editing.files import save_level
from logical_robots_tui.game import Pace
from logical_robots_tui.mind import Mind
from tests.crowd import Crowd
from tests.sshd import SSHD, Line, Server
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui import Level

__all__ = ["SIX_ROBOTS", "SIZE", "need_openssh", "processor", "running", "ssh"]

SIZE = (120, 40)
SIX_ROBOTS = ("10-distributed-mapping", "distributed-mapping")
RATES = ((20_000, 300), (64_000, 100))  # bytes a second, milliseconds that a key may take
PRESSES = 12


def ssh(effort: Effort) -> Iterator[Measurement]:
    """Measure kilobytes per second plain and compressed, and key latency on slow lines."""
    need_openssh()
    seconds = effort.ticks / 150
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with Server(folder, f"SetEnv LOGICAL_ROBOTS_CACHE_DIR={folder}/cache") as server:
            for option, allowed in (("-q", 100), ("-C", 25)):
                with Line(server.port) as line, running(server, line, folder, option) as terminal:
                    before, began = line.traffic, perf_counter()
                    terminal.read_for(seconds)
                    rate = (line.traffic - before) / 1000 / (perf_counter() - began)
                    how = "compressed" if option == "-C" else "plain"
                    subject = f"120x40, 6 robots, {how}"
                    yield summed_up("over ssh", subject, "kB/s", [rate], target=at_most(allowed))
            for limit, milliseconds in RATES:
                with (
                    Line(server.port, limit) as line,
                    running(server, line, folder, "-q") as terminal,
                ):
                    terminal.send("2")
                    terminal.wait_for("Leave")
                    found = Crowd([terminal]).key_milliseconds(PRESSES)
                    subject = f"{limit // 1000} kB/s, 6 robots running"
                    target = at_most(milliseconds)
                    yield summed_up("key over ssh", subject, "ms", found, target=target)


def need_openssh() -> None:
    """Skip the benchmark where a program of OpenSSH is missing."""
    for name, path in (("sshd", SSHD), *((name, which(name)) for name in ("ssh", "ssh-keygen"))):
        need(name, path)


@contextmanager
def running(server: Server, line: Line, folder: Path, option: str) -> Iterator[Terminal]:
    """Run six robots at the other end of a line."""
    game = [sys.executable, "-m", "logical_robots_tui", "play", *SIX_ROBOTS]
    # A separate folder, because a game that was cut off offers to continue.
    command = shlex.join([*game, "--data-dir", str(folder / f"data-{line.port}")])
    with Terminal([*server.client("-t", option, port=line.port), command], size=SIZE) as terminal:
        terminal.wait_for("· applied")
        terminal.send(" ")
        terminal.wait_for("RUNNING")
        yield terminal


def processor(effort: Effort) -> Iterator[Measurement]:
    """Measure the percentage of a core that a game of ten robots uses, paused and running."""
    need("/proc", Path("/proc/self/stat").exists())
    seconds = effort.ticks / 150
    level, text = halls(1200, 700, robots=10, beacons=56), program_text("steering")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_level(level, folder / "ten.toml", replace_all=True)
        (folder / "steering.l").write_text(text, encoding="utf-8")
        game = [sys.executable, "-m", "logical_robots_tui", "play", folder / "ten.toml"]
        with Terminal(
            [*game, folder / "steering.l", "--data-dir", folder / "data"], size=SIZE
        ) as terminal:
            terminal.wait_for("· applied")
            terminal.wait_for_quiet()
            paused = _percent(terminal, seconds)
            terminal.send(" ")
            terminal.wait_for("RUNNING")
            running = _percent(terminal, seconds)
    speed = Pace().speed or 0.0  # the default
    thinking = 100 * speed * _thought_seconds(level, text, effort.ticks)
    for state, percent, target in (
        ("paused", paused, at_most(1)),
        ("running, with thinking", running, None),
        ("running, without thinking", running - thinking, at_most(50)),
    ):
        subject = f"120x40, 10 robots, {state}"
        yield summed_up("processor", subject, "% of a core", [percent], target=target)


def _thought_seconds(level: Level, text: str, ticks: int) -> float:
    """Return the median processor seconds of a think of all robots."""
    mind = Mind(Program.compile(text), level.visibility.memory, level.visibility.sensor)
    rows, found = rows_of(level), []
    for _ in range(ticks):
        began = process_time()
        mind.think(rows, {})
        found.append(process_time() - began)
    mind.close()
    return statistics.median(found)


def _percent(terminal: Terminal, seconds: float) -> float:
    before, began = _computed(terminal.game), perf_counter()
    terminal.read_for(seconds)
    return 100 * (_computed(terminal.game) - before) / (perf_counter() - began)


def _computed(pid: int) -> float:
    """Return the processor seconds of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
