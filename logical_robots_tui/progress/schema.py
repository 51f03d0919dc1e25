"""The database schema as migrations; a released one never changes, new ones are appended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.older import texts_of

if TYPE_CHECKING:
    import sqlite3
    from collections.abc import Sequence

APPLICATION_ID = 0x4C524F42
"""Identifies the file as ours in its header ("LROB")."""

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
        # goals: the second goals that it reaches, one a line.
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
)

_TABLES = {"level", "version", "fact"}


class DamagedError(Exception):
    """The file is not a progress database, or is incomplete."""


class NewerError(Exception):
    """The file was written by a newer version of the game."""


def prepare(
    connection: sqlite3.Connection, migrations: Sequence[Sequence[str]] = MIGRATIONS
) -> None:
    """Check a file and migrate it to the current version in one transaction.

    ``user_version`` is the number of migrations applied. The connection must be in autocommit
    mode. Raises DamagedError, NewerError or sqlite3.Error.
    """
    version = _checked_version(connection, len(migrations))
    if version == len(migrations):
        return
    from hashlib import sha256  # takes time that the first picture needs

    connection.create_function("first_program", 1, lambda text: next(iter(texts_of(text).values())))
    connection.create_function("sha256", 1, lambda text: sha256(text.encode()).hexdigest())
    connection.execute("BEGIN IMMEDIATE")
    try:
        # Another game may have migrated the file while this one waited for the lock.
        for step in migrations[_pragma(connection, "user_version") :]:
            for statement in step:
                connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        connection.execute(f"PRAGMA user_version = {len(migrations)}")
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


def _checked_version(connection: sqlite3.Connection, known: int) -> int:
    version = _pragma(connection, "user_version")
    names = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
    if not names and version == 0:
        return 0
    if _pragma(connection, "application_id") != APPLICATION_ID:
        raise DamagedError("it is not a record of progress")
    if version > known:
        raise NewerError
    if version < 1 or not names >= _TABLES:
        raise DamagedError("tables are missing")
    (found,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if found != "ok":
        raise DamagedError(str(found))
    return version


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    (value,) = connection.execute(f"PRAGMA {name}").fetchone()
    return int(value)
