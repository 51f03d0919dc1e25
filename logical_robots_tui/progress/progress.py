"""A player's progress: states, hints, best results, and earlier versions of programs."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from datetime import UTC, datetime
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
    (SELECT min(size) FROM version WHERE level = ?1),
    (SELECT min(distance) FROM version WHERE level = ?1),
    (SELECT min(rules) FROM version WHERE level = ?1)
FROM level WHERE name = ?1
"""

_MOST_WINS = """
SELECT wins, starts FROM version WHERE level = ? AND wins NOT NULL
ORDER BY 1.0 * wins / starts DESC, starts DESC LIMIT 1
"""

_GOALS = "SELECT DISTINCT goals FROM version WHERE level = ? AND goals <> ''"

_ANSWERS = "SELECT question, query FROM answer WHERE level = ? ORDER BY question"

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
    SELECT number FROM version WHERE level = ?1 AND ticks NOT NULL ORDER BY size LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND ticks NOT NULL ORDER BY distance LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = ?1 AND wins NOT NULL
    ORDER BY 1.0 * wins / starts DESC, starts DESC LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT max(number) FROM version WHERE level = ?1 AND goals <> '' GROUP BY goals))
"""


class Progress(Store):
    """A player's progress by level name, on disk or without a file in memory.

    Methods block, never raise disk errors, and may be called from any thread.
    """

    def record(self, level: str) -> LevelRecord:
        level = _encodable(level)

        def read_record(connection: sqlite3.Connection) -> LevelRecord:
            begun, won, hints, versions, ticks, size, distance, rules = connection.execute(
                _RECORD, (level,)
            ).fetchone()
            wins, starts = connection.execute(_MOST_WINS, (level,)).fetchone() or (None, 0)
            reached_goals = {
                goal for (goals,) in connection.execute(_GOALS, (level,)) for goal in _split(goals)
            }
            bests = Bests(ticks, size, distance, wins, starts, tuple(sorted(reached_goals)), rules)
            state: State = "won" if won else "started" if begun else "new"
            answers = connection.execute(_ANSWERS, (level,)).fetchall()
            return LevelRecord(state, hints or 0, bests, versions, tuple(answers))

        return self.read(read_record)

    def levels(self) -> list[str]:
        rows = self._rows("SELECT name FROM level ORDER BY name")
        return [name for (name,) in rows]

    def begin(self, level: str) -> None:
        self._write_level(_begin, level)

    def reveal(self, level: str, hints: int) -> None:
        """Record the number of revealed hints of a level; they are never hidden again."""
        self._write_level(_reveal, level, hints)

    def answer(self, level: str, question: str, query: str) -> None:
        """Record the query that answers a question of a level."""
        self._write_level(_answer, level, question, query)

    def win(self, level: str, text: str, measures: Measures | None = None) -> None:
        """Record that a program has won a level; unknown measures stay unchanged."""
        self._write_level(_win, level, text, measures)

    def keep(self, level: str, text: str) -> None:
        """Store a version of the player's program; an existing text becomes the newest."""
        self._write_level(_keep, level, text)

    def keep_aside(self, level: str, text: str, otherwise: str) -> None:
        """Store a version behind the newest; if there is none, `otherwise` becomes the newest."""
        newest = self.newest(level)
        self._write_level(_keep, level, text, otherwise if newest is None else newest)

    def versions(self, level: str) -> list[Version]:
        """Return the versions stored for a level, last used first."""
        rows = self._rows(
            "SELECT number, text, kept, won, ticks, size, distance, wins, starts, goals "
            "FROM version WHERE level = ? ORDER BY turn DESC",
            _encodable(level),
        )
        return [_version(row) for row in rows]

    def newest(self, level: str) -> str | None:
        query = "SELECT text FROM version WHERE level = ? ORDER BY turn DESC LIMIT 1"
        return self._value(query, _encodable(level))

    def measures(self, level: str, text: str) -> Measures | None:
        rows = self._rows(
            "SELECT ticks, size, distance, wins, coalesce(starts, 0), goals FROM version "
            "WHERE level = ? AND digest = ? AND ticks NOT NULL",
            _encodable(level),
            _digest(text),
        )
        return Measures(*rows[0])._replace(goals=_split(rows[0][-1])) if rows else None

    def holds(self, text: str) -> bool:
        return bool(self._rows("SELECT 1 FROM version WHERE digest = ? LIMIT 1", _digest(text)))

    def fact(self, name: str) -> str | None:
        return self._value("SELECT value FROM fact WHERE name = ?", name)

    def set_fact(self, name: str, value: str) -> None:
        query = "INSERT OR REPLACE INTO fact VALUES (?, ?)"
        self.write(lambda connection: connection.execute(query, (name, value)))

    def _write_level(self, work: Callable[..., None], level: str, *values: object) -> None:
        self.write(lambda connection: work(connection, _encodable(level), *values))

    def _rows(self, query: str, *values: str) -> list[Any]:
        return self.read(lambda connection: connection.execute(query, values).fetchall())

    def _value(self, query: str, *values: str) -> str | None:
        return next((value for (value,) in self._rows(query, *values)), None)


def _begin(connection: sqlite3.Connection, level: str) -> None:
    connection.execute("INSERT OR IGNORE INTO level (name) VALUES (?)", (level,))
    connection.execute(
        "UPDATE level SET begun = ? WHERE name = ? AND begun IS NULL", (_timestamp(), level)
    )


def _reveal(connection: sqlite3.Connection, level: str, hints: int) -> None:
    connection.execute("INSERT OR IGNORE INTO level (name) VALUES (?)", (level,))
    connection.execute("UPDATE level SET hints = max(hints, ?) WHERE name = ?", (hints, level))


def _answer(connection: sqlite3.Connection, level: str, question: str, query: str) -> None:
    connection.execute(
        "INSERT OR REPLACE INTO answer VALUES (?, ?, ?)",
        (level, _encodable(question), _encodable(query)),
    )


def _win(connection: sqlite3.Connection, level: str, text: str, measures: Measures | None) -> None:
    time = _timestamp()
    _keep(connection, level, text)
    connection.execute("UPDATE level SET won = coalesce(won, ?) WHERE name = ?", (time, level))
    connection.execute(
        "UPDATE version SET won = coalesce(won, ?) WHERE level = ? AND digest = ?",
        (time, level, _digest(text)),
    )
    if measures is not None:
        _measure(connection, level, text, measures)


def _keep(connection: sqlite3.Connection, level: str, *texts: str) -> None:
    for text in texts:
        _begin(connection, level)
        connection.execute(_KEEP, (level, _digest(text), _encodable(text), _timestamp()))
        connection.execute(_FORGET, (level, MOST_VERSIONS))


def _measure(connection: sqlite3.Connection, level: str, text: str, measures: Measures) -> None:
    key = level, _digest(text)
    (stored_goals,) = connection.execute(
        "SELECT goals FROM version WHERE level = ? AND digest = ?", key
    ).fetchone()
    connection.execute(
        "UPDATE version SET ticks = ?, size = ?, distance = ?, goals = ?, "
        "wins = coalesce(?, wins), starts = CASE WHEN ? THEN ? ELSE starts END "
        "WHERE level = ? AND digest = ?",
        (
            measures.ticks,
            measures.size,
            measures.distance,
            "\n".join(dict.fromkeys((*_split(stored_goals), *measures.goals))),
            measures.wins,
            measures.wins is not None,
            measures.starts,
            *key,
        ),
    )


def _version(row: tuple[Any, ...]) -> Version:
    number, text, last_use, won, ticks, size, distance, wins, starts, goals = row
    measures = None
    if ticks is not None:
        measures = Measures(ticks, size, distance, wins, starts or 0, _split(goals))
    return Version(number, text, datetime.fromisoformat(last_use), won is not None, measures)


def _split(goals: str) -> tuple[str, ...]:
    return tuple(goals.splitlines())


def _timestamp() -> str:
    return datetime.now(UTC).isoformat()


def _encodable(text: str) -> str:
    """Return the text with lone surrogates, as in paths, replaced; SQLite can't store them."""
    return text.encode("utf-8", "replace").decode()


def _digest(text: str) -> str:
    import hashlib  # takes time that the first picture needs

    return hashlib.sha256(_encodable(text).encode()).hexdigest()
