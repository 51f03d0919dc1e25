"""Asking a program's predicates at a moment: the quick way, or the plain one where that matters."""

from __future__ import annotations

import sqlite3
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.mind.database import TooMuchError, TooSlowError
from logical_robots_tui.mind.failures import FailureError, in_plain_words
from logical_robots_tui.mind.plain import printable
from logical_robots_tui.mind.stored import TooDeepError, from_sql
from logical_robots_tui.mind.tables import PlainTables, TunedTables, UnfitError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.mind.database import Answer as RawAnswer
    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.moment import Moment, View, Within
    from logical_robots_tui.mind.program import Program
    from logical_robots_tui.values import Value

__all__ = ["Answer", "Asking"]

_SQLITE_ERRORS = (sqlite3.Error, sqlite3.Warning)

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
    """

    def __init__(self, program: Program, limits: Limits, *, plain: bool) -> None:
        self._program = program
        self._limits = limits
        self._plain = PlainTables(limits)
        self._tuned = None if plain or not program.tuned else TunedTables(limits)

    def each(
        self, predicate: str, moment: Moment, within: Within
    ) -> Iterator[tuple[View, Answer | FailureError]]:
        """Rows of a predicate for each view of a moment, or why there are none."""
        views = iter(moment.views)
        # All at once: in between, the caller may ask for something else.
        for answer in list(self._quick_answers(predicate, moment, moment.views, within)):
            yield next(views), answer
        for view in views:
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

    # -- inside --------------------------------------------------------------------------------

    def _ask(self, name: str, sql: str, moment: Moment, view: View, within: Within) -> Answer:
        for answer in self._quick_answers(name, moment, (view,), within):
            return answer
        try:
            return self._read(self._plain.ask(sql, moment, view, within), within)
        except TooSlowError:
            message = f"thinking took longer than {within.seconds:g} seconds"
            raise FailureError(message, slow=True) from None
        except (TooMuchError, TooDeepError) as error:
            raise FailureError(str(error)) from None
        except _SQLITE_ERRORS as error:
            raise FailureError(printable(in_plain_words(error))) from None

    def _quick_answers(
        self, name: str, moment: Moment, views: Sequence[View], within: Within
    ) -> Iterator[Answer]:
        """Answers for the first views, up to one for which the quick way has none."""
        tuned = self._program.tuned.get(name)
        if self._tuned is None or tuned is None:
            return
        try:
            for raw in self._tuned.ask_each(tuned, moment, views, within):
                if tuned.result and any(bytes in map(type, row) for row in raw[1]):
                    return  # no record holds such a value
                answer = _put_together(self._read(raw, within), tuned.result)
                if len(answer[1]) > within.rows and not within.cut:
                    return
                yield answer
        except (UnfitError, TooDeepError, TooMuchError, TooSlowError, *_SQLITE_ERRORS):
            return

    def _read(self, raw: RawAnswer, within: Within) -> Answer:
        columns, rows = raw
        deepest = self._limits.depth
        return columns, [
            tuple([v if v.__class__ is float else from_sql(v, deepest) for v in within.each(row)])
            for row in rows
        ]


def _put_together(answer: Answer, result: Sequence[tuple[str, Sequence[str]]]) -> Answer:
    """An answer whose records were given field by field."""
    if not result:
        return answer
    rows = []
    for row in answer[1]:
        values = iter(row)
        rows.append(
            tuple(
                [
                    {f: _in_record(v) for f, v in zip(fields, values, strict=False)}
                    if fields
                    else next(values)
                    for _, fields in result
                ]
            )
        )
    return tuple([name for name, _ in result]), rows


def _in_record(value: Value) -> Value:
    """A field of a record; a number that JSON can't hold is null there."""
    return None if value.__class__ is float and not isfinite(value) else value
