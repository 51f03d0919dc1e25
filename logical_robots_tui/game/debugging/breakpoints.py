"""Breakpoints: conditions at which a run stops, and which of them a tick hits."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from statistics import fmean
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from logical_robots_tui.game.frame import new_notices
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
        robot = self.robot or "a robot"
        suffix = f" for {self.robot}" if self.robot else ""
        match self.event:
            case "rows":
                return f"{self.subject} {'has rows' if self.is_named else 'holds'}{suffix}"
            case "no rows":
                verb = "no longer has rows" if self.is_named else "no longer holds"
                return f"{self.subject} {verb}{suffix}"
            case "change":
                column = f".{self.column}" if self.column else ""
                return f"{self.subject}{column} changes{suffix}"
            case "blocked":
                return f"{robot} is blocked by a wall"
            case "loses sight":
                return f"{robot} loses sight of {self.subject or 'something'}"
            case "notice":
                kind = f"“{self.subject}”" if self.subject else ""
                return " ".join(f"a notice {kind} appears{suffix}".split())
            case _:
                return f"{robot} {self.event} {self.subject or 'an area'}"


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
    def enabled(self) -> tuple[Breakpoint, ...]:
        return tuple(breakpoint_ for breakpoint_, is_on in self._is_on.items() if is_on)

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
        return tuple(p.name for p in program.predicates if p.has_rows) if program else ()
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
    names = tuple(r.name for r in level.robots)
    if robot and robot not in names:
        return f"This level has no robot {robot}. {did_you_mean(robot, names)}".rstrip()
    options = subjects(breakpoint_.event, level, program)
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
        problem = "The program has no predicate"
    else:
        problem = {
            "loses sight": "Nothing in this level is called",
            "notice": "No notice is called",
        }.get(breakpoint_.event, "This level has no area")
    if not subject or subject in options:
        return ""
    return f"{problem} {subject}. {did_you_mean(subject, options)}".rstrip()


_Rows: TypeAlias = "list[tuple[Value, ...]]"
_FEW = 3  # values that are reported
_LONGEST = 60  # characters of each
_BY_NAME = ("Robot", "Sensor", "Memory")


def matching_rows(question: CompiledQuery, table: ResultTable, robot: str = "") -> ResultTable:
    """Return the rows for which a question holds; "" as robot means any mind.

    For an expression these are values other than null, false and 0; for conditions without
    variables, the minds in which they are true; otherwise all rows.
    """

    def is_match(row: tuple[Value, ...]) -> bool:
        value = row[0] if row else None
        if question.gives == "truth":
            return value == "true"
        return question.gives == "rows" or value not in (None, False)  # 0 is equal to False

    table = table.in_mind_of(robot)
    indices = [n for n, row in enumerate(table.rows) if is_match(row)]
    return table.select(indices)


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
        self._tables: dict[str, tuple[Frame, ResultTable]] = {}
        self._questions: dict[str, CompiledQuery | ProgramError] = {}

    def hits(self, old: Frame, frame: Frame, mind: Mind, stop: threading.Event) -> tuple[Hit, ...]:
        """Return the breakpoints that a tick hits; always pass the same mind. Raises Stopped."""
        hits = []
        for point in self.breakpoints:
            try:
                if point.event in OF_QUESTIONS:
                    values = self._change_of_rows(point, old, frame, mind, stop)
                else:
                    values = "; ".join(_occurrences(point, old, frame))
            except ProgramError as error:
                self.problems[point] = f"This can't be asked: {error.first.message}."
                continue
            except QueryError as error:
                self.problems[point] = f"Tick {frame.tick}: {error}"
                continue
            self.problems.pop(point, None)
            if values:
                hits.append(Hit(point, frame.tick, values))
        return tuple(hits)

    def _change_of_rows(
        self, point: Breakpoint, previous: Frame, frame: Frame, mind: Mind, stop: threading.Event
    ) -> str:
        old_rows = self._rows(point, previous, mind, stop)
        new_rows = self._rows(point, frame, mind, stop)
        if point.event == "rows":
            return "" if old_rows or not new_rows else _join(new_rows)
        if point.event == "no rows":
            return "" if new_rows or not old_rows else f"there was {_join(old_rows)}"
        removed, added = _subtract(old_rows, new_rows), _subtract(new_rows, old_rows)
        if not removed and not added:
            return ""
        return " → ".join(_join(rows) if rows else "nothing" for rows in (removed, added))

    def _rows(self, point: Breakpoint, frame: Frame, mind: Mind, stop: threading.Event) -> _Rows:
        table = self._table(point.subject, frame, mind, stop)
        question = self._questions.get(point.subject)
        if point.event != "change" and question is not None and not isinstance(question, Exception):
            table = matching_rows(question, table)
        rows: Sequence[tuple[Value, ...]] = table.rows
        if point.robot and "robot_name" in table.columns:
            index = table.columns.index("robot_name")
            rows = [row for row in rows if row[index] == point.robot]
        else:
            rows = table.in_mind_of(point.robot).rows
        if not point.column:
            return list(rows)
        if point.column not in table.columns:
            if not table.rows:
                return []
            raise QueryError(f"{point.subject} has no column {point.column}.")
        index = table.columns.index(point.column)
        return [(row[index],) for row in rows]

    def _table(self, subject: str, frame: Frame, mind: Mind, stop: threading.Event) -> ResultTable:
        entry = self._tables.get(subject)
        if entry is not None and entry[0] is frame:
            return entry[1]
        question = self._question(subject, mind, stop)
        sensors, memories = frame.sensors, frame.memories_before
        if question is None:
            table = mind.query(subject, sensors, memories, stop=stop)
        else:
            table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
        self._tables[subject] = (frame, table)
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


def _subtract(rows: _Rows, other_rows: _Rows) -> _Rows:
    if rows == other_rows:
        return []
    from logical_robots_tui.mind.sqlite.stored import to_json

    counts = Counter(to_json(row) for row in other_rows)
    missing = []
    for row in rows:
        text = to_json(row)
        if counts[text]:
            counts[text] -= 1
        else:
            missing.append(row)
    return missing


def _join(rows: _Rows) -> str:
    from logical_robots_tui.mind.sqlite.stored import to_json  # not before there is a mind

    texts = [list(map(to_json, row)) for row in rows[:_FEW]]
    short = ([t if len(t) <= _LONGEST else f"{t[:_LONGEST]}…" for t in row] for row in texts)
    lines = map(", ".join, short)
    surplus = len(rows) - _FEW
    return "; ".join(lines) + (f" and {surplus} more" if surplus > 0 else "")


def _occurrences(point: Breakpoint, previous: Frame, frame: Frame) -> Iterator[str]:
    match point.event:
        case "enters":
            yield from _moves(point, previous, frame, "is in")
        case "leaves":
            yield from _moves(point, frame, previous, "was in")
        case "blocked":
            for old, robot in zip(previous.after.robots, frame.after.robots, strict=True):
                if robot.blocked and not old.blocked and point.robot in ("", robot.name):
                    yield f"{robot.name} at {robot.x:.1f}, {robot.y:.1f}"
        case "loses sight":
            yield from _losses(point, previous, frame)
        case _:
            for name, notice in new_notices(previous, frame):
                if point.robot in ("", name) and point.subject in ("", notice.kind):
                    yield f"{name}: {notice.message}"


def _moves(point: Breakpoint, start: Frame, end: Frame, verb: str) -> Iterator[str]:
    for old, area in zip(start.after.areas, end.after.areas, strict=True):
        if point.subject in ("", area.name):
            for name in area.visitors:
                if name not in old.visitors and point.robot in ("", name):
                    yield f"{name} {verb} {area.name}"


def _losses(point: Breakpoint, previous: Frame, frame: Frame) -> Iterator[str]:
    for old_row, row in zip(previous.sensors, frame.sensors, strict=True):
        name = row["robot_name"]
        if point.robot in ("", name):
            distances = _distances(row)
            for label, distance in _distances(old_row).items():
                if label not in distances and point.subject in ("", label):
                    yield f"{name} saw {label} last at distance {distance:g}"


def _distances(row: SensorRow) -> dict[str, float]:
    return {
        ray["label"]: ray["distance"]
        for ray in row["sensor"]["radar"]
        if ray["object"] in ("beacon", "robot")
    }
