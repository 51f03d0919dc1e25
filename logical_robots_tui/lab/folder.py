"""The folder of a sweep, grading or tournament: manifest, inputs by content, ledger, lock."""

from __future__ import annotations

import fcntl
import hashlib
import os
import re
import sqlite3
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from datetime import timedelta
from errno import ENOSPC
from itertools import count
from pathlib import Path
from time import monotonic, time
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.lab.platforms.gradebooks import Gradebook
from logical_robots_tui.lab.tasks import QueryMeasure, Result, engine, fingerprint
from logical_robots_tui.paths import read_ordinary, write_atomically
from logical_robots_tui.wording import count_of
from logical_robots_tui.world.levels.load import NATIVE, WEB, is_of_web

_FORMAT = 1
_MOST_BYTES = 64_000_000  # of a manifest
_MOST_NESTED = 5_000_000  # brackets and commas of one, whose objects take far more than their text

_UNREADABLE = (msgspec.MsgspecError, AttributeError, RecursionError, TypeError, ValueError)
_LONGEST_STEM = 60
_NESTING = (b"[", b"{", b",")

MEASURES: dict[str, Callable[[Result], float | None]] = {
    "won": lambda result: result.outcome == "won",
    "ticks": lambda result: result.ticks if result.outcome == "won" else None,
    "distance": lambda result: result.distance,
    "size": lambda result: result.size or None,
    "steps": lambda result: result.steps and result.steps / result.ticks,
    "home": lambda result: result.home,
    "time_home": lambda result: result.time_home,
    "rules": lambda result: result.rules or None,  # in folders of earlier versions
}
"""Measures of a run that need no query."""

BUILT_IN = tuple(MEASURES)[:4]
"""Those of sweeps that choose none."""

Digest: TypeAlias = Annotated[str, msgspec.Meta(pattern="^([0-9a-f]{64})?$")]
Ticks: TypeAlias = Annotated[int, msgspec.Meta(ge=0, le=10**9)]
Starts: TypeAlias = Annotated[int, msgspec.Meta(ge=0, le=10_000)]
Measure: TypeAlias = Annotated[str, msgspec.Meta(pattern=f"^({'|'.join(MEASURES)})$")]
Index: TypeAlias = Annotated[int, msgspec.Meta(ge=0)]
FileName: TypeAlias = Annotated[str, msgspec.Meta(pattern=r"^\w[\w.+-]{0,99}$")]


class Cell(msgspec.Struct, frozen=True, omit_defaults=True):
    """One program in one level, from all its starts; texts are named by their digests.

    `program` is the first of several that are the same but for space and comments, `own` the
    student's; a match has "" and, in the order of the teams, `parts`. `settings` are the values
    of what is varied, by name; in a match the players by team, who play every start, or between
    equal seats only the even or the odd ones: `parity` is 0 or 1.
    """

    level: Digest
    program: Digest
    level_name: str
    program_name: str
    ticks: Ticks
    settings: dict[str, bool | int | float | str] = {}
    student: str = ""
    own: Digest = ""
    parts: tuple[Digest, ...] = ()
    parity: Literal[0, 1] | None = None


class Student(msgspec.Struct, frozen=True, omit_defaults=True):
    """A student, or anybody who submitted something; the id is then the submission's name.

    `late_by` are seconds, 0 if that is not known; `grace_days` after the deadline cost nothing.
    `added` are points given by hand, with reasons. `is_unclear` says that something was handed in
    which may be the program of a level without one.
    """

    id: str
    name: str = ""
    submission: str = ""
    late: bool = False
    remarks: tuple[str, ...] = ()
    late_by: float = 0.0
    added: tuple[tuple[float, str], ...] = ()
    grace_days: int = 0
    group: str = ""
    is_unclear: bool = False

    @property
    def lateness(self) -> str:
        lag = timedelta(seconds=round(self.late_by))
        minutes, seconds = divmod(lag.seconds, 60)
        units = {"day": lag.days, "hour": minutes // 60, "minute": minutes % 60, "second": seconds}
        largest = [count_of(number, unit) for unit, number in units.items() if number][:2]
        return " ".join([*largest, "late"]) if self.late or largest else ""

    @property
    def label(self) -> str:
        return f"{self.name} ({self.id})" if self.name not in ("", self.id) else self.id


class TournamentPlayer(msgspec.Struct, frozen=True, omit_defaults=True):
    """A player of a tournament; `lost` is why all matches are lost without being played."""

    name: str
    program: Digest = ""
    lost: str = ""


class Manifest(msgspec.Struct, frozen=True, omit_defaults=True):
    """Everything that is needed to repeat the work, beside the inputs.

    There are `starts` varied starts, if `given_first` for programs that win from the given one.
    The first of them is `first_start`. A think has `steps` at most, a run `run_steps` unless that
    is 0, and `seconds` of a processor; it ends when the question `until` holds, unless that is "".
    `rounds` are pairs of players by index, for each round of a tournament that is known so far.
    `strays` are files that nobody handed in, `notes` what is to be said of the roster and other
    tables, `gradebook` how the roster is filled in, if it is one; `files` are the names of the
    inputs' files by digest.
    """

    kind: Literal["sweep", "grade", "tournament"]
    title: str
    specification: str
    starts: Starts
    given_first: bool
    measures: tuple[Measure, ...]
    asked: tuple[QueryMeasure, ...]
    steps: int
    seconds: float
    cells: tuple[Cell, ...]
    students: tuple[Student, ...] = ()
    assignment: dict[str, Any] = {}
    players: tuple[TournamentPlayer, ...] = ()
    teams: tuple[str, ...] = ()
    match: Cell = Cell("", "", "", "", 0)
    rounds: tuple[tuple[tuple[Index, Index], ...], ...] = ()
    most_rounds: Index = 1
    strays: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    gradebook: Gradebook | None = None
    files: dict[Digest, FileName] = {}
    run_steps: Index = 0
    first_start: Annotated[int, msgspec.Meta(ge=1, le=10**9)] = 1
    until: str = ""
    engine: dict[str, str] = {}
    format: int = _FORMAT

    def starts_of(self, cell: Cell) -> tuple[int, ...]:
        starts = 0, *range(self.first_start, self.first_start + self.starts)
        return tuple(start for start in starts if cell.parity in (None, start % 2))

    def label_of(self, cell: Cell) -> str:
        """Return whose program a cell runs where: ``Ada (1001): ada.l in 01-first-steps``."""
        owner = next((student.label for student in self.students if student.id == cell.student), "")
        return f"{owner}: " * bool(owner) + f"{cell.program_name} in {cell.level_name}"

    def command(self, cell: Cell, start: int) -> str:
        """Return the command that plays a run on the screen, to be typed in the folder."""
        names = (cell.level, *(cell.parts or (cell.program,)))
        files = " ".join(f"inputs/{self.files.get(name, name)}" for name in names)
        return f"logical-robots play {files}" + (f" --start {start}" if start else "")

    def job(self, cell: Cell, start: int) -> str:
        """Return the digest of what a run depends on, except the engine."""
        queries = [(measure.name, measure.query, measure.every) for measure in self.asked]
        program = cell.program or cell.parts
        key = (cell.level, program, start, cell.ticks, queries, self.steps)
        limits = (self.run_steps,) if self.run_steps else ()
        return digest(repr((*key, *limits, self.until) if self.until else (*key, *limits)))

    def run(self, job: str) -> str:
        """Return the identity of a run on this engine."""
        return digest(job + fingerprint())


def digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _files_of(manifest: Manifest, inputs: Mapping[str, str]) -> dict[str, str]:
    """Return names for the files of inputs, after levels, programs, players and students."""
    labels: dict[str, str] = {player.program: player.name for player in manifest.players}
    endings: dict[str, str] = {}
    for cell in (manifest.match, *manifest.cells):
        program = f"{cell.student}-{cell.level_name}" if cell.student else cell.program_name
        for name in filter(None, (cell.own, cell.program)):
            labels.setdefault(name, program.removesuffix(SUFFIX))
        if cell.level not in endings:
            labels.setdefault(cell.level, cell.level_name)
            endings[cell.level] = WEB if is_of_web(inputs.get(cell.level, "")) else NATIVE
    files: dict[str, str] = {}
    used_names: set[str] = {SUFFIX, NATIVE, WEB}
    numbers: defaultdict[str, Iterator[int]] = defaultdict(lambda: count(2))
    for name in filter(labels.__contains__, inputs):
        stem = re.sub(r"[^\w.+-]+", "_", labels[name])[:_LONGEST_STEM].strip("._-+")
        ending = endings.get(name, SUFFIX)
        file = first = stem + ending
        while file.casefold() in used_names:
            file = f"{stem}-{next(numbers[first.casefold()])}".lstrip("-") + ending
        used_names.add(file.casefold())
        files[name] = file
    return files


class Folder:
    def __init__(self, path: Path) -> None:
        self.path = path
        self._files: Mapping[str, str] = {}

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Make and lock the folder; raises InputError if another coordinator has it."""
        try:
            (self.path / "inputs").mkdir(parents=True, exist_ok=True)
            handle = os.open(self.path / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise self._error(f"can't be used: {error.strerror}", "Name another folder.") from error
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                hint = "Wait for it to end, or name another folder."
                raise self._error("Another process is at work in this folder", hint) from None
            yield
        finally:
            fcntl.flock(handle, fcntl.LOCK_UN)  # also for a process that is just starting
            os.close(handle)

    def write(self, manifest: Manifest, inputs: Mapping[str, str]) -> Manifest:
        """Write a manifest and its inputs by digest; return the manifest with engine and files."""
        self._files = manifest.files or _files_of(manifest, inputs)
        try:
            for name, text in inputs.items():
                file, content = self._input(name), text.encode()
                if not file.exists() or file.read_bytes() != content:
                    file.write_bytes(content)
            os.sync()  # once, for thousands of files, before the manifest names them
        except OSError as error:
            raise self._write_error(file, error) from error
        manifest = msgspec.structs.replace(manifest, engine=engine(), files=self._files)
        self.put(self.path / "manifest.json", msgspec.json.format(msgspec.json.encode(manifest)))
        return manifest

    def put(self, file: Path, content: str | bytes) -> None:
        """Write a file of this folder in one step, or raise InputError."""
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(file, content)
        except OSError as error:
            raise self._write_error(file, error) from error

    def manifest(self) -> Manifest:
        """Return the manifest; raises InputError if it is missing, damaged or newer."""
        file = self.path / "manifest.json"
        try:
            content = read_ordinary(file, _MOST_BYTES + 1)
        except OSError as error:
            hint = "The folder is what `sweep`, `grade` or `tournament` wrote with -o."
            raise self._error(f"There is no manifest: {error.strerror}", hint) from error
        try:
            if len(content) > _MOST_BYTES or sum(map(content.count, _NESTING)) > _MOST_NESTED:
                raise ValueError("it is too large")
            if msgspec.json.decode(content).get("format", _FORMAT) > _FORMAT:
                hint = "Use the version of Logical Robots that wrote it."
                raise InputError("A newer version wrote this manifest", place=str(file), hint=hint)
            manifest = msgspec.json.decode(content, type=Manifest)
            if any(len(cell.parts) != len(manifest.teams) for cell in manifest.cells):
                raise ValueError("there is no such team")
            players = range(len(manifest.players))
            if any(not {*pair} <= {*players} for pairs in manifest.rounds for pair in pairs):
                raise ValueError("there is no such player")
            self._files = manifest.files
            return manifest
        except _UNREADABLE as error:
            hint = "Run the same command with -o again; results in the ledger are kept."
            raise InputError("This manifest is damaged", place=str(file), hint=hint) from error

    def text(self, name: str) -> str:
        """Return an input by its digest; raises InputError if it is missing or damaged."""
        file = self._input(name)
        hint = "Run the same command with -o again; results in the ledger are kept."
        try:
            text = file.read_bytes().decode()
        except (OSError, ValueError) as error:
            raise InputError("This input can't be read", place=str(file), hint=hint) from error
        if digest(text) != name:
            raise InputError("This input is damaged", place=str(file), hint=hint)
        return text

    def _input(self, name: str) -> Path:
        return self.path / "inputs" / self._files.get(name, name)

    def ledger(self, *, mixed: bool = False) -> closing[Ledger]:
        return closing(Ledger(self.path / "ledger.db", fingerprint(), mixed=mixed))

    def _write_error(self, file: Path, error: OSError) -> InputError:
        hint = "Free disk space, then do the same again." if error.errno == ENOSPC else ""
        return InputError(f"can't be written: {error.strerror}", place=str(file), hint=hint)

    def _error(self, message: str, hint: str) -> InputError:
        return InputError(message, place=str(self.path), hint=hint)


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


class Ledger:
    """The results of runs by content of what was run, written by one process.

    The results of one engine count, or of all if `mixed`. Raises LedgerError for a damaged or
    newer file, or results of another engine.
    """

    def __init__(self, file: Path, engine: str, *, mixed: bool = False) -> None:
        self._file, self._engine, self._mixed = file, engine, mixed
        self._synced_at = monotonic()
        with self._translating_errors():
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
            raise LedgerError("A newer version wrote this ledger", place=str(self._file), hint=hint)
        self._db.executescript("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;")
        if version == 0:
            self._db.executescript(f"BEGIN; {_SCHEMA} PRAGMA user_version = {_VERSION}; COMMIT;")
        kinds = self._db.execute("SELECT DISTINCT type FROM sqlite_schema").fetchall()
        if not {kind for (kind,) in kinds} <= {"table", "index"}:
            raise LedgerError("It is damaged (it is not a ledger)", place=str(self._file))
        engines = self._db.execute("SELECT DISTINCT engine FROM results").fetchall()
        if not self._mixed and any(engine != self._engine for (engine,) in engines):
            message = "Its results are from another version of Logical Robots, Python or SQLite"
            hint = "Take another folder, or keep them beside new ones with --mixed."
            raise LedgerError(message, place=str(self._file), hint=hint)

    def outcomes(self) -> dict[str, str]:
        return dict(self._results("outcome"))

    def results(self) -> dict[str, Result]:
        read = msgspec.json.Decoder(Result).decode
        try:
            return {job: read(result) for job, result in self._results("result")}
        except (msgspec.DecodeError, RecursionError, TypeError, ValueError) as error:
            raise LedgerError("A result in it is damaged", place=str(self._file)) from error

    def engines(self) -> Mapping[str, str]:
        return dict(self._results("engine"))

    def _results(self, column: str) -> list[Any]:
        sql = f"SELECT job, {column} FROM results"  # noqa: S608 - the column is ours
        condition = "" if self._mixed else "WHERE engine = ?1"
        return self._rows(f"{sql} {condition} ORDER BY engine = ?1, engine", self._engine)

    def record(self, entries: Iterable[Entry]) -> dict[str, str]:
        """Record runs in one transaction; return outcomes by job. An earlier result is kept.

        A differing second result is noted. A power failure may lose a few seconds of records, so
        that these needn't wait for the disk.
        """
        outcomes = {}
        with self._transaction():
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
            self._rows("PRAGMA wal_checkpoint(PASSIVE)")
            self._synced_at = monotonic()
        return outcomes

    def fail(self, job: str, reason: str, worker: str) -> None:
        """Record a failed attempt at a run that the run did not cause."""
        with self._transaction():
            values = (job, self._engine, reason, worker, time())
            self._db.execute("INSERT INTO failures VALUES (?, ?, ?, ?, ?)", values)

    def failures(self) -> dict[str, list[str]]:
        sql = """SELECT job, reason FROM failures WHERE engine = ?1 AND job NOT IN
            (SELECT job FROM results WHERE engine = ?1) ORDER BY rowid"""
        reasons: dict[str, list[str]] = {}
        for job, reason in self._rows(sql, self._engine):
            reasons.setdefault(job, []).append(reason)
        return reasons

    def forget_failures(self) -> None:
        with self._transaction():
            self._db.execute("DELETE FROM failures")

    def differences(self) -> list[str]:
        return [run for (run,) in self._rows("SELECT DISTINCT run FROM differences ORDER BY run")]

    def seconds(self) -> float:
        """Return the processor seconds of all recorded runs together."""
        return float(self._rows("SELECT total(seconds) FROM times")[0][0])

    def close(self) -> None:
        self._db.close()

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        with self._translating_errors(), self._db:
            self._db.execute("BEGIN IMMEDIATE")
            yield

    def _rows(self, sql: str, *values: str) -> list[Any]:
        with self._translating_errors():
            return self._db.execute(sql, values).fetchall()

    @contextmanager
    def _translating_errors(self) -> Iterator[None]:
        """Turn errors of SQLite into LedgerErrors."""
        try:
            yield
        except (sqlite3.Error, UnicodeDecodeError) as error:  # damage in a name it would tell
            messages = {
                "SQLITE_FULL": ("The disk is full", "Free disk space, then resume."),
                "SQLITE_IOERR": ("The disk is full or fails", "Free disk space, then resume."),
                "SQLITE_READONLY": ("It is read-only", "Choose a folder that you can write to."),
                "SQLITE_CANTOPEN": ("It can't be opened", "Choose another folder."),
                "SQLITE_BUSY": ("Another process is writing to it", "Wait for it to end."),
            }
            name = "_".join(getattr(error, "sqlite_errorname", "").split("_")[:2])
            damaged = "Move it away and start again; nothing else in the folder is lost."
            message, hint = messages.get(name, (f"It is damaged ({error})", damaged))
            raise LedgerError(message, place=str(self._file), hint=hint) from error
