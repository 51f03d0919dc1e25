"""A branch: one history of a game, tick after tick, with its levels."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from logical_robots_tui.game.advancing import RecordedTick
from logical_robots_tui.game.frame import Frame, driven
from logical_robots_tui.game.history.marks import STUCK_AFTER, Marks, Rounds, marks_of
from logical_robots_tui.game.history.packing import Packed, TickState
from logical_robots_tui.mind import Decision
from logical_robots_tui.world import Level
from logical_robots_tui.world.walls import PackedBits

if TYPE_CHECKING:
    from logical_robots_tui.game.debugging.breakpoints import Hit
    from logical_robots_tui.mind import Program
    from logical_robots_tui.values import Value


Matter: TypeAlias = Literal["desire", "memory", "notices", "position", "battery"]


@dataclass(frozen=True, slots=True)
class Difference:
    """A difference between the current branch (`here`) and the other one for one robot.

    A ``position`` includes heading and engines.
    """

    robot_name: str
    matter: Matter
    here: Any
    there: Any


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first tick in which two branches differ; decisions first, in file order."""

    tick: int
    differences: tuple[Difference, ...]

    def reversed(self) -> Divergence:
        turned = (replace(each, here=each.there, there=each.here) for each in self.differences)
        return Divergence(self.tick, tuple(turned))


def find_divergence(here: TickState, there: TickState) -> Divergence | None:
    if here.decisions == there.decisions and here.after == there.after:
        return None
    return Divergence(here.after.tick, (*_of_decisions(here, there), *_of_robots(here, there)))


def _of_decisions(here: TickState, there: TickState) -> Iterator[Difference]:
    others = {decision.robot_name: decision for decision in there.decisions}
    for mine in here.decisions:
        other = others.get(mine.robot_name)
        if other is not None and mine != other:
            those = _matters(other)
            for matter, value in _matters(mine).items():
                if value != those[matter]:
                    yield Difference(mine.robot_name, matter, value, those[matter])


def _matters(decision: Decision) -> dict[Matter, object]:
    return {
        "desire": decision.desire,
        "memory": decision.memory,
        "notices": tuple(notice.message for notice in decision.notices),
    }


def _of_robots(here: TickState, there: TickState) -> Iterator[Difference]:
    others = {robot.name: robot for robot in there.after.robots}
    for mine in here.after.robots:
        other = others.get(mine.name)
        if other is None:
            continue
        place, that = (mine.x, mine.y, mine.angle), (other.x, other.y, other.angle)
        if place != that:
            yield Difference(mine.name, "position", place, that)
        if mine.battery_level != other.battery_level:
            yield Difference(mine.name, "battery", mine.battery_level, other.battery_level)


_TOGETHER = 32  # moments in a pack, unless they are heavy
_HEAVY = 12_000_000  # bytes of objects in a pack, unless a single moment has more

_begin_of = attrgetter("first")


class Branch:
    """The last ticks of a history, without gaps; diverging branches share immutable packs."""

    def __init__(self, frame: Frame, level: Level, length: int) -> None:
        self.marks = Marks(frame.after)
        self.levels = Levels(frame.tick, level)
        self.hits: dict[int, tuple[Hit, ...]] = {}
        self._length = length
        self.packs: list[Packed] = []
        self._loose = [TickState(frame.after, frame.memories, frame.decisions, 0.0, 0.0)]
        self._oldest = frame.tick  # that is kept, whether too old or not
        self._programs: list[tuple[int, Program]] = []
        self._unreliable_from: int | None = None
        self._blocked_from: int | None = None
        self._blocked: dict[str, int] = {}  # ticks in a row, by robot
        self._rounds = Rounds()

    @property
    def last(self) -> int:
        return self._loose[-1].after.tick

    @property
    def first(self) -> int:
        """The earliest tick that can be restored; its previous moment is stored."""
        oldest = max(self._oldest, self.last - self._length)
        return oldest + 1 if oldest else 0

    @property
    def loose_weight(self) -> int:
        return sum(moment.weight for moment in self._loose)

    def add(self, frame: Frame, program: Program) -> bool:
        """Store the next tick and the program that decided it; return whether ticks were packed."""
        before = self._loose[-1]
        self._loose.append(TickState.of(frame, before.driven + driven(frame.before, frame.after)))
        for kind, who in marks_of(frame, before.decisions):
            self.marks.note(frame.tick, kind, who)
        earlier, robots = self._blocked, frame.after.robots
        self._blocked = {r.name: earlier.get(r.name, 0) + 1 for r in robots if r.blocked}
        counts = [self._blocked.get(robot.name) for robot in robots]
        if stuck := sum(1 << i for i, count in enumerate(counts) if count == STUCK_AFTER):
            self.marks.note(frame.tick, "stuck", stuck)
        if circling := self._rounds.follow(robots):
            self.marks.note(frame.tick, "circling", circling)
        if self._unreliable_from is None and not frame.is_reliable:
            self._unreliable_from = frame.tick
        if self._blocked_from is None and self._blocked:
            self._blocked_from = frame.tick
        if not self._programs or self._programs[-1][1].texts != program.texts:
            if self._programs:
                self.marks.note(frame.tick, "program")
            self._programs.append((frame.tick, program))
            self._rounds = Rounds()
        is_packed = False
        while together := self._ready():
            try:
                self.packs.append(Packed(self._loose[:together]))
            except MemoryError:
                self.packs.clear()  # drop everything older as well, because there must be no gaps
                self._forget_before(self._loose[together].after.tick)
            del self._loose[:together]
            is_packed = True
        while self.packs and self._begin_after_first_pack() <= self.last - self._length:
            self.forget_pack()
        return is_packed

    def change_level(self, frame: Frame, level: Level) -> None:
        """Continue from the last tick, which is never packed, in another level."""
        self._loose[-1] = TickState.of(frame, self._loose[-1].driven)
        self.marks.refer_to(frame.after)
        if frame.tick > self._oldest:
            self.marks.note(frame.tick, "edit")
        self.levels.change(frame.tick, level)
        self._rounds = Rounds()

    def forget_pack(self) -> bool:
        if self.packs:
            begin = self._begin_after_first_pack()
            del self.packs[0]
            self._forget_before(begin)
        return bool(self.packs)

    def moment(self, tick: int) -> TickState:
        """Return the state after a tick, from the one before `first` to `last`."""
        begin = self._loose[0].after.tick
        if tick >= begin:
            return self._loose[tick - begin]
        pack = self.packs[bisect_right(self.packs, tick, key=_begin_of) - 1]
        return pack.moment(tick - pack.first)

    def memory(self, tick: int, robot: str) -> Value:
        """Return a robot's memory after a tick; raise LookupError if it is not there."""
        begin = self._loose[0].after.tick
        if tick >= begin:
            return self._loose[tick - begin].memories[robot]
        pack = self.packs[bisect_right(self.packs, tick, key=_begin_of) - 1]
        return pack.memory(tick - pack.first, robot)

    def known(self, tick: int) -> RecordedTick:
        moment = self.moment(tick)
        return RecordedTick(self.levels.at(tick - bool(moment.decisions)), moment)

    def replay(self, tick: int) -> tuple[TickState, RecordedTick]:
        return self.moment(max(tick - 1, 0)), self.known(tick)

    def up_to(self, tick: int) -> Branch:
        copy = Branch.__new__(Branch)
        copy.marks = self.marks.copy(tick)
        copy.levels = self.levels.up_to(tick)
        copy.hits = {at: hits for at, hits in self.hits.items() if at <= tick}
        copy._length = self._length
        copy._oldest = self._oldest
        copy._unreliable_from = self._unreliable_from if not self.is_reliable_up_to(tick) else None
        copy._blocked_from = self._blocked_from if self.is_blocked_up_to(tick) else None
        copy._programs = self.programs(tick)
        begins = [*map(_begin_of, self.packs), self._loose[0].after.tick]
        whole = bisect_right(begins, tick) - 1
        copy.packs = self.packs[:whole]
        begin = begins[whole]
        copy._loose = [self.moment(at) for at in range(begin, tick + 1)]
        copy._blocked = self._blocked_until(tick)
        copy._rounds = Rounds()
        return copy

    def _blocked_until(self, tick: int) -> dict[str, int]:
        counts: dict[str, int] = {}
        for at in range(tick, max(self.first, tick - STUCK_AFTER) - 1, -1):
            blocked = [robot.name for robot in self.moment(at).after.robots if robot.blocked]
            still = [name for name in blocked if counts.get(name, 0) == tick - at]
            if not still:
                break
            counts.update(dict.fromkeys(still, tick - at + 1))
        return counts

    def programs(self, tick: int) -> list[tuple[int, Program]]:
        return [(begin, program) for begin, program in self._programs if begin <= tick]

    def program_at(self, tick: int) -> Program | None:
        return next((program for begin, program in reversed(self._programs) if begin <= tick), None)

    def is_reliable_up_to(self, tick: int) -> bool:
        return self._unreliable_from is None or tick < self._unreliable_from

    def is_blocked_up_to(self, tick: int) -> bool:
        return self._blocked_from is not None and self._blocked_from <= tick

    def _ready(self) -> int:
        loose = self._loose
        together, weight = 1, loose[0].weight
        while together < min(len(loose) - 1, _TOGETHER) and weight <= _HEAVY:
            weight += loose[together].weight
            together += 1
        if len(loose) >= 2 * _TOGETHER:
            return together
        is_heavy = len(loose) > 1 and self.loose_weight > 2 * _HEAVY
        return together if is_heavy else 0

    def _begin_after_first_pack(self) -> int:
        rest = self.packs[1:2] or self._loose[:1]
        return rest[0].first if isinstance(rest[0], Packed) else rest[0].after.tick

    def _forget_before(self, tick: int) -> None:
        self._oldest = tick
        self.marks.forget_before(tick)
        self.levels.forget_before(tick)
        self.hits = {at: hits for at, hits in self.hits.items() if at >= tick}


_NO_WALLS = np.zeros((0, 0), np.bool_)


class Levels:
    """The levels of one branch; all but the latest have packed walls."""

    def __init__(self, tick: int, level: Level) -> None:
        self._ticks = [tick]
        self._latest = level
        self._earlier: list[_Packed] = []
        self._opened: tuple[_Packed, Level] | None = None

    @property
    def packed_bytes(self) -> int:
        return sum(len(packed.walls.compressed) for packed in self._earlier)

    def at(self, tick: int) -> Level:
        place = max(bisect_right(self._ticks, tick) - 1, 0)
        if place == len(self._earlier):
            return self._latest
        packed = self._earlier[place]
        if self._opened is None or self._opened[0] is not packed:
            self._opened = packed, packed.level()
        return self._opened[1]

    def is_changed_in(self, tick: int) -> bool:
        return tick in self._ticks[1:]

    def is_changed_up_to(self, tick: int) -> bool:
        return any(changed <= tick for changed in self._ticks[1:])

    def change(self, tick: int, level: Level) -> None:
        """Set the level from a tick's end on; the same level means that robots were moved."""
        is_moved_at_start = level is self._latest and len(self._ticks) == 1
        if tick > self._ticks[-1] or is_moved_at_start:
            self._earlier.append(_Packed.of(self._latest))
            self._ticks.append(tick)
        self._latest = level

    def up_to(self, tick: int) -> Levels:
        copy = Levels(self._ticks[0], self.at(tick))
        place = max(bisect_right(self._ticks, tick), 1)
        copy._ticks = self._ticks[:place]
        copy._earlier = self._earlier[: place - 1]
        return copy

    def forget_before(self, tick: int) -> None:
        place = bisect_right(self._ticks, tick) - 1
        if place > 0:
            del self._ticks[:place], self._earlier[:place]


@dataclass(frozen=True, slots=True, eq=False)
class _Packed:
    rest: Level
    walls: PackedBits

    @classmethod
    def of(cls, level: Level) -> _Packed:
        return cls(replace(level, walls=_NO_WALLS), PackedBits.pack(level.walls))

    def level(self) -> Level:
        walls = self.walls.bits()
        walls.flags.writeable = False
        return replace(self.rest, walls=walls)
