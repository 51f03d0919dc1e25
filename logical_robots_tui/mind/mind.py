"""A mind: a compiled program attached to SQLite; sensors and memories in, decisions out."""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import repeat
from time import perf_counter
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.confinement import check_room
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind import decision
from logical_robots_tui.mind.asking import Answer, Asking, FailureError
from logical_robots_tui.mind.decision import Decision, Notice
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import Program, QueryPlan, Question, Table
from logical_robots_tui.mind.sqlite.budget import EvaluationBudget
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.relations import Relations
    from logical_robots_tui.world import Level

_ROOM = 320 * 1024**2  # bytes of address space that SQLite and all rows may take

Memories = Mapping[str, Value]

_EXPLAINED_ROWS = 20_000  # rows of one predicate, to find derivations among


class Mind:
    """Thinks for all robots of a tick. Use it from one thread at a time.

    Args:
        program: The robots' program.
        memory: Whose memories a robot sees: ``own``, ``seen`` or ``all``.
        sensor: Whose sensors it sees: ``own`` or ``all``. A program's ``@Visible`` has priority.
        limits: Limits on time and size.
        plain: Whether to evaluate the SQL as generated, which is slower but equivalent.
        frozen: Whether the caller never changes a record or list that it passes or receives, as a
            game doesn't. Then values that stay the same stay the same objects and are not
            processed again.
        robots: Names of the robots that it thinks for; nothing of others reaches it. All if None.
    """

    def __init__(
        self,
        program: Program,
        memory: Literal["own", "seen", "all"] = "own",
        sensor: Literal["own", "all"] = "own",
        limits: Limits | None = None,
        *,
        plain: bool = False,
        frozen: bool = False,
        robots: Collection[str] | None = None,
    ) -> None:
        self.program = program
        self._robots = robots
        self.memory = program.memory or memory
        self.sensor = program.sensor or sensor
        self.limits = limits or Limits()
        self._frozen = frozen
        self._moment: Inputs | None = None
        self._rows: Sequence[SensorRow] | None = None  # of that moment, with those of others
        # What `Robot` returned at that moment, as far as known.
        self._thought: list[tuple[View, Answer]] = []
        self._asking = Asking(program, self.limits, plain=plain, frozen=frozen)
        self._robot = self._asking.asked("Robot")
        self._within = EvaluationBudget.of_thought(self.limits)

    @classmethod
    def for_level(cls, program: Program, level: Level, limits: Limits | None = None) -> Mind:
        """Return a mind that sees what robots of a level see; raise ValueError if it has teams."""
        if level.teams:
            raise ValueError("Each team has a mind of its own: use Simulation or Game.")
        return cls(program, level.visibility.memory, level.visibility.sensor, limits)

    @property
    def steps(self) -> int:
        """The steps of the last think: of the same thoughts always the same, on every machine."""
        return self._within.steps - self._within.remainder.steps

    def think(
        self, rows: Sequence[SensorRow], memories: Memories, *, stop: threading.Event | None = None
    ) -> list[Decision]:
        """Decide for every robot that has a sensor row, in the order of the rows.

        Args:
            rows: ``{"robot_name": ..., "sensor": {...}}`` per robot.
            memories: Each robot's memory, by name; null if missing.
            stop: Set it from another thread to give up.

        Raises:
            Stopped: `stop` was set before the think was finished.
        """
        moment = self._moment_of(rows, memories)
        within = self._within  # exact if the last think took too many steps
        within.stop = stop
        within.renew()
        try:
            check_room(_ROOM)
            decisions = self._decisions(moment, memories, within)
            if within.is_close:
                within = within.exact()
                decisions = self._decisions(moment, memories, within)
        except MemoryError:
            self._thought = []
            notice = Notice("no room", "There was not enough memory to think: engines stop.")
            names = moment.names
            return [Decision(name, None, memories.get(name), (notice,)) for name in names]
        self._within.is_exact = within.is_exact and within.remainder.steps < 0
        return decisions

    def _decisions(
        self, moment: Inputs, memories: Memories, within: EvaluationBudget
    ) -> list[Decision]:
        names = moment.names
        answers: dict[str, list[Mapping[str, Value]]] = {name: [] for name in names}
        strangers: dict[str, list[Notice]] = {}
        failures: dict[str, Notice] = {}
        cut_off: dict[str, list[Notice]] = {}
        self._thought = []
        for view, answer in self._asking.each(self._robot, moment, within):
            if isinstance(answer, FailureError):
                notice = decision.blame(
                    answer, self._asking, self.program.needed, moment, view, within
                )
                failures |= dict.fromkeys(view.viewers, notice)
                continue
            if self.program.recursions:
                ended = [*decision.cut_offs(self._asking, moment, view, within)]
                cut_off |= dict.fromkeys(view.viewers, ended)
            columns, found = answer
            mine = view.viewers if len(view.viewers) == 1 else frozenset(view.viewers)
            self._thought.append((view, answer))
            for values in found:
                row = dict(zip(columns, values, strict=True))
                name = row.get("robot_name")
                if isinstance(name, str) and name in mine:
                    answers[name].append(row)
                elif not isinstance(name, str) or name not in answers:
                    decision.note_stranger(name, strangers.setdefault(view.viewers[0], []))
        notices: dict[str, Sequence[Notice]] = {}
        if failures or strangers or cut_off:
            for name in names:
                notices[name] = (*strangers.get(name, ()), *cut_off.get(name, ()))
            notices |= {name: (notice,) for name, notice in failures.items()}
        limits, heaviest = self.limits, self.limits.weight_of_each(len(names))
        return [
            decision.decide(
                name, answers[name], memories.get(name), notices.get(name, ()), limits, heaviest
            )
            for name in names
        ]

    def query(
        self,
        predicate: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> Table:
        """Return the rows of any predicate of the program, or of Sensor or Memory, at one moment.

        Where robots think separately, each row is marked with its robot's name.

        Raises:
            QueryError: There is no such predicate, it has no rows of its own, or it failed.
            Stopped: `stop` was set before the query was finished.
        """
        if predicate == "Sensor":
            sensed = tuple((r["robot_name"], r["sensor"]) for r in self._own(rows))
            return Table(("robot_name", "sensor"), sensed)
        if predicate == "Memory":
            names = [row["robot_name"] for row in self._own(rows)]
            return Table(("robot_name", "memory"), tuple((n, memories.get(n)) for n in names))
        known = self.program.predicate(predicate)
        if known is None:
            raise QueryError(f"The program has no predicate {predicate}.")
        if not known.has_rows:
            raise QueryError(known.reason)
        moment = self._moment_of(rows, memories)
        has_thought = moment is self._moment and len(self._thought) == len(moment.views)
        if predicate == "Robot" and has_thought:
            return self._table(self._thought, {})
        try:
            return self._answered(self._asking.asked(predicate), moment, stop)
        except FailureError as failure:
            raise QueryError(f"{predicate} failed: {failure}") from None

    def ask(
        self,
        question: Question,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
        in_order: bool = True,
    ) -> Table:
        """Answer a question about the program at one moment.

        Args:
            question: A question compiled for this mind's program.
            rows: As for `think`.
            memories: As for `think`.
            stop: Set it from another thread to cancel.
            in_order: Whether the order of the rows matters; without it may be faster.

        Raises:
            QueryError: It failed.
            Stopped: `stop` was set before the question was answered.
        """
        moment = self._moment_of(rows, memories)
        try:
            return self._answered(question, moment, stop, in_order=in_order)
        except FailureError as failure:
            what = question.text if question.text.isidentifier() else "This"
            raise QueryError(f"{what} failed: {failure}.") from None

    def each(
        self,
        predicates: Sequence[str],
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        viewers: Collection[str] | None = None,
        stop: threading.Event | None = None,
    ) -> Iterator[tuple[str, list[dict[str, Value]] | None]]:
        """Return the rows of several predicates in each robot's mind at a moment.

        Yields:
            The rows of each predicate, one entry per view; None if it fails or has more rows
            than the limits allow.

        Raises:
            Stopped: `stop` was set.
        """
        moment = self._new_moment(rows, memories)
        asked = [(name, self._asking.asked(name)) for name in predicates]
        for view in moment.views:
            if viewers is not None and not any(name in viewers for name in view.viewers):
                continue
            for name, question in asked:
                try:
                    within = self._within_query(self.limits.rows, stop, truncates=False)
                    columns, found = self._asking.rows(question, moment, view, within)
                except (FailureError, QueryError):
                    yield name, None
                else:
                    yield name, [dict(zip(columns, row, strict=True)) for row in found]

    def each_at(
        self,
        predicates: Sequence[str],
        moments: Sequence[tuple[Sequence[SensorRow], Memories]],
        *,
        stop: threading.Event | None = None,
    ) -> Iterator[tuple[str, int, list[list[dict[str, Value]]] | None]]:
        """Return the rows of several predicates in each robot's mind at several moments.

        Where each robot sees only its own sensor, one query is for all moments.

        Yields:
            A predicate, the number of a moment, and its rows there, a list for each view; None
            if it fails or has more rows than the limits allow.

        Raises:
            Stopped: `stop` was set.
        """
        each = [self._new_moment(rows, memories) for rows, memories in moments]
        together = bool(each) and all(moment.has_private_sensors for moment in each)
        for first, moment in enumerate([Inputs.stack(each)] if together else each):
            of = [n for n, moment in enumerate(each) for _ in moment.views] if together else ()
            for name in predicates:
                found: dict[int, list[list[dict[str, Value]]] | None] = {}
                within = self._within_query(self.limits.rows, stop, truncates=False)
                question = self._asking.asked(name)
                answers = self._asking.each(question, moment, within, in_order=False)
                for number, (_, answer) in zip(of or repeat(first), answers, strict=False):
                    if isinstance(answer, FailureError):
                        found[number] = None
                    elif (known := found.setdefault(number, [])) is not None:
                        columns, rows = answer
                        known.append([dict(zip(columns, row, strict=True)) for row in rows])
                for number, rows_there in found.items():
                    yield name, number, rows_there

    def relations(
        self,
        robot: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> Relations:
        """Return the rows of predicates as one robot sees them; valid until the next call.

        Takes the arguments of `think`, and the robot's name.

        Raises:
            QueryError: There is no such robot.
        """
        from logical_robots_tui.mind.relations import Relations

        moment = self._new_moment(rows, memories)
        view = next((view for view in moment.views if robot in view.viewers), None)
        if view is None:
            raise QueryError(f"There is no robot {robot} at this tick.")
        within = self._within_query(_EXPLAINED_ROWS, stop, truncates=False)
        return Relations(self._asking, moment, view, within)

    def query_plan(
        self,
        predicate: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> QueryPlan:
        """Return how a predicate is computed at one moment, and how long it takes.

        Raises:
            QueryError: It has no rows of its own, or it failed.
            Stopped: `stop` was set.
        """
        known = self.program.predicate(predicate)
        if known is None or predicate not in self.program.statements:
            raise QueryError(known.reason if known else f"The program has no {predicate}.")
        moment = self._new_moment(rows, memories)
        within = self._within_query(self.limits.rows, stop)
        try:
            tuned, plan = self._asking.plan(predicate, moment, moment.views[0], within)
        except FailureError as failure:
            raise QueryError(f"{predicate} failed: {failure}.") from None
        began = perf_counter()
        self.query(predicate, rows, memories, stop=stop)
        milliseconds = (perf_counter() - began) * 1000
        generated = self.program.statements[predicate]
        return QueryPlan(predicate, generated, tuned, plan, milliseconds)

    def close(self) -> None:
        """Close the databases."""
        self._asking.close()

    # -- inside --------------------------------------------------------------------------------

    def _within_query(
        self, rows: int, stop: threading.Event | None, *, truncates: bool = True
    ) -> EvaluationBudget:
        try:
            check_room(_ROOM)
        except MemoryError:
            raise QueryError("There is not enough memory to look this up.") from None
        return EvaluationBudget.of_query(self.limits, rows, stop, truncates=truncates)

    def _moment_of(self, rows: Sequence[SensorRow], memories: Memories) -> Inputs:
        """Return the moment; the previous one if nothing can have changed."""
        last = self._moment
        if last is None or self._rows is not rows or last.memory_values is not memories:
            last = self._new_moment(rows, memories)
            self._moment = last if self._frozen else None
            self._rows, self._thought = rows, []
        return last

    def _new_moment(self, rows: Sequence[SensorRow], memories: Memories) -> Inputs:
        return Inputs(self._own(rows), memories, self.memory, self.sensor)

    def _own(self, rows: Sequence[SensorRow]) -> Sequence[SensorRow]:
        if self._robots is None:
            return rows
        return [row for row in rows if row["robot_name"] in self._robots]

    def _answered(
        self,
        question: Question,
        moment: Inputs,
        stop: threading.Event | None,
        *,
        in_order: bool = True,
    ) -> Table:
        """Return the answers for all views; recounted exactly if the budget is nearly used up."""
        within = self._within_query(self.limits.rows, stop)
        try:
            answers = self._asking.each(question, moment, within, in_order=in_order)
            table = self._table(answers, question.labels)
        except FailureError:
            if not within.is_close:
                raise
        else:
            if not within.is_close:
                return table
        answers = self._asking.each(question, moment, within.exact(), in_order=in_order)
        return self._table(answers, question.labels)

    def _table(
        self, answers: Iterable[tuple[View, Answer | FailureError]], labels: Mapping[str, str]
    ) -> Table:
        columns: Sequence[str] = ()
        rows: list[tuple[Value, ...]] = []
        viewers: list[str] = []
        for view, answer in answers:
            if isinstance(answer, FailureError):
                raise answer
            columns, found = answer
            rows += found
            viewers += [view.viewers[0]] * len(found)
        most, is_separate = self.limits.rows, (self.memory, self.sensor) != ("all", "all")
        return Table(
            tuple(labels.get(column, column) for column in columns),
            tuple(rows[:most]),
            tuple(viewers[:most]) if is_separate else (),
            truncated=len(rows) > most,
        )
