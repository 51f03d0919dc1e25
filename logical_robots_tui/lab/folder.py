"""The folder of a sweep, grading or tournament: manifest, inputs by content, ledger, lock."""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from errno import ENOSPC
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.ledger import Ledger
from logical_robots_tui.lab.running import Asked, engine, fingerprint
from logical_robots_tui.lab.specification import BUILT_IN
from logical_robots_tui.paths import read_ordinary, write_atomically

_FORMAT = 1
_MOST_BYTES = 64_000_000  # of a manifest
_MOST_NESTED = 5_000_000  # brackets and commas of one, whose objects take far more than their text

_UNREADABLE = (msgspec.MsgspecError, AttributeError, RecursionError, TypeError, ValueError)
_NESTING = (b"[", b"{", b",")

Digest: TypeAlias = Annotated[str, msgspec.Meta(pattern="^([0-9a-f]{64})?$")]
Ticks: TypeAlias = Annotated[int, msgspec.Meta(ge=0, le=10**9)]
Starts: TypeAlias = Annotated[int, msgspec.Meta(ge=0, le=10_000)]
Measure: TypeAlias = Annotated[str, msgspec.Meta(pattern=f"^({'|'.join(BUILT_IN)})$")]
Index: TypeAlias = Annotated[int, msgspec.Meta(ge=0)]


class Cell(msgspec.Struct, frozen=True, omit_defaults=True):
    """One program in one level, from all its starts; texts are named by their digests.

    `program` is the first of several that are the same but for space and comments, `own` the
    student's; a match has "" and, in the order of the teams, `parts`. `settings` are the values
    of what is varied, by name; in a match the players by team.
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


class Student(msgspec.Struct, frozen=True, omit_defaults=True):
    """A student, or anybody who submitted something; the id is then the submission's name."""

    id: str
    name: str = ""
    submission: str = ""
    late: bool = False
    remarks: tuple[str, ...] = ()


class Player(msgspec.Struct, frozen=True, omit_defaults=True):
    """A player of a tournament; `lost` is why all matches are lost without being played."""

    name: str
    program: Digest = ""
    lost: str = ""


class Manifest(msgspec.Struct, frozen=True, omit_defaults=True):
    """Everything that is needed to repeat the work, beside the inputs.

    There are `starts` shifted starts, if `given_first` for programs that win from the given one.
    A think has `steps`, a run `seconds` at most. `rounds` are pairs of players by index, for each
    round of a tournament that is known so far.
    """

    kind: Literal["sweep", "grade", "tournament"]
    title: str
    specification: str
    starts: Starts
    given_first: bool
    measures: tuple[Measure, ...]
    asked: tuple[Asked, ...]
    steps: int
    seconds: float
    cells: tuple[Cell, ...]
    students: tuple[Student, ...] = ()
    assignment: dict[str, Any] = {}
    players: tuple[Player, ...] = ()
    teams: tuple[str, ...] = ()
    match: Cell = Cell("", "", "", "", 0)
    rounds: tuple[tuple[tuple[Index, Index], ...], ...] = ()
    most_rounds: Index = 1
    engine: dict[str, str] = {}
    format: int = _FORMAT

    def job(self, cell: Cell, start: int) -> str:
        """Return the digest of what a run depends on, except the engine."""
        asked = [(each.name, each.query, each.every) for each in self.asked]
        program = cell.program or cell.parts
        what = (cell.level, program, start, cell.ticks, asked, self.steps)
        return digest(repr(what))

    def run(self, job: str) -> str:
        """Return the identity of a run on this engine."""
        return digest(job + fingerprint())


def digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


class Folder:
    def __init__(self, path: Path) -> None:
        self.path = path

    @contextmanager
    def locked(self) -> Iterator[None]:
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
                raise self._error("another process is at work in this folder", hint) from None
            yield
        finally:
            fcntl.flock(handle, fcntl.LOCK_UN)  # also for a process that is just starting
            os.close(handle)

    def write(self, manifest: Manifest, inputs: Mapping[str, str]) -> Manifest:
        """Write a manifest and its inputs by digest; return the manifest with this engine."""
        try:
            for name, text in inputs.items():
                file, content = self.path / "inputs" / name, text.encode()
                if not file.exists() or file.read_bytes() != content:
                    file.write_bytes(content)
            os.sync()  # once, for thousands of files, before the manifest names them
        except OSError as error:
            raise self._unwritable(file, error) from error
        manifest = msgspec.structs.replace(manifest, engine=engine())
        self.put(self.path / "manifest.json", msgspec.json.format(msgspec.json.encode(manifest)))
        return manifest

    def put(self, file: Path, content: str | bytes) -> None:
        """Write a file of this folder in one step, or raise InputError."""
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(file, content)
        except OSError as error:
            raise self._unwritable(file, error) from error

    def manifest(self) -> Manifest:
        """Return the manifest; raises InputError if it is missing, damaged or newer."""
        file = self.path / "manifest.json"
        try:
            content = read_ordinary(file, _MOST_BYTES + 1)
        except OSError as error:
            hint = "The folder is what `sweep`, `grade` or `tournament` wrote with -o."
            raise self._error(f"there is no manifest: {error.strerror}", hint) from error
        try:
            if len(content) > _MOST_BYTES or sum(map(content.count, _NESTING)) > _MOST_NESTED:
                raise ValueError("it is too large")
            if msgspec.json.decode(content).get("format", _FORMAT) > _FORMAT:
                hint = "Use the version of Logical Robots that wrote it."
                raise InputError("a newer version wrote this manifest", place=str(file), hint=hint)
            manifest = msgspec.json.decode(content, type=Manifest)
            if any(len(cell.parts) != len(manifest.teams) for cell in manifest.cells):
                raise ValueError("there is no such team")
            players = range(len(manifest.players))
            if any(not {*pair} <= {*players} for pairs in manifest.rounds for pair in pairs):
                raise ValueError("there is no such player")
            return manifest
        except _UNREADABLE as error:
            hint = "Run the same command with -o again; results in the ledger are kept."
            raise InputError("this manifest is damaged", place=str(file), hint=hint) from error

    def text(self, name: str) -> str:
        """Return an input by its digest; raises InputError if it is missing or damaged."""
        file = self.path / "inputs" / name
        hint = "Run the same command with -o again; results in the ledger are kept."
        try:
            text = file.read_bytes().decode()
        except (OSError, ValueError) as error:
            raise InputError("this input can't be read", place=str(file), hint=hint) from error
        if digest(text) != name:
            raise InputError("this input is damaged", place=str(file), hint=hint)
        return text

    @contextmanager
    def ledger(self, *, mixed: bool = False) -> Iterator[Ledger]:
        ledger = Ledger(self.path / "ledger.db", fingerprint(), mixed=mixed)
        try:
            yield ledger
        finally:
            ledger.close()

    def _unwritable(self, file: Path, error: OSError) -> InputError:
        hint = "Make room, then do the same again." if error.errno == ENOSPC else ""
        return InputError(f"can't be written: {error.strerror}", place=str(file), hint=hint)

    def _error(self, message: str, hint: str) -> InputError:
        return InputError(message, place=str(self.path), hint=hint)
