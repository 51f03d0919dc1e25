"""The laboratory: its overhead over the bare loop, its workers, and a class."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median
from time import perf_counter, process_time
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_least, at_most, summed_up
from logical_robots_tui.game.measuring import play_through, start_of
from logical_robots_tui.lab.coordinating import Coordinator
from logical_robots_tui.lab.engines import LocalEngine
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.lab.running import execute
from logical_robots_tui.lab.sweeping import plan_sweep
from logical_robots_tui.lab.tasks import RunTask, fingerprint
from logical_robots_tui.mind import Program
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import load_level
from tests.memory_use import memory_use

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.lab.folder import Manifest

__all__ = ["laboratory"]

STARTS = 6
LEVELS = ("01-first-steps", "07-station-management", "10-distributed-mapping")
CLASS = (
    "01-first-steps",
    "02-open-space",
    "03-the-long-hall",
    "04-everybody-home",
    "05-lighthouse",
)
STUDENTS = 30
WINNERS = 15
_THINKS = "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: {m: %s}) :- %s;\n"
_SENSES = "Sensor(robot_name:, sensor:)"
_MEMORY = 'Coalesce(memory.m, "ab")'
TROUBLES = (
    _THINKS % (1, "Snesor(robot_name:)"),
    _THINKS % ("1 +", _SENSES),
    "\x00\x01PK\x03\x04" * 99,
    "N(x) :- x in Range(300);\n" + _THINKS % ("Sum{x * y :- N(x), N(y)} + sensor.clock", _SENSES),
    "N(x) :- x in Range(9000);\n" + _THINKS % ("Sum{a * b * c :- N(a), N(b), N(c)}", _SENSES),
    _THINKS % (f"{_MEMORY} ++ {_MEMORY}", f"{_SENSES}, Memory(robot_name:, memory:)"),
)
"""Programs of a fifth of a class: three don't compile, and the others are slow or hostile."""

_REMARK = "# {}\nBy_{}() = {};\n"  # so that no two are the same


def laboratory(effort: Effort) -> Iterator[Measurement]:
    """Measure overhead, the gain by a second worker, memory, and a class of thirty."""
    for level in LEVELS:
        yield from _overhead(level, effort)
    yield from _workers(effort)
    yield _memory(20 if effort.is_quick else 10_000)
    if not effort.is_quick:
        yield from _class()


def _overhead(name: str, effort: Effort) -> Iterator[Measurement]:
    """Compare the runs of a task with the bare loop of world and mind, by turns."""
    level = load_level(name)
    text = (shipped_folder("programs") / f"{level.solution}.l").read_text("utf-8")
    program = Program.compile(text)
    source = Path(level.source).read_text("utf-8")
    ticks, starts = 2 * effort.ticks, tuple(range(STARTS))
    task = RunTask(source, {"": text}, ticks, starts, (), 100_000_000, 600.0, False, fingerprint())
    ratios = []
    for _ in range(effort.repeats + 1):
        began = process_time()
        for start in starts:
            play_through(start_of(level, start), program, ticks)
        bare = process_time() - began
        began = process_time()
        execute(task)
        ratios.append(100 * ((process_time() - began) / bare - 1))
    yield summed_up("laboratory", f"overhead, {name}", "%", ratios[1:], target=at_most(3))


def _experiment(folder: Path, starts: int, ticks: int) -> Path:
    file = folder / "experiment.toml"
    file.write_text(
        '[experiment]\nlevel = "01-first-steps"\nprogram = ["first-steps", "wall-crawler"]\n'
        f"starts = {starts}\nticks = {ticks}\n"
    )
    return file


def _seconds(plan: tuple[Manifest, dict[str, str]], out: Path, workers: int) -> float:
    """Return the seconds of all runs, with the start of the worker processes."""
    folder, engine = Folder(out), LocalEngine(workers)
    with folder.lock(), folder.ledger() as ledger:
        manifest = folder.write(*plan)
        coordinator = Coordinator(folder, manifest, ledger)
        began = perf_counter()
        coordinator.work(engine, lambda: False, lambda: None)
        seconds = perf_counter() - began
        assert coordinator.tally().is_complete
    engine.close()
    return seconds


def _workers(effort: Effort) -> Iterator[Measurement]:
    """Compare two workers with one, on work that takes one worker about a minute."""
    starts, ticks = (7, 200) if effort.is_quick else (127, 1_500)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plan = plan_sweep(_experiment(folder, starts, ticks))
        one, two = (_seconds(plan, folder / f"out-{n}", n) for n in (1, 2))
    subject = "two workers against one"
    yield summed_up("laboratory", subject, "times", [one / two], target=at_least(1.9))


def _memory(runs: int) -> Measurement:
    """Return the memory of a worker after many short runs."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        peak = pool.submit(_peak_after, runs).result()
    subject = f"a worker after {runs:,} runs"
    return summed_up("laboratory", subject, "MB", [peak], target=at_most(200))


def _peak_after(runs: int) -> float:
    """Return the megabytes that this process takes after so many runs of several programs."""
    level = (shipped_folder("levels") / "05-lighthouse.toml").read_text("utf-8")
    text = (shipped_folder("programs") / "lighthouse.l").read_text("utf-8")
    for first in range(0, runs, 20):
        # Each twenty runs are another submission.
        program = text + _REMARK.format(first, first, first)
        starts = tuple(range(first, min(first + 20, runs)))
        while starts:
            programs = {"": program}
            task = RunTask(level, programs, 5, starts, (), 100_000_000, 600.0, False, fingerprint())
            starts = starts[len(execute(task).results) :]
    return memory_use("self") / 1e6


def _class() -> Iterator[Measurement]:
    """Grade a class of thirty in five levels from 21 starts, and the class without its troubles.

    Raises AssertionError if what one and two workers export is not the same.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write_class(folder)
        calm = _graded(folder, "calm", 1)
        for number, text in enumerate(TROUBLES):
            _hand_in(folder, f"trouble-{number}", text)
        all_of_them = _graded(folder, "one", 1)
        _graded(folder, "two", 2)
        one, two = (_exported(folder / out) for out in ("one", "two"))
        assert one == two
        with Folder(folder / "one").ledger() as ledger:
            results = list(ledger.results().values())
    ticks = sum(result.ticks for result in results)
    subject = f"{STUDENTS} students, {len(CLASS)} levels, 21 starts"
    ratio = all_of_them / calm
    yield summed_up("laboratory", f"{subject}, one worker", "s", [all_of_them])
    yield summed_up(
        "laboratory", f"{subject}, against without a fifth", "times", [ratio], target=at_most(1.1)
    )
    yield summed_up("laboratory", f"{subject}, runs", "", [len(results)])
    yield summed_up("laboratory", f"{subject}, runs per core", "/s", [len(results) / all_of_them])
    yield summed_up("laboratory", f"{subject}, ticks per core", "/s", [ticks / all_of_them])
    won = [result.ticks for result in results if result.outcome == "won"]
    lost = [result.ticks for result in results if result.outcome != "won"]
    yield summed_up("laboratory", f"{subject}, ticks of a run won", "", [median(won)])
    yield summed_up("laboratory", f"{subject}, ticks of a run lost", "", [median(lost)])


def _graded(folder: Path, out: str, workers: int) -> float:
    """Grade as the command does, and return the processor seconds that it took."""
    command = (
        f"-m logical_robots_tui grade assignment.toml submissions -o {out} --workers {workers}"
    )
    before = getrusage(RUSAGE_CHILDREN)
    status = subprocess.run(
        [sys.executable, *command.split()], cwd=folder, check=False, timeout=7_200
    ).returncode
    after = getrusage(RUSAGE_CHILDREN)
    assert status == 0, status
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _exported(out: Path) -> dict[str, bytes]:
    """Return all that a person or another program reads, by path."""
    kept = ("ledger.db", "manifest.json")
    files = (path for path in out.rglob("*") if path.is_file() and not path.name.startswith(kept))
    return {str(path.relative_to(out)): path.read_bytes() for path in files}


def _write_class(folder: Path) -> None:
    """Write an assignment and the submissions of those who cause no trouble."""
    levels = "".join(f'[[level]]\nname = "{name}"\n' for name in CLASS)
    (folder / "assignment.toml").write_text(f"[assignment]\nstarts = 20\n{levels}")
    for number in range(STUDENTS - len(TROUBLES)):
        for name in CLASS:
            level = load_level(name)
            program = level.solution if number < WINNERS else level.starter
            text = (shipped_folder("programs") / f"{program}.l").read_text("utf-8")
            _hand_in(folder, f"student-{number}/{name}", text + _REMARK.format(*[number] * 3))


def _hand_in(folder: Path, name: str, text: str) -> None:
    file = folder / "submissions" / f"{name}.l"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
