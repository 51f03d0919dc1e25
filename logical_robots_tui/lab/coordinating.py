"""The coordinator: what is left to run, handed out in tasks, recorded once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from datetime import timedelta
from time import monotonic
from typing import NamedTuple, Protocol, cast

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.folder import ATTEMPTS, Cell, Entry, Folder, Ledger, Manifest
from logical_robots_tui.lab.running import Answer, Task, fingerprint

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

    def submit(self, key: object, task: Task) -> None:
        """Take a task; the key names it when it comes back."""

    def wait(self, seconds: float) -> Iterable[tuple[object, Answer]]:
        """Wait some time for tasks to end; return their keys and answers."""

    def close(self, *, at_once: bool = False) -> None:
        """End, after the tasks at hand or at once."""


class Tally(NamedTuple):
    """How far the work is, in runs; `differing` ones are a defect of this package."""

    done: int
    due: int
    failed: int
    differing: int

    @property
    def is_complete(self) -> bool:
        """Whether no run is left and none failed or has differing results."""
        return not (self.due or self.failed or self.differing)


class _Group(NamedTuple):
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


def starts_due(
    manifest: Manifest, cell: Cell, outcomes: Mapping[str, str]
) -> tuple[list[int], list[int]]:
    """Return the starts of a cell that have a result, and those that are left to run."""
    first = outcomes.get(manifest.job(cell, 0))
    if first == "does not compile" or (first not in (None, "won") and manifest.given_first):
        return [0], []
    done: list[int] = []
    left: list[int] = []
    for start in manifest.all_starts:
        (done if manifest.job(cell, start) in outcomes else left).append(start)
    return done, left


class Coordinator:
    """Hands out the remaining runs; the only writer of the ledger."""

    def __init__(self, folder: Folder, manifest: Manifest, ledger: Ledger) -> None:
        self._folder, self._manifest, self._ledger = folder, manifest, ledger
        self._outcomes = ledger.outcomes()
        self._failures = {job: len(reasons) for job, reasons in ledger.failures().items()}
        self._waiting: deque[_Group] = deque()
        self._slow: deque[_Group] = deque()  # for when nothing else waits
        self._slow_students: set[str] = set()
        self._at_work: dict[int, tuple[float, Cell]] = {}
        self._planned: set[str] = set()
        self._twins: dict[str, list[Cell]] = {}
        for cell in manifest.cells:
            if cell.own:
                self._twins.setdefault(cell.program, []).append(cell)
        self._done = self._left = 0
        for cell in manifest.cells:
            self._plan(cell)

    def tally(self) -> Tally:
        failed = sum(count >= ATTEMPTS for count in self._failures.values())
        differing = len(self._ledger.differences())
        return Tally(self._done, self._left - failed, failed, differing)

    def longest(self) -> tuple[float, Cell] | None:
        """Return how many seconds the longest task at work has taken so far, and its cell."""
        began, cell = min(self._at_work.values(), default=(0.0, None), key=lambda each: each[0])
        return (monotonic() - began, cell) if cell else None

    def work(
        self, engine: Engine, is_stopped: Callable[[], bool], show: Callable[[], None]
    ) -> None:
        """Run everything that is left. Blocks.

        Raises InputError for a damaged input, a worker with another engine, or a full disk.
        """
        while self._at_work or (self._has_more and not is_stopped()):
            while engine.free and self._has_more and not is_stopped():
                group = self._next(engine)
                self._at_work[id(group)] = monotonic(), group.cell
                engine.submit(group, self._task(group))
            for key, answer in engine.wait(_LOOK_SECONDS):
                del self._at_work[id(key)]
                self._take(cast("_Group", key), answer)
            show()

    @property
    def _has_more(self) -> bool:
        return bool(self._waiting or self._slow)

    def _queue(self, group: _Group) -> None:
        is_slow = group.cell.student in self._slow_students
        (self._slow if is_slow else self._waiting).append(group)

    def _postpone(self, student: str) -> None:
        self._slow_students.add(student)
        waiting, self._waiting = self._waiting, deque()
        for group in waiting:
            self._queue(group)

    def _plan(self, cell: Cell) -> None:
        """Queue the rest of a cell, unless it equals an earlier cell."""
        cell = cell_to_run(self._manifest, cell, self._outcomes)
        key = self._manifest.job(cell, 0)
        if key in self._planned:
            return
        self._planned.add(key)
        done, left = starts_due(self._manifest, cell, self._outcomes)
        self._done += len(done)
        self._left += len(left)
        group = _Group(cell, tuple(left))
        attempts = {start: self._failures.get(self._manifest.job(cell, start), 0) for start in left}
        given_up = [start for start in left if attempts[start] >= ATTEMPTS]
        if left and not (self._manifest.given_first and 0 in given_up):
            left = [start for start in left if start not in given_up]
            self._queue(group._replace(starts=tuple(left)))

    def _next(self, engine: Engine) -> _Group:
        """Return a group whose first starts are to be run now, usually all of them."""
        queue = self._waiting or self._slow
        group = queue.popleft()
        if self._manifest.given_first and group.starts[0] == 0:
            return group
        most = 1 if group.is_alone else _MOST_STARTS
        if len(queue) < engine.slots:
            most = min(most, -(-len(group.starts) // engine.slots))
        if rest := group.starts[most:]:
            queue.appendleft(group._replace(starts=rest))
        return group._replace(starts=group.starts[:most])

    def _task(self, group: _Group) -> Task:
        manifest, cell = self._manifest, group.cell
        programs = dict(zip(manifest.teams, cell.parts, strict=True)) or {"": cell.program}
        return Task(
            self._folder.text(cell.level),
            {team: self._folder.text(name) for team, name in programs.items()},
            cell.ticks,
            group.starts[: 1 if group.is_alone else _MOST_STARTS],
            manifest.asked,
            manifest.steps,
            manifest.seconds,
            manifest.given_first,
            fingerprint(),
            manifest.run_steps,
            manifest.until,
            manifest.kind == "grade",
        )

    def _take(self, group: _Group, answer: Answer) -> None:
        if answer.refused:
            hint = "Install the same versions everywhere."
            raise InputError("A worker has another version of Logical Robots", hint=hint)
        manifest = self._manifest
        entries = []
        for start, result, seconds in answer.results:
            job = manifest.job(group.cell, start)
            entries.append(Entry(job, manifest.run(job), result, seconds, answer.worker))
            self._failures.pop(job, None)
        self._outcomes |= self._ledger.record(entries)
        finished = {start for start, _, _ in answer.results}
        _, due = starts_due(manifest, group.cell, self._outcomes)
        left = tuple(start for start in group.starts if start in due)
        self._done += len(entries)
        self._left -= len(group.starts) - len(left)
        culprits = [start for start in group.starts if start not in finished]
        group = group._replace(starts=left)
        if answer.failure:
            if answer.worker or group.is_alone or len(culprits) == 1:
                group = self._note_failure(group, culprits[0], answer)
            else:
                group = group._replace(is_alone=True)
        is_slow = answer.failure or any(each > _SLOW_SECONDS for _, _, each in answer.results)
        student = group.cell.student
        if is_slow and student and student not in self._slow_students:
            self._postpone(student)
        if group.starts:
            self._queue(group)
        if 0 in finished:
            for cell in self._twins.get(group.cell.program, ()):
                self._plan(cell)

    def _note_failure(self, group: _Group, start: int, answer: Answer) -> _Group:
        job = self._manifest.job(group.cell, start)
        for _ in range(ATTEMPTS if answer.is_final else 1):
            self._ledger.fail(job, answer.failure, answer.worker)
            self._failures[job] = self._failures.get(job, 0) + 1
        if self._failures[job] < ATTEMPTS:
            return group
        if start == 0 and self._manifest.given_first:
            return group._replace(starts=())
        return group._replace(starts=tuple(each for each in group.starts if each != start))


class Pace:
    """How far the work of a coordinator is and how fast it goes, in numbers and words."""

    def __init__(self, manifest: Manifest, coordinator: Coordinator) -> None:
        self._manifest, self._coordinator = manifest, coordinator
        self._first, self._began = coordinator.tally(), monotonic()

    def said(self) -> tuple[int, int, str, str]:
        """Return runs done and all runs, these in words, and what to say beside them."""
        tally = self._coordinator.tally()
        pace = (tally.done - self._first.done) / max(monotonic() - self._began, 0.001)
        rest = f"{pace:.1f} runs/s"
        rest += f", {timedelta(seconds=round(tally.due / pace))} left" if pace else ""
        rest += f", {tally.failed:,} failed" if tally.failed else ""
        seconds, cell = self._coordinator.longest() or (0.0, None)
        if cell and seconds > _SLOW_SECONDS:
            rest += f", {self._manifest.called(cell)} for {seconds:.0f} s"
        total = tally.done + tally.due
        return tally.done, total, f"{tally.done:,} of {total:,} runs", rest
