"""Asking a program's predicates at a moment: the quick way, or the plain one where that matters."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from functools import cache
from itertools import accumulate
from math import inf
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.failures import FailureError, in_plain_words
from logical_robots_tui.mind.machinery import plan_lines
from logical_robots_tui.mind.plain import printable
from logical_robots_tui.mind.sqlite.database import TooMuchError, TooSlowError
from logical_robots_tui.mind.sqlite.lasting import Lasting
from logical_robots_tui.mind.sqlite.layouts import COLUMNS_LAYOUT, LISTS_LAYOUT
from logical_robots_tui.mind.sqlite.moment import TooHeavyError
from logical_robots_tui.mind.sqlite.stored import TooDeepError, from_sql
from logical_robots_tui.mind.sqlite.tables import PlainTables, TunedTables, UnfitError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.mind.duck.engine import DuckTables
    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.program import Duck, Program, Tuned
    from logical_robots_tui.mind.sqlite.database import Answer as RawAnswer
    from logical_robots_tui.mind.sqlite.database import Scalar
    from logical_robots_tui.mind.sqlite.moment import Moment, View, Within
    from logical_robots_tui.values import Value

__all__ = ["Answer", "Asking"]

_PLAN = "EXPLAIN QUERY PLAN "

_SQLITE_ERRORS = (sqlite3.Error, sqlite3.Warning)

_NO_QUICK_ANSWER = (
    UnfitError,
    TooDeepError,
    TooHeavyError,
    TooMuchError,
    TooSlowError,
    *_SQLITE_ERRORS,
)

Answer: TypeAlias = "tuple[tuple[str, ...], list[tuple[Value, ...]]]"
"""Column names and rows."""


class Asking:
    """The databases of a mind.

    The quick way computes some things earlier than the program asks for them. So when it fails,
    the plain one is asked: only that knows whether it matters, and what to say.

    Args:
        program: What to ask.
        limits: Bounds on memory, on values and on results.
        plain: Whether to take the plain way only.
        duck: DuckDB, if crowds are to think with it.
        frozen: Whether nobody changes what is given or answered, then or later.
    """

    def __init__(
        self,
        program: Program,
        limits: Limits,
        *,
        plain: bool,
        duck: DuckTables | None = None,
        frozen: bool = False,
    ) -> None:
        self._program = program
        self._plain = PlainTables(limits)
        self._tuned = None if plain else _tables(program, limits, frozen=frozen)
        self._deepest = limits.depth
        self._read_value = Lasting().read if frozen else from_sql
        self._duck = duck

    def each(
        self, predicate: str, moment: Moment, within: Within
    ) -> Iterator[tuple[View, Answer | FailureError]]:
        """Rows of a predicate for each view of a moment, or why there are none."""
        # All at once: in between, the caller may ask for something else.
        answers = self._quick_answers(predicate, moment, within)
        yield from zip(moment.views, answers, strict=False)
        for view in moment.views[len(answers) :]:
            try:
                yield view, self.rows(predicate, moment, view, within)
            except FailureError as failure:
                yield view, failure

    def rows(self, predicate: str, moment: Moment, view: View, within: Within) -> Answer:
        """Rows of a predicate for one view.

        Raises:
            FailureError: It failed, took too long, or has too many rows.
        """
        columns, rows = self._ask(
            predicate, self._program.statements[predicate], moment, view, within
        )
        if len(rows) > within.rows and not within.cut:
            raise FailureError(f"{predicate} has more than {within.rows:,} rows")
        return columns, rows

    def plan(
        self, predicate: str, moment: Moment, view: View, within: Within
    ) -> tuple[str, tuple[str, ...]]:
        """The tuned SQL of a predicate, or "", and SQLite's plan for what is run.

        Raises:
            FailureError: It can't be prepared.
        """
        tuned = None if self._tuned is None else self._program.tuned.get(predicate)
        if self._tuned is not None and tuned is not None:
            try:
                tuned = self._tuned.fitting(tuned, moment)
                planned = replace(tuned, sql=f"{_PLAN}{tuned.sql}", result=())
                return tuned.sql, plan_lines(self._tuned.ask(planned, moment, view, within)[1])
            except _NO_QUICK_ANSWER:
                pass
        sql = self._program.statements[predicate]
        return "", plan_lines(self.plainly(f"{_PLAN}{sql}", moment, view, within)[1])

    def still_grew(self, moment: Moment, view: View, within: Within) -> Iterator[tuple[str, int]]:
        """Recursions that still changed in their last step, and how many steps that was."""
        for predicate, (steps, sql) in self._program.recursions.items():
            try:
                _, rows = self._ask(f"{predicate} grows", sql, moment, view, within)
            except FailureError:
                continue
            if rows[0][0]:
                yield predicate, steps

    def close(self) -> None:
        """Free the databases."""
        self._plain.close()
        if self._tuned is not None:
            self._tuned.close()
        if self._duck is not None:
            self._duck.close()

    def plainly(
        self,
        sql: str,
        moment: Moment,
        view: View,
        within: Within,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Rows of any query over ``Sensor`` and ``Memory`` for one view.

        Raises:
            FailureError: It failed, or took too long.
        """
        try:
            columns, rows = self._plain.ask(sql, moment, view, within, parameters)
            return columns, self._read_all(rows, within)
        except TooSlowError:
            raise _slow(within) from None
        except TooHeavyError as error:
            raise FailureError(str(error), slow=True) from None
        except (TooMuchError, TooDeepError) as error:
            raise FailureError(str(error)) from None
        except _SQLITE_ERRORS as error:
            raise FailureError(printable(in_plain_words(error))) from None

    # -- inside --------------------------------------------------------------------------------

    def _ask(self, name: str, sql: str, moment: Moment, view: View, within: Within) -> Answer:
        answer = self._quick_answer(name, moment, view, within)
        return self.plainly(sql, moment, view, within) if answer is None else answer

    def _quick_answers(self, name: str, moment: Moment, within: Within) -> Sequence[Answer]:
        """Answers for the first views of a moment, up to one for which there is no quick one."""
        tuned = self._program.tuned.get(name)
        if self._tuned is None or tuned is None:
            return ()
        if self._duck is not None and tuned.duck is not None:
            answers = self._duck_answers(self._duck, tuned, tuned.duck, moment, within)
            if answers is not None:
                return answers
        if tuned.together and moment.apart and len(moment.views) > 1:
            answers = self._joint_answers(tuned, moment, within)
            if answers is not None:
                return answers
        answers = []
        for view in moment.views:
            answer = self._quick_answer(name, moment, view, within)
            if answer is None or (len(answer[1]) > within.rows and not within.cut):
                break
            answers.append(answer)
        return answers

    def _joint_answers(self, tuned: Tuned, moment: Moment, within: Within) -> list[Answer] | None:
        """Answers for all views from one query, or None if there is more than one row for one.

        For then only the query of one view tells in which order its rows are.
        """
        assert self._tuned is not None
        try:
            columns, found = self._tuned.ask_together(tuned, moment, within)
            return self._by_viewer(columns[:-1], found, tuned, moment, within)
        except _NO_QUICK_ANSWER:
            return None

    def _duck_answers(
        self, tables: DuckTables, tuned: Tuned, duck: Duck, moment: Moment, within: Within
    ) -> list[Answer] | None:
        """Answers for all views by DuckDB, or None unless each row is for a robot of its own."""
        if tuned.result and len(duck.names) != sum(len(f) or 1 for _, f in tuned.result):
            return None  # these were not made together
        try:
            found = tables.ask(duck, moment, within)
            if len(moment.views) > 1:
                return self._by_viewer(duck.names, found, tuned, moment, within)
            (view,) = moment.views
            place = duck.names.index("robot_name") if "robot_name" in duck.names else 0
            if len({row[place] for row in found}.intersection(view.viewers)) < len(found):
                return None
            answer = self._finished((duck.names, found), tuned, within)
        except _NO_QUICK_ANSWER:
            return None
        return None if answer is None else [answer]

    def _by_viewer(
        self,
        columns: tuple[str, ...],
        found: Sequence[tuple[Any, ...]],
        tuned: Tuned,
        moment: Moment,
        within: Within,
    ) -> list[Answer] | None:
        """Answers for all views from rows that end with the number of their viewer."""
        rows = {row[-1]: row[:-1] for row in found}
        if len(rows) < len(found) or not rows.keys() <= set(range(len(moment.views))):
            return None
        answer = self._finished((columns, list(rows.values())), tuned, within)
        if answer is None:
            return None
        answers: list[Answer] = [(answer[0], [])] * len(moment.views)
        for number, row in zip(rows, answer[1], strict=True):
            answers[number] = (answer[0], [row])
        return answers

    def _quick_answer(self, name: str, moment: Moment, view: View, within: Within) -> Answer | None:
        tuned = self._program.tuned.get(name)
        if self._tuned is None or tuned is None:
            return None
        try:
            return self._finished(self._tuned.ask(tuned, moment, view, within), tuned, within)
        except _NO_QUICK_ANSWER:
            return None

    def _finished(self, raw: RawAnswer, tuned: Tuned, within: Within) -> Answer | None:
        """An answer with its records put together, or None if one can't be."""
        columns, rows = raw
        if not tuned.result:
            return columns, self._read_all(rows, within)
        names, places = _places(tuned.result)
        found = []
        for row in rows:
            if bytes in map(type, row):
                return None  # no record holds such a value
            if inf in row or -inf in row:
                row = _without_infinity(row, tuned)
            found.append(_put_together(self._read(row, within), places))
        return names, found

    def _read_all(self, rows: Sequence[tuple[Any, ...]], within: Within) -> list[tuple[Value, ...]]:
        return [tuple(self._read(row, within)) for row in rows]

    def _read(self, row: Sequence[Any], within: Within) -> list[Value]:
        read, deepest = self._read_value, self._deepest
        return [v if v.__class__ in _READY else read(v, deepest) for v in within.each(row)]


def _slow(within: Within) -> FailureError:
    if within.budget.is_late:
        message = (
            f"a guard ended it after {within.seconds:g} seconds, elsewhere it may go otherwise"
        )
        return FailureError(message, slow=True, late=True)
    return FailureError(f"thinking took more than {within.steps:,} steps", slow=True)


def _tables(program: Program, limits: Limits, *, frozen: bool) -> TunedTables | None:
    """The tables for the tuned queries of a program, if it has any."""
    if not program.tuned:
        return None
    robot = program.tuned.get("Robot")
    few = LISTS_LAYOUT if robot is not None and robot.crowd else COLUMNS_LAYOUT
    return TunedTables(limits, frozen=frozen, few=few)


_READY = frozenset({float, int, type(None)})


def _put_together(values: Sequence[Value], places: Sequence[_Place]) -> tuple[Value, ...]:
    """A row whose records were given field by field."""
    return tuple(
        [
            dict(zip(fields, values[first:last], strict=True)) if fields else values[first]
            for fields, first, last in places
        ]
    )


_Place: TypeAlias = "tuple[tuple[str, ...], int, int]"
"""The fields of a record, or () for what is none, and where they begin and end in a row."""


@cache
def _places(
    result: tuple[tuple[str, tuple[str, ...]], ...],
) -> tuple[tuple[str, ...], Sequence[_Place]]:
    """The columns of a result, and where they stand in a row that was given field by field."""
    ends = [*accumulate(len(fields) or 1 for _, fields in result)]
    return tuple(name for name, _ in result), [
        (fields, last - (len(fields) or 1), last)
        for (_, fields), last in zip(result, ends, strict=True)
    ]


def _without_infinity(values: tuple[Any, ...], tuned: Tuned) -> tuple[Any, ...]:
    """Row as it would be if its records had been JSON: a number that JSON can't hold is null."""
    in_record = [bool(fields) for _, fields in tuned.result for _ in fields or ("",)]
    return tuple(
        [
            None if inside and value in (inf, -inf) else value
            for inside, value in zip(in_record, values, strict=False)
        ]
    )
