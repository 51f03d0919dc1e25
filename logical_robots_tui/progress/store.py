"""One SQLite file that several games can share and that survives crashes and full disks.

A rollback journal, not a write-ahead log, because home folders may be on a network; so each
transaction is short, waits for its turn, and is on disk when it ends.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import sqlite3
import threading
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias, TypeVar

from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.paths import is_there
from logical_robots_tui.progress.old_texts import texts_of

State: TypeAlias = Literal["new", "started", "won"]


class Measures(NamedTuple):
    """The measures of a victory; less is better, except for `wins` and `goals`.

    `size` is the symbols of the program, `distance` map units of all robots together; `wins` of
    `starts` varied starts is None if not tried.
    """

    ticks: int
    size: int
    distance: float
    wins: int | None = None
    starts: int = 0
    goals: tuple[str, ...] = ()


class Bests(NamedTuple):
    """The best of each measure, possibly of different programs; None if not measured yet.

    `rules` is what earlier versions counted instead of `size`.
    """

    ticks: int | None = None
    size: int | None = None
    distance: float | None = None
    wins: int | None = None
    starts: int = 0
    goals: tuple[str, ...] = ()
    rules: int | None = None


class LevelRecord(NamedTuple):
    """The record of a level; `answers` are questions and the queries that answer them."""

    state: State = "new"
    hints: int = 0
    bests: Bests = Bests()
    versions: int = 0
    answers: tuple[tuple[str, str], ...] = ()


class Version(NamedTuple):
    """A program used in a level; `last_use` is a time with its zone."""

    number: int
    text: str
    last_use: datetime
    won: bool = False
    measures: Measures | None = None


NEW = LevelRecord()
"""The record of a level that was never started."""


APPLICATION_ID = 0x4C524F42
"""Identifies the file as ours in its header ("LROB")."""


class Schema(NamedTuple):
    """What a file of ours is: its noun, its number in the header, and the steps that make it."""

    noun: str
    application_id: int
    tables: frozenset[str]
    migrations: tuple[tuple[str, ...], ...]


def _rename_levels(levels: Mapping[str, str], arenas: Mapping[str, str]) -> tuple[str, ...]:
    """Return statements that rename levels in the record; arenas have their paths as names."""
    rows = [f"('{old}', '{new}')" for old, new in levels.items()]
    pairs = [f"SELECT '{old}' AS earlier, '{new}' AS now" for old, new in arenas.items()]
    return (
        "CREATE TEMP TABLE moved (earlier TEXT PRIMARY KEY, now TEXT NOT NULL)",
        *([f"INSERT INTO moved VALUES {', '.join(rows)}"] if rows else []),  # noqa: S608 - ours
        f"""
        INSERT INTO moved SELECT name, replace(name, earlier, now) FROM
            (
                SELECT name FROM level UNION SELECT level FROM version
                UNION SELECT level FROM answer UNION SELECT value FROM fact WHERE name = 'level'
            ),
            ({" UNION ".join(pairs)})
        WHERE name LIKE '%/levels/arenas/' || earlier || '.toml'
        """,  # noqa: S608 - ours
        *(
            f"""
            UPDATE {table} SET {column} = (SELECT now FROM moved WHERE earlier = {column})
            WHERE {column} IN (SELECT earlier FROM moved){condition}
            """  # noqa: S608 - ours
            for table, column, condition in (
                ("level", "name", ""),
                ("version", "level", ""),
                ("answer", "level", ""),
                ("fact", "value", " AND name = 'level'"),
            )
        ),
        "DROP TABLE moved",
    )


MIGRATIONS: tuple[tuple[str, ...], ...] = (
    (
        # hints: how many are revealed. begun and won: when, as ISO 8601 in UTC.
        """
        CREATE TABLE level (
            name TEXT PRIMARY KEY,
            begun TEXT,
            won TEXT,
            hints INTEGER NOT NULL DEFAULT 0
        )
        """,
        # turn: grows with each use, because clocks go back. won: when it first won.
        # ticks to starts: its measures, null until they are known.
        """
        CREATE TABLE version (
            number INTEGER PRIMARY KEY,
            level TEXT NOT NULL,
            digest TEXT NOT NULL,
            text TEXT NOT NULL,
            turn INTEGER NOT NULL,
            kept TEXT NOT NULL,
            won TEXT,
            ticks INTEGER,
            rules INTEGER,
            distance REAL,
            wins INTEGER,
            starts INTEGER,
            UNIQUE (level, digest)
        )
        """,
        "CREATE INDEX version_by_turn ON version (level, turn)",
        "CREATE INDEX version_by_digest ON version (digest)",
        # Facts about the player rather than a level, such as whether the tour was seen.
        "CREATE TABLE fact (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    ),
    (
        # goals: the bonus goals that it reaches, one a line.
        "ALTER TABLE version ADD COLUMN goals TEXT NOT NULL DEFAULT ''",
    ),
    (
        # Victories in levels with teams were kept with the programs of all of them in one text.
        """
        UPDATE OR REPLACE version
        SET text = first_program(text), digest = sha256(first_program(text))
        WHERE text LIKE '# teams: %'
        """,
    ),
    (
        # size: symbols of the program, once it has measures. Its rules are no longer counted.
        "ALTER TABLE version ADD COLUMN size INTEGER",
        "UPDATE version SET size = size_of(text) WHERE ticks NOT NULL",
    ),
    (
        # question: as the level asks it. query: the player's last right answer.
        """
        CREATE TABLE answer (
            level TEXT NOT NULL,
            question TEXT NOT NULL,
            query TEXT NOT NULL,
            PRIMARY KEY (level, question)
        )
        """,
    ),
    _rename_levels(
        {"09-the-gate": "11-the-gate", "11-power-line": "12-power-line", "12-swarm": "13-swarm"},
        {
            "13-high-ground": "14-high-ground",
            "14-four-doors": "15-four-doors",
            "15-low-voltage": "16-low-voltage",
        },
    ),
    _rename_levels(
        {},
        {
            "14-high-ground": "16-high-ground",
            "15-four-doors": "17-four-doors",
            "16-low-voltage": "18-low-voltage",
        },
    ),
)

PROGRESS = Schema(
    "record of progress", APPLICATION_ID, frozenset(("level", "version", "fact")), MIGRATIONS
)


class DamagedStoreError(Exception):
    """The file is not a progress database, or is incomplete."""


class NewerError(Exception):
    """The file was written by a newer version of the game."""


def prepare(
    connection: sqlite3.Connection, schema: Schema = PROGRESS, *, checks_pages: bool = True
) -> None:
    """Check a file and migrate it to the current version in one transaction.

    Checking all pages takes time that grows with the file. ``user_version`` is the number of
    migrations applied. The connection must be in autocommit mode. Raises DamagedError, NewerError
    or sqlite3.Error.
    """
    migrations = schema.migrations
    version = _checked_version(connection, schema, checks_pages=checks_pages)
    if version == len(migrations):
        return
    from hashlib import sha256  # takes time that the first picture needs

    connection.create_function("first_program", 1, lambda text: next(iter(texts_of(text).values())))
    connection.create_function("size_of", 1, size_of)
    connection.create_function("sha256", 1, lambda text: sha256(text.encode()).hexdigest())
    with connection:
        connection.execute("BEGIN IMMEDIATE")
        # Another game may have migrated the file while this one waited for the lock.
        for step in migrations[_pragma(connection, "user_version") :]:
            for statement in step:
                connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {schema.application_id}")
        connection.execute(f"PRAGMA user_version = {len(migrations)}")


def _checked_version(connection: sqlite3.Connection, schema: Schema, *, checks_pages: bool) -> int:
    version = _pragma(connection, "user_version")
    names = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
    if not names and version == 0:
        return 0
    if _pragma(connection, "application_id") != schema.application_id:
        raise DamagedStoreError(f"it is not a {schema.noun}")
    if version > len(schema.migrations):
        raise NewerError
    if version < 1 or not names >= schema.tables:
        raise DamagedStoreError("tables are missing")
    if checks_pages:
        (check_result,) = connection.execute("PRAGMA quick_check(1)").fetchone()
        if check_result != "ok":
            raise DamagedStoreError(str(check_result))
    return version


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    (value,) = connection.execute(f"PRAGMA {name}").fetchone()
    return int(value)


T = TypeVar("T")

BUSY_SECONDS = 10.0
"""Seconds that a transaction waits for those of other games."""

DAMAGE_CODES = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB}
REASONS = {
    sqlite3.SQLITE_FULL: "the disk is full",
    sqlite3.SQLITE_READONLY: "it is read-only",
    sqlite3.SQLITE_PERM: "you have no permission to change it",
    sqlite3.SQLITE_BUSY: "another program is using it",
    sqlite3.SQLITE_LOCKED: "another program is using it",
    sqlite3.SQLITE_CANTOPEN: "its folder can't be used",
}


class Store:
    """A database file, made at the first write, or in memory if no file can be used.

    Methods block, never raise disk errors, and may be called from any thread. `tell` is called
    once about each problem.
    """

    def __init__(
        self, file: Path | None, tell: Callable[[str], None] = lambda _message: None
    ) -> None:
        self._file = file
        self._tell = tell
        self._lock = threading.RLock()
        self._connection: sqlite3.Connection | None = None
        self._file_identity: tuple[int, int] | None = None
        self._in_memory: sqlite3.Connection | None = None
        self._empty_database: sqlite3.Connection | None = None
        if file is None:
            self._in_memory = _empty()

    @property
    def is_kept(self) -> bool:
        """Whether it outlives the process; False after a problem was reported."""
        return self._in_memory is None

    def read(self, work: Callable[[sqlite3.Connection], T]) -> T:
        """Run a read; before the file exists, on an empty database."""
        with self._lock:
            if self._file is not None and self._in_memory is None and not is_there(self._file):
                self._empty_database = self._empty_database or _empty()
                return work(self._empty_database)
            return self._run_work(work)

    def write(self, work: Callable[[sqlite3.Connection], T]) -> T:
        """Run a write in one transaction. The function may be called more than once."""

        def transaction(connection: sqlite3.Connection) -> T:
            with connection:
                connection.execute("BEGIN IMMEDIATE")
                return work(connection)

        with self._lock:
            return self._run_work(transaction)

    def close(self) -> None:
        with self._lock:
            self._disconnect()
            if self._empty_database is not None:
                self._empty_database.close()
                self._empty_database = None

    def _run_work(self, work: Callable[[sqlite3.Connection], T]) -> T:
        for _ in range(3):
            try:
                return work(self._in_memory or self._open_connection())
            except DamagedStoreError:
                self._rename_damaged()
            except NewerError:
                self._continue_in_memory(
                    "Your progress was saved by a newer version of the game. It is left unchanged; "
                    "this version saves no progress.",
                    copy=False,
                )
            except sqlite3.DatabaseError as error:
                code = error_code(error)
                if code in DAMAGE_CODES and self._in_memory is None:
                    self._rename_damaged()
                else:
                    self._continue_in_memory(_cannot_save(REASONS.get(code, str(error))))
            except OSError as error:
                self._continue_in_memory(_cannot_save(error.strerror or str(error)))
        self._continue_in_memory(_cannot_save("it keeps getting damaged"))
        assert self._in_memory is not None
        return work(self._in_memory)

    def _open_connection(self) -> sqlite3.Connection:
        """Return the connection, reopened if the file was removed or set aside by another game."""
        assert self._file is not None
        if self._connection is not None:
            if self._file_identity == _identity(self._file):
                return self._connection
            self._disconnect()
        self._file.parent.mkdir(parents=True, exist_ok=True)
        with self._file_lock():
            connection = _connect(str(self._file))
            try:
                connection.execute("PRAGMA synchronous = EXTRA")
                prepare(connection)
            except BaseException:
                connection.close()
                raise
            self._connection, self._file_identity = connection, _identity(self._file)
        return connection

    @contextlib.contextmanager
    def _file_lock(self) -> Iterator[None]:
        """Prevent other games from opening or renaming the file meanwhile."""
        assert self._file is not None
        handle = os.open(
            self._file.with_suffix(".lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600
        )
        try:
            with contextlib.suppress(OSError):  # the file system has no locks
                fcntl.flock(handle, fcntl.LOCK_EX)
            yield
        finally:
            os.close(handle)

    def _rename_damaged(self) -> None:
        """Rename a damaged file, unless another game has done so."""
        assert self._file is not None
        identity = self._file_identity
        self._disconnect()
        try:
            with self._file_lock():
                if identity is not None and identity != _identity(self._file):
                    return
                if identity is None and _is_sound(self._file):
                    return
                new_path = self._file.with_name(
                    f"{self._file.stem}-damaged-{datetime.now(UTC):%Y%m%d-%H%M%S-%f}"
                    f"{self._file.suffix}"
                )
                self._file.replace(new_path)
                journal = self._file.with_name(f"{self._file.name}-journal")
                with contextlib.suppress(FileNotFoundError):  # it belongs to the damaged file
                    journal.replace(new_path.with_name(f"{new_path.name}-journal"))
        except OSError as error:
            self._continue_in_memory(_cannot_save(error.strerror or str(error)))
            return
        self._tell(
            f"Your progress file was damaged. It was renamed to {new_path.name}, "
            "and a new one was created."
        )

    def _continue_in_memory(self, message: str, *, copy: bool = True) -> None:
        """Continue in memory, with whatever can be read from the file."""
        self._disconnect()
        if self._in_memory is not None:
            return
        self._in_memory = _empty()
        if copy and self._file is not None:
            memory_copy = _connect(":memory:")
            try:
                uri = f"{self._file.absolute().as_uri()}?mode=ro"
                with contextlib.closing(_connect(uri, uri=True)) as original:
                    # Copying would wait forever for another holder of the file; reading does not.
                    original.execute("BEGIN")
                    original.execute("SELECT count(*) FROM sqlite_master").fetchone()
                    original.backup(memory_copy)
                prepare(memory_copy)
                self._in_memory = memory_copy
            except (OSError, sqlite3.Error, DamagedStoreError, NewerError):
                memory_copy.close()
        self._tell(message)

    def _disconnect(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection = self._file_identity = None


def _cannot_save(reason: str) -> str:
    return f"Your progress can't be saved: {reason}. The game continues without saving it."


def _connect(name: str, *, uri: bool = False) -> sqlite3.Connection:
    return sqlite3.connect(
        name, timeout=BUSY_SECONDS, isolation_level=None, check_same_thread=False, uri=uri
    )


def _empty() -> sqlite3.Connection:
    connection = _connect(":memory:")
    prepare(connection)
    return connection


def _is_sound(file: Path) -> bool:
    try:
        with contextlib.suppress(NewerError), contextlib.closing(_connect(str(file))) as connection:
            prepare(connection)
    except DamagedStoreError:
        return False
    except sqlite3.DatabaseError as error:
        return error_code(error) not in DAMAGE_CODES
    return True


def program_digest(text: str) -> str:
    import hashlib  # takes time that the first picture needs

    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()


def error_code(error: sqlite3.Error) -> int:
    return getattr(error, "sqlite_errorcode", 0) & 0xFF


def _identity(file: Path) -> tuple[int, int] | None:
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino
