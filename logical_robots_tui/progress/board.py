"""The board: results of all players of one server, in one SQLite file that their games share.

The texts of programs are not in it but in a folder for each player, so that a game can be kept from
those of others.
"""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Callable
from contextlib import closing, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import PLAYER_NAME, is_there, read_ordinary
from logical_robots_tui.progress.store import (
    BUSY_SECONDS,
    DAMAGE_CODES,
    REASONS,
    DamagedStoreError,
    Measures,
    NewerError,
    Schema,
    error_code,
    prepare,
    program_digest,
)

FILE_NAME = "board.sqlite"
PROGRAMS = "programs"
_HELP = "help.l"
_MOST_PROGRAM_BYTES = 1_000_000

GONE_AFTER = timedelta(minutes=2)
"""How long after its last report a game counts as ended; it reports once a minute at least."""

MOST_GHOST_BYTES = 1_000_000
"""The largest replay that an entry holds for others to race against."""

SCHEMA = Schema(
    "board",
    0x4C524F43,  # "LROC"
    frozenset(("player", "entry", "activity", "challenger", "match")),
    (
        (
            # name: null if anonymous. shares: whether others may race against the runs.
            """
            CREATE TABLE player (
                player TEXT PRIMARY KEY,
                name TEXT UNIQUE COLLATE NOCASE,
                is_listed INTEGER NOT NULL,
                shares INTEGER NOT NULL
            ) WITHOUT ROWID, STRICT
            """,
            # engine and program are digests. confirmed: the engine that played it again.
            # struck: why it does not count. ghost: a replay without programs.
            """
            CREATE TABLE entry (
                number INTEGER PRIMARY KEY,
                level TEXT NOT NULL,
                level_digest TEXT NOT NULL,
                player TEXT NOT NULL,
                program TEXT NOT NULL,
                engine TEXT NOT NULL,
                ticks INTEGER NOT NULL,
                size INTEGER NOT NULL,
                distance REAL NOT NULL,
                won TEXT NOT NULL,
                confirmed TEXT,
                struck TEXT,
                ghost BLOB,
                UNIQUE (level_digest, player, program)
            ) STRICT
            """,
            # runs: since the last victory or opening. help_since: when help was asked for.
            """
            CREATE TABLE activity (
                player TEXT PRIMARY KEY,
                level TEXT NOT NULL DEFAULT '',
                since TEXT NOT NULL DEFAULT '',
                last_seen TEXT NOT NULL,
                is_open INTEGER NOT NULL DEFAULT 1,
                runs INTEGER NOT NULL DEFAULT 0,
                won_level TEXT,
                won TEXT,
                trouble TEXT NOT NULL DEFAULT '',
                help_since TEXT
            ) WITHOUT ROWID, STRICT
            """,
            # The ladder of an arena. program: digest of what was handed in last; played: of what
            # the numbers are of, null before the first match. problem: why it does not play.
            """
            CREATE TABLE challenger (
                arena TEXT NOT NULL,
                player TEXT NOT NULL,
                program TEXT NOT NULL,
                played TEXT,
                rank TEXT NOT NULL DEFAULT '',
                share REAL NOT NULL DEFAULT 0,
                low REAL NOT NULL DEFAULT 0,
                high REAL NOT NULL DEFAULT 0,
                strength REAL NOT NULL DEFAULT 0,
                problem TEXT NOT NULL DEFAULT '',
                PRIMARY KEY (arena, player)
            ) WITHOUT ROWID, STRICT
            """,
            # programs: digests of both. replay: without programs.
            """
            CREATE TABLE match (
                arena TEXT NOT NULL,
                upper TEXT NOT NULL,
                lower TEXT NOT NULL,
                programs TEXT NOT NULL,
                replay BLOB NOT NULL,
                PRIMARY KEY (arena, upper, lower)
            ) STRICT
            """,
        ),
    ),
)

_ADD = """
INSERT INTO entry (level, level_digest, player, program, engine, ticks, size, distance, won, ghost)
VALUES (:level, :level_digest, :player, :program, :engine, :ticks, :size, :distance, :now, :ghost)
ON CONFLICT (level_digest, player, program) DO UPDATE SET
    engine = excluded.engine, ticks = excluded.ticks, distance = excluded.distance,
    ghost = coalesce(excluded.ghost, ghost), struck = NULL,
    confirmed = CASE WHEN struck IS NULL AND engine = excluded.engine THEN confirmed END
"""

_BESTS = " UNION ".join(
    f"""
    SELECT * FROM (
        SELECT number FROM entry
        WHERE level_digest = :level_digest AND player = :player AND struck IS NULL
        ORDER BY {measure}, number LIMIT 1
    )
    """  # noqa: S608 - ours
    for measure in ("ticks", "size", "distance")
)

_FORGET = f"""
DELETE FROM entry
WHERE level_digest = :level_digest AND player = :player AND number NOT IN ({_BESTS})
"""  # noqa: S608 - ours

_STANDINGS = """
SELECT name, player = :player, min(ticks), min(size), min(distance)
FROM entry JOIN player USING (player)
WHERE level_digest = :level_digest AND struck IS NULL
GROUP BY player ORDER BY 3, 4, 5
"""


ANONYMOUS = "anonymous"


def shown_name(name: str | None) -> str:
    return ANONYMOUS if name is None else name


class BoardMembership(NamedTuple):
    """How a player is on the board: `name` is None for anonymous; others may race who shares."""

    is_listed: bool
    name: str | None = None
    shares: bool = False


class BoardStanding(NamedTuple):
    """The best of each measure that one player has in a level."""

    name: str | None
    is_me: bool
    ticks: int
    size: int
    distance: float


class BoardEntry(NamedTuple):
    """A victory; `level_digest`, `program` and `engine` say with what it can be played again."""

    number: int
    level: str
    level_digest: str
    player: str
    name: str | None
    program: str
    engine: str
    ticks: int
    size: int
    distance: float
    won: str
    confirmed: str | None
    struck: str | None


class GhostEntry(NamedTuple):
    """An entry that may be raced against."""

    number: int
    name: str | None
    ticks: int
    size: int


class Activity(NamedTuple):
    """What a player of a class does; times are ISO 8601 in UTC.

    `is_open` is whether the game is, as far as it reports. `runs` are those since the last victory,
    or since the level was opened; `trouble` is what went wrong in the last one.
    """

    player: str
    level: str
    since: str
    last_seen: str
    is_open: bool
    runs: int
    won_level: str | None
    won: str | None
    trouble: str
    help_since: str | None

    @property
    def asks_for_help(self) -> bool:
        return self.is_open and self.help_since is not None


class MissingProgramError(InputError):
    """The program of an entry is gone, or another one."""


T = TypeVar("T")


class Board:
    """The board in a folder, for one player's game, or without a player to read and check it.

    Methods block, may be called from any thread, and raise InputError, a sentence, if the board
    can't be used.
    """

    def __init__(self, folder: Path, player: str = "") -> None:
        self.file = folder / FILE_NAME
        self.player = player
        self._programs = folder / PROGRAMS
        self._has_sound_pages = False

    @property
    def places(self) -> tuple[Path, Path]:
        """What a game with a player needs: the database, and the folder of their programs."""
        return self.file, self._programs / self.player

    def create(self) -> None:
        """Make what is missing: the file, for whom the folder is, and the player's own folder."""
        try:
            folder = self.file.parent
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if self.player:
                self._programs.mkdir(exist_ok=True)
                self.places[1].mkdir(mode=0o700, exist_ok=True)
            with suppress(FileExistsError):
                handle = os.open(self.file, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC)
                os.fchmod(handle, folder.stat().st_mode & 0o666)
                os.close(handle)
        except OSError as error:
            raise self._unusable(error.strerror or str(error)) from error
        self._run(lambda _: None)

    def membership(self) -> BoardMembership | None:
        """Return what the player has chosen, or None before that."""
        query = "SELECT is_listed, name, shares FROM player WHERE player = :player"
        rows = self.rows(query)
        return BoardMembership(bool(rows[0][0]), rows[0][1], bool(rows[0][2])) if rows else None

    def join(self, membership: BoardMembership) -> None:
        """Put the player on the board, change how, or take them and their entries off it.

        Raises InputError if another player has the name.
        """
        values = membership._asdict() | {"player": self.player}

        def write(connection: sqlite3.Connection) -> None:
            connection.execute(
                "INSERT OR REPLACE INTO player VALUES (:player, NULL, :is_listed, :shares)", values
            )
            try:
                connection.execute("UPDATE player SET name = :name WHERE player = :player", values)
            except sqlite3.IntegrityError:
                hint = "Choose another one."
                raise InputError(
                    f"Another player is called {membership.name}.", hint=hint
                ) from None
            if not membership.shares:
                connection.execute("UPDATE entry SET ghost = NULL WHERE player = :player", values)
            if not membership.is_listed:
                connection.execute("DELETE FROM entry WHERE player = :player", values)
                connection.execute("DELETE FROM challenger WHERE player = :player", values)
                connection.execute("DELETE FROM match WHERE :player IN (upper, lower)", values)

        self.write(write, self._remove_programs)

    def add(
        self,
        level: str,
        level_digest: str,
        engine: str,
        text: str,
        measures: Measures,
        ghost: bytes | None = None,
    ) -> None:
        """Enter a victory of the player; of earlier ones in the level only the bests are kept."""
        program = program_digest(text)
        values = {
            "level": level,
            "level_digest": level_digest,
            "player": self.player,
            "program": program,
            "engine": engine,
            "ticks": measures.ticks,
            "size": measures.size,
            "distance": measures.distance,
            "now": timestamp(),
            "ghost": ghost if ghost is not None and len(ghost) <= MOST_GHOST_BYTES else None,
        }

        def write(connection: sqlite3.Connection) -> None:
            self.save_program(f"{program}.l", text)
            connection.execute(_ADD, values)
            connection.execute(_FORGET, values)

        self.write(write, self._remove_programs)

    def standings(self, level_digest: str) -> list[BoardStanding]:
        """Return the bests of all who won a level, the fewest ticks first."""
        rows = self.rows(_STANDINGS, level_digest=level_digest)
        return [BoardStanding(name, bool(is_me), *bests) for name, is_me, *bests in rows]

    def ghosts(self, level_digest: str) -> list[GhostEntry]:
        """Return the entries of others that the player may race, the fewest ticks first."""
        rows = self.rows(
            "SELECT number, name, ticks, size FROM entry JOIN player USING (player) "
            "WHERE level_digest = :level_digest AND ghost NOT NULL AND struck IS NULL "
            "AND player != :player ORDER BY ticks, number",
            level_digest=level_digest,
        )
        return [GhostEntry(*row) for row in rows]

    def ghost(self, number: int) -> bytes | None:
        """Return the replay of an entry, or None if it is no longer there."""
        query = "SELECT ghost FROM entry WHERE number = :number AND length(ghost) <= :most"
        rows = self.rows(query, number=number, most=MOST_GHOST_BYTES)
        return rows[0][0] if rows else None

    def entries(self) -> list[BoardEntry]:
        rows = self.rows(
            "SELECT number, level, level_digest, player, name, program, engine, ticks, size, "
            "distance, won, confirmed, struck FROM entry JOIN player USING (player) "
            "ORDER BY level, level_digest, ticks, number"
        )
        return [BoardEntry(*row) for row in rows]

    def judge(self, entry: BoardEntry, engine: str, struck: str | None) -> None:
        """Record that an entry was played again: it holds, or why it is struck out."""
        values = {**entry._asdict(), "engine": engine, "struck": struck}
        statement = """
            UPDATE entry SET confirmed = :engine, struck = :struck
            WHERE number = :number AND ticks = :ticks AND distance = :distance
        """
        self.write(lambda connection: connection.execute(statement, values))

    def program(self, player: str, digest: str) -> str:
        """Return a program of a player; raise MissingProgramError if it is gone or another one."""
        try:
            text = self._read_program(player, f"{digest}.l")
        except OSError as error:
            raise self._unusable(error.strerror or str(error)) from error
        if text is None or program_digest(text) != digest:
            raise MissingProgramError("The program is missing, or was changed")
        return text

    def report(self, **values: object) -> None:
        """Record what the player does: columns of `Activity`; others keep what they have."""
        names = ["player", "last_seen", *values]
        columns, parameters = ", ".join(names), ", ".join(f":{name}" for name in names)
        changes = ", ".join(f"{name} = excluded.{name}" for name in names)
        statement = f"""
            INSERT INTO activity ({columns}) VALUES ({parameters})
            ON CONFLICT (player) DO UPDATE SET {changes}
        """  # noqa: S608 - names of columns
        row = {"player": self.player, "last_seen": timestamp(), **values}
        self.write(lambda connection: connection.execute(statement, row))

    def activities(self) -> list[Activity]:
        """Return what all players do: who asks for help first, then by name, who is gone last."""
        columns = ", ".join(Activity._fields)
        earliest = timestamp(-GONE_AFTER)
        rows = [Activity(*row) for row in self.rows(f"SELECT {columns} FROM activity")]  # noqa: S608 - ours
        rows = [
            row._replace(is_open=bool(row.is_open) and row.last_seen >= earliest) for row in rows
        ]

        def order(row: Activity) -> tuple[bool, bool, str, str]:
            help_since = (row.asks_for_help and row.help_since) or ""
            return not row.asks_for_help, not row.is_open, help_since, row.player

        return sorted(rows, key=order)

    def show_program(self, text: str | None) -> None:
        """Let the teacher see the player's program, or no longer."""
        if text is None:
            with suppress(OSError):
                (self.places[1] / _HELP).unlink()
        else:
            self.save_program(_HELP, text)

    def shown_program(self, player: str) -> str | None:
        """Return the program of a player who asked for help."""
        try:
            return self._read_program(player, _HELP)
        except OSError:
            return None

    def _read_program(self, player: str, name: str) -> str | None:
        if not PLAYER_NAME.fullmatch(player):
            return None
        try:
            path = self._programs / player / name
            return read_ordinary(path, _MOST_PROGRAM_BYTES).decode("utf-8", "replace")
        except FileNotFoundError:
            return None

    def save_program(self, name: str, text: str) -> None:
        path = self.places[1] / name
        temporary = path.with_name(f"{path.name}.{os.getpid()}")
        try:
            temporary.write_text(text, "utf-8", "replace")
            temporary.replace(path)
        except OSError as error:
            raise self._unusable(error.strerror or str(error)) from error

    def _remove_programs(self, connection: sqlite3.Connection) -> None:
        """Remove the texts without entries; in a transaction, as another game may be adding one."""
        query = """
            SELECT program FROM entry WHERE player = :player
            UNION SELECT program FROM challenger WHERE player = :player
        """
        names = {
            f"{program}.l" for (program,) in connection.execute(query, {"player": self.player})
        }
        with suppress(OSError):
            for path in self.places[1].glob("*.l"):
                if path.name not in names | {_HELP}:
                    path.unlink()

    def rows(self, query: str, **values: object) -> list[Any]:
        parameters = {"player": self.player, **values}
        return self._run(lambda connection: connection.execute(query, parameters).fetchall())

    def write(self, *works: Callable[[sqlite3.Connection], object]) -> None:
        """Do each work in a transaction of its own."""

        def write_all(connection: sqlite3.Connection) -> None:
            for work in works:
                with connection:
                    connection.execute("BEGIN IMMEDIATE")
                    work(connection)

        self._run(write_all)

    def _run(self, work: Callable[[sqlite3.Connection], T]) -> T:
        deadline = time.monotonic() + BUSY_SECONDS
        while True:
            try:
                with closing(self._connect()) as connection:
                    return work(connection)
            except (DamagedStoreError, NewerError) as error:
                reason = str(error) or "a newer version of the game wrote it"
                raise self._unusable(reason) from error
            except sqlite3.Error as error:
                code = error_code(error)
                # Opening and closing a write-ahead log does not wait for other games.
                if code == sqlite3.SQLITE_BUSY and time.monotonic() < deadline:
                    time.sleep(0.01)
                    continue
                if code in DAMAGE_CODES:
                    reason = "it is damaged"
                elif is_there(self.file):
                    reason = REASONS.get(code, str(error))
                else:
                    reason = "it is missing"
                raise self._unusable(reason) from error

    def _connect(self) -> sqlite3.Connection:
        uri = f"{self.file.absolute().as_uri()}?mode=rw"
        connection = sqlite3.connect(uri, timeout=BUSY_SECONDS, isolation_level=None, uri=True)
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            prepare(connection, SCHEMA, checks_pages=not self._has_sound_pages)
            self._has_sound_pages = True
        except BaseException:
            connection.close()
            raise
        return connection

    def _unusable(self, reason: str) -> InputError:
        return InputError(f"can't be used: {reason}", place=f"The board {self.file}")


def timestamp(shift: timedelta = timedelta()) -> str:
    """Return the time in UTC, in seconds; `shift` makes it an earlier or a later one."""
    return (datetime.now(UTC) + shift).isoformat(timespec="seconds")
