"""Breakpoints: conditions at which a run stops, and which of them a tick hits."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from statistics import fmean
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from logical_robots_tui.mind import ProgramError, QueryError, ResultTable
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import CompiledQuery, Mind, Program
    from logical_robots_tui.world import Level

Event: TypeAlias = Literal[
    "rows", "no rows", "change", "enters", "leaves", "blocked", "loses sight", "notice"
]

EVENTS: dict[Event, str] = {
    "rows": "a predicate has rows, or a query holds",
    "no rows": "a predicate no longer has rows, or a query no longer holds",
    "change": "a predicate or the answer to a query changes",
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
            return "It needs the name of a predicate, or a query."
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


_Rows: TypeAlias = "list[tuple[Value, ...]]"
_FEW = 3  # values that are reported
_LONGEST = 60  # characters of each
_BY_NAME = ("Robot", "Sensor", "Memory")


def matching_rows(question: CompiledQuery, table: ResultTable, robot: str = "") -> ResultTable:
    """Return the rows for which a question holds; "" as robot means any mind.

    For an expression these are values other than null, false and 0; for conditions without
    variables, the minds in which they are true; otherwise all rows.
    """

    def counts(row: tuple[Value, ...]) -> bool:
        value = row[0] if row else None
        if question.gives == "truth":
            return value == "true"
        return question.gives == "rows" or value not in (None, False)  # 0 is equal to False

    table = table.in_mind_of(robot)
    kept = [n for n, row in enumerate(table.rows) if counts(row)]
    return replace(
        table,
        rows=tuple(table.rows[n] for n in kept),
        viewers=tuple(table.viewers[n] for n in kept) if table.viewers else (),
    )


def number_of(question: CompiledQuery, table: ResultTable) -> int | float | None:
    """Return one number for an answer, or None.

    For an expression it is its value, the mean of those of several minds; else the number of rows,
    or of the minds in which the conditions hold.
    """
    if table.truncated:
        return None
    if question.gives != "value":
        return len(matching_rows(question, table).rows)
    values = [row[0] for row in table.rows if row and isinstance(row[0], int | float)]
    return values[0] if len(values) == 1 else fmean(values) if values else None


class Watch:
    """Compares each tick with the previous one; `problems` are breakpoints it couldn't check."""

    def __init__(self, breakpoints: Sequence[Breakpoint]) -> None:
        self.breakpoints = breakpoints
        self.problems: dict[Breakpoint, str] = {}
        self._asked: dict[str, tuple[Frame, ResultTable]] = {}
        self._questions: dict[str, CompiledQuery | ProgramError] = {}

    def hits(self, past: Frame, frame: Frame, mind: Mind, stop: threading.Event) -> tuple[Hit, ...]:
        """Return the breakpoints that a tick hits; always pass the same mind. Raises Stopped."""
        found = []
        for each in self.breakpoints:
            try:
                if each.event in OF_QUESTIONS:
                    values = self._change_of_rows(each, past, frame, mind, stop)
                else:
                    values = "; ".join(_occurrences(each, past, frame))
            except ProgramError as error:
                self.problems[each] = f"This can't be asked: {error.diagnostics[0].message}."
                continue
            except QueryError as error:
                self.problems[each] = f"Tick {frame.tick}: {error}"
                continue
            self.problems.pop(each, None)
            if values:
                found.append(Hit(each, frame.tick, values))
        return tuple(found)

    def _change_of_rows(
        self, each: Breakpoint, past: Frame, frame: Frame, mind: Mind, stop: threading.Event
    ) -> str:
        before = self._rows(each, past, mind, stop)
        after = self._rows(each, frame, mind, stop)
        if each.event == "rows":
            return "" if before or not after else _join(after)
        if each.event == "no rows":
            return "" if after or not before else f"there was {_join(before)}"
        gone, new = _without(before, after), _without(after, before)
        if not gone and not new:
            return ""
        return " → ".join(_join(rows) if rows else "nothing" for rows in (gone, new))

    def _rows(self, each: Breakpoint, frame: Frame, mind: Mind, stop: threading.Event) -> _Rows:
        table = self._table(each.subject, frame, mind, stop)
        question = self._questions.get(each.subject)
        if each.event != "change" and question is not None and not isinstance(question, Exception):
            table = matching_rows(question, table)
        return _rows_for(each, table)

    def _table(self, subject: str, frame: Frame, mind: Mind, stop: threading.Event) -> ResultTable:
        asked = self._asked.get(subject)
        if asked is not None and asked[0] is frame:
            return asked[1]
        question = self._question(subject, mind, stop)
        sensors, memories = frame.sensors, frame.memories_before
        if question is None:
            table = mind.query(subject, sensors, memories, stop=stop)
        else:
            table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
        self._asked[subject] = (frame, table)
        return table

    def _question(self, subject: str, mind: Mind, stop: threading.Event) -> CompiledQuery | None:
        """Return the question, None for one best queried by name, or raise ProgramError."""
        if subject in _BY_NAME:
            return None
        question = self._questions.get(subject)
        if question is None:
            try:
                question = mind.program.question(subject, stop=stop, limits=mind.limits)
            except ProgramError as error:
                question = error
            self._questions[subject] = question
        if not isinstance(question, ProgramError):
            return question
        if mind.program.predicate(subject) is not None:
            return None
        raise question


def _rows_for(each: Breakpoint, table: ResultTable) -> _Rows:
    rows: Sequence[tuple[Value, ...]] = table.rows
    if each.robot and "robot_name" in table.columns:
        at = table.columns.index("robot_name")
        rows = [row for row in rows if row[at] == each.robot]
    else:
        rows = table.in_mind_of(each.robot).rows
    if not each.column:
        return list(rows)
    if each.column not in table.columns:
        if not table.rows:
            return []
        raise QueryError(f"{each.subject} has no column {each.column}.")
    at = table.columns.index(each.column)
    return [(row[at],) for row in rows]


def _without(rows: _Rows, others: _Rows) -> _Rows:
    if rows == others:
        return []
    from logical_robots_tui.mind.sqlite.stored import to_json

    left = Counter(to_json(row) for row in others)
    missing = []
    for row in rows:
        written = to_json(row)
        if left[written]:
            left[written] -= 1
        else:
            missing.append(row)
    return missing


def _join(rows: _Rows) -> str:
    from logical_robots_tui.mind.sqlite.stored import to_json  # not before there is a mind

    texts = [list(map(to_json, row)) for row in rows[:_FEW]]
    short = ([t if len(t) <= _LONGEST else f"{t[:_LONGEST]}…" for t in row] for row in texts)
    told = map(", ".join, short)
    more = len(rows) - _FEW
    return "; ".join(told) + (f" and {more} more" if more > 0 else "")


def _occurrences(each: Breakpoint, past: Frame, frame: Frame) -> Iterator[str]:
    match each.event:
        case "enters":
            yield from _moves(each, past, frame, "is in")
        case "leaves":
            yield from _moves(each, frame, past, "was in")
        case "blocked":
            for then, now in zip(past.after.robots, frame.after.robots, strict=True):
                if now.blocked and not then.blocked and each.robot in ("", now.name):
                    yield f"{now.name} at {now.x:.1f}, {now.y:.1f}"
        case "loses sight":
            yield from _losses(each, past, frame)
        case _:
            yield from _notices(each, past, frame)


def _moves(each: Breakpoint, before: Frame, after: Frame, verb: str) -> Iterator[str]:
    for then, now in zip(before.after.areas, after.after.areas, strict=True):
        if each.subject in ("", now.name):
            for name in now.visitors:
                if name not in then.visitors and each.robot in ("", name):
                    yield f"{name} {verb} {now.name}"


def _losses(each: Breakpoint, past: Frame, frame: Frame) -> Iterator[str]:
    for then, now in zip(past.sensors, frame.sensors, strict=True):
        name = now["robot_name"]
        if each.robot in ("", name):
            still = _distances(now)
            for label, distance in _distances(then).items():
                if label not in still and each.subject in ("", label):
                    yield f"{name} saw {label} last at distance {distance:g}"


def _distances(row: SensorRow) -> dict[str, float]:
    return {
        ray["label"]: ray["distance"]
        for ray in row["sensor"]["radar"]
        if ray["object"] in ("beacon", "robot")
    }


def _notices(each: Breakpoint, past: Frame, frame: Frame) -> Iterator[str]:
    known = {(decision.robot_name, n.kind) for decision in past.decisions for n in decision.notices}
    for decision in frame.decisions:
        if each.robot in ("", decision.robot_name):
            for notice in decision.notices:
                is_new = (decision.robot_name, notice.kind) not in known
                if is_new and each.subject in ("", notice.kind):
                    yield f"{decision.robot_name}: {notice.message}"
