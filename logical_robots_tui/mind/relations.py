"""The rows of predicates at a moment, and queries over them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.asking import failures_in_words
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite.budget import STEPS_OF_A_CALL, QueryBudget
from logical_robots_tui.mind.sqlite.database import Answer, Scalar, TooSlowError
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.mind.sqlite.stored import from_sql, to_sql
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.asking import MindDatabases
    from logical_robots_tui.mind.program import Program

GIVEN = "WhyGiven"
"""The table of a query's given values, one row."""

SAME = "why_same"
"""The function for whether two values are the same, in queries."""

ALIKE = "why_alike"
"""The function for whether they are the same but for the order of lists."""

Way = dict[str, "Scalar"]
"""A derivation: a row of a clause's query, as SQLite has it, by the names of the columns."""

_CLOSE = 1e-12
_KEYS_AT_ONCE = 400
_REMARK_PATTERN = re.compile(r"/\* truths:(\S*) nested:(\S*) \*/")
_NONE: tuple[frozenset[str], frozenset[str]] = (frozenset(), frozenset())


def with_remarks(sql: str, truths: Iterable[str], nested: Iterable[str]) -> str:
    """Prepend a comment on which columns of a query are booleans, and which lists or records."""
    return f"/* truths:{','.join(truths)} nested:{','.join(nested)} */ {sql}"


@lru_cache(maxsize=256)
def _remarks(sql: str) -> tuple[frozenset[str], frozenset[str]]:
    match = _REMARK_PATTERN.match(sql)
    return (frozenset(match[1].split(",")), frozenset(match[2].split(","))) if match else _NONE


def with_given(sql: str, number: int) -> str:
    """Prepend a table of given values to a query; they become its first parameters."""
    if not number:
        return sql
    names = ", ".join(f"g{i}" for i in range(number))
    places = ", ".join("?" * number)
    return f"WITH {GIVEN}({names}) AS (VALUES ({places})) SELECT * FROM ({sql})"  # noqa: S608 - ours


class Relations:
    def __init__(
        self, databases: MindDatabases, inputs: Inputs, view: View, budget: QueryBudget
    ) -> None:
        self._databases, self._plain = databases, databases.plain_tables
        self._inputs, self._view, self.budget = self._query_arguments = inputs, view, budget
        self._plain.register(SAME, _same_in_sql, 2)
        self._plain.register(ALIKE, lambda left, right: alike(from_sql(left), from_sql(right)), 2)
        self._rows: dict[str, tuple[dict[str, Value], ...]] = {}
        self._columns: dict[str, Sequence[str]] = {}
        self._loaded_rows: dict[str, Sequence[Mapping[str, Value]]] = {}
        self._cut_off: list[tuple[str, int]] | None = None

    def rows(
        self, predicate: str, sources: Mapping[str, str] = MappingProxyType({})
    ) -> tuple[dict[str, Value], ...]:
        """Return a predicate's rows; raise FailureError.

        `sources` has the SQL of predicates for which the program has none.
        """
        if predicate not in self._rows:
            if sql := sources.get(predicate):
                columns, rows = self._databases.plain_rows(sql, *self._query_arguments)
            else:
                columns, rows = self._databases.rows(
                    self._databases.query_for(predicate), *self._query_arguments
                )
            self._columns[predicate] = columns
            self._rows[predicate] = tuple(dict(zip(columns, row, strict=True)) for row in rows)
        predicate_rows = self._rows[predicate]
        self.spend(STEPS_OF_A_CALL * len(predicate_rows))  # for the caller, which reads them
        return predicate_rows

    def cut_off(self, predicate: str) -> list[tuple[str, int]]:
        """Return the recursions that a predicate leans on and that were cut off, with their steps.

        Only those that `Robot` leans on, too, are known.
        """
        if self._cut_off is None:
            self._cut_off = [*self._databases.unfinished_recursions(*self._query_arguments)]
        used_predicates, pending = {predicate}, [predicate]
        while pending:
            callees = set(self._databases.program.uses.get(pending.pop(), ())) - used_predicates
            used_predicates |= callees
            pending += callees
        return [recursion for recursion in self._cut_off if recursion[0] in used_predicates]

    def answer(self, program: Program, query: str, limits: Limits) -> list[dict[str, Value]]:
        """Return a question's rows, about any program; raise ProgramError or FailureError."""
        self.budget.renew()
        question = program.question(query, stop=self.budget.stop, limits=limits)
        columns, rows = self._databases.plain_rows(question.sql, *self._query_arguments)
        return [dict(zip(columns, row, strict=True)) for row in rows]

    def label(self, predicate: str, column: str) -> str:
        return self._databases.program.label(predicate, column)

    def owners(self, table: Literal["sensor", "memory"], value: Value) -> list[str]:
        """Return the robots in sight whose sensor or memory is a value."""
        if table == "sensor":
            first, last = self._view.sensors
            rows = self._inputs.sensor_rows[first : last + 1]
            return [row["robot_name"] for row in rows if same(row["sensor"], value)]
        first, last = self._view.memories
        visible_names = [name for n, name in self._inputs.memory_rows if first <= n <= last]
        return [name for name in visible_names if same(self._inputs.memory_values.get(name), value)]

    def spend(self, steps: int) -> None:
        """Count steps outside of queries; FailureError if over budget, Stopped if stopped."""
        budget = self.budget
        budget.remainder.steps -= steps
        if budget.stop is not None and budget.stop.is_set():
            raise Stopped("The explanation was stopped.")
        with failures_in_words(budget):
            if budget.remainder.steps < 0:
                raise TooSlowError

    def fill(self, table: str, predicate: str, rows: Sequence[Mapping[str, Value]]) -> None:
        """Fill a table with some of a predicate's rows, unless it has them; raise FailureError."""
        if self._loaded_rows.get(table) is not rows:
            self._loaded_rows.pop(table, None)
            stored = [tuple(map(to_sql, row.values())) for row in rows]
            self.spend(_steps_of(stored))
            with failures_in_words(self.budget):
                columns = self._columns[predicate]
                self._plain.load_view(self._inputs, self._view)
                self._plain.define(table, columns, stored)
            self._loaded_rows[table] = rows

    def ways(
        self,
        sql: str,
        given_values: Sequence[Scalar],
        alike: Sequence[tuple[str, Value]] = (),
        selection: str = "*",
        max_rows: int = 1,
        comparison: str = SAME,
    ) -> list[Way]:
        """Return rows whose `alike` columns match by function `comparison`; raise FailureError."""
        query, parameters = _limited(sql, given_values, alike, selection, max_rows, comparison)
        names, rows = self._ask(query, parameters)
        self.spend(_steps_of(rows))
        derivations: list[Way] = [dict(zip(names, row, strict=True)) for row in rows]
        for column in _remarks(sql)[0] & {*names}:
            for derivation in derivations:
                if derivation[column] is not None:
                    derivation[column] = bool(derivation[column])
        return derivations

    def chosen_key(
        self, aggregate: str, columns: Iterable[tuple[str, str]], keys: Sequence[Scalar]
    ) -> int | None:
        """Return the place of the key that ``arg_min`` or ``arg_max`` chooses, None if none.

        The keys are from some `columns`, each with its query. Raises FailureError.
        """
        if any(column in _remarks(sql)[1] for sql, column in columns):
            aggregate += "_of_nested"
        best: int | None = None
        for start in range(0, len(keys), _KEYS_AT_ONCE):
            places = [*([] if best is None else [best]), *range(len(keys))[start:][:_KEYS_AT_ONCE]]
            pairs = ", ".join(f"({place}, ?)" for place in places)
            sql = f"SELECT {aggregate}(column1, column2) FROM (VALUES {pairs})"  # noqa: S608 - ours
            _, ((best,),) = self._ask(sql, [keys[place] for place in places])
        return best

    def count(
        self,
        sql: str,
        given_values: Sequence[Scalar],
        alike: Sequence[tuple[str, Value]] = (),
        max_rows: int = 1,
    ) -> int:
        """Return the number of a query's rows, at most `max_rows`; raise FailureError."""
        query, parameters = _limited(sql, given_values, alike, "1", max_rows, SAME)
        _, rows = self._ask(f"SELECT COUNT(*) FROM ({query})", parameters)  # noqa: S608 - ours
        return int(rows[0][0])

    def _ask(self, sql: str, parameters: Sequence[Scalar]) -> Answer:
        with failures_in_words(self.budget):
            return self._plain.ask_of(sql, *self._query_arguments, parameters)


def _limited(
    sql: str,
    given_values: Sequence[Scalar],
    alike: Sequence[tuple[str, Value]],
    selection: str,
    max_rows: int,
    comparison: str,
) -> tuple[str, list[Scalar]]:
    conditions = " AND ".join(f"{comparison}({column}, ?)" for column, _ in alike)
    query = f"SELECT {selection} FROM ({with_given(sql, len(given_values))})"  # noqa: S608 - the compiler's own SQL
    query += f"{' WHERE ' * bool(conditions)}{conditions} LIMIT {max_rows}"
    return query, [*given_values, *(to_sql(value) for _, value in alike)]


def _steps_of(rows: Sequence[Sequence[Any]]) -> int:
    """Return the cost of rows in steps: one call for each value, plus its characters."""
    texts = sum(len(value) for row in rows for value in row if value.__class__ is str)
    return texts + STEPS_OF_A_CALL * sum(map(len, rows))


def same(left: Value, right: Value) -> bool:
    """Return whether values are equal up to a number's last digits, which text loses.

    A field that a record lacks is null, as it is where rules with different fields give rows.
    """
    if isinstance(left, dict):
        return isinstance(right, dict) and all(
            same(left.get(name), right.get(name)) for name in {**left, **right}
        )
    if isinstance(left, list):
        return isinstance(right, list) and len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, int | float) and isinstance(right, int | float):
        return left == right or abs(left - right) <= _CLOSE * max(abs(left), abs(right))
    return type(left) is type(right) and left == right


def alike(left: Value, right: Value) -> bool:
    """Return whether values are equal up to the order of lists, which queries don't determine."""
    return same(left, right) or same(_sort(left), _sort(right))


def _sort(value: Value) -> Value:
    if isinstance(value, dict):
        return {name: _sort(value[name]) for name in sorted(value) if value[name] is not None}
    if isinstance(value, list):
        return sorted(map(_sort, value), key=repr)
    return value


def _same_in_sql(left: Scalar, right: Scalar) -> bool:
    if left.__class__ is right.__class__ and left == right:
        return True
    return same(from_sql(left), from_sql(right))
