"""History: what is needed to restore any recent tick exactly, and no more."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game.advancing import Known
from logical_robots_tui.game.course import Course
from logical_robots_tui.game.divergence import find_divergence
from logical_robots_tui.game.frame import NoSuchTickError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.breakpoints import Hit
    from logical_robots_tui.game.divergence import Divergence
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.marks import Marks
    from logical_robots_tui.game.packing import Moment, Packed
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["DEFAULT_LENGTH", "History"]

DEFAULT_LENGTH = 20_000
_MOST_BYTES = 100_000_000


class History:
    """The last ticks of a game, and of the course that was left when another future began.

    Of several courses that were left, the one that reaches farthest is kept.

    Args:
        start: Where the game begins.
        level: The level in which it does.
        length: How many ticks of a course to be able to restore.
        most_bytes: What may be kept; the other course goes first, then the oldest ticks.

    Attributes:
        turns: How often the present course became another one.
        dropped: The first tick that was kept when there was no more room for earlier ones, or 0.
        divergence: Where the current course and the other one diverge, or None if they have not.
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
        self._course = Course(start, level, length)
        self._other: Course | None = None
        self.turns = 0
        self.dropped = 0
        self.divergence: Divergence | None = None

    @property
    def first(self) -> int:
        """The earliest tick that can be restored."""
        return self._course.first

    @property
    def last(self) -> int:
        """The latest tick that was finished."""
        return self._course.last

    @property
    def marks(self) -> Marks:
        """What happened in which tick."""
        return self._course.marks

    @property
    def other(self) -> range | None:
        """The ticks of the other course that can be restored, or None if there is none."""
        return range(self._other.first, self._other.last + 1) if self._other else None

    @property
    def packed_bytes(self) -> int:
        """Bytes of all that is packed; the latest ticks are not."""
        packs = sum(map(len, {id(pack): pack for pack in self._packs()}.values()))
        return packs + self._course.levels.packed_bytes

    @property
    def kept_bytes(self) -> int:
        """Bytes of all that is kept: packed, and as objects."""
        other = self._other.loose_weight if self._other is not None else 0
        return self.packed_bytes + self._course.loose_weight + other

    def add(self, frame: Frame, program: Program) -> None:
        """Keep a finished tick; if it was known before, the present course is left for another."""
        if frame.tick <= self.last:
            self._leave(self._course.up_to(frame.tick - 1))
        packed = self._course.add(frame, program)
        self._look_for_divergence(frame.tick)
        if packed:
            self._keep_within_bounds()

    def change_level(self, frame: Frame, level: Level) -> None:
        """Go on in another level from a tick of the present course, as a frame in its place says.

        What was known of later ticks is left, like a future under another program.
        """
        tick = frame.tick
        if tick < self.last:
            self._leave(self._course.up_to(tick))
        self._course.change_level(frame, level)
        self._look_for_divergence(tick)

    def begins_with(self, start: Frame, level: Level) -> bool:
        """Whether the present course begins so, with nobody put elsewhere by hand."""
        if self.first or level is not self.level_at(0):
            return False
        return self._course.moment(0).after == start.after

    def begin_anew(self, start: Frame, level: Level) -> None:
        """Leave the present course for one that begins at the start of a level."""
        self._leave(Course(start, level, self._length))

    def forget_future(self, tick: int) -> None:
        """Drop what is known of later ticks, for good."""
        if tick < self.last:
            self._go_over_to(self._course.up_to(tick))

    def change_course(self) -> None:
        """Go over to the other course; the present one is the other one then.

        Raises:
            NoSuchTickError: There is no other course.
        """
        if self._other is None:
            raise NoSuchTickError("There is no other future.")
        self._course, self._other = self._other, self._course
        self.turns += 1
        self.divergence = self.divergence and self.divergence.reversed()

    def around(self, tick: int) -> tuple[Moment, Moment]:
        """The moments before and after a tick; for the start, tick 0, twice the same.

        Raises:
            NoSuchTickError: The tick is not in history.
        """
        if not self.first <= tick <= self.last:
            raise NoSuchTickError(
                f"Tick {tick} is not in history, which holds ticks {self.first} to {self.last}."
            )
        return self._course.moment(max(tick - 1, 0)), self._course.moment(tick)

    def is_changed_up_to(self, tick: int) -> bool:
        """Whether anything was changed by hand after the start, up to the end of a tick."""
        return self._course.levels.is_changed_up_to(tick)

    def is_reliable_up_to(self, tick: int) -> bool:
        """Whether no clock ended a thought up to the end of a tick."""
        return self._course.is_reliable_up_to(tick)

    def known(self, tick: int) -> Known:
        """A tick, to be gone through again.

        Raises:
            NoSuchTickError: The tick is not in history.
        """
        moment = self.around(tick)[1]
        return Known(self.level_at(tick - bool(moment.decisions)), moment)

    def programs(self, tick: int) -> list[tuple[int, Program]]:
        """The programs up to a tick, each with the first tick in which it decided."""
        return self._course.programs(tick)

    def program_at(self, tick: int) -> Program | None:
        """The program that decided in a tick; None at the start."""
        return self._course.program_at(tick)

    def in_other(self, tick: int) -> tuple[Moment, Known]:
        """The moment before a tick of the other course, and that tick.

        Raises:
            NoSuchTickError: There is no other course, or it does not hold that tick.
        """
        there = self._other
        if there is None or not there.first <= tick <= there.last:
            raise NoSuchTickError(f"The other future does not hold tick {tick}.")
        moment = there.moment(tick)
        known = Known(there.levels.at(tick - bool(moment.decisions)), moment)
        return there.moment(max(tick - 1, 0)), known

    def program_in_other(self, tick: int) -> Program | None:
        """The program that decided in a tick of the other course; None if none did."""
        return None if self._other is None else self._other.program_at(tick)

    def level_at(self, tick: int) -> Level:
        """The level from the end of a tick on."""
        return self._course.levels.at(tick)

    def is_changed_in(self, tick: int) -> bool:
        """Whether the level was changed by hand at the end of a tick, or a robot put elsewhere."""
        return self._course.levels.is_changed_in(tick)

    def is_by_another(self, text: str, tick: int) -> bool:
        """Whether another program than the one of that text decided in a tick."""
        program = self.program_at(tick)
        return program is not None and program.text != text

    def is_all_by(self, text: str, tick: int) -> bool:
        """Whether one program's text decided in every tick up to that one."""
        return self._course.is_all_by(text, tick)

    def driven(self, tick: int) -> float:
        """Map units that all robots together have driven up to a tick."""
        return self.around(tick)[1].driven

    def hits_at(self, tick: int) -> tuple[Hit, ...]:
        """The breakpoints that were hit in a tick when it was run through."""
        return self._course.hits.get(tick, ())

    def note_hits(self, tick: int, hits: tuple[Hit, ...]) -> None:
        """Keep which breakpoints were hit in a tick."""
        if hits:
            self._course.hits[tick] = hits
            self.marks.note(tick, "breakpoint")

    # -- inside --------------------------------------------------------------------------------

    def _look_for_divergence(self, tick: int) -> None:
        there = self._other
        if self.divergence is None and there is not None and there.first <= tick <= there.last:
            self.divergence = find_divergence(self._course.moment(tick), there.moment(tick))

    def _leave(self, new: Course) -> None:
        """Go over to the present course as it was up to some tick, and keep how it went on."""
        left = self._course
        self._go_over_to(new)
        if self._other is None or self._other.last <= left.last:
            self._other, self.divergence = left, None

    def _go_over_to(self, new: Course) -> None:
        self._course = new
        self.turns += 1
        if self.divergence is not None and self.divergence.tick > new.last:
            self.divergence = None

    def _packs(self) -> Iterator[Packed]:
        yield from self._course.packs
        if self._other is not None:
            yield from self._other.packs

    def _keep_within_bounds(self) -> None:
        if self.kept_bytes > self._most_bytes:
            self._other = self.divergence = None
        while self.kept_bytes > self._most_bytes and self._course.forget_pack():
            self.dropped = self._course.first
