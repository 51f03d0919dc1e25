"""A player's progress: states, hints, best results, and earlier versions of programs."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from logical_robots_tui.progress.store import Bests, LevelRecord, Measures, State, Store, Version

FILE_NAME = "progress.sqlite"

MOST_VERSIONS = 200
"""How many versions of a program are kept per level; those with a best result always are."""

_RECORD = """
SELECT
    max(begun IS NOT NULL), max(won IS NOT NULL), max(hints),
    (SELECT count(*) FROM version WHERE level = ?1),
    (SELECT min(ticks) FROM version WHERE level = ?1),
    (SELECT min(rules) FROM version WHERE level = ?1 AND ticks NOT NULL),
    (SELECT min(distance) FROM version WHERE level = ?1)
FROM level WHERE name = ?1
"""

_MOST_WINS = """
SELECT wins, starts FROM version WHERE level = ? AND wins NOT NULL
ORDER BY 1.0 * wins / starts DESC, starts DESC LIMIT 1
"""

_GOALS = "SELECT DISTINCT goals FROM version WHERE level = ? AND goals <> ''"

_KEEP = """
INSERT INTO version (level, digest, text, turn, kept)
VALUES (?1, ?2, ?3, (SELECT coalesce(max(turn), 0) + 1 FROM version), ?4)
ON CONFLICT (level, digest) DO UPDATE SET turn = excluded.turn, kept = excluded.kept
"""

_FORGET = """
DELETE FROM version WHERE level = ?1 AND number NOT IN (
    SELECT number FROM version WHERE level = ?1 ORDER BY turn DESC LIMIT ?2
) AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND ticks NOT NULL ORDER BY ticks LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND ticks NOT NULL ORDER BY rules LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND ticks NOT NULL ORDER BY distance LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND wins NOT NULL
    ORDER BY 1.0 * wins / starts DESC, starts DESC LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT max(number) FROM version WHERE level = ?1 AND goals <> '' GROUP BY goals))
"""


class Progress:
    """A player's progress by level name, on disk or without a file in memory.

    Methods block, never raise disk errors, and may be called from any thread. `tell` is called
    once about each problem.
    """

    def __init__(self, file: Path | None, tell: Callable[[str], None] = lambda _message: None):
        self._store = Store(file, tell)

    @property
    def is_kept(self) -> bool:
        """Whether progress outlives the process; False after a problem was reported."""
        return self._store.is_kept

    def close(self) -> None:
        self._store.close()

    def record(self, level: str) -> LevelRecord:
        level = _storable(level)

        def look(connection: sqlite3.Connection) -> LevelRecord:
            begun, won, hints, versions, ticks, rules, distance = connection.execute(
                _RECORD, (level,)
            ).fetchone()
            wins, starts = connection.execute(_MOST_WINS, (level,)).fetchone() or (None, 0)
            reached = {
                goal for (goals,) in connection.execute(_GOALS, (level,)) for goal in _split(goals)
            }
            bests = Bests(ticks, rules, distance, wins, starts, tuple(sorted(reached)))
            state: State = "won" if won else "in work" if begun else "new"
            return LevelRecord(state, hints or 0, bests, versions)

        return self._store.read(look)

    def levels(self) -> list[str]:
        rows = self._store.read(
            lambda connection: connection.execute("SELECT name FROM level ORDER BY name").fetchall()
        )
        return [name for (name,) in rows]

    def begin(self, level: str) -> None:
        level = _storable(level)
        self._store.write(lambda connection: _begin(connection, level))

    def reveal(self, level: str, hints: int) -> None:
        """Record the number of revealed hints of a level; they are never hidden again."""
        level = _storable(level)

        def note(connection: sqlite3.Connection) -> None:
            connection.execute("INSERT OR IGNORE INTO level (name) VALUES (?)", (level,))
            connection.execute(
                "UPDATE level SET hints = max(hints, ?) WHERE name = ?", (hints, level)
            )

        self._store.write(note)

    def win(self, level: str, text: str, measures: Measures | None = None) -> None:
        """Record that a program has won a level; unknown measures stay unchanged."""
        level = _storable(level)

        def note(connection: sqlite3.Connection) -> None:
            now = _now()
            _keep(connection, level, text, now)
            connection.execute(
                "UPDATE level SET won = coalesce(won, ?) WHERE name = ?", (now, level)
            )
            connection.execute(
                "UPDATE version SET won = coalesce(won, ?) WHERE level = ? AND digest = ?",
                (now, level, _digest(text)),
            )
            if measures is not None:
                _measure(connection, level, text, measures)

        self._store.write(note)

    def keep(self, level: str, text: str) -> None:
        """Store a version of the player's program; an existing text becomes the newest."""
        level = _storable(level)
        self._store.write(lambda connection: _keep(connection, level, text, _now()))

    def keep_aside(self, level: str, text: str, otherwise: str) -> None:
        """Store a version behind the newest; if there is none, `otherwise` becomes the newest."""
        level = _storable(level)
        newest = self.newest(level)

        def note(connection: sqlite3.Connection) -> None:
            _keep(connection, level, text, _now())
            _keep(connection, level, otherwise if newest is None else newest, _now())

        self._store.write(note)

    def versions(self, level: str) -> list[Version]:
        """Return the versions stored for a level, last used first."""
        level = _storable(level)
        rows = self._store.read(
            lambda connection: connection.execute(
                "SELECT number, text, kept, won, ticks, rules, distance, wins, starts, goals "
                "FROM version WHERE level = ? ORDER BY turn DESC",
                (level,),
            ).fetchall()
        )
        return [_version(row) for row in rows]

    def newest(self, level: str) -> str | None:
        found = self._row(
            "SELECT text FROM version WHERE level = ? ORDER BY turn DESC LIMIT 1", _storable(level)
        )
        return found[0] if found else None

    def measures(self, level: str, text: str) -> Measures | None:
        found = self._row(
            "SELECT ticks, rules, distance, wins, coalesce(starts, 0), goals FROM version "
            "WHERE level = ? AND digest = ? AND ticks NOT NULL",
            _storable(level),
            _digest(text),
        )
        return Measures(*found)._replace(goals=_split(found[-1])) if found else None

    def holds(self, text: str) -> bool:
        return self._row("SELECT 1 FROM version WHERE digest = ?", _digest(text)) is not None

    def fact(self, name: str) -> str | None:
        found = self._row("SELECT value FROM fact WHERE name = ?", name)
        return found[0] if found else None

    def set_fact(self, name: str, value: str) -> None:
        def note(connection: sqlite3.Connection) -> None:
            connection.execute("INSERT OR REPLACE INTO fact VALUES (?, ?)", (name, value))

        self._store.write(note)

    def _row(self, query: str, *values: str) -> Any:
        return self._store.read(lambda connection: connection.execute(query, values).fetchone())


def _begin(connection: sqlite3.Connection, level: str) -> None:
    connection.execute("INSERT OR IGNORE INTO level (name) VALUES (?)", (level,))
    connection.execute(
        "UPDATE level SET begun = ? WHERE name = ? AND begun IS NULL", (_now(), level)
    )


def _keep(connection: sqlite3.Connection, level: str, text: str, now: str) -> None:
    _begin(connection, level)
    connection.execute(_KEEP, (level, _digest(text), _storable(text), now))
    connection.execute(_FORGET, (level, MOST_VERSIONS))


def _measure(connection: sqlite3.Connection, level: str, text: str, found: Measures) -> None:
    connection.execute(
        "UPDATE version SET ticks = ?, rules = ?, distance = ?, goals = ?, "
        "wins = coalesce(?, wins), starts = CASE WHEN ? THEN ? ELSE starts END "
        "WHERE level = ? AND digest = ?",
        (
            found.ticks,
            found.rules,
            found.distance,
            "\n".join(found.goals),
            found.wins,
            found.wins is not None,
            found.starts,
            level,
            _digest(text),
        ),
    )


def _version(row: tuple[Any, ...]) -> Version:
    number, text, kept, won, ticks, rules, distance, wins, starts, goals = row
    measures = None
    if ticks is not None:
        measures = Measures(ticks, rules, distance, wins, starts or 0, _split(goals))
    return Version(number, text, datetime.fromisoformat(kept), won is not None, measures)


def _split(goals: str) -> tuple[str, ...]:
    return tuple(goals.splitlines())


def _now() -> str:
    return datetime.now(UTC).isoformat()


def _storable(text: str) -> str:
    """Return the text with lone surrogates, as in paths, replaced; SQLite can't store them."""
    return text.encode("utf-8", "replace").decode()


def _digest(text: str) -> str:
    import hashlib  # takes time that the first picture needs

    return hashlib.sha256(_storable(text).encode()).hexdigest()
