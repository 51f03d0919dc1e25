"""What the tests cost: processor seconds by folder, and bounds for what costs most.

Processor time is told and not asserted; what is bounded is how often a quick run does what is
expensive, which is the same on every machine.
"""

import os
import resource
import subprocess
from collections import Counter, defaultdict
from collections.abc import Callable, Generator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from _pytest.terminal import TerminalReporter

from logical_robots_tui.mind.compilation import _Compiler
from logical_robots_tui.world import World
from tests.changed import CACHE_KEY
from tests.memory_use import descendants

__all__ = ["BOUNDS", "Bound", "Costs", "folder_of", "register"]

SLOWEST = 6
"""Folders named at the end of a run."""

_TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Bound:
    """How often a whole quick run may do something, and why that is bounded."""

    most: int
    reason: str


BOUNDS = {
    "apps opened": Bound(200, "each lays out the whole screen, for 60 to 80 ms"),
    "Pythons started": Bound(110, "an interpreter that loads the game takes 150 to 250 ms"),
    "ticks played": Bound(120_000, "a tick of a few robots takes 1 ms, one of a swarm 10 to 20"),
    "programs compiled": Bound(1_700, "a small one takes 22 ms, the longest of ours 1.3 s"),
}
"""What costs time in a quick run; who lowers a number of the run lowers its bound."""


def folder_of(test: str) -> str:
    """Return the folder of a test under `tests/`, for `tests/tui` the one below it."""
    parts = test.partition("::")[0].split("/")[1:-1]
    return "/".join(parts[: 2 if parts[:1] == ["tui"] else 1]) or "."


def register(config: pytest.Config, *, is_quick: bool) -> None:
    """Measure each test in the process that runs it, and sum up in the one that reports."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Costs(config, is_quick=is_quick), "costs")
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        config.pluginmanager.register(_Meter(), "meter")


class _Meter:
    """Adds to the report of each test what it has cost and counted."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()
        self._processor_seconds = 0.0
        self._patches = pytest.MonkeyPatch()

    def pytest_sessionfinish(self) -> None:
        self._patches.undo()

    def pytest_sessionstart(self) -> None:
        from textual.app import App

        self._count(App, "run_test", "apps opened")
        self._count(subprocess.Popen, "__init__", "Pythons started", _starts_python)
        self._count(World, "act", "ticks played")
        self._count(_Compiler, "_compute", "programs compiled")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_finish(self) -> None:
        self._processor_seconds = _processor_seconds()

    def _count(
        self, owner: type, name: str, what: str, counts: Callable[..., bool] = lambda *_: True
    ) -> None:
        function: Callable[..., Any] = getattr(owner, name)

        def counted(*args: Any, **options: Any) -> Any:
            self._counts[what] += counts(*args)
            return function(*args, **options)

        self._patches.setattr(owner, name, counted)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        report = yield
        if call.when == "teardown":
            now = _processor_seconds()
            report.user_properties.append(("cost", now - self._processor_seconds))
            report.user_properties += self._counts.items()
            self._processor_seconds = now
            self._counts.clear()
        return report


def _starts_python(_: object, command: object, *__: object) -> bool:
    words = command if isinstance(command, list | tuple) else [command]
    return "python" in Path(str(words[0])).name


def _processor_seconds() -> float:
    """Return the processor time of this process and all below it, also of those that have ended."""
    ended = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in ended) + sum(
        map(_of_process, descendants(os.getpid()))
    )


def _of_process(pid: int) -> float:
    """Return the processor time of a process and of its children that have ended."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:15])) / _TICKS_PER_SECOND


class Costs:
    """Sums up what the tests of a run have cost, and fails a quick run that does too much."""

    def __init__(self, config: pytest.Config, *, is_quick: bool) -> None:
        self._config = config
        self._is_quick = is_quick
        self.by_test: dict[str, float] = {}
        self.counts: dict[str, Counter[str]] = {name: Counter() for name in BOUNDS}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when != "teardown":
            return
        for name, value in report.user_properties:
            if name == "cost":
                self.by_test[report.nodeid] = float(str(value))
            elif name in BOUNDS:
                self.counts[name][report.nodeid.partition("::")[0]] += int(str(value))

    @property
    def excesses(self) -> list[str]:
        excesses: list[str] = []
        if not self._is_quick:
            return excesses
        for name, bound in BOUNDS.items():
            files = self.counts[name]
            if files.total() > bound.most:
                most = ", ".join(f"{file} {count:,}" for file, count in files.most_common(SLOWEST))
                count = f"{files.total():,} {name}, more than {bound.most:,}"
                excesses.append(f"{count}: {bound.reason}. Most in {most}")
        return excesses

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        cache: pytest.Cache | None = getattr(self._config, "cache", None)
        if cache is not None and self.by_test:
            costs = {test: round(seconds, 3) for test, seconds in self.by_test.items()}
            cache.set(CACHE_KEY, {**cache.get(CACHE_KEY, {}), **costs})
        if session.exitstatus == pytest.ExitCode.OK and self.excesses:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: TerminalReporter) -> None:
        by_folder: dict[str, float] = defaultdict(float)
        for test, seconds in self.by_test.items():
            by_folder[folder_of(test)] += seconds
        folders = sorted(by_folder, key=by_folder.__getitem__, reverse=True)[:SLOWEST]
        slowest = ", ".join(f"{folder} {by_folder[folder]:.0f}" for folder in folders)
        terminalreporter.write_line(
            f"processor seconds: {sum(by_folder.values()):.0f}; slowest folders: {slowest}"
        )
        for excess in self.excesses:
            terminalreporter.write_line(f"A quick run does too much: {excess}", red=True)
