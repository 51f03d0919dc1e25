"""Breakpoints: conditions at which a run stops."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from logical_robots_tui.paths import did_you_mean

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

Event: TypeAlias = Literal[
    "rows", "no rows", "change", "enters", "leaves", "blocked", "loses sight", "notice"
]

EVENTS: dict[Event, str] = {
    "rows": "a predicate has rows, or a question holds",
    "no rows": "a predicate no longer has rows, or a question no longer holds",
    "change": "a predicate or the answer to a question changes",
    "enters": "a robot enters an area",
    "leaves": "a robot leaves an area",
    "blocked": "a robot is blocked by a wall",
    "loses sight": "a robot loses sight of something",
    "notice": "a notice appears",
}
"""Descriptions of the events."""

OF_QUESTIONS = frozenset[Event]({"rows", "no rows", "change"})
"""The events that require evaluating the program."""


class Breakpoint(NamedTuple):
    """A condition at which a run stops, in the tick in which it begins to hold.

    "" as `subject` (except of predicates), `robot` or `column` (of ``change``) means any.
    """

    event: Event
    subject: str = ""
    robot: str = ""
    column: str = ""

    @property
    def is_named(self) -> bool:
        return self.event not in OF_QUESTIONS or self.subject.isidentifier() or not self.subject

    @property
    def words(self) -> str:
        """Its description, such as ``Ada enters Home``."""
        who = self.robot or "a robot"
        whose = f" for {self.robot}" if self.robot else ""
        match self.event:
            case "rows":
                return f"{self.subject} {'has rows' if self.is_named else 'holds'}{whose}"
            case "no rows":
                what = "no longer has rows" if self.is_named else "no longer holds"
                return f"{self.subject} {what}{whose}"
            case "change":
                column = f".{self.column}" if self.column else ""
                return f"{self.subject}{column} changes{whose}"
            case "blocked":
                return f"{who} is blocked by a wall"
            case "loses sight":
                return f"{who} loses sight of {self.subject or 'something'}"
            case "notice":
                kind = f"“{self.subject}”" if self.subject else ""
                return " ".join(f"a notice {kind} appears{whose}".split())
            case _:
                return f"{who} {self.event} {self.subject or 'an area'}"


class Hit(NamedTuple):
    breakpoint: Breakpoint
    tick: int
    values: str


class Breakpoints:
    """A player's breakpoints, in the order in which they were set."""

    def __init__(self, breakpoints: Iterable[Breakpoint] = ()) -> None:
        self._is_on = dict.fromkeys(breakpoints, True)

    def __iter__(self) -> Iterator[Breakpoint]:
        return iter(self._is_on)

    def __len__(self) -> int:
        return len(self._is_on)

    @property
    def on(self) -> tuple[Breakpoint, ...]:
        return tuple(each for each, is_on in self._is_on.items() if is_on)

    def add(self, breakpoint_: Breakpoint) -> None:
        self._is_on[breakpoint_] = True

    def remove(self, breakpoint_: Breakpoint) -> None:
        self._is_on.pop(breakpoint_, None)

    def is_on(self, breakpoint_: Breakpoint) -> bool:
        return self._is_on.get(breakpoint_, False)

    def switch(self, breakpoint_: Breakpoint) -> None:
        if breakpoint_ in self._is_on:
            self._is_on[breakpoint_] = not self._is_on[breakpoint_]


def subjects(event: Event, level: Level, program: Program | None) -> tuple[str, ...]:
    if event in OF_QUESTIONS:
        return tuple(each.name for each in program.predicates if each.has_rows) if program else ()
    if event in ("enters", "leaves"):
        return tuple(area.name for area in level.areas)
    if event == "loses sight":
        beacons = tuple(beacon.name for beacon in level.beacons)
        return beacons + tuple(robot.name for robot in level.robots)
    if event == "notice":
        from logical_robots_tui.mind import NoticeKind  # takes time that the first picture needs

        return get_args(NoticeKind)
    return ()


def mistake_in(breakpoint_: Breakpoint, level: Level, program: Program | None) -> str:
    """Return why a breakpoint can't be hit, one sentence, or ""; questions are not checked."""
    robot, subject = breakpoint_.robot, breakpoint_.subject
    names = tuple(each.name for each in level.robots)
    if robot and robot not in names:
        return f"This level has no robot {robot}. {did_you_mean(robot, names)}".rstrip()
    known = subjects(breakpoint_.event, level, program)
    if breakpoint_.event in OF_QUESTIONS:
        if program is None:
            return ""
        if not subject:
            return "It needs the name of a predicate, or a question."
        if not breakpoint_.is_named:
            return ""
        predicate = program.predicate(subject)
        if predicate is not None and not predicate.has_rows:
            return predicate.reason
        what = "The program has no predicate"
    else:
        what = {
            "loses sight": "Nothing in this level is called",
            "notice": "No notice is called",
        }.get(breakpoint_.event, "This level has no area")
    if not subject or subject in known:
        return ""
    return f"{what} {subject}. {did_you_mean(subject, known)}".rstrip()
