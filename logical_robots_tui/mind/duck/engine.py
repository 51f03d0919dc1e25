"""DuckDB, closed off from everything but the tables of a tick."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, TypeAlias
from weakref import WeakMethod

from logical_robots_tui.errors import InputError
from logical_robots_tui.mind.diagnostics import Stopped
from logical_robots_tui.mind.duck.words import is_harmless
from logical_robots_tui.mind.sqlite.database import TooMuchError, TooSlowError
from logical_robots_tui.mind.sqlite.tables import UnfitError
from logical_robots_tui.mind.sqlite.watch import Budget, Work

if TYPE_CHECKING:
    import threading
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.program import Duck
    from logical_robots_tui.mind.sqlite.moment import Moment, Within

__all__ = ["FEWEST", "DuckTables", "Engine", "check_installed"]

Engine: TypeAlias = Literal["sqlite", "duckdb"]
"""What minds think with."""

FEWEST = 200
"""Robots from which on DuckDB is the quicker one."""

_SETTINGS = (
    "temp_directory = ''",
    "autoinstall_known_extensions = false",
    "autoload_known_extensions = false",
    "allow_community_extensions = false",
    "python_enable_replacements = false",
    "enable_external_access = false",
)
_LOCK = "lock_configuration = true"

_PATIENCE = 3  # failures in a row after which a query is not tried again


def check_installed() -> None:
    """Make sure that DuckDB can be used.

    Raises:
        InputError: It is not installed.
    """
    try:
        import_module("duckdb")
    except ImportError:
        raise InputError(
            "DuckDB is not installed.",
            hint="Install it with: pip install logical-robots-tui[duckdb]",
        ) from None


class DuckTables:
    """The rows of a moment in DuckDB, asked for all robots at once.

    One thread of DuckDB's computes, so that sums always come out the same.

    Args:
        limits: Bounds on memory and on results.

    Raises:
        InputError: DuckDB is not installed, or is one that can't be closed off.
    """

    def __init__(self, limits: Limits) -> None:
        check_installed()
        import duckdb

        self._error = duckdb.Error
        self._limits = limits
        self._failures: dict[str, int] = {}
        self._connection = duckdb.connect(":memory:", config={"threads": 1})
        try:
            for setting in (*_SETTINGS, f"memory_limit = '{limits.mind_bytes}B'", _LOCK):
                self._connection.execute(f"SET {setting}")
        except duckdb.Error:
            self._connection.close()
            raise InputError(
                f"DuckDB {duckdb.__version__} can't be closed off from files and the network.",
                hint="Install another one with: pip install -U logical-robots-tui[duckdb]",
            ) from None
        # Weakly, for who looks after the work may remember it for longer than DuckDB likes.
        interrupt = WeakMethod(self._interrupt)
        self._work = Work(lambda: (halt := interrupt()) and halt())
        self._columns: dict[str, dict[str, NDArray[Any]]] = {}
        self._prepared = ""
        self._is_live = self._reads_in_place()

    def ask(self, duck: Duck, moment: Moment, within: Within) -> Sequence[tuple[Any, ...]]:
        """Rows for all robots; each ends with the number of its robot unless all see everything.

        Raises:
            UnfitError: It is better asked of SQLite, for want of a query, because the sensors have
                not the usual shape, or because DuckDB failed.
            Stopped: The thought was stopped.
            TooSlowError: It took too long.
            TooMuchError: The result is too large.
        """
        query = _query_for(duck, moment) if len(moment.names) >= FEWEST else ""
        if not query or self._failures.get(query, 0) >= _PATIENCE:
            raise UnfitError("no query for DuckDB")
        if not is_harmless(query):
            raise UnfitError("a query that was not made here")
        try:
            self._load(duck.columns, moment)
            self._prepare(query)
            rows = self._fetch(within)
        except (self._error, UnicodeError) as error:
            self._failures[query] = self._failures.get(query, 0) + 1
            raise UnfitError(str(error)) from None
        self._failures.pop(query, None)
        if not _is_answer(rows, len(duck.names), 0 if query is duck.all else len(moment.names)):
            raise UnfitError("an answer of another form")
        return rows

    def close(self) -> None:
        """Free everything."""
        self._connection.close()

    # -- inside --------------------------------------------------------------------------------

    def _interrupt(self) -> None:
        self._connection.interrupt()

    def _load(self, tables: Mapping[str, tuple[str, ...]], moment: Moment) -> None:
        """Let DuckDB see the columns of a moment.

        It reads numpy's arrays where they are, whenever a query runs. So new values are put into
        the same arrays: what was prepared stays, and to prepare takes longer than to compute.
        """
        from logical_robots_tui.mind.duck.loading import columns_of, filled

        for table, wanted in tables.items():
            columns = columns_of(table, moment, wanted)
            kept = self._columns.get(table)
            if kept is None or not self._is_live or not filled(kept, columns):
                self._connection.register(table, columns)
                self._columns[table] = columns
                self._prepared = ""

    def _prepare(self, query: str) -> None:
        if query != self._prepared:
            self._connection.execute(f"PREPARE thought AS {query}")
            self._prepared = query

    def _reads_in_place(self) -> bool:
        """Whether a prepared query sees what is put into an array later."""
        import numpy as np

        probe = {name: np.array([item], dtype=object) for name, item in (("a", "x"), ("b", "y"))}
        probe["c"] = np.array([1.5])
        self._connection.register("probe", probe)
        self._connection.execute("PREPARE probing AS SELECT a, b, c FROM probe")
        probe["a"][:] = ["z"]
        probe["c"][:] = [2.5]
        seen = self._connection.execute("EXECUTE probing").fetchall()
        self._connection.execute("DEALLOCATE probing")
        self._connection.unregister("probe")
        return seen == [("z", "y", 2.5)]

    def _fetch(self, within: Within) -> list[tuple[Any, ...]]:
        # Half the time: if that is not enough, SQLite has the other half.
        budget = Budget(0, within.budget.seconds / 2)
        self._work.begin(budget, within.stop)
        try:
            found = self._connection.execute("EXECUTE thought")
            rows: list[tuple[Any, ...]] = found.fetchmany(within.rows + 1)
        except self._error:
            if self._work.halted:
                raise self._end(within.stop) from None
            raise
        finally:
            self._work.end()
            within.budget.seconds -= within.budget.seconds / 2 - budget.seconds
        if self._work.halted:
            raise self._end(within.stop)
        size = sum(len(v.encode()) for row in rows for v in row if v.__class__ is str)
        if size > self._limits.result_bytes:
            raise TooMuchError(f"the result has more than {self._limits.result_bytes:,} bytes")
        return rows

    def _end(self, stop: threading.Event | None) -> Exception:
        if stop is not None and stop.is_set():
            return Stopped("The program was stopped while it was thinking.")
        return TooSlowError()


def _is_answer(rows: Sequence[tuple[Any, ...]], columns: int, viewers: int) -> bool:
    """Whether rows have so many columns, and the number of a viewer if there are viewers."""
    if not viewers:
        return all(len(row) == columns for row in rows)
    numbers = range(viewers)
    return all(len(row) == columns + 1 and row[-1] in numbers for row in rows)


def _query_for(duck: Duck, moment: Moment) -> str:
    if len(moment.views) == 1 and len(moment.names) > 1:
        return duck.all
    if not moment.apart:
        return ""
    return duck.own if moment.stride else duck.memories
