"""Marks: ticks with notable events, for the timeline."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterator, Sequence
from copy import copy
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.world import RobotState, WorldState


MarkKind: TypeAlias = Literal[
    "victory", "breakpoint", "program", "edit", "stuck", "circling", "area", "notice", "memory"
]

STUCK_AFTER = 100
"""Ticks in a row for which a robot that is stuck has been blocked."""

ROUNDS = 3
"""How often in a row a robot that goes round in circles has gone the same way."""

MARK_KINDS: tuple[MarkKind, ...] = get_args(MarkKind)
"""All kinds, the rarest and so most significant first."""


class Mark(NamedTuple):
    """An event in a tick, with the robots or areas concerned, if any.

    A ``stuck`` robot was blocked for `STUCK_AFTER` ticks, a ``circling`` one repeats its way
    (see `Rounds`); an ``edit`` is at the end of the tick.
    """

    kind: MarkKind
    names: tuple[str, ...] = ()


_BLOCKED = f"stuck: blocked for {STUCK_AFTER} ticks."
_CIRCLES = f"in circles: {ROUNDS} times the same way."
_TROUBLE: dict[MarkKind, tuple[str, str]] = {
    "stuck": (f"is {_BLOCKED}", f"are {_BLOCKED}"),
    "circling": (f"goes round {_CIRCLES}", f"go round {_CIRCLES}"),
}
"""What is said of one robot, and of several."""


def trouble(mark: Mark) -> str:
    """Return a sentence about robots that get nowhere, or ""."""
    words = _TROUBLE.get(mark.kind)
    names = clip(one_line(", ".join(mark.names)), 60)
    return f"{names} {words[len(mark.names) > 1]}" if words is not None else ""


def marks_of(frame: Frame, old_decisions: tuple[Decision, ...]) -> Iterator[tuple[MarkKind, int]]:
    """Return the events of a tick, each with the indices concerned, as bits."""
    start, end = frame.before, frame.after
    if end.won_at == frame.tick and frame.tick:
        yield "victory", 1
    if areas := _difference_bits([a.active for a in start.areas], [a.active for a in end.areas]):
        yield "area", areas
    if any(decision.notices for decision in frame.decisions):
        kinds = [{notice.kind for notice in decision.notices} for decision in frame.decisions]
        old_kinds = [{notice.kind for notice in decision.notices} for decision in old_decisions]
        old_kinds = old_kinds or [set()] * len(kinds)
        pairs = zip(kinds, old_kinds, strict=True)
        if robots := sum(1 << i for i, (new_kinds, old) in enumerate(pairs) if new_kinds - old):
            yield "notice", robots
    if frame.memories != frame.memories_before:
        memories, old = frame.memories, frame.memories_before
        yield "memory", _difference_bits([old[name] for name in memories], [*memories.values()])


def _difference_bits(old: list[object], new: list[object]) -> int:
    """Return the indices at which two lists of equal length differ, as bits."""
    if old == new:
        return 0
    pairs = zip(old, new, strict=True)
    return sum(1 << i for i, (a, b) in enumerate(pairs) if a != b)


class Marks:
    def __init__(self, state: WorldState) -> None:
        self._robots: list[str] = []
        self._areas: list[str] = []
        self._ticks: dict[MarkKind, array[int]] = {kind: array("q") for kind in MARK_KINDS}
        self._bits: dict[MarkKind, list[int]] = {kind: [] for kind in MARK_KINDS}
        self.refer_to(state)

    def note(self, tick: int, kind: MarkKind, bits: int = 1) -> None:
        """Store a mark; `bits` is a set of indices. Fastest for a tick after all others."""
        if places := self._places.get(kind):
            bits = sum(1 << place for index, place in enumerate(places) if bits >> index & 1)
        ticks, masks = self._ticks[kind], self._bits[kind]
        position = len(ticks) if not ticks or ticks[-1] < tick else bisect_left(ticks, tick)
        if position < len(ticks) and ticks[position] == tick:
            masks[position] |= bits
        else:
            ticks.insert(position, tick)
            masks.insert(position, bits)

    def refer_to(self, state: WorldState) -> None:
        robots = _places([robot.name for robot in state.robots], self._robots)
        areas = _places([area.name for area in state.areas], self._areas)
        of_robots: list[MarkKind] = ["stuck", "circling", "notice", "memory"]
        self._places: dict[MarkKind, list[int]] = dict.fromkeys(of_robots, robots)
        self._places["area"] = areas

    def marks_at(self, tick: int) -> tuple[Mark, ...]:
        """Return the marks of one tick, the most significant first."""
        marks = []
        for kind, ticks in self._ticks.items():
            index = bisect_left(ticks, tick)
            if index < len(ticks) and ticks[index] == tick:
                bits = self._bits[kind][index]
                names = self._areas if kind == "area" else self._robots
                indexed_names = enumerate(names if kind in self._places else ())
                marks.append(Mark(kind, tuple(name for n, name in indexed_names if bits >> n & 1)))
        return tuple(marks)

    def has(self, kind: MarkKind, first: int, last: int, robot: str | None = None) -> bool:
        """Return whether ticks `first` to `last` have a mark; for a robot, of its own memory."""
        ticks = self._ticks[kind]
        begin, end = bisect_left(ticks, first), bisect_right(ticks, last)
        if kind != "memory" or robot not in self._robots:
            return begin < end
        bits = 1 << self._robots.index(robot)
        return any(masks & bits for masks in self._bits[kind][begin:end])

    def nearest(
        self, tick: int, steps: Literal[-1, 1], kinds: Collection[MarkKind], robot: str | None
    ) -> int | None:
        """Return the nearest other tick with a mark, or with a change of the robot's memory."""
        candidates = [self._next(kind, tick, steps, ~0) for kind in kinds]
        if robot in self._robots:
            candidates.append(self._next("memory", tick, steps, 1 << self._robots.index(robot)))
        ticks = [candidate for candidate in candidates if candidate is not None]
        if not ticks:
            return None
        return min(ticks) if steps > 0 else max(ticks)

    def up_to(self, last: int) -> Marks:
        marks = copy(self)
        marks._robots, marks._areas = self._robots.copy(), self._areas.copy()
        ends = {kind: bisect_right(ticks, last) for kind, ticks in self._ticks.items()}
        marks._ticks = {kind: ticks[: ends[kind]] for kind, ticks in self._ticks.items()}
        marks._bits = {kind: bits[: ends[kind]] for kind, bits in self._bits.items()}
        return marks

    def forget_before(self, tick: int) -> None:
        for kind, ticks in self._ticks.items():
            end = bisect_left(ticks, tick)
            del ticks[:end], self._bits[kind][:end]

    def _next(self, kind: MarkKind, tick: int, steps: Literal[-1, 1], bits: int) -> int | None:
        ticks, masks = self._ticks[kind], self._bits[kind]
        index = bisect_right(ticks, tick) if steps > 0 else bisect_left(ticks, tick) - 1
        while 0 <= index < len(ticks):
            if masks[index] & bits:
                return ticks[index]
            index += steps
        return None


def _places(names: list[str], registry: list[str]) -> list[int]:
    """Return the indices of names among the known ones, adding new ones; [] if identical."""
    free = list(enumerate(registry))
    places = []
    for name in names:
        match = next((pair for pair in free if pair[1] == name), None)
        if match is None:
            match = len(registry), name
            registry.append(name)
        else:
            free.remove(match)
        places.append(match[0])
    return [] if places == list(range(len(names))) else places


_CELL = 10.0  # map units
_SECTORS = 8  # of headings
_SHORTEST = 20  # ticks of a round
_SOONEST = 100  # ticks of rounds before they are told
_FEWEST = 4  # places of a round; a robot on the border between two may change to and fro
_MISSES = 3  # places in a row that may differ from the round before
_MOST = 4096  # places that are remembered


class Rounds:
    """Detects robots that go round in circles.

    A place is a square of the map with a sector of headings. A robot circles if it revisits
    place after place in the same number of ticks, within a tenth.
    """

    def __init__(self) -> None:
        self._traces: dict[str, _Trace] = {}
        self._tick = 0

    def follow(self, robots: Sequence[RobotState]) -> int:
        """Return the indices of robots that have just ended their last round, as bits."""
        bits = 0
        self._tick += 1
        for index, robot in enumerate(robots):
            place = _map_place(robot)
            trace = self._traces.get(robot.name)
            if trace is None:
                trace = self._traces[robot.name] = _Trace()
            if place != trace.place and trace.enter(place, self._tick):
                bits |= 1 << index
        return bits


def last_rounds(path: Sequence[RobotState]) -> tuple[int, int] | None:
    """Return index and period of the rounds in which one robot's path ends, or None."""
    trace = _Trace()
    for tick, robot in enumerate(path):
        if (place := _map_place(robot)) != trace.place:
            trace.enter(place, tick)
    end = len(path) - 1
    if trace.place is None or not trace.goes_round(end):
        return None
    if end - trace.visits[trace.place] > trace.period:
        return None  # it has stopped since
    return max(trace.since - trace.period, 0), trace.period


_Place = tuple[float, float, float]


def _map_place(robot: RobotState) -> _Place:
    sector = robot.angle % math.tau * _SECTORS // math.tau
    return robot.x // _CELL, robot.y // _CELL, sector


class _Trace:
    """Where one robot was when.

    `period` is the ticks of a round, or 0 if the robot is somewhere new; `hits` counts places
    reached a period after their last visit, `misses` others in a row.
    """

    __slots__ = ("hits", "is_reported", "misses", "period", "place", "since", "visits")

    def __init__(self) -> None:
        self.place: _Place | None = None
        self.visits: dict[_Place, int] = {}
        self.period = self.since = self.hits = self.misses = 0
        self.is_reported = False

    def enter(self, place: _Place, tick: int) -> bool:
        """Record a visit to a place; return whether to report the rounds now."""
        self.place = place
        if len(self.visits) >= _MOST:
            self.visits.clear()
        lag = tick - self.visits.get(place, tick)
        self.visits[place] = tick
        if 0 < lag < _SHORTEST:
            return False
        if self.period and abs(lag - self.period) <= max(3, self.period // 10):
            self.hits, self.misses = self.hits + 1, 0
        else:
            self.misses += 1
            if not self.period or self.misses > _MISSES:
                self.period, self.since, self.hits, self.misses = lag, tick, 0, 0
                self.is_reported = self.is_reported and lag > 0
        if self.is_reported or not self.goes_round(tick):
            return False
        self.is_reported = True
        return True

    def goes_round(self, tick: int) -> bool:
        repeats = ROUNDS - 1
        return (
            self.period > 0
            and tick - self.since >= max(repeats * self.period, _SOONEST)
            and self.hits >= repeats * _FEWEST
        )
