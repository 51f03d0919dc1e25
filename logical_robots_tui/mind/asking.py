"""Querying a program's predicates at a moment: tuned, or plain where the difference matters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import accumulate
from typing import Any, TypeAlias

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.failures import FailureError, failures_in_words
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import TRUTH_MARK, Program, Question, Tuned
from logical_robots_tui.mind.sqlite.database import Answer as RawAnswer
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.layouts import COLUMNS_LAYOUT, LISTS_LAYOUT
from logical_robots_tui.mind.sqlite.moment import Moment, View, Within
from logical_robots_tui.mind.sqlite.stored import Interner, from_sql
from logical_robots_tui.mind.sqlite.tables import PlainTables, TunedTables
from logical_robots_tui.mind.table import plan_lines
from logical_robots_tui.values import Value

_PLAN = "EXPLAIN QUERY PLAN "
_MOST_TOGETHER = 20_000  # rows for all views from one query

Answer: TypeAlias = "tuple[tuple[str, ...], list[tuple[Value, ...]]]"
"""Column names and rows."""


class _OrPlainly:
    """Ends a tuned query that fails; the plain query then determines the error."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> bool:
        return kind is not None and issubclass(kind, Exception) and not issubclass(kind, Stopped)


_OR_PLAINLY = _OrPlainly()


class Asking:
    """The databases of a mind.

    Tuned queries evaluate some expressions earlier than the program does. When one fails, the
    plain query decides whether that matters and which error to report.
    """

    def __init__(
        self, program: Program, limits: Limits, *, plain: bool, frozen: bool = False
    ) -> None:
        self._program = program
        self.plain_tables = PlainTables(limits)
        self._tuned = None if plain else _tables(program, limits, frozen=frozen)
        self._deepest = limits.depth
        self._read_value = Interner().read if frozen else from_sql

    def each(
        self, predicate: str, moment: Moment, within: Within, *, in_order: bool = True
    ) -> Iterator[tuple[View, Answer | FailureError]]:
        # All at once: the caller may query something else in between.
        tuned = self._program.tuned.get(predicate)
        answers = self._quick_answers(tuned, moment, within, in_order=in_order)
        for view, answer in zip(moment.views, answers, strict=False):
            yield view, _with_truths(self._program.truths.get(predicate), answer)
        for view in moment.views[len(answers) :]:
            try:
                yield view, self.rows(predicate, moment, view, within)
            except FailureError as failure:
                yield view, failure

    def question(
        self, question: Question, moment: Moment, within: Within, *, in_order: bool
    ) -> Iterator[tuple[View, Answer]]:
        """Yield each view's rows, truncated to the limits; raise FailureError."""
        tuned = question.tuned
        answers = self._quick_answers(tuned, moment, within, in_order=in_order)
        for view, answer in zip(moment.views, answers, strict=False):
            yield view, _with_truths(question.truths, answer)
        for view in moment.views[len(answers) :]:
            answer = self._ask(tuned, question.sql, moment, view, within)
            yield view, _with_truths(question.truths, answer)

    def rows(self, predicate: str, moment: Moment, view: View, within: Within) -> Answer:
        """Return a predicate's rows for one view; raise FailureError, also for too many."""
        tuned, sql = self._program.tuned.get(predicate), self._program.statements.get(predicate)
        if sql is None:
            raise FailureError(f"{predicate} can't be computed")
        columns, rows = self._ask(tuned, sql, moment, view, within)
        if len(rows) > within.rows and not within.cut:
            raise FailureError(f"{predicate} has more than {within.rows:,} rows")
        return _with_truths(self._program.truths.get(predicate), (columns, rows))

    def plan(
        self, predicate: str, moment: Moment, view: View, within: Within
    ) -> tuple[str, tuple[str, ...]]:
        """Return the tuned SQL, or "", and SQLite's plan for the SQL run; raise FailureError."""
        tuned = None if self._tuned is None else self._program.tuned.get(predicate)
        if self._tuned is not None and tuned is not None:
            with _OR_PLAINLY:
                tuned = self._tuned.fitting(tuned, moment)
                planned = replace(tuned, sql=f"{_PLAN}{tuned.sql}", result=())
                return tuned.sql, plan_lines(self._tuned.ask(planned, moment, view, within)[1])
        sql = self._program.statements[predicate]
        return "", plan_lines(self.plainly(f"{_PLAN}{sql}", moment, view, within)[1])

    def still_grew(self, moment: Moment, view: View, within: Within) -> Iterator[tuple[str, int]]:
        for predicate, (steps, sql) in self._program.recursions.items():
            try:
                tuned = self._program.tuned.get(f"{predicate} grows")
                _, rows = self._ask(tuned, sql, moment, view, within)
            except FailureError:
                continue
            if rows[0][0]:
                yield predicate, steps

    def reach(self, predicate: str) -> set[str]:
        """Return a predicate and all that it mentions, directly or through others."""
        found, waiting = {predicate}, [predicate]
        while waiting:
            new = set(self._program.uses.get(waiting.pop(), ())) - found
            found |= new
            waiting += new
        return found

    def label(self, predicate: str, column: str) -> str:
        return self._program.label(predicate, column)

    def place_of(self, predicate: str) -> str:
        """Return "Line 4: " for a predicate of the program, or "" for others."""
        found = (each.line for each in self._program.predicates if each.name == predicate)
        line = next(found, None)
        return f"Line {line}: " if line else ""

    def close(self) -> None:
        self.plain_tables.close()
        if self._tuned is not None:
            self._tuned.close()

    def plainly(
        self,
        sql: str,
        moment: Moment,
        view: View,
        within: Within,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Return the rows of any query over ``Sensor`` and ``Memory``; raise FailureError."""
        with failures_in_words(within):
            columns, rows = self.plain_tables.ask(sql, moment, view, within, parameters)
            return columns, self._read_all(rows, within)

    # -- inside --------------------------------------------------------------------------------

    def _ask(
        self, tuned: Tuned | None, sql: str, moment: Moment, view: View, within: Within
    ) -> Answer:
        answer = self._quick_answer(tuned, moment, view, within)
        return self.plainly(sql, moment, view, within) if answer is None else answer

    def _quick_answers(
        self, tuned: Tuned | None, moment: Moment, within: Within, *, in_order: bool = True
    ) -> Sequence[Answer]:
        if self._tuned is None or tuned is None:
            return ()
        if tuned.together and moment.apart and len(moment.views) > 1:
            answers = self._joint_answers(tuned, moment, within, in_order=in_order)
            if answers is not None:
                return answers
        answers = []
        for view in moment.views:
            answer = self._quick_answer(tuned, moment, view, within)
            if answer is None or (len(answer[1]) > within.rows and not within.cut):
                break
            answers.append(answer)
        return answers

    def _joint_answers(
        self, tuned: Tuned, moment: Moment, within: Within, *, in_order: bool
    ) -> list[Answer] | None:
        """Answer all views with one query, or return None where that may lose the row order."""
        assert self._tuned is not None
        most = len(moment.views) if in_order else _MOST_TOGETHER
        with _OR_PLAINLY:
            columns, found = self._tuned.ask_together(tuned, moment, within, most + 1)
            if len(found) > most:
                return None
            return self._by_viewer(columns[:-1], found, tuned, moment, within, in_order=in_order)
        return None

    def _by_viewer(
        self,
        columns: tuple[str, ...],
        found: Sequence[tuple[Any, ...]],
        tuned: Tuned,
        moment: Moment,
        within: Within,
        *,
        in_order: bool,
    ) -> list[Answer] | None:
        """Split rows that end with a viewer's number into answers; None if that isn't safe."""
        numbers = [row[-1] for row in found]
        viewers = set(numbers)
        if in_order and len(viewers) < len(found):
            return None
        if not viewers <= set(range(len(moment.views))):
            return None
        answer = self._finished((columns, [row[:-1] for row in found]), tuned, within)
        if answer is None:
            return None
        nothing: list[tuple[Value, ...]] = []
        answers: list[Answer] = [(answer[0], nothing)] * len(moment.views)
        for number, row in zip(numbers, answer[1], strict=True):
            if answers[number][1] is nothing:
                answers[number] = (answer[0], [])
            answers[number][1].append(row)
        if not within.cut and any(len(rows) > within.rows for _, rows in answers):
            return None
        return answers

    def _quick_answer(
        self, tuned: Tuned | None, moment: Moment, view: View, within: Within
    ) -> Answer | None:
        if self._tuned is None or tuned is None:
            return None
        with _OR_PLAINLY:
            return self._finished(self._tuned.ask(tuned, moment, view, within), tuned, within)
        return None

    def _finished(self, raw: RawAnswer, tuned: Tuned, within: Within) -> Answer | None:
        columns, rows = raw
        if not tuned.result:
            return columns, self._read_all(rows, within)
        names, places, truths = _places(tuned.result)
        found = []
        for row in rows:
            if bytes in map(type, row):
                return None  # no record holds such a value
            values = self._read(row, within)
            for place in truths:
                values[place] = None if values[place] is None else bool(values[place])
            found.append(_put_together(values, places))
        return names, found

    def _read_all(self, rows: Sequence[tuple[Any, ...]], within: Within) -> list[tuple[Value, ...]]:
        return [tuple(self._read(row, within)) for row in rows]

    def _read(self, row: Sequence[Any], within: Within) -> list[Value]:
        read, deepest = self._read_value, self._deepest
        if within.is_much:
            row = within.each(row)
        return [v if v.__class__ in _READY else read(v, deepest) for v in row]


def _tables(program: Program, limits: Limits, *, frozen: bool) -> TunedTables | None:
    if not program.tuned:
        return None
    robot = program.tuned.get("Robot")
    few = LISTS_LAYOUT if robot is not None and robot.crowd else COLUMNS_LAYOUT
    return TunedTables(limits, frozen=frozen, few=few)


_READY = frozenset({float, int, type(None)})


def _put_together(values: Sequence[Value], places: Sequence[_Place]) -> tuple[Value, ...]:
    return tuple(
        [
            dict(zip(fields, values[first:last], strict=True)) if fields else values[first]
            for fields, first, last in places
        ]
    )


_Place: TypeAlias = "tuple[tuple[str, ...], int, int]"
"""The fields of a record, or () if it is not a record, and its first and last place in a row."""


@cache
def _places(
    result: tuple[tuple[str, tuple[str, ...]], ...],
) -> tuple[tuple[str, ...], Sequence[_Place], Sequence[int]]:
    ends = [*accumulate(len(fields) or 1 for _, fields in result)]
    places = [
        (tuple(f.removesuffix(TRUTH_MARK) for f in fields), last - (len(fields) or 1), last)
        for (_, fields), last in zip(result, ends, strict=True)
    ]
    given = [field for _, fields in result for field in fields or ("",)]
    truths = [place for place, field in enumerate(given) if field.endswith(TRUTH_MARK)]
    return tuple(name for name, _ in result), places, truths


def _with_truths(names: Sequence[str] | None, answer: Answer) -> Answer:
    """Return an answer with true and false in boolean columns, where SQLite has 1 and 0."""
    if not names:
        return answer
    columns, rows = answer
    is_truth = [column in names for column in columns]
    return columns, [
        tuple(
            bool(value) if truth and value is not None else value
            for value, truth in zip(row, is_truth, strict=True)
        )
        for row in rows
    ]
