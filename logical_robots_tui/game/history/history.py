"""History: everything needed to restore any recent tick exactly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from logical_robots_tui.game.advancing import RecordedTick, Worlds, frame_of
from logical_robots_tui.game.frame import Frame, NoSuchTickError, Peak
from logical_robots_tui.game.history.branch import Divergence, HistoryBranch, find_divergence
from logical_robots_tui.game.history.marks import Marks
from logical_robots_tui.game.history.packing import Moment
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.game.debugging.breakpoints import Hit
    from logical_robots_tui.mind import Program
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.values import Value

DEFAULT_LENGTH = 20_000
_MOST_BYTES = 100_000_000


class History:
    """The last ticks of a game, and of the longest branch that was abandoned.

    Beyond `most_bytes` the other branch is dropped first, then the oldest ticks; `dropped` is
    then the first tick left, otherwise 0.
    """

    def __init__(
        self,
        start: Frame,
        level: Level,
        length: int = DEFAULT_LENGTH,
        most_bytes: int = _MOST_BYTES,
    ) -> None:
        self._length = length
        self._most_bytes = most_bytes
        self._branch = HistoryBranch(start, level, length)
        self._other: HistoryBranch | None = None
        self.turns = 0
        self.dropped = 0
        self.divergence: Divergence | None = None

    @property
    def first(self) -> int:
        """The earliest tick that can be restored."""
        return self._branch.first

    @property
    def last(self) -> int:
        return self._branch.last

    @property
    def marks(self) -> Marks:
        return self._branch.marks

    @property
    def other_ticks(self) -> range | None:
        return range(self._other.first, self._other.last + 1) if self._other else None

    @property
    def packed_bytes(self) -> int:
        """Bytes of all packs; the latest ticks are not packed."""
        both = [*self._branch.packs, *(self._other.packs if self._other is not None else ())]
        packs = sum(map(len, {id(pack): pack for pack in both}.values()))
        return packs + self._branch.levels.packed_bytes

    @property
    def kept_bytes(self) -> int:
        other_weight = self._other.loose_weight if self._other is not None else 0
        return self.packed_bytes + self._branch.loose_weight + other_weight

    def add(self, frame: Frame, program: Program) -> None:
        """Store a finished tick; storing an earlier one again begins another branch."""
        if frame.tick <= self.last:
            self._abandon(self._branch.up_to(frame.tick - 1))
        is_packed = self._branch.add(frame, program)
        self._look_for_divergence(frame.tick)
        if is_packed:  # and may have become too much
            if self.kept_bytes > self._most_bytes:
                self._other = self.divergence = None
            while self.kept_bytes > self._most_bytes and self._branch.forget_pack():
                self.dropped = self._branch.first

    def change_level(self, frame: Frame, level: Level) -> None:
        """Continue in another level from a tick, replaced by the frame; abandons later ticks."""
        tick = frame.tick
        if tick < self.last:
            self._abandon(self._branch.up_to(tick))
        self._branch.change_level(frame, level)
        self._look_for_divergence(tick)

    def begins_with(self, start: Frame, level: Level) -> bool:
        if self.first or level is not self.level_at(0):
            return False
        return self._branch.moment(0).after == start.after

    def begin_anew(self, start: Frame, level: Level) -> None:
        self._abandon(HistoryBranch(start, level, self._length))

    def forget_future(self, tick: int) -> None:
        if tick < self.last:
            self._switch_to(self._branch.up_to(tick))

    def change_branch(self) -> None:
        """Switch to the other branch and keep this one, or raise NoSuchTickError."""
        if self._other is None:
            raise NoSuchTickError("There is no other branch.")
        self._branch, self._other = self._other, self._branch
        self.turns += 1
        self.divergence = self.divergence and self.divergence.reversed()

    def memory(self, tick: int, robot: str) -> Value:
        """Return a robot's memory after a tick, without restoring it.

        Raises NoSuchTickError, and LookupError if the robot is not there.
        """
        if tick + 1 != self.first:
            self._check(tick)
        return self._branch.memory(tick, robot)

    def _check(self, tick: int) -> None:
        if not self.first <= tick <= self.last:
            raise NoSuchTickError(
                f"Tick {tick} is not in history, which holds ticks {self.first} to {self.last}."
            )

    def is_changed_up_to(self, tick: int) -> bool:
        return self._branch.levels.is_changed_up_to(tick)

    def is_reliable_up_to(self, tick: int) -> bool:
        """Return whether no time limit cut off a thought up to this tick."""
        return self._branch.is_reliable_up_to(tick)

    def is_blocked_up_to(self, tick: int) -> bool:
        return self._branch.is_blocked_up_to(tick)

    def peak(self, tick: int) -> Peak:
        return self._branch.peak(tick)

    def moment(self, tick: int) -> Moment:
        """Return the state after a tick, or raise NoSuchTickError."""
        self._check(tick)
        return self._branch.moment(tick)

    def recorded(self, tick: int) -> RecordedTick:
        """Return all that is known of a tick, or raise NoSuchTickError."""
        self._check(tick)
        return self._branch.recorded(tick)

    def stored_ahead(
        self, tick: int, limit: int, texts: Texts, *, follow_branch: bool
    ) -> list[RecordedTick]:
        """Return the stored next ticks that can be replayed under a program.

        A branch that ends with it counts as a whole, until the player asks for the other branch.
        """
        is_on_branch = follow_branch and self._is_by(texts, self.last)
        ticks: list[RecordedTick] = []
        for t in range(tick + 1, min(tick + limit, self.last) + 1):
            if not is_on_branch and (not self._is_by(texts, t) or self.is_changed_in(t)):
                break
            ticks.append(self._branch.recorded(t, ticks[-1].moment if ticks else None))
        return ticks

    def _is_by(self, texts: Texts, tick: int) -> bool:
        program = self.program_at(tick)
        return program is not None and program.texts == texts

    def programs(self, tick: int) -> list[tuple[int, Program]]:
        """Return the programs up to a tick, each with the first tick that it decided."""
        return self._branch.programs(tick)

    def program_at(self, tick: int) -> Program | None:
        """Return the program that decided a tick; None at the start."""
        return self._branch.program_at(tick)

    def recorded_in_other(self, tick: int) -> tuple[Program | None, RecordedTick]:
        """Return a tick of the other branch and who decided it, or raise NoSuchTickError."""
        branch = self._other
        if branch is None or not branch.first <= tick <= branch.last:
            raise NoSuchTickError(f"The other branch does not hold tick {tick}.")
        return branch.program_at(tick), branch.recorded(tick)

    def level_at(self, tick: int) -> Level:
        """Return the level from the end of a tick on."""
        return self._branch.levels.level_at(tick)

    def is_changed_in(self, tick: int) -> bool:
        """Return whether the level was edited or a robot moved at the end of a tick."""
        return self._branch.levels.is_changed_in(tick)

    def hits_at(self, tick: int) -> tuple[Hit, ...]:
        return self._branch.hits.get(tick, ())

    def note_hits(self, tick: int, hits: tuple[Hit, ...]) -> None:
        if hits:
            self._branch.hits[tick] = hits
            self.marks.note(tick, "breakpoint")

    def _look_for_divergence(self, tick: int) -> None:
        branch = self._other
        if self.divergence is None and branch is not None and branch.first <= tick <= branch.last:
            self.divergence = find_divergence(self._branch.moment(tick), branch.moment(tick))

    def _abandon(self, new: HistoryBranch) -> None:
        """Switch to a truncated copy of the current branch, and keep the full one."""
        old_branch = self._branch
        self._switch_to(new)
        if self._other is None or self._other.last <= old_branch.last:
            self._other, self.divergence = old_branch, None

    def _switch_to(self, new: HistoryBranch) -> None:
        self._branch = new
        self.turns += 1
        if self.divergence is not None and self.divergence.tick > new.last:
            self.divergence = None


class TickHistory(Protocol):
    """Ticks that were computed, of a game or a run."""

    @property
    def turns(self) -> int: ...

    def moment(self, tick: int, /) -> Moment: ...
    def memory(self, tick: int, robot: str, /) -> Value: ...
    def recorded(self, tick: int, /) -> RecordedTick: ...
    def level_at(self, tick: int, /) -> Level: ...
    def program_at(self, tick: int, /) -> Program | None: ...
    def is_reliable_up_to(self, tick: int, /) -> bool: ...


class Past:
    """Restores ticks of a history, on the event loop; the last one is cached."""

    def __init__(self, history: History) -> None:
        self.worlds = Worlds(history.level_at(0))
        self._history = history
        self._last: Frame | None = None
        self._turns = 0

    def frame(self, tick: int) -> Frame:
        """Return the exact frame of a tick, or raise NoSuchTickError."""
        history = self._history
        recorded = history.recorded(tick)
        if self._last is None or self._last.tick != tick or self._turns != history.turns:
            self._last = frame_of(self.worlds, recorded)
            self._turns = history.turns
        return self._last

    def forget(self) -> None:
        """Clear the cache after the end of a tick was edited."""
        self._last = None
