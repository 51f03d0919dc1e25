"""A mind's database: in memory, with its own tables and listed functions only."""

from __future__ import annotations

import re
import secrets
import sqlite3
from collections.abc import Callable, Iterable, Sequence
from itertools import count
from typing import Any, TypeAlias

from logical_robots_tui.language.diagnostics import Stopped
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite import registry
from logical_robots_tui.mind.sqlite.budget import (
    LONG,
    MAX_ITEMS,
    STEPS_AT_ONCE,
    MeteredWork,
    QueryBudget,
    charge,
)
from logical_robots_tui.mind.sqlite.layouts import PLAIN_LAYOUT, SqlLayout

Answer: TypeAlias = "tuple[tuple[str, ...], Sequence[tuple[Any, ...]]]"
"""Column names and rows."""

Scalar: TypeAlias = int | float | str | None
"""A value as stored in a table."""

_NAMED_QUERY = re.compile(r"t_\d+_\w+|the_last_step|WhyGiven")
"""Names of the named queries of a statement."""

_BUILT_IN = """
    abs acos acosh asin asinh atan atan2 atanh avg ceil ceiling char coalesce concat concat_ws
    cos cosh count cume_dist degrees dense_rank exp first_value floor format group_concat if
    ifnull iif instr json json_array json_array_length json_each json_extract json_group_array
    json_group_object json_object json_quote json_type json_valid lag last_value lead length
    like likelihood likely ln log log10 log2 lower ltrim max median min mod nth_value ntile
    nullif percent_rank percentile pi pow power printf quote radians rank replace round
    row_number rtrim sign sin sinh sqrt string_agg substr substring sum tan tanh total trim
    trunc typeof unicode unlikely upper
"""

BUILT_IN = frozenset(_BUILT_IN.split())
"""SQLite's own functions that may be called.

Excluded are functions that reach beyond the query (``load_extension``, ``readfile``), reveal the
machine (``random``, ``date``, ``sqlite_version``), or only create large values (``randomblob``,
``zeroblob``, ``hex``). Functions that can take very long in a single call are replaced by our
own.
"""

_ALLOWED_ACTIONS = frozenset({sqlite3.SQLITE_SELECT, sqlite3.SQLITE_RECURSIVE})

_SQLITE_LIMITS = {
    sqlite3.SQLITE_LIMIT_ATTACHED: 0,
    sqlite3.SQLITE_LIMIT_COLUMN: 100,
    sqlite3.SQLITE_LIMIT_COMPOUND_SELECT: 500,
    sqlite3.SQLITE_LIMIT_EXPR_DEPTH: 1_000,
    sqlite3.SQLITE_LIMIT_FUNCTION_ARG: 127,
    sqlite3.SQLITE_LIMIT_LIKE_PATTERN_LENGTH: 1_000,
    sqlite3.SQLITE_LIMIT_SQL_LENGTH: 2_000_000,
    sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH: 1,
    sqlite3.SQLITE_LIMIT_VARIABLE_NUMBER: 1_000,
    sqlite3.SQLITE_LIMIT_VDBE_OP: 1_000_000,
    sqlite3.SQLITE_LIMIT_WORKER_THREADS: 0,
}

_MANY_ROWS = 100  # rows from which on it may take a while to read them

_DELETE = "DELETE FROM "

_HALTED_LENGTH = 30  # longest text that a halted query can still make


class TooSlowError(Exception):
    """A query took too many steps, or, by the time limit, too long."""


class TooMuchError(Exception):
    """A query needs or returns more memory than allowed; the message says which."""


class Database:
    """A private in-memory SQLite with the tables of a layout; for one thread at a time."""

    def __init__(self, limits: Limits | None = None, layout: SqlLayout = PLAIN_LAYOUT) -> None:
        self._limits = limits or Limits()
        self._readable = layout.readable
        self._own_statements = _OwnStatements(secrets.token_hex(8))
        self._functions: set[str] = set()
        self._bytes = 0
        self._max_bytes = self._limits.result_bytes
        self._connection = sqlite3.connect(
            ":memory:", isolation_level=None, check_same_thread=False, cached_statements=512
        )
        self._work = MeteredWork(self._halt, self._limits.aggregate_bytes)
        self._numbers = count()
        self._connection.set_progress_handler(self._work.count_steps, STEPS_AT_ONCE)
        registry.install(self._connection, self._work)
        self._connection.executescript(
            f"""
            PRAGMA trusted_schema = OFF;
            PRAGMA temp_store = MEMORY;
            PRAGMA hard_heap_limit = {self._limits.mind_bytes};
            {layout.script}
            """
        )
        # SQLite creates its JSON tables on first use, which the authorizer would refuse.
        self._connection.execute("SELECT 1 FROM json_each('[]'), json_tree('[]')").fetchall()
        self._trusted = True
        self._connection.set_authorizer(self._authorize)
        for category, limit in _SQLITE_LIMITS.items():
            self._connection.setlimit(category, limit)
        self._connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, self._limits.value_bytes)
        self._connection.text_factory = self._text

    @property
    def is_empty(self) -> bool:
        """Whether the tables are empty; SQLite rolls back when it runs out of memory."""
        return not self._connection.in_transaction

    def load(self, sensors: Sequence[tuple[str, Any]], memories: Sequence[tuple[str, Any]]) -> None:
        """Replace ``Sensor`` and ``Memory`` in the plain layout; TooMuchError for large values."""
        self.fill("Sensor", (("INSERT INTO Sensor VALUES (?, ?)", sensors),))
        self.fill("Memory", (("INSERT INTO Memory VALUES (?, ?)", memories),))

    def fill(
        self,
        table: str,
        inserts: Sequence[tuple[str, Sequence[Sequence[Any]]]],
        *,
        clear: bool = True,
    ) -> None:
        """Replace rows of a table.

        Args:
            table: Its name.
            inserts: Our own statements, each with the SQLite values of each execution.
            clear: Whether to delete all rows first.

        Raises:
            TooMuchError: A value is too large.
            sqlite3.Error: A value is not one of SQLite's types.
        """
        self._trusted = True
        connection = self._connection
        try:
            if not connection.in_transaction:
                connection.execute("BEGIN")  # never committed: nobody else reads it
            if clear:
                connection.execute(self._own_statements[_DELETE + table])
            try:
                for insert, rows in inserts:
                    connection.executemany(self._own_statements[insert], rows)
            except UnicodeEncodeError:
                self.fill(
                    table,
                    [(insert, _without_surrogates(rows)) for insert, rows in inserts],
                    clear=clear,
                )
        except (sqlite3.DataError, MemoryError) as error:
            raise self._memory_error(error) from None

    def ask(
        self,
        sql: str,
        parameters: Sequence[Scalar] = (),
        *,
        max_rows: int,
        budget: QueryBudget | None = None,
    ) -> Answer:
        """Return the column names and at most `max_rows` rows of one read-only query.

        Raises:
            Stopped: The caller stopped it.
            TooSlowError: It took too many steps, or too long.
            TooMuchError: It needs too much memory, or its result is too large.
            sqlite3.Error: It failed, in a callback too, or used something that is not allowed.
        """
        if budget is None:
            budget = QueryBudget.of_thought(self._limits)
        remainder, stop = budget.remainder, budget.stop
        if stop is not None and stop.is_set():
            raise Stopped("The program was stopped before it started thinking.")
        if remainder.is_late or remainder.steps < 0:
            raise TooSlowError
        if budget.is_exact:
            sql = f"/* {next(self._numbers)} */ {sql}"
        self._trusted = False
        self._bytes = 0
        work = self._work
        work.begin(remainder, stop)
        try:
            answer = self._fetch(sql, parameters, max_rows)
            budget.is_large = self._bytes > LONG or len(answer[1]) > _MANY_ROWS
            return answer
        except TooMuchError:
            raise
        except Exception as error:
            if work.is_halted and work.is_stopped:
                raise Stopped("The program was stopped while it was thinking.") from None
            if work.is_over:
                raise TooSlowError from None
            if isinstance(error, MemoryError | sqlite3.DataError):
                raise self._memory_error(error) from None
            if isinstance(error, sqlite3.Error | sqlite3.Warning):
                raise
            # For one, a callback's argument that can't be decoded.
            raise sqlite3.OperationalError(f"user-defined: {error}") from error
        finally:
            work.end()
            if work.is_halted:
                self._connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, self._limits.value_bytes)

    def define(self, table: str, columns: Sequence[str], rows: Sequence[Sequence[Scalar]]) -> None:
        """Fill a table, created if necessary, that queries may read; raise TooMuchError."""
        self._trusted = True
        connection = self._connection
        quoted = (name.replace('"', '""') for name in columns)
        names = ", ".join(f'"{name}"' for name in quoted)
        if not connection.in_transaction:
            connection.execute("BEGIN")
        try:
            connection.execute(self._own_statements[f"CREATE TABLE IF NOT EXISTS {table}({names})"])
            places = ", ".join("?" * len(columns))
            self._readable |= {table.lower()}
            insert = f"INSERT INTO {table} VALUES ({places})"  # noqa: S608 - our own name
            self.fill(table, ((insert, rows),))
        except (sqlite3.DataError, MemoryError) as error:
            raise self._memory_error(error) from None

    def register(self, name: str, function: Callable[..., Any], arguments: int = 1) -> None:
        """Register a function for queries, once; its errors and steps count as the query's."""
        if name not in self._functions:
            self._connection.create_function(name, arguments, charge(function, self._work))
            self._functions.add(name)

    def prepare(self, sql: str, parameters: Sequence[int] = ()) -> None:
        """Compile a query without running it; raise sqlite3.Error or MemoryError."""
        self._trusted = False
        self._connection.execute(f"EXPLAIN {sql}", parameters).close()

    def close(self) -> None:
        self._connection.close()

    # -- inside --------------------------------------------------------------------------------

    def _fetch(self, sql: str, parameters: Sequence[Scalar], max_rows: int) -> Answer:
        try:
            cursor = self._connection.execute(sql, parameters)
        except UnicodeEncodeError:
            raise sqlite3.ProgrammingError("this is not a query") from None
        if cursor.description is None:
            raise sqlite3.ProgrammingError("this is not a query")
        columns = tuple([d[0] for d in cursor.description])
        rows: list[tuple[Any, ...]] = []
        for row in cursor:
            if bytes in map(type, row):
                self._bytes += sum(len(value) for value in row if value.__class__ is bytes)
                if self._bytes > self._max_bytes:
                    raise self._result_error()
            rows.append(row)
            if len(rows) == max_rows:
                break
        cursor.close()
        return columns, rows

    def _text(self, raw: bytes) -> str:
        self._bytes += len(raw)
        if self._bytes > self._max_bytes:
            raise self._result_error()
        return raw.decode("utf-8", "replace")

    def _result_error(self) -> TooMuchError:
        return TooMuchError(f"the result has more than {self._max_bytes:,} bytes")

    def _memory_error(self, error: Exception) -> TooMuchError:
        if isinstance(error, MemoryError):
            return TooMuchError(f"it needs more than {self._limits.mind_bytes:,} bytes of memory")
        if self._work.is_full:
            max_bytes = self._limits.aggregate_bytes
            return TooMuchError(f"aggregates collect more than {max_bytes:,} bytes at a time")
        return TooMuchError(
            f"a value became too large; a string, list or record may have "
            f"{self._limits.value_bytes:,} bytes, a list in a function {MAX_ITEMS:,} items"
        )

    def _halt(self) -> None:
        """End the running query, from another thread.

        SQLite checks for interrupts once per row; a tiny limit on texts ends long rows, too.
        """
        self._connection.interrupt()
        self._connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _HALTED_LENGTH)

    def _authorize(
        self,
        action: int,
        table_name: str | None,
        detail_name: str | None,
        _database: str | None,
        _trigger: str | None,
    ) -> int:
        """Return what a statement may do; SQLite calls this while it prepares the statement."""
        if self._trusted or action in _ALLOWED_ACTIONS:
            return sqlite3.SQLITE_OK
        if action == sqlite3.SQLITE_READ and table_name is not None:
            # A named query is only mentioned here when its rows are counted.
            is_count = detail_name == "" and _NAMED_QUERY.fullmatch(table_name) is not None
            if is_count or table_name.lower() in self._readable:
                return sqlite3.SQLITE_OK
        if action == sqlite3.SQLITE_FUNCTION and detail_name is not None:
            name = detail_name.lower()
            if name in BUILT_IN or name in registry.NAMES or name in self._functions:
                return sqlite3.SQLITE_OK
        return sqlite3.SQLITE_DENY


class _OwnStatements(dict[str, str]):
    """Our own statements, marked so that no program can name one in the statement cache."""

    def __init__(self, mark: str) -> None:
        super().__init__()
        self._mark = mark

    def __missing__(self, sql: str) -> str:
        self[sql] = statement = f"/* {self._mark} */ {sql}"
        return statement


def _without_surrogates(rows: Iterable[Sequence[Any]]) -> list[list[Any]]:
    """Return rows with lone surrogates replaced, which SQLite can't store."""
    return [
        [v.encode("utf-8", "replace").decode() if isinstance(v, str) else v for v in row]
        for row in rows
    ]
