"""A mind: a compiled program attached to SQLite; sensors and memories in, decisions out."""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import islice, repeat
from time import perf_counter
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.confinement import check_room
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind import decision
from logical_robots_tui.mind.asking import Answer, FailureError, MindDatabases
from logical_robots_tui.mind.decision import Decision, Notice
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import CompiledQuery, Program, QueryPlan, ResultTable
from logical_robots_tui.mind.sqlite.budget import QueryBudget
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.relations import Relations
    from logical_robots_tui.world import Level

_REQUIRED_BYTES = 320 * 1024**2  # bytes of address space that SQLite and all rows may take

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
        self._inputs: Inputs | None = None
        self._rows: Sequence[SensorRow] | None = None  # of those inputs, with those of others
        # What `Robot` returned for those inputs, as far as it was computed.
        self._robot_answers: list[tuple[View, Answer]] = []
        self._databases = MindDatabases(program, self.limits, plain=plain, frozen=frozen)
        self._robot_query = self._databases.query_for("Robot")
        self._budget = QueryBudget.of_thought(self.limits)

    @classmethod
    def for_level(cls, program: Program, level: Level, limits: Limits | None = None) -> Mind:
        """Return a mind that sees what robots of a level see; raise ValueError if it has teams."""
        if level.teams:
            raise ValueError("Each team has a mind of its own: use Simulation or Game.")
        return cls(program, level.visibility.memory, level.visibility.sensor, limits)

    @property
    def steps(self) -> int:
        """The steps of the last think; the same for the same inputs, on every machine."""
        return self._budget.steps - self._budget.remainder.steps

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
        inputs = self._inputs_of(rows, memories)
        budget = self._budget  # exact if the last think took too many steps
        budget.stop = stop
        budget.renew()
        try:
            check_room(_REQUIRED_BYTES)
            decisions = self._decisions(inputs, memories, budget)
            if budget.is_close:
                budget = budget.exact()
                decisions = self._decisions(inputs, memories, budget)
        except MemoryError:
            self._robot_answers = []
            notice = Notice("no room", "There was not enough memory to think: engines stop.")
            names = inputs.names
            return [Decision(name, None, memories.get(name), (notice,)) for name in names]
        self._budget.is_exact = budget.is_exact and budget.remainder.steps < 0
        return decisions

    def _decisions(self, inputs: Inputs, memories: Memories, budget: QueryBudget) -> list[Decision]:
        names = inputs.names
        answers: dict[str, list[Mapping[str, Value]]] = {name: [] for name in names}
        strangers: dict[str, list[Notice]] = {}
        failures: dict[str, Notice] = {}
        cut_off: dict[str, list[Notice]] = {}
        self._robot_answers = []
        for view, answer in self._databases.answers(self._robot_query, inputs, budget):
            if isinstance(answer, FailureError):
                notice = decision.blame(
                    answer, self._databases, self.program.needed, inputs, view, budget
                )
                failures |= dict.fromkeys(view.viewers, notice)
                continue
            if self.program.recursions:
                cut_off_notices = [*decision.cut_offs(self._databases, inputs, view, budget)]
                cut_off |= dict.fromkeys(view.viewers, cut_off_notices)
            columns, rows = answer
            viewers = view.viewers if len(view.viewers) == 1 else frozenset(view.viewers)
            self._robot_answers.append((view, answer))
            for values in rows:
                row = dict(zip(columns, values, strict=True))
                name = row.get("robot_name")
                if isinstance(name, str) and name in viewers:
                    answers[name].append(row)
                elif not isinstance(name, str) or name not in answers:
                    decision.note_stranger(name, strangers.setdefault(view.viewers[0], []))
        notices: dict[str, Sequence[Notice]] = {}
        if failures or strangers or cut_off:
            for name in names:
                notices[name] = (*strangers.get(name, ()), *cut_off.get(name, ()))
            notices |= {name: (notice,) for name, notice in failures.items()}
        limits, max_weight = self.limits, self.limits.weight_of_each(len(names))
        return [
            decision.decide(
                name, answers[name], memories.get(name), notices.get(name, ()), limits, max_weight
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
    ) -> ResultTable:
        """Return the rows of any predicate of the program, or of Sensor or Memory, at one moment.

        Where robots think separately, each row is marked with its robot's name, unless the
        predicate depends on no sensor or memory.

        Raises:
            QueryError: There is no such predicate, it has no rows of its own, or it failed.
            Stopped: `stop` was set before the query was finished.
        """
        if predicate == "Sensor":
            sensed = tuple((r["robot_name"], r["sensor"]) for r in self._robot_rows(rows))
            return ResultTable(("robot_name", "sensor"), sensed)
        if predicate == "Memory":
            names = [row["robot_name"] for row in self._robot_rows(rows)]
            return ResultTable(("robot_name", "memory"), tuple((n, memories.get(n)) for n in names))
        definition = self.program.predicate(predicate)
        if definition is None:
            raise QueryError(f"The program has no predicate {predicate}.")
        if not definition.has_rows:
            raise QueryError(definition.reason)
        inputs = self._inputs_of(rows, memories)
        is_answered = inputs is self._inputs and len(self._robot_answers) == len(inputs.views)
        if predicate == "Robot" and is_answered:
            return self._table(self._robot_answers, self._databases.query_for(predicate))
        try:
            return self._answer(self._databases.query_for(predicate), inputs, stop)
        except FailureError as failure:
            reason = failure.reason(self.program, [predicate])
            raise QueryError(f"{predicate} failed: {reason}") from None

    def ask(
        self,
        question: CompiledQuery,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
        in_order: bool = True,
    ) -> ResultTable:
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
        inputs = self._inputs_of(rows, memories)
        try:
            return self._answer(question, inputs, stop, in_order=in_order)
        except FailureError as failure:
            subject = question.text if question.text.isidentifier() else "This"
            raise QueryError(f"{subject} failed: {failure}.") from None

    def predicate_rows(
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
        inputs = self._new_inputs(rows, memories)
        queries = [(name, self._databases.query_for(name)) for name in predicates]
        for view in inputs.views:
            if viewers is not None and not any(name in viewers for name in view.viewers):
                continue
            for name, question in queries:
                try:
                    budget = self._query_budget(self.limits.rows, stop, truncates=False)
                    columns, answer_rows = self._databases.rows(question, inputs, view, budget)
                except (FailureError, QueryError):
                    yield name, None
                else:
                    yield name, [dict(zip(columns, row, strict=True)) for row in answer_rows]

    def predicate_rows_at(
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
        all_inputs = [self._new_inputs(rows, memories) for rows, memories in moments]
        is_stacked = bool(all_inputs) and all(inputs.has_private_sensors for inputs in all_inputs)
        for index, inputs in enumerate([Inputs.stack(all_inputs)] if is_stacked else all_inputs):
            moment_numbers = (
                [n for n, inputs in enumerate(all_inputs) for _ in inputs.views]
                if is_stacked
                else ()
            )
            for name in predicates:
                views_by_moment: dict[int, list[list[dict[str, Value]]] | None] = {}
                budget = self._query_budget(self.limits.rows, stop, truncates=False)
                question = self._databases.query_for(name)
                answers = self._databases.answers(question, inputs, budget, in_order=False)
                for number, (_, answer) in zip(
                    moment_numbers or repeat(index), answers, strict=False
                ):
                    if isinstance(answer, FailureError):
                        views_by_moment[number] = None
                    elif (view_rows := views_by_moment.setdefault(number, [])) is not None:
                        columns, rows = answer
                        view_rows.append([dict(zip(columns, row, strict=True)) for row in rows])
                for number, views in views_by_moment.items():
                    yield name, number, views

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

        inputs = self._new_inputs(rows, memories)
        view = next((view for view in inputs.views if robot in view.viewers), None)
        if view is None:
            raise QueryError(f"There is no robot {robot} at this tick.")
        budget = self._query_budget(_EXPLAINED_ROWS, stop, truncates=False)
        return Relations(self._databases, inputs, view, budget)

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
        definition = self.program.predicate(predicate)
        if definition is None or predicate not in self.program.statements:
            raise QueryError(
                definition.reason if definition else f"The program has no {predicate}."
            )
        inputs = self._new_inputs(rows, memories)
        budget = self._query_budget(self.limits.rows, stop)
        try:
            tuned, plan = self._databases.plan(predicate, inputs, inputs.views[0], budget)
        except FailureError as failure:
            raise QueryError(f"{predicate} failed: {failure}.") from None
        start = perf_counter()
        self.query(predicate, rows, memories, stop=stop)
        milliseconds = (perf_counter() - start) * 1000
        generated = self.program.statements[predicate]
        return QueryPlan(predicate, generated, tuned, plan, milliseconds)

    def close(self) -> None:
        """Close the databases."""
        self._databases.close()

    # -- inside --------------------------------------------------------------------------------

    def _query_budget(
        self, rows: int, stop: threading.Event | None, *, truncates: bool = True
    ) -> QueryBudget:
        try:
            check_room(_REQUIRED_BYTES)
        except MemoryError:
            raise QueryError("There is not enough memory to look this up.") from None
        return QueryBudget.of_query(self.limits, rows, stop, truncates=truncates)

    def _inputs_of(self, rows: Sequence[SensorRow], memories: Memories) -> Inputs:
        """Return the inputs as an object; the previous one if nothing can have changed."""
        inputs = self._inputs
        if inputs is None or self._rows is not rows or inputs.memory_values is not memories:
            inputs = self._new_inputs(rows, memories)
            self._inputs = inputs if self._frozen else None
            self._rows, self._robot_answers = rows, []
        return inputs

    def _new_inputs(self, rows: Sequence[SensorRow], memories: Memories) -> Inputs:
        return Inputs(self._robot_rows(rows), memories, self.memory, self.sensor)

    def _robot_rows(self, rows: Sequence[SensorRow]) -> Sequence[SensorRow]:
        if self._robots is None:
            return rows
        return [row for row in rows if row["robot_name"] in self._robots]

    def _answer(
        self,
        question: CompiledQuery,
        inputs: Inputs,
        stop: threading.Event | None,
        *,
        in_order: bool = True,
    ) -> ResultTable:
        """Return the answers for all views; recounted exactly if the budget is nearly used up."""
        budget = self._query_budget(self.limits.rows, stop)
        try:
            answers = self._databases.answers(question, inputs, budget, in_order=in_order)
            table = self._table(answers, question)
        except FailureError:
            if not budget.is_close:
                raise
        else:
            if not budget.is_close:
                return table
        answers = self._databases.answers(question, inputs, budget.exact(), in_order=in_order)
        return self._table(answers, question)

    def _table(
        self, answers: Iterable[tuple[View, Answer | FailureError]], question: CompiledQuery
    ) -> ResultTable:
        is_separate = (self.memory, self.sensor) != ("all", "all") and question.reads_inputs
        columns: Sequence[str] = ()
        rows: list[tuple[Value, ...]] = []
        viewers: list[str] = []
        for view, answer in answers if is_separate else islice(answers, 1):
            if isinstance(answer, FailureError):
                raise answer
            columns, view_rows = answer
            rows += view_rows
            viewers += [view.viewers[0]] * len(view_rows)
        max_rows, labels = self.limits.rows, question.labels
        return ResultTable(
            tuple(labels.get(column, column) for column in columns),
            tuple(rows[:max_rows]),
            tuple(viewers[:max_rows]) if is_separate else (),
            truncated=len(rows) > max_rows,
        )
