"""The sensors and memories of one tick, who sees which of them, and the budget of evaluations."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from operator import itemgetter
from typing import Any, Literal, NamedTuple

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.limits import Limits, weight_of_row
from logical_robots_tui.mind.sqlite.budget import Budget
from logical_robots_tui.values import SensorRow, Value


class View(NamedTuple):
    """Robots that think alike, and the first and last numbers of the rows that they see."""

    viewers: tuple[str, ...]
    sensors: tuple[int, int]
    memories: tuple[int, int]


class Moment:
    """The sensors and memories of one tick; the rows that a robot sees are adjacent.

    Attributes:
        sensors: The sensor rows, numbered from 0.
        names: Names of the robots, in the same order.
        memories: Ascending numbers and names of the visible memories: robot m's memory, as
            seen by robot n, has number n * `stride` + m.
        stride: The number of robots; 0 if all see the same memories.
        apart: Whether each robot sees only its own sensor.
    """

    def __init__(
        self,
        rows: Sequence[SensorRow],
        memories: Mapping[str, Value],
        memory: Literal["own", "seen", "all"],
        sensor: Literal["own", "all"],
    ) -> None:
        self._objects: list[list[Any]] | None = None
        self._rays_to: dict[str, Sequence[Sequence[tuple[int, Mapping[str, Any]]]]] = {}
        self.sensors = rows
        self.remembered = memories
        self.names = names = [row["robot_name"] for row in rows]
        self.apart = sensor == "own"
        self.stride = 0 if memory == "all" else len(rows)
        if memory == "seen":
            self.memories = self._met()
        else:
            own = self.stride + 1
            self.memories = [(n * own, name) for n, name in enumerate(names)]
        last = len(rows) - 1
        if not rows:
            self.views: list[View] = []
        elif memory == "all" and sensor == "all":
            self.views = [View(tuple(names), (0, last), (0, last))]
        else:
            self.views = [
                View(
                    (name,),
                    (n, n) if self.apart else (0, last),
                    (n * self.stride, n * self.stride + last),
                )
                for n, name in enumerate(names)
            ]

    @classmethod
    def stacked(cls, moments: Sequence[Moment]) -> Moment:
        """Return several moments, in which each robot sees only its own sensor, as one.

        Its robots are those of all moments in turn; each sees what it sees in its moment.
        """
        rows = [row for moment in moments for row in moment.sensors]
        stack = cls(rows, {}, "own", "own")
        remembered: dict[str, Value] = {}
        memories: list[tuple[int, str]] = []
        first = 0
        for moment in moments:
            size = len(moment.sensors)
            owners = [_Owner(name) for name in moment.names]
            for owner in owners:
                remembered[owner] = moment.remembered.get(str(owner))
            seen = [number for number, _ in moment.memories]
            if not moment.stride:
                seen = [n * size + m for n in range(size) for m in seen]
            for number in seen:
                viewer, mine = divmod(number, size)
                memories.append(((first + viewer) * len(rows) + first + mine, owners[mine]))
            first += size
        stack.remembered, stack.memories = remembered, memories
        return stack

    def rays_to(self, kind: str) -> Sequence[Sequence[tuple[int, Mapping[str, Any]]]]:
        found = self._rays_to.get(kind)
        if found is None:
            if self._objects is None:
                self._objects = [[*map(_OBJECT, row["sensor"]["radar"])] for row in self.sensors]
            found = self._rays_to[kind] = [
                _pick(kind, objects, row) if kind in objects else ()
                for objects, row in zip(self._objects, self.sensors, strict=True)
            ]
        return found

    def one_by_one(self, view: View) -> Iterator[View]:
        for name in view.viewers if len(view.viewers) > 1 else ():
            number = next(i for i, row in enumerate(self.sensors) if row["robot_name"] == name)
            yield View((name,), (number, number), (number, number))

    def _met(self) -> list[tuple[int, str]]:
        names = self.names
        numbers = {name: number for number, name in enumerate(names)}
        found = []
        for number, rays in enumerate(self.rays_to("robot")):
            seen = {numbers.get(ray["label"], number) for _, ray in rays}
            found += [(number * len(names) + m, names[m]) for m in sorted(seen | {number})]
        return found


class _Owner(str):
    """The name of a memory's owner at one of several moments, different from all others."""

    __slots__ = ()
    __eq__ = object.__eq__
    __hash__ = object.__hash__


_OBJECT = itemgetter("object")


def _pick(
    kind: str, objects: Sequence[Any], row: SensorRow
) -> Sequence[tuple[int, Mapping[str, Any]]]:
    radar = row["sensor"]["radar"]
    return [(n, radar[n]) for n, found in enumerate(objects) if found == kind]


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

    def again(self) -> Within:
        """Return the same budget unused, counted exactly."""
        return replace(self, seconds=max(self.budget.seconds, 0.0), anew=True)

    def each(self, row: Sequence[Any]) -> Sequence[Any]:
        """Return the row, or raise Stopped or TooHeavyError (bytes of all rows together)."""
        if self.stop is not None and self.stop.is_set():
            raise Stopped("The program was stopped while its answer was read.")
        self._left -= weight_of_row(row)
        if self._left < 0:
            raise TooHeavyError(f"all results together take more than {self.weight:,} bytes")
        return row
