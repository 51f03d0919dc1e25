"""The database of a mind: in memory, its own tables, listed functions, nothing else."""

from __future__ import annotations

import secrets
import sqlite3
from time import monotonic
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind import functions
from logical_robots_tui.mind.diagnostics import Stopped

if TYPE_CHECKING:
    import threading
    from collections.abc import Iterable, Sequence

__all__ = ["Database", "TooSlowError"]

_STEPS_BETWEEN_LOOKS = 2_000  # virtual machine steps of SQLite, about 50 microseconds

_ALLOWED_ACTIONS = frozenset({sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ, sqlite3.SQLITE_RECURSIVE})

BUILT_IN = frozenset(
    [
        "abs",
        "acos",
        "acosh",
        "asin",
        "asinh",
        "atan",
        "atan2",
        "atanh",
        "avg",
        "ceil",
        "ceiling",
        "char",
        "coalesce",
        "concat",
        "concat_ws",
        "cos",
        "cosh",
        "count",
        "cume_dist",
        "degrees",
        "dense_rank",
        "exp",
        "first_value",
        "floor",
        "format",
        "glob",
        "group_concat",
        "hex",
        "if",
        "ifnull",
        "iif",
        "instr",
        "json",
        "json_array",
        "json_array_length",
        "json_each",
        "json_extract",
        "json_group_array",
        "json_group_object",
        "json_object",
        "json_quote",
        "json_type",
        "json_valid",
        "lag",
        "last_value",
        "lead",
        "length",
        "like",
        "likelihood",
        "likely",
        "ln",
        "log",
        "log10",
        "log2",
        "lower",
        "ltrim",
        "max",
        "median",
        "min",
        "mod",
        "nth_value",
        "ntile",
        "nullif",
        "percent_rank",
        "percentile",
        "pi",
        "pow",
        "power",
        "printf",
        "quote",
        "radians",
        "rank",
        "replace",
        "round",
        "row_number",
        "rtrim",
        "sign",
        "sin",
        "sinh",
        "sqrt",
        "string_agg",
        "strftime",
        "substr",
        "substring",
        "sum",
        "tan",
        "tanh",
        "total",
        "trim",
        "trunc",
        "typeof",
        "unhex",
        "unicode",
        "unlikely",
        "upper",
    ]
)


class TooSlowError(Exception):
    """A query took longer than it may."""


class Database:
    """A private in-memory SQLite with the tables ``Sensor`` and ``Memory``.

    Use it in one thread at a time.

    Args:
        seconds: How long one query may take.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._mark = secrets.token_hex(8)
        self._deadline = 0.0
        self._stop: threading.Event | None = None
        self._connection = sqlite3.connect(
            ":memory:", isolation_level=None, check_same_thread=False, cached_statements=512
        )
        functions.install(self._connection)
        self._connection.executescript(
            """
            PRAGMA trusted_schema = OFF;
            PRAGMA temp_store = MEMORY;
            CREATE TABLE Sensor(robot_name, sensor);
            CREATE TABLE Memory(robot_name, memory);
            """
        )
        # SQLite sets up its JSON tables at their first use, which the authorizer would refuse.
        self._connection.execute("SELECT 1 FROM json_each('[]'), json_tree('[]')").fetchall()
        self._trusted = True
        self._connection.set_authorizer(self._authorize)
        self._connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, 50_000_000)
        self._connection.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)
        self._connection.set_progress_handler(self._must_stop, _STEPS_BETWEEN_LOOKS)

    def load(
        self,
        sensors: Iterable[tuple[str, Any]],
        memories: Iterable[tuple[str, Any]],
    ) -> None:
        """Replace the rows of ``Sensor`` and ``Memory``, both as SQLite values."""
        connection = self._connection
        self._trusted = True
        connection.execute(self._own("DELETE FROM Sensor"))
        connection.execute(self._own("DELETE FROM Memory"))
        connection.executemany(self._own("INSERT INTO Sensor VALUES (?, ?)"), sensors)
        connection.executemany(self._own("INSERT INTO Memory VALUES (?, ?)"), memories)

    def ask(
        self, sql: str, *, most: int, stop: threading.Event | None = None
    ) -> tuple[tuple[str, ...], Sequence[tuple[Any, ...]]]:
        """Column names and at most `most` rows of one query that may only read.

        Raises:
            Stopped: `stop` was set meanwhile.
            TooSlowError: It took too long.
            sqlite3.Error: It failed, or asked for what is not allowed.
        """
        self._deadline = monotonic() + self._seconds
        self._stop = stop
        self._trusted = False
        try:
            cursor = self._connection.execute(sql)
            rows = cursor.fetchmany(most)
            columns = tuple(d[0] for d in cursor.description)
            cursor.close()
        except sqlite3.OperationalError as error:
            if "interrupted" not in str(error):
                raise
            if stop is not None and stop.is_set():
                raise Stopped("The program was stopped while it was thinking.") from None
            raise TooSlowError from None
        finally:
            self._deadline = 0.0
            self._stop = None
        return columns, rows

    def close(self) -> None:
        """Free everything."""
        self._connection.close()

    def _own(self, sql: str) -> str:
        """A statement of ours, marked so that no program can name it in the statement cache."""
        return f"/* {self._mark} */ {sql}"

    def _must_stop(self) -> bool:
        if self._stop is not None and self._stop.is_set():
            return True
        return 0.0 < self._deadline < monotonic()

    def _authorize(
        self,
        action: int,
        _first: str | None,
        second: str | None,
        _database: str | None,
        _trigger: str | None,
    ) -> int:
        """Say what a statement may do; SQLite asks while it prepares it."""
        if self._trusted or action in _ALLOWED_ACTIONS:
            return sqlite3.SQLITE_OK
        if action == sqlite3.SQLITE_FUNCTION and second is not None:
            name = second.lower()
            if name in BUILT_IN or name in functions.NAMES:
                return sqlite3.SQLITE_OK
        return sqlite3.SQLITE_DENY
