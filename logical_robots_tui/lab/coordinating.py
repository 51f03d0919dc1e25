"""The coordinator: it hands out the remaining runs in tasks and records each result once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from datetime import timedelta
from time import monotonic
from typing import NamedTuple, Protocol, cast

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.folder import ATTEMPTS, Cell, Entry, Folder, Ledger, Manifest
from logical_robots_tui.lab.tasks import RunTask, WorkerAnswer, fingerprint

_MOST_STARTS = 64  # of a task
_LOOK_SECONDS = 0.2
_SLOW_SECONDS = 5.0  # of a run; the rest of its student's runs waits for those of the others


class Engine(Protocol):
    """Runs tasks, in processes or on a cluster."""

    @property
    def slots(self) -> int:
        """The number of tasks at a time."""

    @property
    def free(self) -> int:
        """The number of tasks that it takes now."""

    def submit(self, key: object, task: RunTask) -> None:
        """Take a task; the key names it when it comes back."""

    def wait(self, seconds: float) -> Iterable[tuple[object, WorkerAnswer]]:
        """Wait some time for tasks to end; return their keys and answers."""

    def close(self, *, at_once: bool = False) -> None:
        """End, after the tasks at hand or at once."""


class RunTally(NamedTuple):
    """How far the work is, in runs; `differing` ones are a defect of this package."""

    done: int
    due: int
    failed: int
    differing: int

    @property
    def is_complete(self) -> bool:
        """Whether no run is left and none failed or has differing results."""
        return not (self.due or self.failed or self.differing)


class _StartBatch(NamedTuple):
    """Starts of a cell that are left; alone, each is a task, because it may end its worker."""

    cell: Cell
    starts: tuple[int, ...]
    is_alone: bool = False


def cell_to_run(manifest: Manifest, cell: Cell, outcomes: Mapping[str, str]) -> Cell:
    """Return a cell with the text to run.

    Texts that are the same but for space and comments run once, except to say where each of them
    has its mistakes.
    """
    if cell.own and outcomes.get(manifest.job(cell, 0)) == "does not compile":
        return msgspec.structs.replace(cell, program=cell.own)
    return cell


def split_starts(
    manifest: Manifest, cell: Cell, outcomes: Mapping[str, str]
) -> tuple[list[int], list[int]]:
    """Return the starts of a cell that have a result, and those that are left to run."""
    first = outcomes.get(manifest.job(cell, 0))
    if first == "does not compile" or (first not in (None, "won") and manifest.given_first):
        return [0], []
    done_starts: list[int] = []
    due_starts: list[int] = []
    for start in manifest.starts_of(cell):
        (done_starts if manifest.job(cell, start) in outcomes else due_starts).append(start)
    return done_starts, due_starts


class Coordinator:
    """Hands out the remaining runs; the only writer of the ledger."""

    def __init__(self, folder: Folder, manifest: Manifest, ledger: Ledger) -> None:
        self._folder, self._manifest, self._ledger = folder, manifest, ledger
        self._outcomes = ledger.outcomes()
        self._failures = {job: len(reasons) for job, reasons in ledger.failures().items()}
        self._batches: deque[_StartBatch] = deque()
        self._slow_batches: deque[_StartBatch] = deque()  # for when nothing else waits
        self._slow_students: set[str] = set()
        self._tasks: dict[int, tuple[float, Cell]] = {}
        self._planned_jobs: set[str] = set()
        self._twins: dict[str, list[Cell]] = {}
        for cell in manifest.cells:
            if cell.own:
                self._twins.setdefault(cell.program, []).append(cell)
        self._done_count = self._due_count = 0
        for cell in manifest.cells:
            self._plan(cell)

    def tally(self) -> RunTally:
        failed = sum(count >= ATTEMPTS for count in self._failures.values())
        differing = len(self._ledger.differences())
        return RunTally(self._done_count, self._due_count - failed, failed, differing)

    def longest(self) -> tuple[float, Cell] | None:
        """Return how many seconds the longest task at work has taken so far, and its cell."""
        began, cell = min(self._tasks.values(), default=(0.0, None), key=lambda entry: entry[0])
        return (monotonic() - began, cell) if cell else None

    def work(
        self, engine: Engine, is_stopped: Callable[[], bool], show: Callable[[], None]
    ) -> None:
        """Run everything that is left. Blocks.

        Raises InputError for a damaged input, a worker with another engine, or a full disk.
        """
        while self._tasks or (self._has_more and not is_stopped()):
            while engine.free and self._has_more and not is_stopped():
                batch = self._next(engine)
                self._tasks[id(batch)] = monotonic(), batch.cell
                engine.submit(batch, self._task(batch))
            for key, answer in engine.wait(_LOOK_SECONDS):
                del self._tasks[id(key)]
                self._record_answer(cast("_StartBatch", key), answer)
            show()

    @property
    def _has_more(self) -> bool:
        return bool(self._batches or self._slow_batches)

    def _queue(self, batch: _StartBatch) -> None:
        is_slow = batch.cell.student in self._slow_students
        (self._slow_batches if is_slow else self._batches).append(batch)

    def _plan(self, cell: Cell) -> None:
        """Queue the rest of a cell, unless it equals an earlier cell."""
        cell = cell_to_run(self._manifest, cell, self._outcomes)
        key = self._manifest.job(cell, 0)
        if key in self._planned_jobs:
            return
        self._planned_jobs.add(key)
        done_starts, due_starts = split_starts(self._manifest, cell, self._outcomes)
        self._done_count += len(done_starts)
        self._due_count += len(due_starts)
        batch = _StartBatch(cell, tuple(due_starts))
        jobs = {start: self._manifest.job(cell, start) for start in due_starts}
        failed_starts = [s for s in due_starts if self._failures.get(jobs[s], 0) >= ATTEMPTS]
        if due_starts and not (self._manifest.given_first and 0 in failed_starts):
            due_starts = [start for start in due_starts if start not in failed_starts]
            self._queue(batch._replace(starts=tuple(due_starts)))

    def _next(self, engine: Engine) -> _StartBatch:
        """Return a group whose first starts are to be run now, usually all of them."""
        queue = self._batches or self._slow_batches
        batch = queue.popleft()
        if self._manifest.given_first and batch.starts[0] == 0:
            return batch
        limit = 1 if batch.is_alone else _MOST_STARTS
        if len(queue) < engine.slots:
            limit = min(limit, -(-len(batch.starts) // engine.slots))
        if later_starts := batch.starts[limit:]:
            queue.appendleft(batch._replace(starts=later_starts))
        return batch._replace(starts=batch.starts[:limit])

    def _task(self, batch: _StartBatch) -> RunTask:
        manifest, cell = self._manifest, batch.cell
        programs = dict(zip(manifest.teams, cell.parts, strict=True)) or {"": cell.program}
        return RunTask(
            self._folder.text(cell.level),
            {team: self._folder.text(name) for team, name in programs.items()},
            cell.ticks,
            batch.starts[: 1 if batch.is_alone else _MOST_STARTS],
            manifest.asked,
            manifest.steps,
            manifest.seconds,
            manifest.given_first,
            fingerprint(),
            manifest.run_steps,
            manifest.until,
            manifest.kind == "grade",
        )

    def _record_answer(self, batch: _StartBatch, answer: WorkerAnswer) -> None:
        if answer.is_refused:
            hint = "Install the same versions everywhere."
            raise InputError("A worker has another version of Logical Robots", hint=hint)
        manifest = self._manifest
        entries = []
        for start, result, seconds in answer.results:
            job = manifest.job(batch.cell, start)
            entries.append(Entry(job, manifest.run(job), result, seconds, answer.worker))
            self._failures.pop(job, None)
        self._outcomes |= self._ledger.record(entries)
        done_starts = {start for start, _, _ in answer.results}
        _, due_starts = split_starts(manifest, batch.cell, self._outcomes)
        next_starts = tuple(start for start in batch.starts if start in due_starts)
        self._done_count += len(entries)
        self._due_count -= len(batch.starts) - len(next_starts)
        culprits = [start for start in batch.starts if start not in done_starts]
        batch = batch._replace(starts=next_starts)
        if answer.failure:
            if answer.worker or batch.is_alone or len(culprits) == 1:
                batch = self._note_failure(batch, culprits[0], answer)
            else:
                batch = batch._replace(is_alone=True)
        is_slow = answer.failure or any(seconds > _SLOW_SECONDS for _, _, seconds in answer.results)
        student = batch.cell.student
        if is_slow and student and student not in self._slow_students:
            self._slow_students.add(student)
            batches, self._batches = self._batches, deque()
            for waiting_batch in batches:
                self._queue(waiting_batch)
        if batch.starts:
            self._queue(batch)
        if 0 in done_starts:
            for cell in self._twins.get(batch.cell.program, ()):
                self._plan(cell)

    def _note_failure(self, batch: _StartBatch, start: int, answer: WorkerAnswer) -> _StartBatch:
        job = self._manifest.job(batch.cell, start)
        for _ in range(ATTEMPTS if answer.is_final else 1):
            self._ledger.fail(job, answer.failure, answer.worker)
            self._failures[job] = self._failures.get(job, 0) + 1
        if self._failures[job] < ATTEMPTS:
            return batch
        if start == 0 and self._manifest.given_first:
            return batch._replace(starts=())
        return batch._replace(starts=tuple(s for s in batch.starts if s != start))


class WorkProgress:
    """Progress and speed of a coordinator, in numbers and words."""

    def __init__(self, manifest: Manifest, coordinator: Coordinator) -> None:
        self._manifest, self._coordinator = manifest, coordinator
        self._first, self._began = coordinator.tally(), monotonic()

    def summary(self) -> tuple[int, int, str, str]:
        """Return the number of runs done and of all runs, both in words, and details."""
        tally = self._coordinator.tally()
        pace = (tally.done - self._first.done) / max(monotonic() - self._began, 0.001)
        details = f"{pace:.1f} runs/s"
        details += f", {timedelta(seconds=round(tally.due / pace))} left" if pace else ""
        details += f", {tally.failed:,} failed" if tally.failed else ""
        seconds, cell = self._coordinator.longest() or (0.0, None)
        if cell and seconds > _SLOW_SECONDS:
            details += f", {self._manifest.label_of(cell)} for {seconds:.0f} s"
        total = tally.done + tally.due
        return tally.done, total, f"{tally.done:,} of {total:,} runs", details
