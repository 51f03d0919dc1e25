"""Queries over a mind's inputs, tuned, or plain where that matters; their failures in words."""

from __future__ import annotations

import logging
import re
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import accumulate
from typing import Any, TypeAlias

from logical_robots_tui.language.diagnostics import MULTIPLIES, Stopped, printable
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import TRUTH_MARK, CompiledQuery, Program, Tuned
from logical_robots_tui.mind.sqlite.budget import QueryBudget, TooHeavyError
from logical_robots_tui.mind.sqlite.database import Answer as RawAnswer
from logical_robots_tui.mind.sqlite.database import Scalar, TooMuchError, TooSlowError
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.mind.sqlite.layouts import COLUMNS_LAYOUT, LISTS_LAYOUT
from logical_robots_tui.mind.sqlite.stored import Interner, TooDeepError, from_sql
from logical_robots_tui.mind.sqlite.tables import PlainTables, TunedTables
from logical_robots_tui.values import Value

_PLAN = "EXPLAIN QUERY PLAN "
_MAX_ROWS_TOGETHER = 20_000  # rows for all views from one query

Answer: TypeAlias = "tuple[tuple[str, ...], list[tuple[Value, ...]]]"
"""Column names and rows."""


class FailureError(Exception):
    """A query failed; the message is for the player.

    `is_slow`: trying again would take too long, too; `is_late`: a time limit ended it;
    `is_large`: it needs too much memory.
    """

    def __init__(
        self,
        message: str,
        *,
        is_slow: bool = False,
        is_late: bool = False,
        is_large: bool = False,
    ) -> None:
        self.is_slow = is_slow
        self.is_late = is_late
        self.is_large = is_large
        super().__init__(message)

    def reason(self, program: Program, predicates: Iterable[str]) -> str:
        """Return the message, and what the warnings say of predicates whose rows multiply."""
        messages = {f"{name} {MULTIPLIES}" for name in predicates}
        warnings = program.warnings if self.is_slow or self.is_large else ()
        growing = next((w for w in warnings if w.message in messages), None)
        return f"{self}. {growing.message}. {growing.hint.rstrip('.')}" if growing else str(self)


class _SuppressFailure:
    """Ends a tuned query that fails; the plain query then determines the error."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> bool:
        return kind is not None and issubclass(kind, Exception) and not issubclass(kind, Stopped)


_SUPPRESS_FAILURE = _SuppressFailure()


class MindDatabases:
    """The databases of a mind.

    Tuned queries evaluate some expressions earlier than the program does. When one fails, the
    plain query decides whether that matters and which error to report.
    """

    def __init__(
        self, program: Program, limits: Limits, *, plain: bool, frozen: bool = False
    ) -> None:
        self.program = program
        self.plain_tables = PlainTables(limits)
        self._tuned: TunedTables | None = None
        if program.tuned and not plain:
            robot = program.tuned.get("Robot")
            small_layout = LISTS_LAYOUT if robot is not None and robot.crowd else COLUMNS_LAYOUT
            self._tuned = TunedTables(limits, frozen=frozen, small_layout=small_layout)
        self._max_depth = limits.depth
        self._read_value = Interner().read if frozen else from_sql

    def query_for(self, predicate: str) -> CompiledQuery:
        """Return the query for the rows of a predicate of the program."""
        program = self.program
        sql, truths = program.statements.get(predicate, ""), program.truths.get(predicate, ())
        labels, tuned = program.labels.get(predicate, {}), program.tuned.get(predicate)
        return CompiledQuery(predicate, sql, truths=truths, labels=labels, tuned=tuned)

    def answers(
        self, question: CompiledQuery, inputs: Inputs, budget: QueryBudget, *, in_order: bool = True
    ) -> Iterator[tuple[View, Answer | FailureError]]:
        """Yield each view's rows, truncated to the limits, or why there are none."""
        # All at once, because the caller may query something else in between.
        answers = self._tuned_answers(question.tuned, inputs, budget, in_order=in_order)
        for view, answer in zip(inputs.views, answers, strict=False):
            yield view, _with_truths(question.truths, answer)
        for view in inputs.views[len(answers) :]:
            try:
                yield view, self.rows(question, inputs, view, budget)
            except FailureError as failure:
                yield view, failure

    def rows(
        self, question: CompiledQuery, inputs: Inputs, view: View, budget: QueryBudget
    ) -> Answer:
        """Return the rows for one view; raise FailureError, also for too many."""
        if not question.sql:
            raise FailureError(f"{question.text} can't be computed")
        answer = self._tuned_answer(question.tuned, inputs, view, budget)
        if answer is None:
            answer = self.plain_rows(question.sql, inputs, view, budget)
        if len(answer[1]) > budget.rows and not budget.truncates:
            raise FailureError(f"{question.text} has more than {budget.rows:,} rows")
        return _with_truths(question.truths, answer)

    def plan(
        self, predicate: str, inputs: Inputs, view: View, budget: QueryBudget
    ) -> tuple[str, tuple[str, ...]]:
        """Return the tuned SQL, or "", and SQLite's plan for the SQL run; raise FailureError."""
        tuned = self.program.tuned.get(predicate)
        if self._tuned is not None and tuned is not None:
            with _SUPPRESS_FAILURE:
                tuned = self._tuned.variant_for(tuned, inputs)
                plan_query = replace(tuned, sql=f"{_PLAN}{tuned.sql}", result=())
                return tuned.sql, plan_lines(self._tuned.ask(plan_query, inputs, view, budget)[1])
        sql = self.program.statements[predicate]
        return "", plan_lines(self.plain_rows(f"{_PLAN}{sql}", inputs, view, budget)[1])

    def unfinished_recursions(
        self, inputs: Inputs, view: View, budget: QueryBudget
    ) -> Iterator[tuple[str, int]]:
        """Yield each recursion that was cut off, with the number of its steps."""
        for predicate, (steps, sql) in self.program.recursions.items():
            query = CompiledQuery("", sql, tuned=self.program.tuned.get(f"{predicate} grows"))
            try:
                _, rows = self.rows(query, inputs, view, budget)
            except FailureError:
                continue
            if rows[0][0]:
                yield predicate, steps

    def close(self) -> None:
        self.plain_tables.close()
        if self._tuned is not None:
            self._tuned.close()

    def plain_rows(
        self,
        sql: str,
        inputs: Inputs,
        view: View,
        budget: QueryBudget,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Return the rows of any query over ``Sensor`` and ``Memory``; raise FailureError."""
        with failures_in_words(budget):
            columns, rows = self.plain_tables.ask_of(sql, inputs, view, budget, parameters)
            return columns, self._read_all(rows, budget)

    # -- inside --------------------------------------------------------------------------------

    def _tuned_answers(
        self, tuned: Tuned | None, inputs: Inputs, budget: QueryBudget, *, in_order: bool
    ) -> Sequence[Answer]:
        if self._tuned is None or tuned is None:
            return ()
        if tuned.together and inputs.has_private_sensors and len(inputs.views) > 1:
            # With one query for all views, or not where that may lose the order of rows.
            max_rows = len(inputs.views) if in_order else _MAX_ROWS_TOGETHER
            with _SUPPRESS_FAILURE:
                columns, rows = self._tuned.ask_together(tuned, inputs, budget, max_rows + 1)
                if len(rows) <= max_rows and (
                    split_answers := self._split_by_viewer(
                        columns[:-1], rows, tuned, inputs, budget, in_order
                    )
                ):
                    return split_answers
        answers = []
        for view in inputs.views:
            answer = self._tuned_answer(tuned, inputs, view, budget)
            if answer is None or (len(answer[1]) > budget.rows and not budget.truncates):
                break
            answers.append(answer)
        return answers

    def _split_by_viewer(
        self,
        columns: tuple[str, ...],
        raw_rows: Sequence[tuple[Any, ...]],
        tuned: Tuned,
        inputs: Inputs,
        budget: QueryBudget,
        in_order: bool,
    ) -> list[Answer] | None:
        """Split rows that end with a viewer's number into answers; None if that isn't safe."""
        numbers = [row[-1] for row in raw_rows]
        viewers = set(numbers)
        if in_order and len(viewers) < len(raw_rows):
            return None
        if not viewers <= set(range(len(inputs.views))):
            return None
        answer = self._assemble((columns, [row[:-1] for row in raw_rows]), tuned, budget)
        if answer is None:
            return None
        no_rows: list[tuple[Value, ...]] = []
        answers: list[Answer] = [(answer[0], no_rows)] * len(inputs.views)
        for number, row in zip(numbers, answer[1], strict=True):
            if answers[number][1] is no_rows:
                answers[number] = (answer[0], [])
            answers[number][1].append(row)
        if not budget.truncates and any(len(rows) > budget.rows for _, rows in answers):
            return None
        return answers

    def _tuned_answer(
        self, tuned: Tuned | None, inputs: Inputs, view: View, budget: QueryBudget
    ) -> Answer | None:
        if self._tuned is None or tuned is None:
            return None
        with _SUPPRESS_FAILURE:
            return self._assemble(self._tuned.ask(tuned, inputs, view, budget), tuned, budget)
        return None

    def _assemble(self, raw: RawAnswer, tuned: Tuned, budget: QueryBudget) -> Answer | None:
        columns, rows = raw
        if not tuned.result:
            return columns, self._read_all(rows, budget)
        names, places, truths = _places(tuned.result)
        records = []
        for row in rows:
            if bytes in map(type, row):
                return None  # no record holds such a value
            values = self._read(row, budget)
            for place in truths:
                values[place] = None if values[place] is None else bool(values[place])
            parts = [
                dict(zip(fields, values[first:last], strict=True)) if fields else values[first]
                for fields, first, last in places
            ]
            records.append(tuple(parts))
        return names, records

    def _read_all(
        self, rows: Sequence[tuple[Any, ...]], budget: QueryBudget
    ) -> list[tuple[Value, ...]]:
        return [tuple(self._read(row, budget)) for row in rows]

    def _read(self, row: Sequence[Any], budget: QueryBudget) -> list[Value]:
        read, max_depth = self._read_value, self._max_depth
        if budget.is_large:
            budget.weigh(row)
        return [v if v.__class__ in _READY else read(v, max_depth) for v in row]


_READY = frozenset({float, int, type(None)})

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
    result_fields = [field for _, fields in result for field in fields or ("",)]
    truths = [place for place, field in enumerate(result_fields) if field.endswith(TRUTH_MARK)]
    return tuple(name for name, _ in result), places, truths


def _with_truths(names: Sequence[str], answer: Answer) -> Answer:
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


def plan_lines(rows: Sequence[Sequence[Any]]) -> tuple[str, ...]:
    """Return the steps of a plan, indented, from SQLite's rows: number, parent, unused, text."""
    depths = {0: -1}
    lines = []
    for number, parent, _, words in rows:
        depths[number] = depths.get(parent, -1) + 1
        lines.append("  " * depths[number] + str(words))
    return tuple(lines)


# -- failures ------------------------------------------------------------------------------------

_log = logging.getLogger(__name__)
_logged: set[type[Exception]] = set()  # each class of our bugs is logged once


@contextmanager
def failures_in_words(budget: QueryBudget) -> Iterator[None]:
    """Turn any exception of a query but `Stopped` into a `FailureError` for the player."""
    try:
        yield
    except TooSlowError:
        is_late = budget.remainder.is_late
        message = f"thinking took more than {budget.steps:,} steps"
        if is_late:
            message = f"a time limit ended it after {budget.seconds:g} seconds; "
            message += "another run may differ"
        raise FailureError(message, is_slow=True, is_late=is_late) from None
    except TooHeavyError as error:
        raise FailureError(str(error), is_slow=True) from None
    except (TooMuchError, TooDeepError) as error:
        raise FailureError(str(error), is_large=isinstance(error, TooMuchError)) from None
    except (sqlite3.Error, sqlite3.Warning) as error:
        raise FailureError(printable(in_plain_words(error))) from None
    except (FailureError, Stopped):
        raise
    except Exception as error:
        if type(error) not in _logged:
            _logged.add(type(error))
            _log.exception("a query failed in our own code")
        raise FailureError("it can't be computed; this is a bug in the game") from error


def in_plain_words(error: Exception) -> str:
    text = str(error)
    for pattern, words in _PLAIN_WORDS:
        if match := re.search(pattern, text):
            return match.expand(words)
    return "it can't be computed"


_PLAIN_WORDS = (
    (r"malformed JSON", "a field was read from something that is neither a record nor a list"),
    (r"user-defined: '?utf", "a string holds half of a character, as Chr(55296) makes it"),
    (
        r"user-defined",
        "a function was given a value that it can't use, such as a string instead of a list",
    ),
    (
        r"parser stack overflow|too many levels|too large|tree is too|too many terms",
        "an expression is nested too deeply; split it into named parts",
    ),
    (
        r"too many references|tables in a join",
        "it combines too many predicates; mention long ones less often",
    ),
    (r"too many arguments", "a list or a call has too many parts"),
    (r"not authorized|prohibited|not a query", "it uses something that robots may not use"),
    (r"too big|out of memory", "a value became too large"),
    (r"integer overflow", "an integer became too large"),
    (r"no such function: (\w+)", r"there is no function \1"),
    (r"wrong number of arguments to function (\w+)", r"\1 has the wrong number of arguments"),
    (r"misuse of aggregate", "an aggregate is used where a plain value is needed"),
    (r"misuse of window", "a function is used that needs an order of rows"),
    (r"no such column: (?:\w+\.)?(col\d+)", "a positional column is used that does not exist"),
    (r"no such column: (?:\w+\.)?(\w+)", r"a column \1 is used that does not exist"),
    (r"no such table: (?:\w+\.)?(\w+)", r"there is no predicate \1"),
    (r"same number of result columns", "its rules have different columns"),
    (r'near "\.": syntax', "it passes on a whole record (..r); name the fields instead"),
    (r"circular reference", "it depends on itself in a way that can't be computed"),
)
