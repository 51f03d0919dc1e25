"""A small laboratory for tests: experiments, classes, and what their folders hold."""

import csv
import os
import signal
import sqlite3
import subprocess
import sys
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path

from logical_robots_tui.lab import running
from logical_robots_tui.lab.tasks import RunTask, WorkerAnswer
from logical_robots_tui.paths import shipped_folder
from tests.waiting import PATIENCE, until

FIRST_STEPS = Path(__file__).with_name("first.l").read_text("utf-8")

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

LANE = Path(__file__).with_name("lane.toml").read_text("utf-8")
SENSOR = "Sensor(robot_name:, sensor:)"
STILL = "Robot(robot_name:, desire: {{left_engine: {}, right_engine: 0}}, memory: {}) :- {};"
STANDING = STILL.format("0", '""', SENSOR)
ENDLESS = "N(x) :- x in Range(3000);\n" + STILL.format("Sum{x * y :- N(x), N(y)}", '""', SENSOR)


def lane(title: str) -> str:
    return LANE.replace("A lane", title)


def program_text(name: str) -> str:
    return (shipped_folder("programs") / f"{name}.l").read_text("utf-8")


def write_experiment(
    folder: Path, *, values: Sequence[float] = (20, 40), starts: int = 1, ticks: int = 60
) -> Path:
    (folder / "first.l").write_text(FIRST_STEPS, "utf-8")
    file = folder / "experiment.toml"
    file.write_text(EXPERIMENT.format(values=list(values), starts=starts, ticks=ticks), "utf-8")
    return file


def write_files(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder


def page_of(folder: Path) -> str:
    page = (folder / "report.html").read_text("utf-8")
    for outside in ("<script", "href=", "src=", "@import", "url("):
        assert outside not in page
    return page


def exported(folder: Path) -> dict[str, bytes]:
    """All exported files of a folder: everything but the ledger, the lock and the report."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.name.startswith((".", "ledger.db"))
    }


def recorded(folder: Path) -> int:
    try:
        with closing(sqlite3.connect(f"file:{folder}/ledger.db?mode=ro", uri=True)) as ledger:
            (count,) = ledger.execute("SELECT count(*) FROM results").fetchone()
    except sqlite3.Error:
        return 0
    return int(count)


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8-sig", newline="") as lines:
        return list(csv.DictReader(lines))


class InlineEngine:
    """An engine that executes a task in this process when its answer is waited for.

    A task that would end its worker gets the answer that a dead worker's task gets.
    """

    def __init__(self, slots: int) -> None:
        self.slots = slots
        self._tasks: deque[tuple[object, RunTask]] = deque()

    @property
    def free(self) -> int:
        return self.slots - len(self._tasks)

    def submit(self, key: object, task: RunTask) -> None:
        self._tasks.append((key, task))

    def wait(self, seconds: float) -> Iterator[tuple[object, WorkerAnswer]]:
        key, task = self._tasks.popleft()
        died = WorkerAnswer(failure="its worker process died")
        yield key, died if is_deadly(task) else running.execute(task)

    def close(self, *, at_once: bool = False) -> None:
        """Nothing to end."""


class Background:
    def __init__(self, *arguments: object) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "logical_robots_tui", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def workers(self) -> list[int]:
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
        workers = self.workers()
        self.process.kill()
        self.process.communicate(timeout=PATIENCE)
        until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in workers))

    def interrupt(self) -> None:
        os.killpg(self.process.pid, signal.SIGINT)

    def finish(self) -> tuple[int, str]:
        said, _ = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, said


def killed(out: Path, arguments: Sequence[object], workers: Sequence[int]) -> list[int]:
    """Begin a work and go on with it, each time killing it; return the counts of its results."""
    counts = [recorded(out)]
    words = (*arguments, "-o", out)
    for number in workers:
        running = Background(*words, "--workers", number)
        until(lambda: recorded(out) > counts[-1])
        running.kill()
        counts.append(recorded(out))
        words = ("lab", "resume", out)
    return counts[1:]


def endless(task: RunTask) -> WorkerAnswer:
    """Execute a task, but compute for ever if the program says so."""
    while "# endless" in "".join(task.programs.values()):
        pass
    return running.execute(task)


def is_deadly(task: RunTask) -> bool:
    text = "".join(task.programs.values())
    return any(f"# deadly from {start};" in text for start in task.starts)


def deadly(task: RunTask) -> WorkerAnswer:
    """Execute a task, but end the worker at a start of which the program says so."""
    if is_deadly(task):
        os._exit(9)
    return running.execute(task)
