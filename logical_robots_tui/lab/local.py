"""The local engine: worker processes on this machine, each with one task at a time."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import resource_tracker
from time import monotonic

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.running import CHUNK_SECONDS, Answer, Task, execute
from logical_robots_tui.processes.helper import collect_seldom

_MOST_FALSE_STARTS = 2  # in a row
_GRACE = 60.0  # seconds after the time of a task after which a worker that says nothing is ended


class LocalEngine:
    """Worker processes, made when needed and anew when they die.

    Each is a pool of its own, so that a death is blamed on the one task that the worker had.
    """

    def __init__(self, workers: int) -> None:
        self._workers = [_Worker() for _ in range(workers)]

    @property
    def slots(self) -> int:
        return len(self._workers)

    @property
    def free(self) -> int:
        return sum(worker.task is None for worker in self._workers)

    def submit(self, key: object, task: Task) -> None:
        next(worker for worker in self._workers if worker.task is None).start(key, task)

    def wait(self, seconds: float) -> Iterator[tuple[object, Answer]]:
        """Yield keys and answers of tasks that end in time; a dead worker's has a failure."""
        wait([w.future for w in self._workers if w.future], seconds, FIRST_COMPLETED)
        for worker in self._workers:
            worker.end_if_stuck()
            if worker.future is not None and worker.future.done():
                yield worker.finish()

    def close(self, *, at_once: bool = False) -> None:
        for worker in self._workers:
            worker.close(at_once=at_once)


class _Worker:
    def __init__(self) -> None:
        self.task: Task | None = None
        self.future: Future[Answer] | None = None
        self._key: object = None
        self._pool: ProcessPoolExecutor | None = None
        self._pid: Future[int] | None = None
        self._deadline = 0.0
        self._false_starts = 0
        self._is_stuck = False

    def start(self, key: object, task: Task) -> None:
        self._key, self.task = key, task
        resource_tracker.ensure_running()  # its start would let interrupts through again
        # A new process inherits that keyboard interrupts wait; here they only wait a moment.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            if self._pool is None:
                spawn = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(1, mp_context=spawn, initializer=_begin)
                self._pid = self._pool.submit(os.getpid)
            self.future = self._pool.submit(execute, task)
        except BrokenProcessPool as error:
            self.future = Future()
            self.future.set_exception(error)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        self._is_stuck = False
        self._deadline = monotonic() + CHUNK_SECONDS + task.seconds + _GRACE

    def finish(self) -> tuple[object, Answer]:
        """Return the finished task's key and answer; raises InputError if workers keep dying."""
        assert self.task is not None
        assert self.future is not None
        error = self.future.exception()
        if isinstance(error, BrokenProcessPool):
            has_begun = self._pid is not None and self._pid.exception() is None
            self._false_starts = 0 if has_begun else self._false_starts + 1
            if self._false_starts > _MOST_FALSE_STARTS:
                raise InputError("a worker process can't start", hint="Is there memory left?")
            said = f"it took more than {self.task.seconds:g} seconds and could not be stopped"
            answer = Answer(failure=said if self._is_stuck else "its worker process died")
            self.close(at_once=True)
        elif error is not None:
            answer = Answer(failure=f"a bug in Logical Robots: {error!r}")
        else:
            answer = self.future.result()
        key, self._key = self._key, None
        self.task = self.future = None
        return key, answer

    def end_if_stuck(self) -> None:
        if self.task is not None and monotonic() > self._deadline:
            self._is_stuck = True
            self._kill()

    def close(self, *, at_once: bool) -> None:
        if self._pool is not None:
            if at_once:
                self._kill()
            self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool = self._pid = None

    def _kill(self) -> None:
        if self._pid is not None and self._pid.done() and self._pid.exception() is None:
            with suppress(ProcessLookupError):
                os.kill(self._pid.result(), signal.SIGKILL)


def _begin() -> None:
    """Prepare a worker process: ignore interrupts, which the coordinator handles."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    collect_seldom()
    threading.Thread(target=_end_with_coordinator, daemon=True).start()


def _end_with_coordinator() -> None:
    coordinator = multiprocessing.parent_process()
    if coordinator is not None:
        coordinator.join()
    os._exit(1)
