"""Marks: ticks with notable events, for the timeline."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.world import WorldState

MarkKind: TypeAlias = Literal[
    "victory", "breakpoint", "program", "edit", "stuck", "circling", "area", "notice", "memory"
]

STUCK_AFTER = 100
"""Ticks in a row for which a robot that is stuck has been blocked."""

MARK_KINDS: tuple[MarkKind, ...] = get_args(MarkKind)
"""All kinds, the rarest and so most significant first."""


class Mark(NamedTuple):
    """An event in a tick, with the robots or areas concerned, if any.

    A ``stuck`` robot was blocked for `STUCK_AFTER` ticks, a ``circling`` one repeats its way
    (see `rounds.py`); an ``edit`` is at the end of the tick.
    """

    kind: MarkKind
    names: tuple[str, ...] = ()


def marks_of(
    frame: Frame, decisions_before: tuple[Decision, ...]
) -> Iterator[tuple[MarkKind, int]]:
    """Return the events of a tick, each with the indices concerned, as bits."""
    before, after = frame.before, frame.after
    if after.won_at == frame.tick and frame.tick:
        yield "victory", 1
    if areas := _differing([a.active for a in before.areas], [a.active for a in after.areas]):
        yield "area", areas
    if any(decision.notices for decision in frame.decisions):
        kinds = [{notice.kind for notice in each.notices} for each in frame.decisions]
        known = [{notice.kind for notice in each.notices} for each in decisions_before]
        known = known or [set()] * len(kinds)
        pairs = zip(kinds, known, strict=True)
        if new := sum(1 << i for i, (now, then) in enumerate(pairs) if now - then):
            yield "notice", new
    if frame.memories != frame.memories_before:
        was, now = frame.memories_before, frame.memories
        yield "memory", _differing([was[name] for name in now], list(now.values()))


def _differing(before: list[object], after: list[object]) -> int:
    """Return the indices at which two lists of equal length differ, as bits."""
    if before == after:
        return 0
    pairs = zip(before, after, strict=True)
    return sum(1 << i for i, (then, now) in enumerate(pairs) if then != now)


class Marks:
    def __init__(self, state: WorldState) -> None:
        self._robots: list[str] = []
        self._areas: list[str] = []
        self._ticks: dict[MarkKind, array[int]] = {kind: array("q") for kind in MARK_KINDS}
        self._who: dict[MarkKind, list[int]] = {kind: [] for kind in MARK_KINDS}
        self.refer_to(state)

    def note(self, tick: int, kind: MarkKind, who: int = 1) -> None:
        """Store a mark; `who` is a bit set of indices. Fastest for a tick after all others."""
        if places := self._places.get(kind):
            who = sum(1 << place for now, place in enumerate(places) if who >> now & 1)
        ticks, everyone = self._ticks[kind], self._who[kind]
        at = len(ticks) if not ticks or ticks[-1] < tick else bisect_left(ticks, tick)
        if at < len(ticks) and ticks[at] == tick:
            everyone[at] |= who
        else:
            ticks.insert(at, tick)
            everyone.insert(at, who)

    def refer_to(self, state: WorldState) -> None:
        robots = _places([robot.name for robot in state.robots], self._robots)
        areas = _places([area.name for area in state.areas], self._areas)
        self._places: dict[MarkKind, list[int]] = {
            "area": areas,
            "stuck": robots,
            "circling": robots,
            "notice": robots,
            "memory": robots,
        }

    def at(self, tick: int) -> tuple[Mark, ...]:
        """Return the marks of one tick, the most significant first."""
        found = []
        for kind, ticks in self._ticks.items():
            at = bisect_left(ticks, tick)
            if at < len(ticks) and ticks[at] == tick:
                found.append(Mark(kind, self._named(kind, self._who[kind][at])))
        return tuple(found)

    def has(self, kind: MarkKind, first: int, last: int, robot: str | None = None) -> bool:
        """Return whether ticks `first` to `last` have a mark; for a robot, of its own memory."""
        ticks = self._ticks[kind]
        begin, end = bisect_left(ticks, first), bisect_right(ticks, last)
        if kind != "memory" or robot not in self._robots:
            return begin < end
        who = 1 << self._robots.index(robot)
        return any(everyone & who for everyone in self._who[kind][begin:end])

    def nearest(
        self, tick: int, steps: Literal[-1, 1], kinds: Collection[MarkKind], robot: str | None
    ) -> int | None:
        """Return the nearest other tick with a mark, or with a change of the robot's memory."""
        found = [self._next(kind, tick, steps, ~0) for kind in kinds]
        if robot in self._robots:
            found.append(self._next("memory", tick, steps, 1 << self._robots.index(robot)))
        known = [each for each in found if each is not None]
        if not known:
            return None
        return min(known) if steps > 0 else max(known)

    def copy(self, last: int) -> Marks:
        copy = Marks.__new__(Marks)
        copy._robots, copy._areas = self._robots.copy(), self._areas.copy()
        copy._places = self._places
        ends = {kind: bisect_right(ticks, last) for kind, ticks in self._ticks.items()}
        copy._ticks = {kind: ticks[: ends[kind]] for kind, ticks in self._ticks.items()}
        copy._who = {kind: who[: ends[kind]] for kind, who in self._who.items()}
        return copy

    def forget_before(self, tick: int) -> None:
        for kind, ticks in self._ticks.items():
            end = bisect_left(ticks, tick)
            del ticks[:end], self._who[kind][:end]

    def _next(self, kind: MarkKind, tick: int, steps: Literal[-1, 1], who: int) -> int | None:
        ticks, everyone = self._ticks[kind], self._who[kind]
        at = bisect_right(ticks, tick) if steps > 0 else bisect_left(ticks, tick) - 1
        while 0 <= at < len(ticks):
            if everyone[at] & who:
                return ticks[at]
            at += steps
        return None

    def _named(self, kind: MarkKind, who: int) -> tuple[str, ...]:
        if kind == "area":
            names = self._areas
        elif kind in ("stuck", "circling", "notice", "memory"):
            names = self._robots
        else:
            names = []
        return tuple(name for place, name in enumerate(names) if who >> place & 1)


def _places(names: list[str], known: list[str]) -> list[int]:
    """Return the indices of names among the known ones, adding new ones; [] if identical."""
    left = list(enumerate(known))
    places = []
    for name in names:
        found = next((pair for pair in left if pair[1] == name), None)
        if found is None:
            found = len(known), name
            known.append(name)
        else:
            left.remove(found)
        places.append(found[0])
    return [] if places == list(range(len(names))) else places
