"""Engines that run tasks: processes on this computer, or the workers of a Dask scheduler."""

from __future__ import annotations

import logging
import math
import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from pathlib import Path
from time import monotonic
from types import ModuleType
from typing import Any

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.running import CHUNK_SECONDS, execute, timeout_reason
from logical_robots_tui.lab.tasks import RunTask, WorkerAnswer
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

    def submit(self, key: object, task: RunTask) -> None:
        next(worker for worker in self._workers if worker.task is None).start(key, task)

    def wait(self, seconds: float) -> Iterator[tuple[object, WorkerAnswer]]:
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
        self.task: RunTask | None = None
        self.future: Future[WorkerAnswer] | None = None
        self._key: object = None
        self._pool: ProcessPoolExecutor | None = None
        self._pid: Future[int] | None = None
        self._used_seconds = self._limit = 0.0  # seconds of a processor: so far, and at most
        self._active_at = 0.0  # when it was last seen to do something
        self._false_starts = 0
        self._is_stuck = False

    def start(self, key: object, task: RunTask) -> None:
        self._key, self.task = key, task
        resource_tracker.ensure_running()  # its start would let interrupts through again
        # A new process inherits that keyboard interrupts wait; here they only wait a moment.
        old_mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            if self._pool is None:
                spawn = multiprocessing.get_context("spawn")
                self._pool = ProcessPoolExecutor(1, mp_context=spawn, initializer=_prepare_worker)
                with _no_main():
                    self._pid = self._pool.submit(os.getpid)
            self.future = self._pool.submit(execute, task)
        except BrokenProcessPool as error:
            self.future = Future()
            self.future.set_exception(error)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, old_mask)
        self._is_stuck = False
        self._used_seconds, self._active_at = self._processor_seconds(), monotonic()
        self._limit = self._used_seconds + self._patience

    def finish(self) -> tuple[object, WorkerAnswer]:
        """Return the finished task's key and answer; raises InputError if workers keep dying."""
        assert self.task is not None
        assert self.future is not None
        error = self.future.exception()
        if isinstance(error, BrokenProcessPool):
            has_begun = self._pid is not None and self._pid.exception() is None
            self._false_starts = 0 if has_begun else self._false_starts + 1
            if self._false_starts > _MOST_FALSE_STARTS:
                raise InputError("A worker process can't start", hint="Is there memory left?")
            reason = f"{timeout_reason(self.task)} and could not be stopped"
            is_final = self._used_seconds > self._limit
            answer = WorkerAnswer(failure=reason if self._is_stuck else "its worker process died")
            answer = msgspec.structs.replace(answer, is_final=is_final and self._is_stuck)
            self.close(at_once=True)
        elif error is not None:
            answer = WorkerAnswer(failure=f"a bug in Logical Robots: {error!r}")
        else:
            answer = self.future.result()
        key, self._key = self._key, None
        self.task = self.future = None
        return key, answer

    def end_if_stuck(self) -> None:
        """Kill it if its task takes too much of a processor, or gets none for as long."""
        if self.task is None:
            return
        current_time, seconds = monotonic(), self._processor_seconds()
        if seconds != self._used_seconds:
            self._used_seconds, self._active_at = seconds, current_time
        if seconds > self._limit or current_time > self._active_at + self._patience:
            self._is_stuck = True
            self._kill()

    @property
    def _patience(self) -> float:
        return CHUNK_SECONDS + (self.task.seconds if self.task else 0.0) + _GRACE

    def _processor_seconds(self) -> float:
        """Return how much of a processor it has used, or the time where that is not known."""
        if sys.platform != "linux":
            return monotonic()
        if self._pid is None or not self._pid.done() or self._pid.exception():
            return 0.0
        try:
            text = Path(f"/proc/{self._pid.result()}/stat").read_text("utf-8", "replace")
        except OSError:  # it has just ended
            return self._used_seconds
        user, system = text.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

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


@contextmanager
def _no_main() -> Iterator[None]:
    """Let a process begin without running the script again that asked for the work."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _prepare_worker() -> None:
    """Ignore interrupts, which the coordinator handles, and end when it has ended."""

    def end_with_coordinator() -> None:
        coordinator = multiprocessing.parent_process()
        if coordinator is not None:
            coordinator.join()
        os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    collect_seldom()
    threading.Thread(target=end_with_coordinator, daemon=True).start()


_TASKS_PER_THREAD = 2  # tasks for each thread of a worker, so that none waits for the coordinator
_COUNT_SECONDS = 2.0  # for which the number of threads is good
_FETCH_SECONDS = 1.0
_CONNECT_SECONDS = 30.0
_RECONNECT_SECONDS = 600.0
_RETRY_SECONDS = 5.0


class ClusterEngine:
    """Tasks on a Dask scheduler, such as ``tcp://HOST:8786``; raises InputError without one.

    Each future is released as soon as its answer is there. `say` is told when the scheduler is
    lost, and when another one is found.
    """

    def __init__(self, address: str, say: Callable[[str], None] = lambda _: None) -> None:
        try:
            import distributed
        except ImportError:
            hint = "Install it with: pip install 'logical-robots-tui[dask]'"
            raise InputError("A cluster needs Dask", hint=hint) from None
        for name in ("distributed", "distributed.client"):  # the second has a level of its own
            logging.getLogger(name).setLevel(logging.CRITICAL)  # losses are expected
        self._dask: Any = distributed
        self._address = address
        self._tasks: dict[Any, tuple[object, RunTask]] = {}
        self._lost_tasks: deque[tuple[object, RunTask]] = deque()
        self._lost_since: float | None = None
        self._say = say
        self._client: Any = None
        self._threads, self._counted_at = 1, -math.inf
        self._connect(_CONNECT_SECONDS)

    @property
    def slots(self) -> int:
        if monotonic() > self._counted_at + _COUNT_SECONDS:
            with suppress(Exception):  # the scheduler may be gone
                self._threads = max(1, sum(self._client.nthreads().values()))
            self._counted_at = monotonic()
        return self._threads

    @property
    def free(self) -> int:
        return max(0, _TASKS_PER_THREAD * self.slots - len(self._tasks) - len(self._lost_tasks))

    def submit(self, key: object, task: RunTask) -> None:
        # A task that ends its worker is not tried again by Dask: the coordinator tries it alone.
        try:
            future = self._client.submit(execute, task, pure=False, retries=0)
        except Exception:  # the scheduler is gone; Dask raises many kinds of errors then
            self._lost_tasks.append((key, task))
        else:
            self._tasks[future] = key, task

    def wait(self, seconds: float) -> Iterator[tuple[object, WorkerAnswer]]:
        is_lost = self._client.status != "running" or self._lost_tasks
        if is_lost and not self._reconnect(max(seconds, _RETRY_SECONDS)):
            return
        with suppress(TimeoutError, CancelledError, ValueError):  # or there are none
            self._dask.wait(list(self._tasks), timeout=seconds, return_when="FIRST_COMPLETED")
        for future in [future for future in self._tasks if future.done()]:
            try:
                answer = future.result(timeout=_FETCH_SECONDS)
            except TimeoutError:
                continue  # the worker that has it says nothing: later, or from another worker
            except (CancelledError, self._dask.comm.CommClosedError):
                self._lost_tasks.append(self._tasks.pop(future))  # the scheduler has lost it
                continue
            except Exception as error:
                answer = WorkerAnswer(failure=f"its worker died: {error}")
            key, _ = self._tasks.pop(future)
            yield key, answer
            future.release()  # it is recorded now: should its worker die, nothing runs again

    def close(self, *, at_once: bool = False) -> None:
        with suppress(Exception):  # the scheduler may be gone
            self._client.cancel(list(self._tasks))
        with suppress(Exception):
            self._client.close(timeout=1 if at_once else 10)

    def _connect(self, seconds: float) -> None:
        try:
            self._client = self._dask.Client(self._address, timeout=seconds)
        except (OSError, RuntimeError, TypeError, ValueError) as error:  # the last ones by TLS
            message = f"The Dask scheduler can't be reached: {error}"
            hint = "Start one with `dask scheduler`, and check the address and the keys."
            raise InputError(message, place=self._address, hint=hint) from error

    def _reconnect(self, seconds: float) -> bool:
        """Try to connect again and resubmit lost work; raises InputError after ten minutes."""
        if self._lost_since is None:
            self._lost_since = monotonic()
            self._say(
                f"{self._address}: the Dask scheduler is lost. Waiting ten minutes for one at the "
                "same address; what was computed is kept."
            )
        tasks = [*self._lost_tasks, *self._tasks.values()]
        self._lost_tasks.clear()
        self._tasks.clear()
        with suppress(Exception):
            self._client.close(timeout=1)
        try:
            self._connect(seconds)
        except InputError:
            if monotonic() > self._lost_since + _RECONNECT_SECONDS:
                raise
            self._lost_tasks.extend(tasks)
            return False
        self._lost_since = None
        self._say(f"{self._address}: connected to a Dask scheduler again.")
        for key, task in tasks:
            self.submit(key, task)
        return True
