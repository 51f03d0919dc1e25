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

STEPS_AT_ONCE = 20_000
"""Steps of SQLite's virtual machine between two counts: a fifth of a millisecond or more."""

STEPS_OF_A_CALL = 10
"""Steps that a call of one of our functions counts; each character counts one more."""

_BYTES_OF_A_STEP = 8  # of what an aggregate holds when it ends; it may sort that

_UNCOUNTED = 2**62  # for our own statements
_LOOK_SECONDS = 0.02
_QUIET_LOOKS = 50  # idle looks before the thread goes to sleep


@dataclass(slots=True, eq=False)
class Budget:
    """A budget shared by several evaluations.

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
"""Characters of an answer that is weighed row by row."""

_CLOSE = 0.1  # of all steps; far more than the error of an inexact count


@dataclass(slots=True, eq=False)
class Within:
    """The budget of steps and rows that several evaluations share.

    Attributes:
        steps: Steps for all of them, as a `Budget` counts them.
        seconds: The time limit.
        rows: The most rows of one evaluation.
        stop: Ends them when set.
        cut: Whether further rows are left out instead of being an error.
        anew: Whether to prepare statements again. SQLite continues counting the steps of a prepared
            statement from its last run; only a new one gives the same count each time.
        weight: The most bytes of objects in the rows of all evaluations.
        budget: The rest of the budget.
        is_much: Whether the last answer is so large that each of its rows must be checked.
    """

    steps: int
    seconds: float
    rows: int
    stop: threading.Event | None
    _: KW_ONLY
    cut: bool = False
    anew: bool = False
    weight: int = 96_000_000
    is_much: bool = field(default=True, init=False)
    budget: Budget = field(init=False)
    _left: int = field(init=False)

    def __post_init__(self) -> None:
        self.renew()

    @classmethod
    def of_thought(cls, limits: Limits) -> Within:
        steps, seconds, rows = limits.think_steps, limits.think_seconds, limits.think_rows
        return cls(steps, seconds, rows, None, weight=limits.think_weight)

    @classmethod
    def of_query(
        cls, limits: Limits, rows: int, stop: threading.Event | None, *, cut: bool = True
    ) -> Within:
        steps, seconds = limits.query_steps, limits.query_seconds
        return cls(steps, seconds, rows, stop, cut=cut, weight=limits.think_weight)

    @property
    def is_close(self) -> bool:
        """Return whether so little is left that only an exact count can find the cause."""
        return not self.anew and self.budget.steps < self.steps * _CLOSE

    def renew(self) -> None:
        self._left = self.weight
        self.budget = Budget(self.steps, self.seconds)

    @contextmanager
    def at_most(self, steps: int) -> Iterator[None]:
        """Bound the steps of what follows; they are spent of the budget."""
        whole = self.budget
        self.budget = part = Budget(min(steps, whole.steps), whole.seconds)
        try:
            yield
        finally:
            whole.steps -= min(steps, whole.steps) - part.steps
            whole.seconds, whole.is_late = part.seconds, part.is_late
            self.budget = whole

    def again(self) -> Within:
        """Return the same budget unused, counted exactly."""
        return replace(self, seconds=max(self.budget.seconds, 0.0), anew=True)

    def weigh(self, row: Sequence[Any]) -> None:
        """Count the bytes of a row; raise Stopped, or TooHeavyError if all take too many."""
        if self.stop is not None and self.stop.is_set():
            raise Stopped("The program was stopped while its answer was read.")
        self._left -= weight_of_row(row)
        if self._left < 0:
            raise TooHeavyError(f"all results together take more than {self.weight:,} bytes")


class Work:
    """Work that can be halted: `halt` is called in another thread repeatedly until it ends."""

    __slots__ = (
        *("_budget", "_halt", "_most_bytes", "_number", "_stop"),
        *("bytes", "halted", "is_full", "steps"),
    )

    def __init__(self, halt: Callable[[], None], most_bytes: int = _UNCOUNTED) -> None:
        self._halt = halt
        self._most_bytes = most_bytes
        self._renew(Budget(_UNCOUNTED, 0.0), None)

    def begin(self, budget: Budget, stop: threading.Event | None) -> None:
        self._renew(budget, stop)
        _watcher.add(self)

    def _renew(self, budget: Budget, stop: threading.Event | None) -> None:
        self._budget, self._stop = budget, stop
        self.steps, self.bytes, self._number = budget.steps, self._most_bytes, 0
        self.is_full = self.halted = False

    def end(self) -> None:
        _watcher.remove(self)
        self._budget.steps, self.steps = self.steps, _UNCOUNTED

    @property
    def stopped(self) -> bool:
        """Return whether the caller halted it, as opposed to the budget being used up."""
        return self._stop is not None and self._stop.is_set()

    @property
    def is_over(self) -> bool:
        return self.halted or self.steps < 0

    def count(self) -> bool:
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
        if self.halted or self.steps < 0:
            raise TooLargeError("the think was halted")

    def hold(self, size: int) -> None:
        """Count bytes that an aggregate holds; raise TooLargeError if there are too many."""
        self.bytes -= size
        if self.bytes < 0:
            self.is_full = True
            raise TooLargeError("the aggregates hold too much")

    def look(self, seconds: float) -> None:
        """Halt the work if its time is up; `seconds` is the processor time since the last call."""
        self._budget.seconds -= seconds
        if self._budget.seconds < 0:
            self._budget.is_late = True
        if self.stopped or self._budget.is_late:
            self.halted = True
            self._halt()


class _Watcher:
    """The thread that watches, and the work that it watches."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the thread and all work after a fork, which copies the lock but not the thread."""
        self._works: set[Work] = set()
        self._lock = threading.Lock()
        self._awake = threading.Event()
        self._never = threading.Event()
        self._thread: threading.Thread | None = None
        self._looks = False  # whether the thread is alive and awake

    def add(self, work: Work) -> None:
        with self._lock:
            self._works.add(work)
            renew_bound(is_working=True)
            if not self._looks:
                self._looks = True
                self._awake.set()
                if self._thread is None or not self._thread.is_alive():
                    name = "logical-robots-watch"
                    self._thread = threading.Thread(target=self._run, name=name, daemon=True)
                    self._thread.start()

    def remove(self, work: Work) -> None:
        with self._lock:
            self._works.discard(work)

    def _run(self) -> None:
        quiet, last = 0, process_time()
        try:
            while True:
                if not self._awake.is_set():
                    self._awake.wait()
                    last = process_time()  # what was computed meanwhile is nobody's work
                now = process_time()
                with self._lock:
                    quiet = 0 if self._works else quiet + 1
                    for work in self._works:
                        work.look(now - last)
                    renew_bound(is_working=bool(self._works))
                    if quiet > _QUIET_LOOKS:
                        quiet = 0
                        self._looks = False
                        self._awake.clear()
                last = now
                self._never.wait(_LOOK_SECONDS)
        finally:
            self._looks = False


_watcher = _Watcher()
os.register_at_fork(after_in_child=_watcher.reset)


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


def check_items(count: float, most: int = MAX_ITEMS) -> None:
    if count > most:
        raise TooLargeError(f"a list of {count:,} items")


def check_text(length: int) -> None:
    if length > MAX_TEXT:
        raise TooLargeError(f"a string of {length:,} characters")


def charge(
    function: Callable[..., Any],
    work: Work,
    *,
    null_safe: bool = False,
    checks: bool = False,
    extra: Callable[..., int] | None = None,
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
        if extra is not None:
            work.steps -= extra(*arguments)
        if work.halted or work.steps < 0:
            raise TooLargeError("the think was halted")
        if steps > _SHORT and checks:
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


class Aggregate(Protocol):
    """An aggregate; `compares` if each step compares its values with those held.

    A step takes a row, and returns by how many bytes of objects the aggregate grew.
    """

    compares: ClassVar[bool]

    @property
    def step(self) -> Callable[..., int]: ...

    def finalize(self) -> Any: ...


class ChargedAggregate:
    """Charges an aggregate for its steps and for the bytes that it holds."""

    __slots__ = ("_aggregate", "_held", "_work")

    def __init__(self, make: Callable[[], Aggregate], work: Work) -> None:
        self._aggregate = make()
        self._work = work
        self._held = 0

    def step(self, *arguments: Any) -> None:
        steps = STEPS_OF_A_CALL + sum([len(a) for a in arguments if a.__class__ is str])
        if self._aggregate.compares:
            steps += self._held // _BYTES_OF_A_STEP
        self._work.charge(steps)
        try:
            grown = self._aggregate.step(*arguments)
        except RecursionError:
            raise TooLargeError(_TOO_DEEP) from None
        self._held += grown
        self._work.hold(grown)

    def finalize(self) -> Any:
        self._work.charge(STEPS_OF_A_CALL + self._held // _BYTES_OF_A_STEP)
        try:
            result = self._aggregate.finalize()
        except RecursionError:
            raise TooLargeError(_TOO_DEEP) from None
        self._work.hold(-self._held)
        return result


def check_long(text: str) -> None:
    """Raise TooLargeError if a text, or the list or record in it, is too large."""
    check_text(len(text))
    check_items(_size(text))


class Room:
    """The remaining capacity of an aggregate that collects values."""

    __slots__ = ("_characters", "_items", "_size")

    def __init__(self) -> None:
        self._items = 0
        self._size = 0
        self._characters = 0

    def take(self, value: Any, items: int = 1) -> int:
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
