"""A player's progress: states, hints, best results, and earlier versions of programs."""

from __future__ import annotations

import sqlite3
from datetime import UTC, datetime
from typing import Any

from logical_robots_tui.progress.store import (
    Bests,
    LevelRecord,
    Measures,
    State,
    Store,
    Version,
    program_digest,
)

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

_BEGIN = """
INSERT INTO level (name, begun) VALUES (:level, :time)
ON CONFLICT (name) DO UPDATE SET begun = coalesce(begun, excluded.begun)
"""

_REVEAL = """
INSERT INTO level (name, hints) VALUES (:level, :hints)
ON CONFLICT (name) DO UPDATE SET hints = max(hints, excluded.hints)
"""

_KEEP = """
INSERT INTO version (level, digest, text, turn, kept)
VALUES (:level, :digest, :text, (SELECT coalesce(max(turn), 0) + 1 FROM version), :time)
ON CONFLICT (level, digest) DO UPDATE SET turn = excluded.turn, kept = excluded.kept
"""

_FORGET = """
DELETE FROM version WHERE level = :level AND number NOT IN (
    SELECT number FROM version WHERE level = :level ORDER BY turn DESC LIMIT :most
) AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = :level AND ticks NOT NULL ORDER BY ticks LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = :level AND ticks NOT NULL ORDER BY size LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = :level AND ticks NOT NULL ORDER BY distance LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT number FROM version WHERE level = :level AND wins NOT NULL
    ORDER BY 1.0 * wins / starts DESC, starts DESC LIMIT 1))
AND number NOT IN (SELECT * FROM (
    SELECT max(number) FROM version WHERE level = :level AND goals <> '' GROUP BY goals))
"""

_WIN = (
    "UPDATE level SET won = coalesce(won, :time) WHERE name = :level",
    "UPDATE version SET won = coalesce(won, :time) WHERE level = :level AND digest = :digest",
)

_MEASURE = """
UPDATE version SET ticks = :ticks, size = :size, distance = :distance, goals = :goals,
    wins = coalesce(:wins, wins), starts = CASE WHEN :wins NOT NULL THEN :starts ELSE starts END
WHERE level = :level AND digest = :digest
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
        self._run(level, _BEGIN)

    def reveal(self, level: str, hints: int) -> None:
        """Record the number of revealed hints of a level; they are never hidden again."""
        self._run(level, _REVEAL, hints=hints)

    def answer(self, level: str, question: str, query: str) -> None:
        """Record the query that answers a question of a level."""
        statement = "INSERT OR REPLACE INTO answer VALUES (:level, :question, :query)"
        self._run(level, statement, question=_encodable(question), query=_encodable(query))

    def win(self, level: str, text: str, measures: Measures | None = None) -> None:
        """Record that a program has won a level; unknown measures stay unchanged."""
        level = _encodable(level)

        def write_victory(connection: sqlite3.Connection) -> None:
            _keep(connection, level, text)
            key = {"level": level, "digest": program_digest(text)}
            for statement in _WIN:
                connection.execute(statement, {**key, "time": _timestamp()})
            if measures is not None:
                (stored_goals,) = connection.execute(
                    "SELECT goals FROM version WHERE level = :level AND digest = :digest", key
                ).fetchone()
                goals = dict.fromkeys((*_split(stored_goals), *measures.goals))
                values = {**measures._asdict(), **key, "goals": "\n".join(goals)}
                connection.execute(_MEASURE, values)

        self.write(write_victory)

    def keep(self, level: str, *texts: str) -> None:
        """Store versions of the player's program, the last as the newest."""
        level = _encodable(level)
        self.write(lambda connection: _keep(connection, level, *texts))

    def keep_aside(self, level: str, text: str, otherwise: str) -> None:
        """Store a version behind the newest; if there is none, `otherwise` becomes the newest."""
        newest = self.newest(level)
        self.keep(level, text, otherwise if newest is None else newest)

    def versions(self, level: str) -> list[Version]:
        """Return the versions stored for a level, last used first."""
        rows = self._rows(
            "SELECT number, text, kept, won, ticks, size, distance, wins, starts, goals "
            "FROM version WHERE level = ? ORDER BY turn DESC",
            _encodable(level),
        )
        return [
            Version(
                number, text, datetime.fromisoformat(last_use), won is not None, _measures(*row)
            )
            for number, text, last_use, won, *row in rows
        ]

    def newest(self, level: str) -> str | None:
        query = "SELECT text FROM version WHERE level = ? ORDER BY turn DESC LIMIT 1"
        return self._value(query, _encodable(level))

    def measures(self, level: str, text: str) -> Measures | None:
        rows = self._rows(
            "SELECT ticks, size, distance, wins, starts, goals FROM version "
            "WHERE level = ? AND digest = ?",
            _encodable(level),
            program_digest(text),
        )
        return _measures(*rows[0]) if rows else None

    def holds(self, text: str) -> bool:
        return bool(
            self._rows("SELECT 1 FROM version WHERE digest = ? LIMIT 1", program_digest(text))
        )

    def fact(self, name: str) -> str | None:
        return self._value("SELECT value FROM fact WHERE name = ?", name)

    def set_fact(self, name: str, value: str) -> None:
        query = "INSERT OR REPLACE INTO fact VALUES (?, ?)"
        self.write(lambda connection: connection.execute(query, (name, value)))

    def _run(self, level: str, statement: str, **values: object) -> None:
        parameters = {"level": _encodable(level), "time": _timestamp(), **values}
        self.write(lambda connection: connection.execute(statement, parameters))

    def _rows(self, query: str, *values: str) -> list[Any]:
        return self.read(lambda connection: connection.execute(query, values).fetchall())

    def _value(self, query: str, *values: str) -> str | None:
        return next((value for (value,) in self._rows(query, *values)), None)


def _keep(connection: sqlite3.Connection, level: str, *texts: str) -> None:
    for text in texts:
        values = {
            "level": level,
            "digest": program_digest(text),
            "text": _encodable(text),
            "time": _timestamp(),
            "most": MOST_VERSIONS,
        }
        for statement in (_BEGIN, _KEEP, _FORGET):
            connection.execute(statement, values)


def _measures(
    ticks: int | None, size: int, distance: float, wins: int | None, starts: int | None, goals: str
) -> Measures | None:
    if ticks is None:
        return None
    return Measures(ticks, size, distance, wins, starts or 0, _split(goals))


def _split(goals: str) -> tuple[str, ...]:
    return tuple(goals.splitlines())


def _timestamp() -> str:
    return datetime.now(UTC).isoformat()


def _encodable(text: str) -> str:
    """Return the text with lone surrogates, as in paths, replaced; SQLite can't store them."""
    return text.encode("utf-8", "replace").decode()
