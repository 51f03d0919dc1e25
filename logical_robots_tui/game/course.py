"""A course: one way that a game went, tick after tick."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from logical_robots_tui.game.levels import Levels
from logical_robots_tui.game.marks import Marks, marks_of
from logical_robots_tui.game.odometer import driven
from logical_robots_tui.game.packing import Moment, Packed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.breakpoints import Hit
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["Course"]

_TOGETHER = 32  # moments in a pack


class Course:
    """The last ticks of one way that a game went, without gaps.

    Courses that part share what they have in common, for what is packed never changes.

    Args:
        frame: Where it begins.
        level: The level in which it does.
        length: How many ticks to be able to restore.

    Attributes:
        marks: What happened in which of its ticks.
        hits: The breakpoints that were hit, by tick.
        levels: Which level it went through when.
    """

    def __init__(self, frame: Frame, level: Level, length: int) -> None:
        self.marks = Marks(frame.after)
        self.levels = Levels(frame.tick, level)
        self.hits: dict[int, tuple[Hit, ...]] = {}
        self._length = length
        self._packs: deque[Packed] = deque()
        self._loose = [Moment(frame.after, frame.memories, frame.decisions, 0.0, 0.0)]
        self._oldest = frame.tick  # that is kept, be it too old or not
        self._programs: list[tuple[int, Program]] = []
        self._unreliable_from: int | None = None

    @property
    def last(self) -> int:
        """The latest tick that was finished."""
        return self._loose[-1].after.tick

    @property
    def first(self) -> int:
        """The earliest tick that can be restored: one of which the moment before is kept."""
        oldest = max(self._oldest, self.last - self._length)
        return oldest + 1 if oldest else 0

    @property
    def packs(self) -> Iterator[Packed]:
        """All that is packed."""
        return iter(self._packs)

    def add(self, frame: Frame, program: Program) -> bool:
        """Keep the tick that follows the last one, and which program decided in it.

        Returns:
            Whether some ticks were packed.
        """
        before = self._loose[-1]
        self._loose.append(
            Moment(
                frame.after,
                frame.memories,
                frame.decisions,
                frame.think_milliseconds,
                before.driven + driven(frame.before, frame.after),
            )
        )
        for kind, who in marks_of(frame, before.decisions):
            self.marks.note(frame.tick, kind, who)
        if self._unreliable_from is None and not frame.is_reliable:
            self._unreliable_from = frame.tick
        if not self._programs or self._programs[-1][1] is not program:
            self._use(frame.tick, program)
        if len(self._loose) < 2 * _TOGETHER:
            return False
        self._packs.append(Packed(self._loose[:_TOGETHER]))
        del self._loose[:_TOGETHER]
        while self._oldest + _TOGETHER <= self.last - self._length:
            self.forget_pack()
        return True

    def change_level(self, frame: Frame, level: Level) -> None:
        """Go on from the last tick in another level, as a frame in its place says.

        What was packed never changes; the last tick never is.
        """
        before = self._loose[-1]
        self._loose[-1] = Moment(
            frame.after,
            frame.memories,
            frame.decisions,
            frame.think_milliseconds,
            before.driven,
        )
        self.marks.speak_of(frame.after)
        if frame.tick > self._oldest:
            self.marks.note(frame.tick, "edit")
        self.levels.change(frame.tick, level)

    def forget_pack(self) -> bool:
        """Drop the oldest ticks; False if so few are left that they are not packed."""
        if self._packs:
            self._packs.popleft()
            self._oldest += _TOGETHER
            self.marks.forget_before(self._oldest)
            self.levels.forget_before(self._oldest)
            self.hits = {tick: hits for tick, hits in self.hits.items() if tick >= self._oldest}
        return bool(self._packs)

    def moment(self, tick: int) -> Moment:
        """What a tick left behind, from the one before `first` to `last`."""
        at = tick - self._oldest
        pack, place = divmod(at, _TOGETHER)
        if pack < len(self._packs):
            return self._packs[pack].moment(place)
        return self._loose[at - len(self._packs) * _TOGETHER]

    def up_to(self, tick: int) -> Course:
        """The same course up to one of its ticks."""
        copy = Course.__new__(Course)
        copy.marks = self.marks.copy(tick)
        copy.levels = self.levels.up_to(tick)
        copy.hits = {at: hits for at, hits in self.hits.items() if at <= tick}
        copy._length = self._length
        copy._oldest = self._oldest
        copy._unreliable_from = self._unreliable_from if not self.is_reliable_up_to(tick) else None
        copy._programs = self.programs(tick)
        whole = min((tick - self._oldest) // _TOGETHER, len(self._packs))
        copy._packs = deque(pack for pack, _ in zip(self._packs, range(whole), strict=False))
        begin = self._oldest + whole * _TOGETHER
        copy._loose = [self.moment(at) for at in range(begin, tick + 1)]
        return copy

    def programs(self, tick: int) -> list[tuple[int, Program]]:
        """The programs up to a tick, each with the first tick in which it decided."""
        return [(begin, program) for begin, program in self._programs if begin <= tick]

    def program_at(self, tick: int) -> Program | None:
        """The program that decided in a tick; None at the start."""
        return next((program for begin, program in reversed(self._programs) if begin <= tick), None)

    def is_all_by(self, text: str, tick: int) -> bool:
        """Whether one program's text decided in every tick up to that one."""
        return all(program.text == text for begin, program in self._programs if begin <= tick)

    def is_reliable_up_to(self, tick: int) -> bool:
        """Whether no clock ended a thought up to the end of a tick."""
        return self._unreliable_from is None or tick < self._unreliable_from

    def _use(self, tick: int, program: Program) -> None:
        if self._programs and self._programs[-1][1].text != program.text:
            self.marks.note(tick, "program")
        self._programs.append((tick, program))
