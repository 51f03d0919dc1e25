"""A small laboratory for tests: experiments, classes, and what their folders hold."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.lab import running
from logical_robots_tui.paths import shipped_folder
from tests.waiting import PATIENCE, until

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.lab.running import Answer, Task

__all__ = [
    "Background",
    "deadly",
    "endless",
    "exported",
    "program_text",
    "recorded",
    "start",
    "write_experiment",
]

FIRST_STEPS = """
# The number is what is varied.
Near() = 40;  # Near() = 1;
Drive(distance) = (
  if distance < Near() then {left_engine: 0.8, right_engine: -0.8}
  else if distance < 90 then {left_engine: 0.8, right_engine: 0.6}
  else {left_engine: 0.8, right_engine: 0.8}
);
Robot(robot_name:, desire: Drive(sensor.forward_distance), memory: "") :-
  Sensor(robot_name:, sensor:);
"""

EXPERIMENT = """
[experiment]
level = "01-first-steps"
program = "first.l"
starts = {starts}
ticks = {ticks}
[[vary]]
constant = "Near"
values = {values}
"""


def program_text(name: str) -> str:
    """The text of a shipped program."""
    return (shipped_folder("programs") / f"{name}.l").read_text("utf-8")


def write_experiment(
    folder: Path, *, values: Sequence[float] = (20, 40), starts: int = 1, ticks: int = 60
) -> Path:
    """Write an experiment and its program into a folder; return its file."""
    (folder / "first.l").write_text(FIRST_STEPS, "utf-8")
    file = folder / "experiment.toml"
    text = EXPERIMENT.format(values=list(values), starts=starts, ticks=ticks)
    file.write_text(text, "utf-8")
    return file


def exported(folder: Path) -> dict[str, bytes]:
    """All exported files of a folder: everything but the ledger, the lock and the report."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.name.startswith((".", "ledger.db"))
    }


def recorded(folder: Path) -> int:
    """The number of results in a ledger, which another process may be writing."""
    try:
        with closing(sqlite3.connect(f"file:{folder}/ledger.db?mode=ro", uri=True)) as ledger:
            (count,) = ledger.execute("SELECT count(*) FROM results").fetchone()
    except sqlite3.Error:
        return 0
    return int(count)


class Background:
    """The command in a process of its own, in a session of its own."""

    def __init__(self, *arguments: object) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "logical_robots_tui", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def workers(self) -> list[int]:
        """The identities of its worker processes."""
        found = []
        for process in Path("/proc").iterdir():
            if not process.name.isdigit():
                continue
            try:
                stat = (process / "stat").read_text().rpartition(")")[2].split()
                command = (process / "cmdline").read_bytes()
            except OSError:
                continue
            if int(stat[1]) == self.process.pid and b"spawn_main" in command and stat[0] != "Z":
                found.append(int(process.name))
        return found

    def kill(self) -> None:
        """Kill it, and wait until none of its workers is left."""
        workers = self.workers()
        self.process.kill()
        self.process.communicate(timeout=PATIENCE)
        until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in workers))

    def interrupt(self) -> None:
        """Type ^C: all processes of the terminal get it."""
        os.killpg(self.process.pid, signal.SIGINT)

    def finish(self) -> tuple[int, str]:
        """Wait for its end; return its exit status and what it has said."""
        said, _ = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, said


def start(*arguments: object) -> Background:
    """Start the command in a process of its own."""
    return Background(*arguments)


def endless(task: Task) -> Answer:
    """Execute a task, but compute for ever if the program says so."""
    while "# endless" in "".join(task.programs.values()):
        pass
    return running.execute(task)


def deadly(task: Task) -> Answer:
    """Execute a task, but end the worker at a start of which the program says so."""
    if any(f"# deadly from {start};" in "".join(task.programs.values()) for start in task.starts):
        os._exit(9)
    return running.execute(task)
