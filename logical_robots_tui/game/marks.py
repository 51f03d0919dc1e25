"""Marks: in which ticks something happened that one may want to find again."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.world import WorldState

__all__ = ["MARK_KINDS", "Mark", "MarkKind", "Marks", "marks_of"]

MarkKind: TypeAlias = Literal[
    "victory", "breakpoint", "program", "edit", "area", "notice", "memory"
]

MARK_KINDS: tuple[MarkKind, ...] = get_args(MarkKind)
"""All kinds, the rarest and so most telling first."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Something that happened in a tick.

    Attributes:
        kind: ``victory``; ``breakpoint``, one was hit; ``program``, another one decided than in
            the tick before; ``edit``, the level was changed at the end of it; ``area``, one was
            switched; ``notice``, one was given that was not there in the tick before; ``memory``,
            one differs from that of the tick before.
        names: Whose notices or memories, or which areas; () for the other kinds.
    """

    kind: MarkKind
    names: tuple[str, ...] = ()


def marks_of(
    frame: Frame, decisions_before: tuple[Decision, ...]
) -> Iterator[tuple[MarkKind, int]]:
    """What happened in a tick, each with the places of those concerned, as bits.

    Args:
        frame: The tick.
        decisions_before: What was decided in the tick before.
    """
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
    """At which places two lists of one length differ, as bits."""
    if before == after:
        return 0
    pairs = zip(before, after, strict=True)
    return sum(1 << i for i, (then, now) in enumerate(pairs) if then != now)


class Marks:
    """The marks of many ticks, found quickly by tick.

    Args:
        state: A world; its robots and areas are those that are spoken of.
    """

    def __init__(self, state: WorldState) -> None:
        self._robots: list[str] = []
        self._areas: list[str] = []
        self._ticks: dict[MarkKind, array[int]] = {kind: array("q") for kind in MARK_KINDS}
        self._who: dict[MarkKind, list[int]] = {kind: [] for kind in MARK_KINDS}
        self.speak_of(state)

    def note(self, tick: int, kind: MarkKind, who: int = 1) -> None:
        """Keep a mark; quickest for a tick after all others.

        Args:
            tick: When.
            kind: What.
            who: Places of the robots or areas concerned, as bits.
        """
        if places := self._places.get(kind):
            who = sum(1 << place for now, place in enumerate(places) if who >> now & 1)
        ticks, everyone = self._ticks[kind], self._who[kind]
        at = len(ticks) if not ticks or ticks[-1] < tick else bisect_left(ticks, tick)
        if at < len(ticks) and ticks[at] == tick:
            everyone[at] |= who
        else:
            ticks.insert(at, tick)
            everyone.insert(at, who)

    def speak_of(self, state: WorldState) -> None:
        """Let the places of robots and areas be those of another world from now on."""
        robots = _places([robot.name for robot in state.robots], self._robots)
        areas = _places([area.name for area in state.areas], self._areas)
        self._places: dict[MarkKind, list[int]] = {
            "area": areas,
            "notice": robots,
            "memory": robots,
        }

    def at(self, tick: int) -> tuple[Mark, ...]:
        """The marks of one tick, the most telling first."""
        found = []
        for kind, ticks in self._ticks.items():
            at = bisect_left(ticks, tick)
            if at < len(ticks) and ticks[at] == tick:
                found.append(Mark(kind, self._named(kind, self._who[kind][at])))
        return tuple(found)

    def has(self, kind: MarkKind, first: int, last: int, robot: str | None = None) -> bool:
        """Whether a kind of mark is in any of the ticks from `first` to `last`.

        Args:
            kind: Which kind.
            first: The first tick.
            last: The last one.
            robot: Whose memory counts, or None for any.
        """
        ticks = self._ticks[kind]
        begin, end = bisect_left(ticks, first), bisect_right(ticks, last)
        if kind != "memory" or robot not in self._robots:
            return begin < end
        who = 1 << self._robots.index(robot)
        return any(everyone & who for everyone in self._who[kind][begin:end])

    def nearest(
        self, tick: int, steps: Literal[-1, 1], kinds: Collection[MarkKind], robot: str | None
    ) -> int | None:
        """The nearest later or earlier tick with a mark, or None.

        Args:
            tick: Where to begin; its own marks don't count.
            steps: Which way to look.
            kinds: Which marks count.
            robot: Whose changes of memory count besides.
        """
        found = [self._next(kind, tick, steps, ~0) for kind in kinds]
        if robot in self._robots:
            found.append(self._next("memory", tick, steps, 1 << self._robots.index(robot)))
        known = [each for each in found if each is not None]
        if not known:
            return None
        return min(known) if steps > 0 else max(known)

    def copy(self, last: int) -> Marks:
        """The same up to a tick."""
        copy = Marks.__new__(Marks)
        copy._robots, copy._areas = self._robots.copy(), self._areas.copy()
        copy._places = self._places
        ends = {kind: bisect_right(ticks, last) for kind, ticks in self._ticks.items()}
        copy._ticks = {kind: ticks[: ends[kind]] for kind, ticks in self._ticks.items()}
        copy._who = {kind: who[: ends[kind]] for kind, who in self._who.items()}
        return copy

    def forget_before(self, tick: int) -> None:
        """Drop the marks of earlier ticks."""
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
        elif kind in ("notice", "memory"):
            names = self._robots
        else:
            names = []
        return tuple(name for place, name in enumerate(names) if who >> place & 1)


def _places(names: list[str], known: list[str]) -> list[int]:
    """Where names are among those known, which the new ones join; [] if that is where they are."""
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
