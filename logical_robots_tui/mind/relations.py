"""The rows of predicates at a moment, and queries over them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.asking import failures_in_words
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite.budget import STEPS_OF_A_CALL, EvaluationBudget
from logical_robots_tui.mind.sqlite.database import Answer, Scalar, TooSlowError
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.mind.sqlite.stored import from_sql, to_sql
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.asking import Asking
    from logical_robots_tui.mind.program import Program

GIVEN = "WhyGiven"
"""The table of the values that are given, one row."""

SAME = "why_same"
"""The function for whether two values are the same, in queries."""

ALIKE = "why_alike"
"""That for whether they are the same but for the order of lists."""

Way = dict[str, "Scalar"]
"""A derivation: a row of a clause's query, as SQLite has it, by the names of the columns."""

_CLOSE = 1e-12
_KEYS_AT_ONCE = 400
_REMARKS = re.compile(r"/\* truths:(\S*) nested:(\S*) \*/")
_NONE: tuple[frozenset[str], frozenset[str]] = (frozenset(), frozenset())


def with_remarks(sql: str, truths: Iterable[str], nested: Iterable[str]) -> str:
    """Prepend a comment on which columns of a query are booleans, and which lists or records."""
    return f"/* truths:{','.join(truths)} nested:{','.join(nested)} */ {sql}"


@lru_cache(maxsize=256)
def _remarks(sql: str) -> tuple[frozenset[str], frozenset[str]]:
    found = _REMARKS.match(sql)
    return (frozenset(found[1].split(",")), frozenset(found[2].split(","))) if found else _NONE


def with_given(sql: str, number: int) -> str:
    """Prepend a table of given values to a query; they become its first parameters."""
    if not number:
        return sql
    names = ", ".join(f"g{i}" for i in range(number))
    places = ", ".join("?" * number)
    return f"WITH {GIVEN}({names}) AS (VALUES ({places})) SELECT * FROM ({sql})"  # noqa: S608 - ours


class Relations:
    def __init__(
        self, asking: Asking, moment: Inputs, view: View, within: EvaluationBudget
    ) -> None:
        self._asking, self._plain = asking, asking.plain_tables
        self._moment, self._view, self.within = moment, view, within
        self._plain.register(SAME, _same_in_sql, 2)
        self._plain.register(ALIKE, lambda one, other: alike(from_sql(one), from_sql(other)), 2)
        self._rows: dict[str, tuple[dict[str, Value], ...]] = {}
        self._columns: dict[str, Sequence[str]] = {}
        self._loaded: dict[str, Sequence[Mapping[str, Value]]] = {}
        self._cut_off: list[tuple[str, int]] | None = None

    def rows(self, predicate: str, sql: str = "") -> tuple[dict[str, Value], ...]:
        """Return a predicate's rows, by default with the program's query; raise FailureError."""
        if predicate not in self._rows:
            if sql:
                columns, rows = self._asking.plainly(sql, *self._where)
            else:
                columns, rows = self._asking.rows(self._asking.asked(predicate), *self._where)
            self._columns[predicate] = columns
            self._rows[predicate] = tuple(dict(zip(columns, row, strict=True)) for row in rows)
        found = self._rows[predicate]
        self.spend(STEPS_OF_A_CALL * len(found))  # the caller looks through them
        return found

    def cut_off(self, predicate: str) -> list[tuple[str, int]]:
        """Return the recursions that a predicate leans on and that were cut off, with their steps.

        Only those that `Robot` leans on, too, are known.
        """
        if self._cut_off is None:
            self._cut_off = [*self._asking.still_grew(*self._where)]
        found, waiting = {predicate}, [predicate]
        while waiting:
            new = set(self._asking.program.uses.get(waiting.pop(), ())) - found
            found |= new
            waiting += new
        return [each for each in self._cut_off if each[0] in found]

    def answer(self, program: Program, query: str, limits: Limits) -> list[dict[str, Value]]:
        """Return a question's rows, about any program; raise ProgramError or FailureError."""
        self.renew()
        question = program.question(query, stop=self.within.stop, limits=limits)
        columns, rows = self._asking.plainly(question.sql, *self._where)
        return [dict(zip(columns, row, strict=True)) for row in rows]

    def label(self, predicate: str, column: str) -> str:
        return self._asking.program.label(predicate, column)

    def owners(self, what: Literal["sensor", "memory"], value: Value) -> list[str]:
        """Return the robots in sight whose sensor or memory is a value."""
        if what == "sensor":
            first, last = self._view.sensors
            rows = self._moment.sensor_rows[first : last + 1]
            return [row["robot_name"] for row in rows if same(row["sensor"], value)]
        first, last = self._view.memories
        seen = [name for number, name in self._moment.memory_rows if first <= number <= last]
        return [name for name in seen if same(self._moment.memory_values.get(name), value)]

    def renew(self) -> None:
        self.within.renew()

    @property
    def _where(self) -> tuple[Inputs, View, EvaluationBudget]:
        return self._moment, self._view, self.within

    def spend(self, steps: int) -> None:
        """Count steps outside of queries; FailureError if over budget, Stopped if stopped."""
        within = self.within
        within.remainder.steps -= steps
        if within.stop is not None and within.stop.is_set():
            raise Stopped("The explanation was stopped.")
        with failures_in_words(within):
            if within.remainder.steps < 0:
                raise TooSlowError

    def fill(self, table: str, predicate: str, rows: Sequence[Mapping[str, Value]]) -> None:
        """Fill a table with some of a predicate's rows, unless it has them; raise FailureError."""
        if self._loaded.get(table) is not rows:
            self._loaded.pop(table, None)
            stored = [tuple(map(to_sql, row.values())) for row in rows]
            self.spend(_steps_of(stored))
            with failures_in_words(self.within):
                columns = self._columns[predicate]
                self._plain.load_view(self._moment, self._view)
                self._plain.define(table, columns, stored)
            self._loaded[table] = rows

    def ways(
        self,
        sql: str,
        given: Sequence[Scalar],
        alike: Sequence[tuple[str, Value]] = (),
        what: str = "*",
        most: int = 1,
        compared: str = SAME,
    ) -> list[Way]:
        """Return rows whose `alike` columns match by function `compared`; raise FailureError."""
        query, parameters = _limited(sql, given, alike, what, most, compared)
        columns, rows = self._ask(query, parameters)
        self.spend(_steps_of(rows))
        ways: list[Way] = [dict(zip(columns, row, strict=True)) for row in rows]
        for column in _remarks(sql)[0] & {*columns}:
            for way in ways:
                way[column] = None if way[column] is None else bool(way[column])
        return ways

    def chosen(
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
        given: Sequence[Scalar],
        alike: Sequence[tuple[str, Value]] = (),
        most: int = 1,
    ) -> int:
        """Return the number of a query's rows, at most `most`; raise FailureError."""
        query, parameters = _limited(sql, given, alike, "1", most, SAME)
        _, rows = self._ask(f"SELECT COUNT(*) FROM ({query})", parameters)  # noqa: S608 - ours
        return int(rows[0][0])

    def _ask(self, sql: str, parameters: Sequence[Scalar]) -> Answer:
        with failures_in_words(self.within):
            return self._plain.ask_of(sql, *self._where, parameters)


def _limited(
    sql: str,
    given: Sequence[Scalar],
    alike: Sequence[tuple[str, Value]],
    what: str,
    most: int,
    compared: str,
) -> tuple[str, list[Scalar]]:
    where = " AND ".join(f"{compared}({column}, ?)" for column, _ in alike)
    query = f"SELECT {what} FROM ({with_given(sql, len(given))})"  # noqa: S608 - the compiler's own SQL
    query += f"{' WHERE ' * bool(where)}{where} LIMIT {most}"
    return query, [*given, *(to_sql(value) for _, value in alike)]


def _steps_of(rows: Sequence[Sequence[Any]]) -> int:
    """Return the cost of rows in steps: one call for each value, plus its characters."""
    texts = sum(len(value) for row in rows for value in row if value.__class__ is str)
    return texts + STEPS_OF_A_CALL * sum(map(len, rows))


def same(one: Value, other: Value) -> bool:
    """Return whether values are equal up to a number's last digits, which text loses."""
    if isinstance(one, dict):
        return (
            isinstance(other, dict)
            and one.keys() == other.keys()
            and all(same(value, other[key]) for key, value in one.items())
        )
    if isinstance(one, list):
        return isinstance(other, list) and len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, int | float) and isinstance(other, int | float):
        return one == other or abs(one - other) <= _CLOSE * max(abs(one), abs(other))
    return type(one) is type(other) and one == other


def alike(one: Value, other: Value) -> bool:
    """Return whether values are equal up to the order of lists, which queries don't determine."""
    return same(one, other) or same(_sort(one), _sort(other))


def _sort(value: Value) -> Value:
    if isinstance(value, dict):
        return {name: _sort(each) for name, each in value.items()}
    if isinstance(value, list):
        return sorted(map(_sort, value), key=repr)
    return value


def _same_in_sql(one: Scalar, other: Scalar) -> bool:
    if one.__class__ is other.__class__ and one == other:
        return True
    return same(from_sql(one), from_sql(other))
