"""Limiting work: steps and bytes end a query, and a thread enforces a time limit."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass, field, replace
from time import process_time
from typing import Any, ClassVar, Protocol

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.limits import Limits, weight_of_row, weight_of_scalar
from logical_robots_tui.processes.lifeline import renew_bound

STEPS_AT_ONCE = 1_000
"""Steps of SQLite's virtual machine between two counts, which take far longer than a count."""

STEPS_OF_A_CALL = 10
"""Steps that a call of one of our functions counts; each character counts one more."""

_BYTES_OF_A_STEP = 8  # of what an aggregate holds when it ends; it may sort that

_UNLIMITED = 2**62  # for our own statements
_CHECK_SECONDS = 0.02
_IDLE_CHECKS = 50  # idle looks before the thread goes to sleep


@dataclass(slots=True, eq=False)
class StepBudget:
    """The steps and seconds that are left.

    Steps are the same on every machine under any load. The seconds are only a safeguard.

    Attributes:
        steps: Steps of SQLite's virtual machine left, including function calls and characters;
            negative if it took too many.
        seconds: Processor seconds of this process left.
        is_late: Whether the seconds ended it.
    """

    steps: int
    seconds: float
    is_late: bool = False


class TooHeavyError(Exception):
    """Rows would take too much memory; the message says how much."""


LONG = 10_000
"""Characters from which on an answer is weighed row by row."""

_CLOSE_SHARE = 0.1  # of all steps; far more than the error of an inexact count


@dataclass(slots=True, eq=False)
class QueryBudget:
    """The budget of steps and rows that several evaluations share.

    Attributes:
        steps: Steps for all of them, as a `StepBudget` counts them.
        rows: The most rows of one evaluation.
        stop: Ends them when set.
        truncates: Whether further rows are left out instead of being an error.
        is_exact: Whether to prepare statements again. SQLite continues counting the steps of a
            prepared statement from its last run; only a new one gives the same count each time.
        weight: The most bytes of objects in the rows of all evaluations.
        is_large: Whether the last answer is so large that each of its rows must be checked.
    """

    steps: int
    seconds: float
    rows: int
    stop: threading.Event | None
    _: KW_ONLY
    truncates: bool = False
    is_exact: bool = False
    weight: int = 96_000_000
    is_large: bool = field(default=True, init=False)
    remainder: StepBudget = field(init=False)
    _weight_left: int = field(init=False)

    def __post_init__(self) -> None:
        self.renew()

    @classmethod
    def of_thought(cls, limits: Limits) -> QueryBudget:
        steps, seconds, rows = limits.think_steps, limits.think_seconds, limits.think_rows
        return cls(steps, seconds, rows, None, weight=limits.think_weight)

    @classmethod
    def of_query(
        cls, limits: Limits, rows: int, stop: threading.Event | None, *, truncates: bool = True
    ) -> QueryBudget:
        steps, seconds = limits.query_steps, limits.query_seconds
        return cls(steps, seconds, rows, stop, truncates=truncates, weight=limits.think_weight)

    @property
    def is_close(self) -> bool:
        """Return whether so little is left that only an exact count can find the cause."""
        return not self.is_exact and self.remainder.steps < self.steps * _CLOSE_SHARE

    def renew(self) -> None:
        self._weight_left = self.weight
        self.remainder = StepBudget(self.steps, self.seconds)

    @contextmanager
    def bound_steps(self, steps: int) -> Iterator[None]:
        """Bound the steps of a block; they are taken from the budget."""
        whole = self.remainder
        self.remainder = part = StepBudget(min(steps, whole.steps), whole.seconds)
        try:
            yield
        finally:
            whole.steps -= min(steps, whole.steps) - part.steps
            whole.seconds, whole.is_late = part.seconds, part.is_late
            self.remainder = whole

    def exact(self) -> QueryBudget:
        """Return the same budget unused, counted exactly."""
        return replace(self, seconds=max(self.remainder.seconds, 0.0), is_exact=True)

    def weigh(self, row: Sequence[Any]) -> None:
        """Count the bytes of a row; raise Stopped, or TooHeavyError if all take too many."""
        if self.stop is not None and self.stop.is_set():
            raise Stopped("The program was stopped while its answer was read.")
        self._weight_left -= weight_of_row(row)
        if self._weight_left < 0:
            raise TooHeavyError(f"all results together take more than {self.weight:,} bytes")


class MeteredWork:
    """Work that can be halted: `halt` is called in another thread repeatedly until it ends."""

    __slots__ = (
        *("_budget", "_halt", "_max_bytes", "_number", "_stop"),
        *("bytes", "is_full", "is_halted", "steps"),
    )

    def __init__(self, halt: Callable[[], None], max_bytes: int = _UNLIMITED) -> None:
        self._halt = halt
        self._max_bytes = max_bytes
        self._renew(StepBudget(_UNLIMITED, 0.0), None)

    def begin(self, budget: StepBudget, stop: threading.Event | None) -> None:
        self._renew(budget, stop)
        _watchdog.add(self)

    def _renew(self, budget: StepBudget, stop: threading.Event | None) -> None:
        self._budget, self._stop = budget, stop
        self.steps, self.bytes, self._number = budget.steps, self._max_bytes, 0
        self.is_full = self.is_halted = False

    def end(self) -> None:
        _watchdog.remove(self)
        self._budget.steps, self.steps = self.steps, _UNLIMITED

    @property
    def is_stopped(self) -> bool:
        """Return whether the caller halted it, as opposed to the budget being used up."""
        return self._stop is not None and self._stop.is_set()

    @property
    def is_over(self) -> bool:
        return self.is_halted or self.steps < 0

    def count_steps(self) -> bool:
        """Count some steps of the virtual machine; return whether to stop."""
        self.steps -= STEPS_AT_ONCE
        return self.steps < 0

    def next_number(self) -> int:
        """Return 1, 2, 3 ... since the work began."""
        self.charge(STEPS_OF_A_CALL)
        self._number += 1
        return self._number

    def charge(self, steps: int) -> None:
        """Count the steps of a call; raise TooLargeError if none are left."""
        self.steps -= steps
        if self.is_halted or self.steps < 0:
            raise TooLargeError("the think was halted")

    def charge_bytes(self, size: int) -> None:
        """Count bytes that an aggregate holds; raise TooLargeError if there are too many."""
        self.bytes -= size
        if self.bytes < 0:
            self.is_full = True
            raise TooLargeError("the aggregates hold too much")

    def spend_seconds(self, seconds: float) -> None:
        """Halt the work if its time is up; `seconds` is the processor time since the last call."""
        self._budget.seconds -= seconds
        if self._budget.seconds < 0:
            self._budget.is_late = True
        if self.is_stopped or self._budget.is_late:
            self.is_halted = True
            self._halt()


class _Watchdog:
    """The thread that halts work when its time is up, and that work."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the thread and all work after a fork, which copies the lock but not the thread."""
        self._pending: set[MeteredWork] = set()
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._timer = threading.Event()
        self._thread: threading.Thread | None = None
        self._is_awake = False  # whether the thread is alive and awake

    def add(self, work: MeteredWork) -> None:
        with self._lock:
            self._pending.add(work)
            renew_bound(is_working=True)
            if not self._is_awake:
                self._is_awake = True
                self._wake.set()
                if self._thread is None or not self._thread.is_alive():
                    name = "logical-robots-watch"
                    self._thread = threading.Thread(target=self._run, name=name, daemon=True)
                    self._thread.start()

    def remove(self, work: MeteredWork) -> None:
        with self._lock:
            self._pending.discard(work)

    def _run(self) -> None:
        idle_checks, last_seconds = 0, process_time()
        try:
            while True:
                if not self._wake.is_set():
                    self._wake.wait()
                    last_seconds = process_time()  # time used while asleep is charged to no work
                seconds = process_time()
                with self._lock:
                    idle_checks = 0 if self._pending else idle_checks + 1
                    for work in self._pending:
                        work.spend_seconds(seconds - last_seconds)
                    renew_bound(is_working=bool(self._pending))
                    if idle_checks > _IDLE_CHECKS:
                        idle_checks = 0
                        self._is_awake = False
                        self._wake.clear()
                last_seconds = seconds
                self._timer.wait(_CHECK_SECONDS)
        finally:
            self._is_awake = False


_watchdog = _Watchdog()
os.register_at_fork(after_in_child=_watchdog.reset)


MAX_ITEMS = 20_000
"""Most items and fields of all lists and records in a value that a function parses."""

MAX_RANGE = 100_000
"""Most numbers in a range."""

_MAX_COLLECTED = 100_000  # items and fields of everything that an aggregate collects

MAX_TEXT = 2_000_000
"""Most characters of a text that a function builds; SQLite also limits the bytes."""

_SHORT = 2 * MAX_ITEMS  # a shorter text can't hold more than MAX_ITEMS items


_TOO_DEEP = "records and lists nested too deeply"


class TooLargeError(OverflowError):
    """A value is larger than a function accepts or returns; SQLite reports it as too big."""


def check_items(count: float, max_count: int = MAX_ITEMS) -> None:
    if count > max_count:
        raise TooLargeError(f"a list of {count:,} items")


def check_text(length: int) -> None:
    if length > MAX_TEXT:
        raise TooLargeError(f"a string of {length:,} characters")


def charge(
    function: Callable[..., Any],
    work: MeteredWork,
    *,
    null_safe: bool = False,
    checks_size: bool = False,
    extra_steps: Callable[..., int] | None = None,
) -> Callable[..., Any]:
    """Charge a function for calls and for the characters that it takes and returns."""

    def charged_function(*arguments: Any) -> Any:
        steps = STEPS_OF_A_CALL
        for argument in arguments:
            if argument.__class__ is str:
                steps += len(argument)
            elif argument is None and null_safe:
                return None
        work.steps -= steps
        if extra_steps is not None:
            work.steps -= extra_steps(*arguments)
        if work.is_halted or work.steps < 0:
            raise TooLargeError("the think was halted")
        if steps > _SHORT and checks_size:
            for argument in arguments:
                if argument.__class__ is str and len(argument) > _SHORT:
                    check_long(argument)
        try:
            result = function(*arguments)
        except RecursionError:
            raise TooLargeError(_TOO_DEEP) from None
        if result.__class__ is str:
            work.steps -= len(result)
        return result

    return charged_function


class AggregateFunction(Protocol):
    """An aggregate; `compares` if each step compares its values with those held.

    A step takes a row, and returns by how many bytes of objects the aggregate grew.
    """

    compares: ClassVar[bool]

    @property
    def step(self) -> Callable[..., int]: ...

    def finalize(self) -> Any: ...


class ChargedAggregate:
    """Charges an aggregate for its steps and for the bytes that it holds."""

    __slots__ = ("_aggregate", "_bytes", "_work")

    def __init__(self, make: Callable[[], AggregateFunction], work: MeteredWork) -> None:
        self._aggregate = make()
        self._work = work
        self._bytes = 0

    def step(self, *arguments: Any) -> None:
        steps = STEPS_OF_A_CALL + sum([len(a) for a in arguments if a.__class__ is str])
        if self._aggregate.compares:
            steps += self._bytes // _BYTES_OF_A_STEP
        self._work.charge(steps)
        try:
            growth = self._aggregate.step(*arguments)
        except RecursionError:
            raise TooLargeError(_TOO_DEEP) from None
        self._bytes += growth
        self._work.charge_bytes(growth)

    def finalize(self) -> Any:
        self._work.charge(STEPS_OF_A_CALL + self._bytes // _BYTES_OF_A_STEP)
        try:
            result = self._aggregate.finalize()
        except RecursionError:
            raise TooLargeError(_TOO_DEEP) from None
        self._work.charge_bytes(-self._bytes)
        return result


def check_long(text: str) -> None:
    """Raise TooLargeError if a text, or the list or record in it, is too large."""
    check_text(len(text))
    check_items(_size(text))


class CollectionLimit:
    """The remaining capacity of an aggregate that collects values."""

    __slots__ = ("_characters", "_items", "_size")

    def __init__(self) -> None:
        self._items = self._size = self._characters = 0

    def add(self, value: Any, items: int = 1) -> int:
        """Count a value; return its bytes as an object. Raises TooLargeError if it is too much."""
        self._items += items
        self._size += items
        check_items(self._items)
        if value.__class__ is str:
            self._characters += len(value)
            check_text(self._characters)
            self._size += _size(value)
        check_items(self._size, _MAX_COLLECTED)
        return weight_of_scalar(value)


def _size(text: str) -> int:
    """Return an upper bound for the items and fields of all lists and records in a text."""
    if text.lstrip()[:1] not in ("[", "{"):
        return 0
    return text.count(",") + text.count("[") + text.count("{")
