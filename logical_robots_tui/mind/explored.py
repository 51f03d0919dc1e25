"""What one view of a moment shows, to be asked for explanations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.diagnostics import Stopped
from logical_robots_tui.mind.failures import FailureError, failures_in_words
from logical_robots_tui.mind.sqlite.database import TooSlowError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.mind.asking import Answer, Asking
    from logical_robots_tui.mind.sqlite.database import Answer as RawAnswer
    from logical_robots_tui.mind.sqlite.database import Scalar
    from logical_robots_tui.mind.sqlite.moment import Moment, View, Within

__all__ = ["Explored"]


class Explored:
    """What one view of a moment shows, for explanations.

    Args:
        asking: The databases of the mind.
        moment: The moment.
        view: The view.
        within: What all of it may use up, and most rows of a predicate.
    """

    def __init__(self, asking: Asking, moment: Moment, view: View, within: Within) -> None:
        self._asking, self._plain = asking, asking.tables_to_explore()
        self._moment, self._view, self._within = moment, view, within

    def spend(self, steps: int) -> None:
        """Count work outside of queries, in steps.

        Raises:
            FailureError: Too many were taken.
            Stopped: It was stopped.
        """
        within = self._within
        within.budget.steps -= steps
        if within.stop is not None and within.stop.is_set():
            raise Stopped("The explanation was stopped.")
        with failures_in_words(within):
            if within.budget.steps < 0:
                raise TooSlowError

    def rows(self, predicate: str, sql: str) -> Answer:
        """Columns and rows of a predicate.

        Args:
            predicate: Its name.
            sql: A query for them, or "" for that of the program.

        Raises:
            FailureError: It failed, or has too many.
        """
        if not sql and not self._asking.sql_of(predicate):
            raise FailureError(f"{predicate} can't be computed")
        if not sql:
            return self._asking.rows(predicate, self._moment, self._view, self._within)
        return self._asking.plainly(sql, self._moment, self._view, self._within)

    def load(self, table: str, columns: Sequence[str], rows: Sequence[Sequence[Scalar]]) -> None:
        """Fill a table that queries may read.

        Raises:
            FailureError: It takes too much memory.
        """
        with failures_in_words(self._within):
            self._plain.define(table, columns, rows, self._moment, self._view)

    def ask(self, sql: str, parameters: Sequence[Scalar]) -> RawAnswer:
        """Columns and rows of a query, as SQLite has them.

        Raises:
            FailureError: It failed.
        """
        with failures_in_words(self._within):
            return self._plain.ask(sql, self._moment, self._view, self._within, parameters)
