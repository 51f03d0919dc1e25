"""Checking breakpoints: which ones a tick hits, and with what values."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.game.debugging.breakpoints import OF_QUESTIONS, Breakpoint, Hit
from logical_robots_tui.mind import ProgramError, QueryError, Table
from logical_robots_tui.mind.sqlite.stored import to_json
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Mind, Question

_Rows: TypeAlias = "list[tuple[Value, ...]]"
_FEW = 3  # values that are reported
_LONGEST = 60  # characters of each
_BY_NAME = ("Robot", "Sensor", "Memory")


def matching_rows(question: Question, table: Table, robot: str = "") -> Table:
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


class Watch:
    """Compares each tick with the previous one; `problems` are breakpoints it couldn't check."""

    def __init__(self, breakpoints: Sequence[Breakpoint]) -> None:
        self.breakpoints = breakpoints
        self.problems: dict[Breakpoint, str] = {}
        self._asked: dict[str, tuple[Frame, Table]] = {}
        self._questions: dict[str, Question | ProgramError] = {}

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

    def _table(self, subject: str, frame: Frame, mind: Mind, stop: threading.Event) -> Table:
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

    def _question(self, subject: str, mind: Mind, stop: threading.Event) -> Question | None:
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


def _rows_for(each: Breakpoint, table: Table) -> _Rows:
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
