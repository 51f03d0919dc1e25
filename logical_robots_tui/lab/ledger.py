"""The ledger: the result of each run, recorded once, in one SQLite file with one writer."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, time
from typing import NamedTuple, TypeAlias

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.running import Result

ATTEMPTS = 3
"""Attempts after which a run that could not be finished counts as `infrastructure`."""

_VERSION = 1
_SYNC_SECONDS = 3.0  # after which records are forced onto the disk
_SCHEMA = """
CREATE TABLE results(
    job TEXT NOT NULL, engine TEXT NOT NULL, run TEXT NOT NULL UNIQUE, outcome TEXT NOT NULL,
    result TEXT NOT NULL, PRIMARY KEY(job, engine)
);
CREATE TABLE times(
    run TEXT NOT NULL, seconds REAL NOT NULL, worker TEXT NOT NULL, at REAL NOT NULL
);
CREATE TABLE failures(
    job TEXT NOT NULL, engine TEXT NOT NULL, reason TEXT NOT NULL, worker TEXT NOT NULL,
    at REAL NOT NULL
);
CREATE TABLE differences(run TEXT NOT NULL, first TEXT NOT NULL, second TEXT NOT NULL);
"""


class LedgerError(InputError):
    title = "The ledger can't be used"


class Entry(NamedTuple):
    """A run that was done; `job` leaves out the engine, `run` includes it."""

    job: str
    run: str
    result: str
    seconds: float
    worker: str


Results: TypeAlias = "dict[str, Result]"
"""Results by job."""


class Ledger:
    """The results of runs by content of what was run, written by one process.

    The results of one engine count, or of all if `mixed`. Raises LedgerError for a damaged or
    newer file, or results of another engine.
    """

    def __init__(self, file: Path, engine: str, *, mixed: bool = False) -> None:
        self._file, self._engine, self._mixed = file, engine, mixed
        self._synced_at = monotonic()
        with self._in_words():
            self._db = sqlite3.connect(file, isolation_level=None)
            try:
                self._open()
            except BaseException:
                self._db.close()
                raise

    def _open(self) -> None:
        version = self._db.execute("PRAGMA user_version").fetchone()[0]
        if version > _VERSION:
            hint = "Use the version of Logical Robots that wrote it, or another folder."
            raise LedgerError("a newer version wrote this ledger", place=str(self._file), hint=hint)
        self._db.executescript("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;")
        if version == 0:
            self._db.executescript(f"BEGIN; {_SCHEMA} PRAGMA user_version = {_VERSION}; COMMIT;")
        kinds = self._db.execute("SELECT DISTINCT type FROM sqlite_schema").fetchall()
        if not {kind for (kind,) in kinds} <= {"table", "index"}:
            raise LedgerError("it is damaged (it is no ledger)", place=str(self._file))
        found = self._db.execute("SELECT DISTINCT engine FROM results").fetchall()
        if not self._mixed and any(engine != self._engine for (engine,) in found):
            message = "its results are from another version of Logical Robots, Python or SQLite"
            hint = "Take another folder, or keep them beside new ones with --mixed."
            raise LedgerError(message, place=str(self._file), hint=hint)

    def outcomes(self) -> dict[str, str]:
        with self._in_words():
            return dict(self._db.execute(f"SELECT job, outcome {self._counting()}"))

    def results(self) -> Results:
        with self._in_words():
            found = self._db.execute(f"SELECT job, result {self._counting()}").fetchall()
        read = msgspec.json.Decoder(Result).decode
        try:
            return {job: read(result) for job, result in found}
        except (msgspec.DecodeError, RecursionError, TypeError, ValueError) as error:
            raise LedgerError("a result in it is damaged", place=str(self._file)) from error

    def engines(self) -> Mapping[str, str]:
        with self._in_words():
            return dict(self._db.execute(f"SELECT job, engine {self._counting()}"))

    def _counting(self) -> str:
        quoted = "'" + self._engine + "'"
        which = "" if self._mixed else f"WHERE engine = {quoted}"
        return f"FROM results {which} ORDER BY engine = {quoted}, engine"

    def record(self, entries: Iterable[Entry]) -> dict[str, str]:
        """Record runs in one transaction; return outcomes by job. An earlier result is kept.

        A differing second result is noted. A power failure may lose a few seconds of records, so
        that these needn't wait for the disk.
        """
        outcomes = {}
        with self._in_words(), self._transaction():
            for entry in entries:
                outcome = outcomes[entry.job] = msgspec.json.decode(entry.result)["outcome"]
                values = (entry.job, self._engine, entry.run, outcome, entry.result)
                sql = "INSERT INTO results VALUES (?, ?, ?, ?, ?) ON CONFLICT DO NOTHING"
                if not self._db.execute(sql, values).rowcount:
                    sql = "SELECT result, outcome FROM results WHERE run = ?"
                    first, outcome = self._db.execute(sql, (entry.run,)).fetchone()
                    outcomes[entry.job] = outcome
                    if first != entry.result:
                        sql = "INSERT INTO differences VALUES (?, ?, ?)"
                        self._db.execute(sql, (entry.run, first, entry.result))
                sql = "INSERT INTO times VALUES (?, ?, ?, ?)"
                self._db.execute(sql, (entry.run, entry.seconds, entry.worker, time()))
        if monotonic() > self._synced_at + _SYNC_SECONDS:
            with self._in_words():
                self._db.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchall()
            self._synced_at = monotonic()
        return outcomes

    def fail(self, job: str, reason: str, worker: str) -> None:
        """Record a failed attempt at a run that the run did not cause."""
        with self._in_words(), self._transaction():
            values = (job, self._engine, reason, worker, time())
            self._db.execute("INSERT INTO failures VALUES (?, ?, ?, ?, ?)", values)

    def failures(self) -> dict[str, list[str]]:
        sql = """SELECT job, reason FROM failures WHERE engine = ?1 AND job NOT IN
            (SELECT job FROM results WHERE engine = ?1) ORDER BY rowid"""
        found: dict[str, list[str]] = {}
        with self._in_words():
            for job, reason in self._db.execute(sql, (self._engine,)):
                found.setdefault(job, []).append(reason)
        return found

    def forget_failures(self) -> None:
        with self._in_words(), self._transaction():
            self._db.execute("DELETE FROM failures")

    def differences(self) -> list[str]:
        with self._in_words():
            found = self._db.execute("SELECT DISTINCT run FROM differences ORDER BY run")
            return [run for (run,) in found]

    def seconds(self) -> float:
        """Return the processor seconds of all recorded runs together."""
        with self._in_words():
            return float(self._db.execute("SELECT total(seconds) FROM times").fetchone()[0])

    def close(self) -> None:
        self._db.close()

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._db.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._db.execute("COMMIT")
        except BaseException:
            if self._db.in_transaction:
                self._db.execute("ROLLBACK")
            raise

    @contextmanager
    def _in_words(self) -> Iterator[None]:
        """Turn errors of SQLite into LedgerErrors."""
        try:
            yield
        except (sqlite3.Error, UnicodeDecodeError) as error:  # damage in a name it would tell
            said = {
                "SQLITE_FULL": ("the disk is full", "Make room, then resume."),
                "SQLITE_IOERR": ("the disk is full or fails", "Make room, then resume."),
                "SQLITE_READONLY": ("it may not be written", "Take a folder that is yours."),
                "SQLITE_CANTOPEN": ("it can't be opened", "Take another folder."),
                "SQLITE_BUSY": ("another process writes it", "Wait for it to end."),
            }
            name = "_".join(getattr(error, "sqlite_errorname", "").split("_")[:2])
            damaged = "Move it away and start again; nothing else in the folder is lost."
            message, hint = said.get(name, (f"it is damaged ({error})", damaged))
            raise LedgerError(message, place=str(self._file), hint=hint) from error
