"""A branch: one history of a game, tick after tick, with its levels."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from logical_robots_tui.game.advancing import RecordedTick
from logical_robots_tui.game.frame import Frame, Peak
from logical_robots_tui.game.history.marks import STUCK_AFTER, Marks, Rounds, marks_of
from logical_robots_tui.game.history.packing import Moment, Packed
from logical_robots_tui.world import Level
from logical_robots_tui.world.walls import PackedBits

if TYPE_CHECKING:
    from logical_robots_tui.game.debugging.breakpoints import Hit
    from logical_robots_tui.mind import Program
    from logical_robots_tui.values import Value


Matter: TypeAlias = Literal["desire", "memory", "notices", "position", "battery"]


@dataclass(frozen=True, slots=True)
class BranchDifference:
    """A difference between the current branch (`value`) and the other one for one robot.

    A ``position`` includes heading and engines.
    """

    robot_name: str
    matter: Matter
    value: Any
    other_value: Any


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first tick in which two branches differ; decisions first, in file order."""

    tick: int
    differences: tuple[BranchDifference, ...]

    def reversed(self) -> Divergence:
        swapped = (replace(d, value=d.other_value, other_value=d.value) for d in self.differences)
        return Divergence(self.tick, tuple(swapped))


def find_divergence(state: Moment, other_state: Moment) -> Divergence | None:
    if state.decisions == other_state.decisions and state.after == other_state.after:
        return None
    other_values = dict(_matters(other_state))
    differences = (
        BranchDifference(*key, value, other_values[key])
        for key, value in _matters(state)
        if key in other_values and value != other_values[key]
    )
    return Divergence(state.after.tick, tuple(differences))


def _matters(moment: Moment) -> Iterator[tuple[tuple[str, Matter], object]]:
    """Yield what is compared of each robot."""
    for decision in moment.decisions:
        yield (decision.robot_name, "desire"), decision.desire
        yield (decision.robot_name, "memory"), decision.memory
        messages = tuple(notice.message for notice in decision.notices)
        yield (decision.robot_name, "notices"), messages
    for robot in moment.after.robots:
        yield (robot.name, "position"), (robot.x, robot.y, robot.angle)
        yield (robot.name, "battery"), robot.battery_level


_TOGETHER = 32  # moments in a pack, unless they are heavy
_HEAVY = 12_000_000  # bytes of objects in a pack, unless a single moment has more

_begin_of = attrgetter("first")


class HistoryBranch:
    """The last ticks of a history, without gaps; diverging branches share immutable packs."""

    def __init__(self, frame: Frame, level: Level, length: int) -> None:
        self.marks = Marks(frame.after)
        self.levels = Levels(frame.tick, level)
        self.hits: dict[int, tuple[Hit, ...]] = {}
        self._length = length
        self.packs: list[Packed] = []
        self._loose = [Moment(frame.after, frame.memories, frame.decisions, 0.0, 0.0)]
        self._oldest = frame.tick  # that is kept, whether too old or not
        self._programs: list[tuple[int, Program]] = []
        self._unreliable_from: int | None = None
        self._blocked_from: int | None = None
        self._blocked: dict[str, int] = {}  # ticks in a row, by robot
        self._rounds = Rounds()
        self._peaks = [Peak().with_tick(level, frame.after)]

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
        previous = self._loose[-1]
        self._loose.append(Moment.from_frame(frame, previous.driven + frame.distance))
        for kind, who in marks_of(frame, previous.decisions):
            self.marks.note(frame.tick, kind, who)
        counts_before, robots = self._blocked, frame.after.robots
        self._blocked = {r.name: counts_before.get(r.name, 0) + 1 for r in robots if r.blocked}
        counts = [self._blocked.get(robot.name) for robot in robots]
        if stuck := sum(1 << i for i, count in enumerate(counts) if count == STUCK_AFTER):
            self.marks.note(frame.tick, "stuck", stuck)
        if circling := self._rounds.follow(robots):
            self.marks.note(frame.tick, "circling", circling)
        peak = self._peaks[-1].with_tick(self.levels.level_at(frame.tick), frame.after)
        if peak is not self._peaks[-1]:
            self._peaks.append(peak)
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
        while count := self._ready():
            try:
                self.packs.append(Packed(self._loose[:count]))
            except MemoryError:
                self.packs.clear()  # drop everything older as well, because there must be no gaps
                self._forget_before(self._loose[count].after.tick)
            del self._loose[:count]
            is_packed = True
        while self.packs and self._begin_after_first_pack() <= self.last - self._length:
            self.forget_pack()
        return is_packed

    def change_level(self, frame: Frame, level: Level) -> None:
        """Continue from the last tick, which is never packed, in another level."""
        self._loose[-1] = Moment.from_frame(frame, self._loose[-1].driven)
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

    def moment(self, tick: int) -> Moment:
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

    def recorded(self, tick: int, previous: Moment | None = None) -> RecordedTick:
        moment, previous = self.moment(tick), previous or self.moment(max(tick - 1, 0))
        return RecordedTick(self.levels.level_at(tick - bool(moment.decisions)), previous, moment)

    def up_to(self, tick: int) -> HistoryBranch:
        branch = copy(self)
        branch.marks = self.marks.up_to(tick)
        branch.levels = self.levels.up_to(tick)
        branch.hits = {t: hits for t, hits in self.hits.items() if t <= tick}
        branch._unreliable_from = (
            self._unreliable_from if not self.is_reliable_up_to(tick) else None
        )
        branch._blocked_from = self._blocked_from if self.is_blocked_up_to(tick) else None
        branch._programs = self.programs(tick)
        branch._peaks = [peak for peak in self._peaks if peak.tick <= tick]
        begins = [*map(_begin_of, self.packs), self._loose[0].after.tick]
        count = bisect_right(begins, tick) - 1
        branch.packs = self.packs[:count]
        begin = begins[count]
        branch._loose = [self.moment(number) for number in range(begin, tick + 1)]
        branch._blocked = self._blocked_until(tick)
        branch._rounds = Rounds()
        return branch

    def _blocked_until(self, tick: int) -> dict[str, int]:
        counts: dict[str, int] = {}
        for number in range(tick, max(self.first, tick - STUCK_AFTER) - 1, -1):
            blocked = [robot.name for robot in self.moment(number).after.robots if robot.blocked]
            names = [name for name in blocked if counts.get(name, 0) == tick - number]
            if not names:
                break
            counts.update(dict.fromkeys(names, tick - number + 1))
        return counts

    def programs(self, tick: int) -> list[tuple[int, Program]]:
        return [(begin, program) for begin, program in self._programs if begin <= tick]

    def peak(self, tick: int) -> Peak:
        """Return the peak up to a tick, also if that is too old to be restored."""
        return next((peak for peak in reversed(self._peaks) if peak.tick <= tick), Peak())

    def program_at(self, tick: int) -> Program | None:
        return next((program for begin, program in reversed(self._programs) if begin <= tick), None)

    def is_reliable_up_to(self, tick: int) -> bool:
        return self._unreliable_from is None or tick < self._unreliable_from

    def is_blocked_up_to(self, tick: int) -> bool:
        return self._blocked_from is not None and self._blocked_from <= tick

    def _ready(self) -> int:
        loose = self._loose
        count, weight = 1, loose[0].weight
        while count < min(len(loose) - 1, _TOGETHER) and weight <= _HEAVY:
            weight += loose[count].weight
            count += 1
        if len(loose) >= 2 * _TOGETHER:
            return count
        is_heavy = len(loose) > 1 and self.loose_weight > 2 * _HEAVY
        return count if is_heavy else 0

    def _begin_after_first_pack(self) -> int:
        oldest = self.packs[1:2] or self._loose[:1]
        return oldest[0].first if isinstance(oldest[0], Packed) else oldest[0].after.tick

    def _forget_before(self, tick: int) -> None:
        self._oldest = tick
        self.marks.forget_before(tick)
        self.levels.forget_before(tick)
        self.hits = {t: hits for t, hits in self.hits.items() if t >= tick}


_NO_WALLS = np.zeros((0, 0), np.bool_)


class Levels:
    """The levels of one branch; all but the latest have packed walls."""

    def __init__(self, tick: int, level: Level) -> None:
        self._ticks = [tick]
        self._latest = level
        self._earlier: list[tuple[Level, PackedBits]] = []  # without walls, and those
        self._cache: tuple[PackedBits, Level] | None = None

    @property
    def packed_bytes(self) -> int:
        return sum(len(walls.compressed) for _, walls in self._earlier)

    def level_at(self, tick: int) -> Level:
        index = max(bisect_right(self._ticks, tick) - 1, 0)
        if index == len(self._earlier):
            return self._latest
        description, walls = self._earlier[index]
        if self._cache is None or self._cache[0] is not walls:
            self._cache = walls, replace(description, walls=walls.bits())
        return self._cache[1]

    def is_changed_in(self, tick: int) -> bool:
        return tick in self._ticks[1:]

    def is_changed_up_to(self, tick: int) -> bool:
        return any(change <= tick for change in self._ticks[1:])

    def change(self, tick: int, level: Level) -> None:
        """Set the level from a tick's end on; the same level means that robots were moved."""
        is_moved_at_start = level is self._latest and len(self._ticks) == 1
        if tick > self._ticks[-1] or is_moved_at_start:
            walls = PackedBits.pack(self._latest.walls)
            self._earlier.append((replace(self._latest, walls=_NO_WALLS), walls))
            self._ticks.append(tick)
        self._latest = level

    def up_to(self, tick: int) -> Levels:
        levels = Levels(self._ticks[0], self.level_at(tick))
        index = max(bisect_right(self._ticks, tick), 1)
        levels._ticks = self._ticks[:index]
        levels._earlier = self._earlier[: index - 1]
        return levels

    def forget_before(self, tick: int) -> None:
        index = bisect_right(self._ticks, tick) - 1
        if index > 0:
            del self._ticks[:index], self._earlier[:index]
