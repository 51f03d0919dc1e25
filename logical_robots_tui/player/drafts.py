"""Drafts: unsaved work, written soon after every change, that survives crashes."""

from __future__ import annotations

import asyncio
import fcntl
import json
import os
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Generic, Literal, NamedTuple, TypeAlias, TypeVar

import msgspec

from logical_robots_tui.game.source import ProgramSource
from logical_robots_tui.paths import write_atomically
from logical_robots_tui.player.session_state import Ui
from logical_robots_tui.wording import clip, one_line

OLD_DRAFTS_KEPT = 50
"""How many discarded drafts are kept in the folder ``old``."""

Kind: TypeAlias = Literal["program", "level", "place"]
Key: TypeAlias = tuple[Kind, str]
"""The kind and the file path of a draft. A session has one draft of each key."""

_ADOPTED = "-adopted"
_held_locks: set[int] = set()


@dataclass(frozen=True, slots=True)
class Draft:
    """Unsaved work; `turn` orders drafts regardless of the clock.

    `path` may be a substitute for a file; `saved`, with time zone, is only shown.
    """

    kind: Kind
    name: str
    path: str
    text: str
    saved: Annotated[datetime, msgspec.Meta(tz=True)] = field(
        default_factory=lambda: datetime.now(UTC)
    )
    turn: int = field(default=0, compare=False)
    level: str = ""

    @property
    def key(self) -> Key:
        return self.kind, self.path

    @property
    def identity(self) -> tuple[str, ...]:
        """Return what drafts have in common if only the newest of them is wanted."""
        return self.key if self.kind == "place" else (*self.key, self.text)


class Drafts:
    """The drafts of one session, each in its own file, locked while the session lives.

    The next session adopts the drafts of an ended one, and keeps them apart from its own until
    they are taken. Drafts that can't be moved or removed are offered again next time. Methods
    may be called from any thread and from a signal handler.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._session = os.urandom(8).hex()
        self._guard = threading.RLock()
        self._lock: int | None = None
        self._is_closed = False
        self._turn = self._turns_before = 0
        self._latest: dict[Key, int] = {}
        self._drafts: dict[Key, Draft] = {}
        self._adopted: dict[tuple[str, ...], Draft] = {}
        self._unwritten: set[Key] = set()

    def next_turn(self) -> int:
        """Reserve a turn for a draft that is written later; the latest turn wins."""
        with self._guard:
            self._turn += 1
            return self._turn

    def keep(self, draft: Draft, turn: int | None = None) -> None:
        """Write a draft, unless its turn (by default the next) is outdated; may raise OSError."""
        with self._guard:
            if not self._is_turn_of(draft.key, turn):
                return
            self._drafts[draft.key] = draft
            self._unwritten.add(draft.key)
            self._hold_lock()
            draft = replace(draft, turn=self._turns_before + self._latest[draft.key])
            self._drafts[draft.key] = draft
            write_atomically(self._file(draft.key), json.dumps(asdict(draft), default=str))
            self._unwritten.discard(draft.key)

    def unwritten(self) -> list[tuple[Draft, OSError]]:
        """Return the drafts that still can't be written, with reasons; they are lost at exit."""
        failures = []
        with self._guard:
            for draft in [self._drafts[key] for key in sorted(self._unwritten)]:
                try:
                    self.keep(draft, self._latest.get(draft.key))
                except OSError as error:
                    failures.append((draft, error))
        return failures

    def get(self, key: Key) -> Draft | None:
        return self._drafts.get(key)

    def take(self, key: Key, text: str | None = None) -> Draft | None:
        """Turn the newest adopted draft of a key, or that with a text, into an own one, or None.

        An own draft of the same key is moved to the folder ``old``.
        """
        with self._guard:
            matches = [d for d in self._adopted.values() if d.key == key and text in (None, d.text)]
            draft = max(matches, key=lambda draft: draft.turn, default=None)
            if draft is not None:
                del self._adopted[draft.identity]
                self._drafts[key] = draft
                self._unwritten.add(key)
                with suppress(OSError):
                    if self._file(key).exists():
                        self._retire(self._file(key))
                    self._file(draft.identity, _ADOPTED).replace(self._file(key))
                    self._unwritten.discard(key)
            return draft

    def drop(self, key: Key, turn: int | None = None) -> None:
        """Delete a saved or obsolete draft, unless the turn (by default the next) is outdated."""
        with self._guard:
            if not self._is_turn_of(key, turn):
                return
            self._unwritten.discard(key)
            if self._drafts.pop(key, None) is not None:
                with suppress(OSError):
                    self._file(key).unlink(missing_ok=True)

    def put_away(self, draft: Draft) -> None:
        """Move an adopted draft to the folder ``old``."""
        with self._guard:
            if self._adopted.pop(draft.identity, None) is not None:
                with suppress(OSError):
                    self._retire(self._file(draft.identity, _ADOPTED))

    def adopt(self, kind: Kind) -> list[Draft]:
        """Take over drafts of ended sessions, unless this one has ended; may raise OSError.

        Returns those of a kind, newest first; of equal `identity` only the newest.
        """
        with self._guard:
            if self.folder.is_dir() and not self._is_closed:
                self._hold_lock()
                sessions = {file.name.partition("-")[0] for file in self._draft_files()}
                sessions |= {file.stem for file in self.folder.glob("*.lock")}
                for session in sorted(sessions - {self._session}):
                    self._adopt_session(session)
            drafts = [draft for draft in self._adopted.values() if draft.kind == kind]
            return sorted(drafts, key=lambda draft: draft.turn, reverse=True)

    def close(self) -> None:
        """End the session; its drafts remain for the next one."""
        with self._guard:
            self._is_closed = True
            if self._lock is None:
                return
            if not self._drafts and not self._adopted:
                with suppress(OSError):
                    self._lock_file(self._session).unlink(missing_ok=True)
            release(self._lock)
            self._lock = None

    def _is_turn_of(self, key: Key, turn: int | None) -> bool:
        turn = self.next_turn() if turn is None else turn
        if self._latest.get(key, 0) > turn:
            return False
        self._latest[key] = turn
        return True

    def _file(self, names: tuple[str, ...], suffix: str = "") -> Path:
        """Return the file of an own draft by its key, or of an adopted one by its identity."""
        import hashlib  # takes time that the first picture needs

        digest = hashlib.sha256(" ".join(names).encode("utf-8", "surrogatepass")).hexdigest()
        return self.folder / f"{self._session}-{digest[:16]}{suffix}.json"

    def _lock_file(self, session: str) -> Path:
        return self.folder / f"{session}.lock"

    def _draft_files(self, session: str = "") -> list[Path]:
        return sorted(self.folder.glob(f"{session}*-*.json"))

    def _hold_lock(self) -> None:
        if self._lock is None:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._lock = acquire(self._lock_file(self._session))
            drafts = map(_from_json, self._draft_files())
            turns = [draft.turn for draft in drafts if draft is not None]
            self._turns_before = max([0, *turns, *map(_number, self.folder.glob("old/*-*.json"))])

    def _adopt_session(self, session: str) -> None:
        lock = acquire(self._lock_file(session))
        if lock is None:
            return
        try:
            for file in self._draft_files(session):
                draft = _from_json(file)
                rival = self._adopted.get(draft.identity) if draft is not None else None
                if draft is None or (rival is not None and rival.turn >= draft.turn):
                    self._retire(file)
                    continue
                if rival is not None:
                    self._retire(self._file(draft.identity, _ADOPTED))
                file.replace(self._file(draft.identity, _ADOPTED))
                self._adopted[draft.identity] = draft
            # What else it leaves: its lock, half a write.
            for file in (self._lock_file(session), *self.folder.glob(f".{session}-*")):
                file.unlink(missing_ok=True)
        finally:
            release(lock)

    def _retire(self, file: Path) -> None:
        old = self.folder / "old"
        old.mkdir(exist_ok=True)
        file.replace(old / f"{self._turns_before + self.next_turn()}-{file.name}")
        for surplus in sorted(old.glob("*-*.json"), key=_number)[:-OLD_DRAFTS_KEPT]:
            surplus.unlink(missing_ok=True)


def _number(file: Path) -> int:
    number = file.name.partition("-")[0]
    return int(number) if number.isdecimal() else 0


def _from_json(file: Path) -> Draft | None:
    try:
        return msgspec.convert(json.loads(file.read_text("utf-8")), Draft)
    except (OSError, ValueError, RecursionError):
        return None


def acquire(file: Path) -> int | None:
    """Lock a file; return None if it is locked already or the file system has no locks."""
    handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(handle).st_ino != file.stat().st_ino:  # removed while waiting for the lock
            raise BlockingIOError
    except OSError:
        os.close(handle)
        return None
    _held_locks.add(handle)
    return handle


def release(handle: int) -> None:
    # Closed only, it would be locked for as long as a process that is just starting has it open.
    fcntl.flock(handle, fcntl.LOCK_UN)
    _close(handle)


def _close(handle: int) -> None:
    _held_locks.discard(handle)
    os.close(handle)


# A forked child would hold the locks after its parent has ended.
os.register_at_fork(after_in_child=lambda: [*map(_close, tuple(_held_locks))])


State = TypeVar("State")


class UnsavedText(NamedTuple):
    """What is in the editor, and the key of its level."""

    source: ProgramSource
    text: str
    level: str


@dataclass(eq=False)
class Autosave(Generic[State]):
    """Keeps edited work safe; a hangup loses at most `delay` seconds of changes.

    `state` returns an immutable state, of which `draft`, in a thread, makes a draft or names
    one that is no longer needed.
    """

    drafts: Drafts
    state: Callable[[], State]
    draft: Callable[[State], Draft | Key]
    warn: Callable[[str], None]
    subject: str
    delay: float = 0.25
    _has_failed: bool = False
    _written: State | None = None
    _written_turn: int = 0
    _pending: asyncio.Task[None] | None = None

    def edited(self) -> None:
        """Write a draft soon, or delete it if nothing is unsaved any more."""
        if self._pending is None or self._pending.done():
            self._pending = asyncio.create_task(self._keep_soon())

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        try:
            self._keep(self.state(), self.drafts.next_turn())
        except OSError as error:
            self.report(error)

    def stop(self) -> None:
        if self._pending is not None:
            self._pending.cancel()
        self.flush()

    def drop(self, key: Key) -> None:
        if self._pending is not None:
            self._pending.cancel()
        self._written = None
        self.drafts.drop(key)

    def report(self, error: OSError) -> None:
        if not self._has_failed:
            self._has_failed = True
            reason = error.strerror or str(error)
            self.warn(f"{self.subject} can't be kept on disk: {reason}. Save it elsewhere.")

    async def _keep_soon(self) -> None:
        state = self._written
        while self.state() != state:
            await asyncio.sleep(self.delay)
            state, turn = self.state(), self.drafts.next_turn()
            if state == self._written:
                return
            self._written = None  # until the thread is done, what is on disk is uncertain
            try:
                await asyncio.to_thread(self._keep, state, turn)
            except OSError as error:
                self.report(error)
                return

    def _keep(self, state: State, turn: int) -> None:
        if state == self._written:
            return
        draft = self.draft(state)
        if isinstance(draft, Draft):
            self.drafts.keep(draft, turn)
        else:
            self.drafts.drop(draft, turn)
        if turn > self._written_turn:
            self._written, self._written_turn = state, turn


def program_draft(unsaved: UnsavedText) -> Draft | Key:
    """Return a program's draft, or only its key if the file has the same text."""
    source, text, level = unsaved
    if text == source.text:
        return "program", source.draft
    return Draft("program", source.name, source.draft, text, level=level)


def leave(ui: Ui, end: Callable[[], None], drafts: Drafts, *flushes: Callable[[], None]) -> None:
    """End the game; ask first if unsaved work can't be kept."""
    for flush in flushes:
        flush()
    if not (lost := drafts.unwritten()):
        end()
        return
    draft, error = lost[0]
    question = (
        f"Your changes to “{clip(one_line(draft.name), 40)}” are not saved and can't be "
        f"kept for next time: {error.strerror or error}."
    )

    async def ask() -> None:
        answers = [("stay", "Stay"), ("leave", "Leave without it")]
        if await ui.choose("Not saved", question, answers) == "leave":
            end()

    ui.spawn(ask, "leaving", exclusive=True)
