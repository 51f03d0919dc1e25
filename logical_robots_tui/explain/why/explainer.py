"""What one robot thinks at one moment, explained: rows, proofs, calls, sources of values."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.explain.why.derivations import Derivations, Row, check_given
from logical_robots_tui.explain.why.deriving import ask_of
from logical_robots_tui.explain.why.explanation import (
    Ask,
    Explanation,
    Proof,
    Subject,
    ValueSource,
    read_call,
)
from logical_robots_tui.explain.why.nearest import Nearest, Suggestion
from logical_robots_tui.explain.why.probing import (
    Clause,
    PredicateCall,
    Probing,
    SourceSpan,
    decompose,
)
from logical_robots_tui.explain.why.proving import explain, prove
from logical_robots_tui.explain.why.sourcing import source_of
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.program import ResultTable
from logical_robots_tui.mind.relations import Way
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.mind import Memories, Mind
    from logical_robots_tui.mind.program import Program

_ROBOT = Ask()


class Explainer:
    """Explains what one robot thinks at one moment.

    Every question may raise `Stopped`.

    Args:
        mind: Thinks for the robot; explanations are valid until it is asked again.
        rows: The sensors of all robots at that moment.
        memories: Their memories.
        stop: Ends a question.

    Raises:
        QueryError: There is no such robot.
    """

    def __init__(
        self,
        mind: Mind,
        robot: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> None:
        relations = mind.relations(robot, rows, memories, stop=stop)
        self._program, self._robot = mind.program, robot
        self._limits, self._budget = mind.limits, relations.budget
        self._decomposed: dict[tuple[str, str], Probing] = {}
        self._derivations = Derivations(relations, robot, self._decompose)

    def stop_with(self, stop: threading.Event) -> None:
        """Let another event end the questions from now on."""
        self._budget.stop = stop

    def why(self, query: Ask = _ROBOT) -> Explanation:
        """Explain a predicate's rows, or their absence.

        Rows are those of the robot, where there is a column ``robot_name`` with no other value.

        Raises:
            QueryError: There is no such predicate or column, arguments are missing, or it failed.
        """
        return explain(self._derivations, self._with_robot(query))

    def proof(self, query: Ask = _ROBOT, *, depth: int = 100, nodes: int = 10_000) -> Proof:
        """Prove a row down to sensors and memories, up to `depth` predicates and `nodes` nodes.

        Raises QueryError as `why` does.
        """
        return prove(self._derivations, self._with_robot(query), depth=depth, nodes=nodes)

    def nearest(self, query: Ask = _ROBOT) -> list[tuple[SourceSpan, Suggestion]]:
        """Return changes that would give rules the row, smallest first; raise QueryError.

        There are none within a predicate made with ``:=``.
        """
        if query.within:
            return []
        values = self._with_robot(query).given
        nearest = Nearest(self._program, self._derivations, values, self._limits)
        probing = self._decompose(query.predicate, "")
        return [
            (rule.span, suggestion)
            for rule in probing.rules
            for suggestion in nearest.suggestions(probing, rule)
        ]

    def calls(self, function: str) -> ResultTable:
        """Return a function's distinct calls, arguments and results; raise QueryError."""
        entry = self._program.predicate(function)
        if entry is None or not entry.is_function:
            raise QueryError(f"{function} is not a function of this program.")
        self._budget.renew()
        uses = self._program.uses
        callers = {
            name: [p for p, callees in uses.items() if name in callees and p != name]
            for name in uses
        }
        limit, probing = self._limits.rows, self._decompose(function, "")
        calls = _Calls(callers, self._derivations, limit + 1)
        rows: list[tuple[Value, ...]] = []
        try:
            for values in calls.arguments(function, 0):
                arguments = {column: values.get(column) for column in probing.parameters}
                rows += [tuple(r.values()) for r in self._derivations.rows(probing, arguments)]
                if len(rows) > limit:
                    break
        except FailureError as failure:
            raise QueryError(f"The calls of {function} can't be listed: {failure}.") from None
        labels = tuple(self._program.label(function, column) for column in probing.columns)
        return ResultTable(labels, tuple(rows[:limit]), truncated=len(rows) > limit)

    def source(self, subject: Subject) -> ValueSource:
        """Trace a value to its source; raise QueryError if there is no such value."""
        return source_of(self._derivations, replace(subject, query=self._with_robot(subject.query)))

    def _decompose(self, predicate: str, within: str) -> Probing:
        key = predicate, within
        if key not in self._decomposed:
            self._decomposed[key] = decompose(
                self._program, *key, stop=lambda: self._budget.stop, limits=self._limits
            )
        return self._decomposed[key]

    def _with_robot(self, query: Ask) -> Ask:
        """Return the question about this robot, unless it names another one."""
        self._budget.renew()
        probing = self._decompose(query.predicate, query.within)
        if "robot_name" in probing.columns and "robot_name" not in probing.parameters:
            return replace(query, given={"robot_name": self._robot, **query.given})
        return query


def read_ask(program: Program, text: str, within: str = "") -> Ask:
    """Read a question, such as ``Next(robot_name: "Crow")``. Blocks.

    Raises:
        ProgramError: It is not a predicate with values.
        QueryError: There is no such predicate or column, or arguments are missing.
    """
    query = read_call(text, within)
    probing = decompose(program, query.predicate, within)
    return replace(query, given=check_given(query, probing, program.label))


_MOST_WAYS = 1_000
_DEEPEST = 20  # functions that call functions


class _Calls:
    """Finds the arguments of functions, up to `limit` each, from the derivations of callers."""

    def __init__(
        self, callers: Mapping[str, Sequence[str]], derivations: Derivations, limit: int
    ) -> None:
        self._callers, self._derivations, self._limit = callers, derivations, limit
        self._arguments: dict[str, list[Row]] = {}

    def arguments(self, name: str, depth: int) -> list[Row]:
        if name in self._arguments or depth > _DEEPEST:
            return self._arguments.get(name, [])
        self._arguments[name] = []
        parameters = self._derivations.decompose(name, "").parameters
        distinct: dict[str, Row] = {}
        for caller in self._callers.get(name, ()):
            probing = self._derivations.decompose(caller, "")
            for context in self.arguments(caller, depth + 1) if probing.parameters else ({},):
                self._derivations.prepare(probing)
                clauses = [clause for rule in probing.rules for clause in rule.clauses]
                for call, match in self._calls(clauses, probing, probing.arguments(context), name):
                    values = {c: v for c, v in ask_of(call, match).given.items() if c in parameters}
                    distinct.setdefault(json.dumps(values, sort_keys=True), values)
                if len(distinct) >= self._limit:
                    break
        self._arguments[name] = list(distinct.values())
        return self._arguments[name]

    def _calls(
        self, clauses: Sequence[Clause], probing: Probing, arguments: Sequence[Scalar], name: str
    ) -> Iterator[tuple[PredicateCall, Way]]:
        for clause in clauses:
            calls = [s.call for s in clause.steps if s.call and s.call.predicate == name]
            bodies = [step.denial for step in clause.steps if step.denial]
            bodies += [term.body for term in clause.all_terms() if term.body]
            sql = probing.queries.get(clause.query)
            if sql is None or not (calls or bodies):
                continue
            try:
                matches = self._derivations.relations.ways(sql, arguments, max_rows=_MOST_WAYS)
            except FailureError as failure:
                if failure.is_slow:
                    raise
                continue
            for match in matches:
                yield from ((call, match) for call in calls)
                for body in bodies:
                    yield from self._calls(body.clauses, probing, body.arguments(match), name)
