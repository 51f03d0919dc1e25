"""The laboratory: many runs, from one file, each computed once. No screen.

`sweep`, `grade` and `tournament` do from Python what the commands of these names do.

Example:
    >>> from logical_robots_tui.lab import sweep
    >>> results = sweep("experiment.toml", "out")
    >>> results.to_pandas().groupby("Near").ticks.median()
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from logical_robots_tui.errors import check_installed

if TYPE_CHECKING:
    import pandas

    from logical_robots_tui.lab.coordinating import Coordinator, Engine
    from logical_robots_tui.lab.exporting import ResultTable
    from logical_robots_tui.lab.folder import Folder, Ledger, Manifest
    from logical_robots_tui.toml_files import Given

__all__ = ["Results", "grade", "sweep", "tournament"]


class Results:
    """What a folder of the laboratory holds so far.

    Args:
        folder: What `sweep`, `grade`, `tournament` or the commands wrote.
        mixed: Whether results of another version count, too.

    Attributes:
        path: The folder.
        title: What was run.
        tables: The names of its tables; the first one is what the methods take by default.
        done: Number of runs that have a result.
        due: Number of runs that are left.
        failed: Number of runs that could not be done.
        complete: Whether nothing is left: no run, no failure, and no further round.

    Raises:
        InputError: There is no such folder, or it is damaged.
    """

    def __init__(self, folder: str | Path, *, mixed: bool = False) -> None:
        from logical_robots_tui.lab.coordinating import Coordinator
        from logical_robots_tui.lab.exporting import RunRecords
        from logical_robots_tui.lab.folder import Folder
        from logical_robots_tui.lab.reporting import tables_of

        self.path = Path(folder)
        self._folder, self._mixed = Folder(self.path), mixed
        manifest = self._folder.manifest()
        self.title = manifest.title
        with self._folder.ledger(mixed=mixed) as ledger:
            coordinator = Coordinator(self._folder, manifest, ledger)
            self.done, self.due, self.failed, differing = coordinator.tally()
            is_over = next_round(manifest, ledger, coordinator) is None
            self.complete = is_over and not (self.due or self.failed or differing)
            self._tables: dict[str, ResultTable] = tables_of(RunRecords(manifest, ledger))
        self.tables = tuple(self._tables)

    def to_pandas(self, table: str = "") -> pandas.DataFrame:
        """Return a table as a data frame.

        Raises:
            KeyError: There is no such table.
            InputError: There is no pandas, which is installed apart.
        """
        from logical_robots_tui.lab.exporting import columns_of

        check_installed("pandas", "A table", "pandas")
        from pandas import DataFrame

        return DataFrame(columns_of(self._tables[table or self.tables[0]]))

    def to_arrow(self, table: str = "") -> Any:
        """Return the same as a `pyarrow.Table`; it raises alike."""
        from logical_robots_tui.lab.exporting import arrow_of

        check_installed("pyarrow", "A table of Arrow")
        return arrow_of(self._tables[table or self.tables[0]])

    def report(self) -> Path:
        """Write report.html, a page with plots, into the folder; return its path.

        Raises:
            InputError: A library is missing, or it can't be written.
        """
        from logical_robots_tui.lab.exporting import RunRecords
        from logical_robots_tui.lab.reporting import write_report

        with self._folder.ledger(mixed=self._mixed) as ledger:
            records = RunRecords(self._folder.manifest(), ledger)
            return Path(write_report(self._folder, records))

    def __repr__(self) -> str:
        counts = {"runs": self.done, "left": self.due, "failed": self.failed}
        summary = ", ".join(f"{n:,} {name}" for name, n in counts.items() if n or name == "runs")
        return f"<Results of {self.title} in {self.path}: {summary}>"


class WorkOptions(TypedDict, total=False):
    """Options for the work.

    Attributes:
        workers: Processes on this computer, by default one per core.
        dask: The address of a Dask scheduler instead, such as ``tcp://HOST:8786``.
        mixed: Whether results of another version count, too.
        progress: Whether standard error says how far it is; so by default.
    """

    workers: int | None
    dask: str
    mixed: bool
    progress: bool


def sweep(experiment: Given, folder: str | Path, **options: Unpack[WorkOptions]) -> Results:
    """Run an experiment; what was computed before is not computed again.

    After an interruption do the same once more: it goes on. Blocks until everything is done.

    Args:
        experiment: A file as described in ``docs/lab.md``, or a mapping with what would be in it.
        folder: Where all results go.
        options: As in `WorkOptions`, such as ``workers=2``.

    Raises:
        TomlFileError: The experiment is wrong; `problems` has all that is.
        InputError: The folder can't be used.
    """
    from logical_robots_tui.lab.sweeping import plan_sweep

    return _carry_out(plan_sweep(experiment), folder, **options)


def grade(
    assignment: Given,
    submissions: str | Path,
    folder: str | Path,
    *,
    file_times: bool = False,
    late_anyway: bool = False,
    **options: Unpack[WorkOptions],
) -> Results:
    """Grade the programs of a class, in a folder or an archive; else as `sweep`.

    `file_times` takes the times of files where a platform says nothing, `late_anyway` believes
    times of submission that are suspicious.
    """
    from logical_robots_tui.lab.submissions import plan_grading

    times = {"file_times": file_times, "late_anyway": late_anyway}
    return _carry_out(plan_grading(assignment, Path(submissions), **times), folder, **options)


def tournament(
    specification: Given, players: str | Path, folder: str | Path, **options: Unpack[WorkOptions]
) -> Results:
    """Let the programs of a folder play against each other; else as `sweep`."""
    from logical_robots_tui.lab.competing import plan_tournament

    return _carry_out(plan_tournament(specification, Path(players)), folder, **options)


def _carry_out(
    plan: tuple[Manifest, dict[str, str]],
    path: str | Path,
    *,
    workers: int | None = None,
    dask: str = "",
    mixed: bool = False,
    progress: bool = True,
) -> Results:
    from logical_robots_tui.lab.exporting import RunRecords
    from logical_robots_tui.lab.folder import Folder
    from logical_robots_tui.lab.reporting import export

    folder = Folder(Path(path))
    with folder.lock(), folder.ledger(mixed=mixed) as ledger:
        first_manifest = folder.write(*plan)
        ledger.forget_failures()
        engine = engine_for(workers, dask, _say if progress else lambda _: None)
        with closing_engine(engine):
            for manifest, coordinator in rounds(folder, first_manifest, ledger):
                with _progress(manifest, coordinator, progress) as show:
                    coordinator.work(engine, lambda: False, show)
        if coordinator.tally().is_complete or manifest.kind == "grade":
            export(folder, RunRecords(manifest, ledger))
    return Results(path, mixed=mixed)


def engine_for(workers: int | None, dask: str, say: Callable[[str], None]) -> Engine:
    """Return an engine: processes here, by default one per core, or a cluster."""
    if dask:
        from logical_robots_tui.lab.engines import ClusterEngine

        return ClusterEngine(dask, say)
    from logical_robots_tui.lab.engines import LocalEngine

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return LocalEngine(workers or cores or 1)


@contextmanager
def closing_engine(engine: Engine) -> Iterator[None]:
    """Close an engine in the end, at once if that is an error or an interrupt."""
    try:
        yield
    except BaseException:
        engine.close(at_once=True)
        raise
    engine.close()


def rounds(
    folder: Folder, manifest: Manifest, ledger: Ledger
) -> Iterator[tuple[Manifest, Coordinator]]:
    """Yield manifest and coordinator of a round, then those of further rounds."""
    from logical_robots_tui.lab.coordinating import Coordinator

    coordinator = Coordinator(folder, manifest, ledger)
    yield manifest, coordinator
    while (next_manifest := next_round(manifest, ledger, coordinator)) is not None:
        manifest = folder.write(next_manifest, {})
        coordinator = Coordinator(folder, manifest, ledger)
        yield manifest, coordinator


def next_round(manifest: Manifest, ledger: Ledger, coordinator: Coordinator) -> Manifest | None:
    """Return the manifest with the next round of a tournament, or None."""
    if manifest.kind != "tournament" or not coordinator.tally().is_complete:
        return None
    from logical_robots_tui.lab import competing

    return competing.next_round(manifest, ledger)


_LINE_SECONDS = 5.0
_REDRAW_SECONDS = 0.2


@contextmanager
def _progress(
    manifest: Manifest, coordinator: Coordinator, is_enabled: bool
) -> Iterator[Callable[[], None]]:
    """Show progress, on one line in a terminal or notebook, elsewhere on a line now and then."""
    from logical_robots_tui.lab.coordinating import WorkProgress

    pace = WorkProgress(manifest, coordinator)
    is_live = sys.stderr.isatty() or "ipykernel" in sys.modules
    interval = _REDRAW_SECONDS if is_live else _LINE_SECONDS
    next_time, has_printed = monotonic() + interval, False

    def show() -> None:
        nonlocal next_time, has_printed
        if not is_enabled or monotonic() < next_time:
            return
        next_time, has_printed = monotonic() + interval, True
        _, _, count, details = pace.summary()
        line = f"{manifest.title}: {count}, {details}"
        _say(f"{line[:99]:<99}" if is_live else line, "\r" if is_live else "\n")

    yield show
    if has_printed and is_live:
        _say("")


def _say(text: str, end: str = "\n") -> None:
    from logical_robots_tui.lab.exporting import harmless_text

    sys.stderr.write(harmless_text(text) + end)
    sys.stderr.flush()
