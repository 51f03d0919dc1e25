"""A clock that tests own: an event loop on which time passes only when nothing else can happen.

On this loop a second takes no time, and a slow machine is no slower. Whatever is in progress in
threads is waited for first, so that robots are never further than a test has let them come.

``looptime``, which is maintained for this, lets time pass at the machine's speed while a thread
works: how far robots get, which think in a thread, would still be a matter of chance.
"""

import asyncio
import selectors
import threading
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from time import monotonic
from typing import Any, TypeVar, TypeVarTuple, Unpack

from logical_robots_tui.clock import Clock
from tests.waiting import PATIENCE

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

_BEGINNING = 1000.0  # seconds
_MOMENT = 0.002  # seconds of the machine that threads get, where they are not waited for
_LONGEST = 600.0  # seconds
_WORK = 0.001  # seconds that work in a thread takes, and each look at the clock in a thread


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop with a time of its own, in seconds."""

    def __init__(self) -> None:
        self.now = _BEGINNING
        self._in_threads = 0
        self.held = 0
        self._is_impatient = False
        self._handled: list[asyncio.Future[None]] = []
        self._settled: list[asyncio.Future[None]] = []
        self._changed: list[asyncio.Future[None]] = []
        super().__init__(_Selector(self._next_events))

    def time(self) -> float:
        return self.now

    def run_in_executor(
        self, executor: Executor | None, func: Callable[[Unpack[Ts]], T], *args: *Ts
    ) -> asyncio.Future[T]:
        """Note work in a thread until its result is there, or nobody waits for it any more."""
        future = super().run_in_executor(executor, func, *args)
        self._in_threads += 1
        future.add_done_callback(self._returned)
        return future

    def _returned(self, _: object) -> None:
        self._in_threads -= 1
        self.now += _WORK

    def shutdown_default_executor(self, timeout: float | None = None) -> Coroutine[Any, Any, None]:
        """Join the threads, however long it takes: a limit would be one of virtual seconds."""
        return super().shutdown_default_executor()

    async def handled(self) -> None:
        """Wait until everything at this time is done but what threads are working on."""
        await self._noted(self._handled)

    async def settled(self) -> None:
        """Wait until everything at this time is done, also in threads."""
        await self._noted(self._settled)

    async def changed(self) -> None:
        """Wait for the next thing that happens: a thread returns, or time passes."""
        await self._noted(self._changed)

    @contextmanager
    def impatient(self) -> Iterator[None]:
        """Let time pass although threads are at work."""
        before, self._is_impatient = self._is_impatient, True
        try:
            yield
        finally:
            self._is_impatient = before

    async def _noted(self, waiting: list[asyncio.Future[None]]) -> None:
        future = self.create_future()
        waiting.append(future)
        await future

    def _next_events(self, select: Callable[[float | None], Any], timeout: float | None) -> Any:
        """Return what has happened outside of the loop; if nothing has, let time pass."""
        events = select(0)
        if events:
            self._has_changed()
        if events or timeout == 0 or _resolved(self._handled):
            return events
        in_threads = self._in_threads - self.held
        if in_threads and not self._is_impatient:
            events = self._waited(select)
        elif in_threads and (events := select(_MOMENT)):
            pass
        elif _resolved(self._settled):
            return events
        elif timeout is None:
            events = self._waited(select)
        else:
            self.now += timeout
        self._has_changed()
        return events

    def _has_changed(self) -> None:
        """Tell who waits for a change as soon as all that follows from it is handled."""
        self._handled += self._changed
        self._changed.clear()

    def _waited(self, select: Callable[[float | None], Any]) -> Any:
        events = select(PATIENCE)
        if not events:
            for future in (*self._settled, *self._changed):
                future.set_exception(AssertionError(f"nothing happened within {PATIENCE} s"))
            self._settled.clear()
            self._changed.clear()
        return events


class _Selector(selectors.DefaultSelector):
    def __init__(self, next_events: Callable[[Callable[[float | None], Any], float | None], Any]):
        super().__init__()
        self._next_events = next_events

    def select(self, timeout: float | None = None) -> Any:
        return self._next_events(super().select, timeout)


def _resolved(waiting: list[asyncio.Future[None]]) -> bool:
    """Resolve futures, and return whether somebody waits for one."""
    found = [future for future in waiting if not future.done()]
    waiting.clear()
    for future in found:
        future.set_result(None)
    return bool(found)


class VirtualClock(Clock):
    """The time of the running loop; nobody else wants the processors."""

    def __init__(self) -> None:
        self._loop = virtual_loop()
        self._thread = threading.get_ident()

    def now(self) -> float:
        if threading.get_ident() != self._thread:
            self._loop.now += _WORK
        return self._loop.now

    def computed(self) -> float:
        return 0.0

    def processor_times(self) -> None:
        return None


class Hold:
    """Holds work in a thread, which time does not wait for until it is released."""

    def __init__(self) -> None:
        self._loop = virtual_loop()
        self.has_begun = False
        self._released = threading.Event()

    def here(self) -> None:
        self._loop.call_soon_threadsafe(self._begin)
        assert self._released.wait(PATIENCE)

    def release(self) -> None:
        self._loop.held = 0
        self._released.set()

    def _begin(self) -> None:
        self.has_begun = True
        if not self._released.is_set():
            self._loop.held += 1


def virtual_loop() -> VirtualLoop:
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualLoop)
    return loop


async def later(seconds: float) -> None:
    future = virtual_loop().create_future()
    virtual_loop().call_later(seconds, future.set_result, None)
    await future


async def until(condition: Callable[[], object], otherwise: Callable[[], str] = str) -> None:
    """Let time pass until a condition holds, and stop it at that moment.

    Args:
        condition: Looked at whenever something has happened.
        otherwise: What to say if it never comes true.
    """
    loop = virtual_loop()
    patient_until, longest = monotonic() + PATIENCE, loop.time() + _LONGEST
    await loop.handled()
    while not condition():
        assert monotonic() < patient_until, f"not within {PATIENCE} s: {otherwise()}"
        assert loop.time() < longest, f"not within {_LONGEST} s of the loop: {otherwise()}"
        await loop.changed()
