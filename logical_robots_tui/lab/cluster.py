"""The cluster engine: tasks on the workers of a Dask scheduler."""

from __future__ import annotations

import logging
import math
from collections import deque
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import suppress
from time import monotonic
from typing import Any

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.running import Answer, Task, execute

_AHEAD = 2  # tasks for each thread of a worker, so that none waits for the coordinator
_COUNT_SECONDS = 2.0  # for which the number of threads is good
_FETCH_SECONDS = 1.0
_CONNECT_SECONDS = 30.0
_RECONNECT_SECONDS = 600.0


class ClusterEngine:
    """Tasks on a Dask scheduler, such as ``tcp://HOST:8786``; raises InputError without one.

    Each future is released as soon as its answer is there.
    """

    def __init__(self, address: str) -> None:
        try:
            import distributed
        except ImportError:
            hint = "Install it with: pip install 'logical-robots-tui[dask]'"
            raise InputError("a cluster needs Dask", hint=hint) from None
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # losses are expected
        self._dask: Any = distributed
        self._address = address
        self._tasks: dict[Any, tuple[object, Task]] = {}
        self._lost: deque[tuple[object, Task]] = deque()
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
        return max(0, _AHEAD * self.slots - len(self._tasks) - len(self._lost))

    def submit(self, key: object, task: Task) -> None:
        # A task that ends its worker is not tried again by Dask: the coordinator tries it alone.
        try:
            future = self._client.submit(execute, task, pure=False, retries=0)
        except Exception:  # the scheduler is gone; Dask raises many kinds of errors then
            self._lost.append((key, task))
        else:
            self._tasks[future] = key, task

    def wait(self, seconds: float) -> Iterator[tuple[object, Answer]]:
        if self._client.status != "running" or self._lost:
            self._reconnect()
        with suppress(TimeoutError, CancelledError, ValueError):  # or there are none
            self._dask.wait(list(self._tasks), timeout=seconds, return_when="FIRST_COMPLETED")
        for future in [future for future in self._tasks if future.done()]:
            try:
                answer = future.result(timeout=_FETCH_SECONDS)
            except TimeoutError:
                continue  # the worker that has it says nothing: later, or from another worker
            except (CancelledError, self._dask.comm.CommClosedError):
                self._lost.append(self._tasks.pop(future))  # the scheduler has lost it
                continue
            except Exception as error:
                answer = Answer(failure=f"its worker died: {error}")
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
            message = f"there is no Dask scheduler that can be reached: {error}"
            hint = "Start one with `dask scheduler`, and check the address and the keys."
            raise InputError(message, place=self._address, hint=hint) from error

    def _reconnect(self) -> None:
        """Resubmit lost work once a scheduler is back; raises InputError if that takes long."""
        until = monotonic() + _RECONNECT_SECONDS
        left = [*self._lost, *self._tasks.values()]
        self._lost.clear()
        self._tasks.clear()
        while True:
            with suppress(Exception):
                self._client.close(timeout=1)
            try:
                self._connect(_CONNECT_SECONDS)
                break
            except InputError:
                if monotonic() > until:
                    raise
        for key, task in left:
            self.submit(key, task)
