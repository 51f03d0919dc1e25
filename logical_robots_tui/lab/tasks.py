"""What a coordinator and its workers exchange: tasks, results, and the versions that made them."""

from __future__ import annotations

import hashlib
import platform
import sqlite3
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

import msgspec

from logical_robots_tui.game.run import simulation_digest
from logical_robots_tui.mind import Diagnostic

Outcome: TypeAlias = Literal[
    "won",
    "out of ticks",
    "played",
    "stopped",
    "nothing changes",
    "too many steps",
    "too slow",
    "does not compile",
    "infrastructure",
]
"""How a run ended: `played` to the end of a match, `stopped` because a query held;
`infrastructure` could not be done."""


Reduction: TypeAlias = Literal["last", "min", "max", "mean", "sum"]


class QueryMeasure(msgspec.Struct, frozen=True):
    """A query that is a measure, every so many ticks, in the first and in the last one.

    0 means in the last one only. `reduce` are the ways to make one number of many.
    """

    name: str
    query: str
    every: int
    reduce: tuple[Reduction, ...] = ()


class RunTask(msgspec.Struct, frozen=True):
    """Runs in one level, of texts of programs by team, "" if all robots think alike.

    Start 0 is the given one; if `given_first`, a program that does not win from it is done. A
    think has `steps` at most, a run `seconds` of a processor, and `run_steps` unless that is 0;
    it ends when the question `until` holds, if there is one. If `is_explained`, the result from
    the given start, if it is not won, has paths and findings.
    `fingerprint` is of the engine that must run it.
    """

    level: str
    programs: dict[str, str]
    ticks: int
    starts: tuple[int, ...]
    measures: tuple[QueryMeasure, ...]
    steps: int
    seconds: float
    given_first: bool
    fingerprint: str
    run_steps: int = 0
    until: str = ""
    is_explained: bool = False


class Series(msgspec.Struct, frozen=True):
    """The rows of a question, each starting with its tick; they may be cut off at a limit.

    `numbers` are ticks and what is one number of their rows, as of `number_of`, or None.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    failure: str = ""
    numbers: tuple[tuple[int, int | float | None], ...] = ()


class End(msgspec.Struct, frozen=True):
    """Where a robot was at the end, in map units, and the tick since which it was there."""

    robot: str
    x: float
    y: float
    since: int

    def sentence(self, last: int) -> str:
        """Describe it, for a run whose last tick was `last`."""
        place = f"{self.robot} ended at ({self.x:g}, {self.y:g}), and "
        is_still = self.since < last
        return place + (
            f"had stood there since tick {self.since:,}." if is_still else "still moved."
        )


class RunFinding(msgspec.Struct, frozen=True):
    """A finding of the diagnosis; the line is 0 if it has none."""

    kind: str
    line: int
    message: str


class Result(msgspec.Struct, frozen=True, omit_defaults=True):
    """The result of a run, determined by its inputs alone.

    `distance` is map units of all robots together, `size` the symbols of the programs, `rules` what
    earlier versions counted instead, `steps` those of all thoughts together, `notices` the number
    of ticks with a notice of each kind, `first` the first one (tick, robot, message). Teams in
    `forfeit` have lost because their programs failed. `peak` tells how many robots were home at
    once, `paths` are points in map units by robot. `home` is the largest share of a goal's robots
    that were in it at once, beyond those that began there, and `time_home` the mean share over all
    ticks that the run may take, after a victory 1; None in results of earlier versions.
    """

    outcome: Outcome
    ticks: int = 0
    distance: float = 0.0
    size: int = 0
    notices: dict[str, int] = {}
    first: tuple[int, str, str] | None = None
    series: dict[str, Series] = {}
    mistakes: tuple[Diagnostic, ...] = ()
    points: dict[str, float] = {}
    forfeit: tuple[str, ...] = ()
    rules: int = 0
    ends: tuple[End, ...] = ()
    peak: str = ""
    paths: dict[str, tuple[tuple[int, int], ...]] = {}
    findings: tuple[RunFinding, ...] = ()
    steps: int | None = None
    home: float | None = None
    time_home: float | None = None


class WorkerAnswer(msgspec.Struct, frozen=True):
    """The answer of a worker (host and process).

    `results` are start, result as JSON and processor seconds of each run; `is_refused` means that
    the worker's engine is another one, `is_final` that another attempt would fail in the same way.
    """

    results: tuple[tuple[int, str, float], ...] = ()
    worker: str = ""
    failure: str = ""
    is_refused: bool = False
    is_final: bool = False


@cache
def engine() -> dict[str, str]:
    """Return the versions of everything that can affect the result of a run."""
    from importlib import metadata

    sources = [Path(__file__).with_name(name).read_bytes() for name in ("tasks.py", "running.py")]
    return {
        "code": hashlib.sha256(b"".join((simulation_digest(), *sources))).hexdigest(),
        **{name: metadata.version(name) for name in ("logica", "numpy", "sqlglot")},
        "sqlite": sqlite3.sqlite_version,
        "python": platform.python_version(),
        "machine": platform.machine(),
        "libm": " ".join(platform.libc_ver()) or platform.platform(),
    }


@cache
def fingerprint() -> str:
    return hashlib.sha256(msgspec.json.encode(engine(), order="deterministic")).hexdigest()
