"""Drafts: unsaved text, kept on disk so that it survives crashes."""

from __future__ import annotations

import fcntl
import hashlib
import itertools
import json
import os
import secrets
import threading
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["OLD_DRAFTS_KEPT", "Draft", "Drafts", "fingerprint"]

OLD_DRAFTS_KEPT = 50
"""How many discarded drafts are kept in the folder ``old``."""

_serials = itertools.count()
_held_locks: set[int] = set()


def fingerprint(text: str) -> str:
    """Return a short digest of a text."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:16]


@dataclass(frozen=True, slots=True)
class Draft:
    """Unsaved text of one program.

    Attributes:
        program: Name of the program, to show.
        path: Path of the program's file; a newer draft of the same path replaces the older one.
        text: The unsaved text.
        base: Fingerprint of the program's text as it was read from the file.
        saved: When the draft was made, with time zone, to show.
        turn: A counter that orders drafts regardless of the clock; 0 if unknown.
    """

    program: str
    path: str
    text: str
    base: str
    saved: datetime = field(default_factory=lambda: datetime.now(UTC))
    turn: int = field(default=0, compare=False)
    _serial: int = field(default_factory=lambda: next(_serials), repr=False, compare=False)


class Drafts:
    """The drafts of one session, each in its own file, locked while the session lives.

    The next session adopts the drafts of a session that has ended, and keeps them apart from its
    own until they are taken or put away. Drafts of a live session are left alone. Drafts that the
    disk does not allow to be moved or removed stay in place and are offered again next time. All
    methods may be called from any thread and from a signal handler.

    Args:
        folder: The folder of the drafts of all sessions; created when needed.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._session = f"{datetime.now(UTC):%Y%m%d%H%M%S}{secrets.token_hex(4)}"
        self._guard = threading.RLock()
        self._lock: int | None = None
        self._turn = 0
        self._mine: dict[str, Draft] = {}
        self._adopted: dict[str, Draft] = {}
        self._dropped: dict[str, int] = {}
        self._unwritten: set[str] = set()

    def keep(self, draft: Draft) -> None:
        """Write a draft, replacing an older one; a draft older than the stored one is ignored.

        Raises:
            OSError: It can't be written.
        """
        with self._guard:
            newest = self._mine.get(draft.path)
            if newest is not None and newest._serial > draft._serial:
                return
            if self._dropped.get(draft.path, -1) > draft._serial:
                return
            self._mine[draft.path] = draft
            self._unwritten.add(draft.path)
            self._hold_lock()
            self._turn += 1
            self._mine[draft.path] = draft = replace(draft, turn=self._turn)
            write_atomically(self._file(draft.path), _as_json(draft))
            self._unwritten.discard(draft.path)

    def unwritten(self) -> list[tuple[Draft, OSError]]:
        """Return the drafts that still can't be written, with reasons; they are lost at exit."""
        found = []
        with self._guard:
            for draft in [self._mine[path] for path in sorted(self._unwritten)]:
                try:
                    self.keep(draft)
                except OSError as error:
                    found.append((draft, error))
        return found

    def get(self, path: str) -> Draft | None:
        """Return this session's draft of a program, or None."""
        return self._mine.get(path)

    def take(self, path: str) -> Draft | None:
        """Turn the adopted draft of a program into an own one; return None if there is none.

        An own draft of the same program is moved to the folder ``old``.
        """
        with self._guard:
            draft = self._adopted.pop(path, None)
            if draft is not None:
                self._mine[path] = draft
                self._unwritten.add(path)
                with suppress(OSError):
                    if self._file(path).exists():
                        self._retire(self._file(path))
                    self._adopted_file(path).replace(self._file(path))
                    self._unwritten.discard(path)
            return draft

    def drop(self, path: str) -> None:
        """Delete the draft of a program whose text was saved or equals the file again."""
        with self._guard:
            self._dropped[path] = next(_serials)
            self._unwritten.discard(path)
            if self._mine.pop(path, None) is not None:
                with suppress(OSError):
                    self._file(path).unlink(missing_ok=True)

    def put_away(self, path: str) -> None:
        """Move the adopted draft of a program to the folder ``old``."""
        with self._guard:
            if self._adopted.pop(path, None) is not None:
                with suppress(OSError):
                    self._retire(self._adopted_file(path))

    def adopt(self) -> list[Draft]:
        """Take over the drafts of sessions that have ended.

        Returns:
            All adopted drafts, newest first, one per path.

        Raises:
            OSError: The folder can't be used.
        """
        with self._guard:
            if self.folder.is_dir():
                self._hold_lock()
                for session in sorted({p.name.partition("-")[0] for p in self._draft_files()}):
                    if session != self._session:
                        self._adopt_session(session)
                self._remove_dead_locks()
            return sorted(self._adopted.values(), key=_newness, reverse=True)

    def close(self) -> None:
        """End the session; its drafts remain for the next one."""
        with self._guard:
            if self._lock is None:
                return
            if not self._mine and not self._adopted:
                with suppress(OSError):
                    self._lock_file(self._session).unlink(missing_ok=True)
            _release(self._lock)
            self._lock = None

    # -- files ---------------------------------------------------------------------------------

    def _file(self, path: str) -> Path:
        return self.folder / f"{self._session}-{fingerprint(path)}.json"

    def _adopted_file(self, path: str) -> Path:
        return self.folder / f"{self._session}-{fingerprint(path)}-adopted.json"

    def _lock_file(self, session: str) -> Path:
        return self.folder / f"{session}.lock"

    def _draft_files(self, session: str = "") -> list[Path]:
        return sorted(self.folder.glob(f"{session}*-*.json"))

    def _hold_lock(self) -> None:
        if self._lock is None:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._lock = _acquire(self._lock_file(self._session))
            drafts = map(_from_json, self._draft_files())
            self._turn = max([self._turn, *(draft.turn for draft in drafts if draft is not None)])

    def _adopt_session(self, session: str) -> None:
        lock = _acquire(self._lock_file(session))
        if lock is None:
            return
        try:
            for file in self._draft_files(session):
                self._adopt_file(file)
            self._clear(session)
        finally:
            _release(lock)

    def _adopt_file(self, file: Path) -> None:
        draft = _from_json(file)
        if draft is None:
            self._retire(file)
            return
        rival = self._adopted.get(draft.path)
        if rival is not None and _newness(rival) >= _newness(draft):
            self._retire(file)
            return
        if rival is not None:
            self._retire(self._adopted_file(draft.path))
        file.replace(self._adopted_file(draft.path))
        self._adopted[draft.path] = draft

    def _remove_dead_locks(self) -> None:
        for file in self.folder.glob("*.lock"):
            if file.stem != self._session and (lock := _acquire(file)) is not None:
                if not self._draft_files(file.stem):
                    self._clear(file.stem)
                _release(lock)

    def _clear(self, session: str) -> None:
        """Remove the lock and unfinished writes of a session that has ended."""
        for file in (self._lock_file(session), *self.folder.glob(f".{session}-*")):
            file.unlink(missing_ok=True)

    def _retire(self, file: Path) -> None:
        old = self.folder / "old"
        old.mkdir(exist_ok=True)
        file.replace(old / f"{datetime.now(UTC):%Y%m%d%H%M%S%f}-{file.name}")
        for surplus in sorted(old.glob("*.json"))[:-OLD_DRAFTS_KEPT]:
            surplus.unlink(missing_ok=True)


def _newness(draft: Draft) -> tuple[int, datetime]:
    return draft.turn, draft.saved


def _as_json(draft: Draft) -> str:
    data = {
        "program": draft.program,
        "path": draft.path,
        "base": draft.base,
        "saved": draft.saved.isoformat(),
        "turn": draft.turn,
        "text": draft.text,
    }
    return json.dumps(data, indent=1)


def _from_json(file: Path) -> Draft | None:
    """Read a draft; return None if the file is not one."""
    try:
        data: dict[str, Any] = json.loads(file.read_text("utf-8"))
        saved = datetime.fromisoformat(data["saved"])
        turn = int(data.get("turn", 0))
        program, path, text, base = (data[key] for key in ("program", "path", "text", "base"))
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    if saved.tzinfo is None or not all(isinstance(t, str) for t in (program, path, text, base)):
        return None
    return Draft(program, path, text, base, saved, turn)


def _acquire(file: Path) -> int | None:
    """Lock a file; return None if it is locked already or the file system has no locks."""
    handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(handle).st_ino != file.stat().st_ino:  # removed while waiting for the lock
            raise BlockingIOError
    except OSError:
        os.close(handle)
        return None
    _held_locks.add(handle)
    return handle


def _release(handle: int) -> None:
    _held_locks.discard(handle)
    os.close(handle)


def _release_all() -> None:
    for handle in tuple(_held_locks):
        _release(handle)


# A forked child would hold the locks after its parent has ended.
os.register_at_fork(after_in_child=_release_all)
