"""What is asked about finished ticks: queries, explanations, and values that a player pins."""

from __future__ import annotations

import asyncio
import contextlib
import math
import operator
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from itertools import count, repeat
from typing import TYPE_CHECKING, NamedTuple, TypeAlias, TypeVar

from logical_robots_tui import explain
from logical_robots_tui.game.advancing import Thinker
from logical_robots_tui.game.debugging.breakpoints import matching_rows
from logical_robots_tui.game.frame import Frame, Superseded
from logical_robots_tui.mind import (
    Limits,
    ProgramError,
    QueryError,
    QueryPlan,
    ResultTable,
    Stopped,
)
from logical_robots_tui.values import Value, spell
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask, Proof
    from logical_robots_tui.explain.why.explainer import Explainer
    from logical_robots_tui.explain.why.nearest import Suggestion
    from logical_robots_tui.mind import Mind, Program, ResultTable

MIND = "in the mind of"
"""Pseudo-column for the robot in whose reasoning a row holds. No real column has this name."""

ROBOT_COLUMNS = (MIND, "robot_name", "robot")
"""Columns that name the robot of a row, the most specific first."""

Path: TypeAlias = "tuple[str | int, ...]"
"""The path into a value: field names and list indices."""


class Pin(NamedTuple):
    """A number of rows ("" as column), or one value in one row.

    A question counts only the rows for which it holds.
    """

    predicate: str
    column: str = ""
    where: tuple[tuple[str, Value], ...] = ()
    path: Path = ()

    @property
    def is_question(self) -> bool:
        return not self.predicate.isidentifier()

    @property
    def name(self) -> str:
        """Its name without the robot, such as ``Robot.memory.phase`` or ``Near: rows``."""
        if self.is_question:
            return self.predicate
        if not self.column:
            return f"{self.predicate}: rows"
        return path_text(self.path, f"{self.predicate}.{self.column}")

    @property
    def words(self) -> str:
        """Its full description, such as ``Robot.memory for Ada``."""
        parts = (
            text if name in ROBOT_COLUMNS else f"{name} {text}"
            for name, value in self.where
            for text in [value if isinstance(value, str) else spell(value, is_rounded=True)]
        )
        return f"{self.name} for {', '.join(parts)}" if self.where else self.name

    def deeper(self, path: Path) -> Pin:
        return self._replace(path=self.path + path)


class PinReading(NamedTuple):
    """The value of a pin at a tick."""

    value: Value = None
    problem: str = ""

    @property
    def number(self) -> float | None:
        """The value as a number, 0 or 1 for a Boolean; None if it is not a finite number."""
        if not isinstance(self.value, bool | int | float):
            return None
        try:
            number = float(self.value)
        except OverflowError:
            return None
        return number if math.isfinite(number) else None


def path_text(path: Path, root: str = "memory") -> str:
    return root + "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in path)


def pin_of_cell(
    predicate: str, columns: Sequence[str], rows: Sequence[Sequence[Value]], row: int, column: str
) -> Pin | None:
    """Return the pin of a value in a table, which finds its row again at other ticks.

    As few columns as needed identify the row. None if only the value itself distinguishes it.
    """
    cells = rows[row]
    candidates = [cells for index, cells in enumerate(rows) if index != row]
    where: list[tuple[str, Value]] = []
    names = [name for name in ROBOT_COLUMNS if name in columns]
    for name in (*names, *(name for name in columns if name not in ROBOT_COLUMNS)):
        place = columns.index(name)
        value = cells[place]
        matches = [candidate for candidate in candidates if _is_same(candidate[place], value)]
        is_distinctive = name in ROBOT_COLUMNS or len(matches) < len(candidates)
        if is_distinctive and name != column and isinstance(value, bool | int | float | str):
            where.append((name, value))
            candidates = matches
    return None if candidates else Pin(predicate, column, tuple(where))


def read(pin: Pin, table: ResultTable | QueryError) -> PinReading:
    if isinstance(table, QueryError):
        return PinReading(problem=str(table))
    for name in (*(name for name, _ in pin.where), pin.column):
        if table.rows and name not in (*table.columns, MIND, ""):
            return PinReading(problem=f"{pin.predicate} has no column {name}.")
    places = [table.columns.index(c) if c in table.columns else None for c, _ in pin.where]
    tests = [(place, value) for place, (_, value) in zip(places, pin.where, strict=True)]
    numbers = [
        number
        for number, row, viewer in zip(count(), table.rows, table.viewers or repeat(None))
        if all(
            viewer in (None, value) if place is None else _is_same(row[place], value)
            for place, value in tests
        )
    ]
    rows = table.select(numbers).once().rows
    if not pin.column:
        return PinReading(len(rows))
    if len(rows) != 1:
        return PinReading(problem=f"{len(rows)} rows." if rows else "No row.")
    return _inside(rows[0][table.columns.index(pin.column)], pin.path)


def _is_same(value: Value, expected: Value) -> bool:
    """Return whether a value identifies the same row; angles may differ in the last digits."""
    if isinstance(value, float) and isinstance(expected, float):
        return math.isclose(value, expected, rel_tol=1e-6, abs_tol=1e-9)
    return value == expected


def _inside(value: Value, path: Path) -> PinReading:
    for step in path:
        if isinstance(step, str):
            if not isinstance(value, Mapping) or step not in value:
                return PinReading(problem=f"There is no field {step}.")
            value = value[step]
        elif isinstance(value, Sequence) and not isinstance(value, str) and step < len(value):
            value = value[step]
        else:
            return PinReading(problem=f"There is no item {step}.")
    return PinReading(value)


T = TypeVar("T")

_LIMITS = Limits()


class Inquiry:
    """Answers questions about frames of a level, without side effects, during the game.

    A newer question of the same kind cancels an older one, which raises Superseded.
    """

    def __init__(self, level: Level) -> None:
        self._level = level
        self._asker = Thinker("ask")
        self._explainer = Thinker("explain")
        self._surveyor = Thinker("survey")
        self._watcher = Thinker("watch")
        # By who is asked: asked again about the same, an explainer reuses what it has worked out.
        self._last: dict[Thinker, tuple[tuple[Mind, str, Frame], Explainer]] = {}

    async def ask(self, program: Program, query: str, frame: Frame) -> ResultTable:
        """Evaluate a call, an expression, conditions, or rules of which the last is evaluated.

        Raises ProgramError for a wrong query, QueryError if it failed at this tick.
        """

        def work(mind: Mind, stop: threading.Event) -> ResultTable:
            question = program.question(query, stop=stop, limits=_LIMITS)
            return mind.ask(question, frame.sensors, frame.memories_before, stop=stop)

        return await self._do(self._asker, program, work)

    async def prepare(self, program: Program, question: Ask) -> None:
        """Do what a question needs before there is a frame."""
        from logical_robots_tui.explain.why.probing import decompose

        def work(stop: threading.Event) -> None:
            with contextlib.suppress(QueryError):
                decompose(program, question.predicate, question.within, stop=lambda: stop)

        await self._explainer.do(work)

    async def proof(
        self, program: Program, robot: str, frame: Frame, question: Ask, *, depth: int = 100
    ) -> Proof:
        """Prove the first row that is asked for, or its absence, `depth` predicates deep.

        Asked again deeper, it reuses what it has worked out. Raises QueryError.
        """
        return await self._explain(
            self._explainer, program, robot, frame, lambda e: e.proof(question, depth=depth)
        )

    async def calls(
        self, program: Program, robot: str, frame: Frame, predicate: str
    ) -> ResultTable:
        """Return a function's calls in a robot's reasoning at a frame, or raise QueryError."""
        return await self._explain(
            self._surveyor, program, robot, frame, lambda explainer: explainer.calls(predicate)
        )

    async def nearest(
        self, program: Program, robot: str, frame: Frame, question: Ask
    ) -> list[tuple[int, Suggestion]]:
        """Return lines with changes that would give a row, smallest first, or raise QueryError."""

        def work(explainer: Explainer) -> list[tuple[int, Suggestion]]:
            return [(rule.line, suggestion) for rule, suggestion in explainer.nearest(question)]

        return await self._explain(self._explainer, program, robot, frame, work)

    async def query_plans(self, program: Program, frame: Frame) -> list[QueryPlan]:
        """Return how each of the program's predicates is computed at a frame, slowest first."""
        names = [p.name for p in program.predicates if p.kind == "program" and p.has_rows]

        def work(mind: Mind, stop: threading.Event) -> list[QueryPlan]:
            plans = []
            for name in names:
                with contextlib.suppress(QueryError):
                    sensors, memories = frame.sensors, frame.memories_before
                    mind.query(name, sensors, memories, stop=stop)  # the first time is slower
                    plans.append(mind.query_plan(name, sensors, memories, stop=stop))
            return sorted(plans, key=lambda plan: -plan.milliseconds)

        return await self._do(self._explainer, program, work)

    async def survey(self, program: Program, frame: Frame) -> dict[str, ResultTable | QueryError]:
        """Return the rows of all predicates that have rows, or why one has none."""
        names = [predicate.name for predicate in program.predicates if predicate.has_rows]
        return await self._do(self._surveyor, program, partial(_tables, names, frame))

    async def readings(
        self, program: Program, frame: Frame, pins: Sequence[Pin]
    ) -> dict[Pin, PinReading]:
        def work(mind: Mind, stop: threading.Event) -> dict[Pin, PinReading]:
            tables = _tables(dict.fromkeys(pin.predicate for pin in pins), frame, mind, stop)
            return {pin: read(pin, tables[pin.predicate]) for pin in pins}

        return await self._do(self._watcher, program, work)

    async def close(self) -> None:
        thinkers = (self._asker, self._explainer, self._surveyor, self._watcher)
        await asyncio.gather(*(thinker.close() for thinker in thinkers))

    async def _explain(
        self,
        thinker: Thinker,
        program: Program,
        robot: str,
        frame: Frame,
        work: Callable[[Explainer], T],
    ) -> T:
        def explained(mind: Mind, stop: threading.Event) -> T:
            about = mind, robot, frame
            last = self._last.get(thinker)
            if last is None or not all(map(operator.is_, last[0], about)):
                sensors, memories = frame.sensors, frame.memories_before
                last = about, explain.Explainer(mind, robot, sensors, memories)
                self._last[thinker] = last
            last[1].stop_with(stop)
            return work(last[1])

        return await self._do(thinker, program, explained)

    async def _do(
        self, thinker: Thinker, program: Program, work: Callable[[Mind, threading.Event], T]
    ) -> T:
        thinker.stop()
        try:
            return await thinker.do(
                lambda stop: work(thinker.mind(program, self._level, _LIMITS), stop)
            )
        except Stopped:
            raise Superseded from None


def _tables(
    predicates: Iterable[str], frame: Frame, mind: Mind, stop: threading.Event
) -> dict[str, ResultTable | QueryError]:
    tables: dict[str, ResultTable | QueryError] = {}
    sensors, memories = frame.sensors, frame.memories_before
    for name in predicates:
        try:
            if name.isidentifier():
                tables[name] = mind.query(name, sensors, memories, stop=stop)
            else:
                question = mind.program.question(name, stop=stop, limits=mind.limits)
                table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
                tables[name] = matching_rows(question, table)
        except ProgramError as error:
            tables[name] = QueryError(f"This can't be asked: {error.first.message}.")
        except QueryError as error:
            tables[name] = error
    return tables
