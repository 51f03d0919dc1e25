"""Paths and files: checks that return False where pathlib raises, reading, writing in one step."""

from __future__ import annotations

import difflib
import fcntl
import os
import re
import stat
from collections.abc import Iterable
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Literal, TypeAlias

from logical_robots_tui.confinement import REFUSAL, check_mine, check_name, check_quota, is_confined
from logical_robots_tui.errors import InputError

PLAYER_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,31}")
"""Names of players, who have a folder each; a teacher chooses them, not the player."""

_OF_THE_KERNEL = ("/proc", "/sys", "/dev")


def is_there(path: Path) -> bool:
    return os.path.exists(path)  # noqa: PTH110 - pathlib raises errors


def is_file(path: Path) -> bool:
    return os.path.isfile(path)  # noqa: PTH113 - pathlib raises errors


def is_folder(path: Path) -> bool:
    return os.path.isdir(path)  # noqa: PTH112 - pathlib raises errors


def real(path: Path) -> Path:
    """Resolve all symbolic links of a path, as far as possible if they form a loop."""
    return Path(os.path.realpath(path))


def read_ordinary(path: Path, max_bytes: int) -> bytes:
    """Return the first bytes of a regular file; raises OSError for anything that could block."""
    check_mine(path)
    real_path = real(path)
    if any(real_path.is_relative_to(folder) for folder in _OF_THE_KERNEL):
        raise OSError(None, "not a regular file", str(path))
    without_waiting = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
    with open(
        path, "rb", opener=lambda path, flags: os.open(path, flags | without_waiting)
    ) as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise OSError(None, "not a regular file", str(path))
        # Python takes the memory of all that is asked for, and the allocator then keeps more of it.
        return file.read(min(max_bytes, status.st_size))


def decoded(content: bytes) -> str:
    """Return a file's text without a byte-order mark, lines ended by newlines; or UnicodeError."""
    return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")


def read_text(path: Path, max_bytes: int) -> str:
    """Return a regular file's text in UTF-8, of at most so many bytes; raises OSError."""
    content = read_ordinary(path, max_bytes + 1)
    if len(content) > max_bytes:
        raise OSError(None, f"it is larger than {max_bytes // 10**6} MB")
    try:
        return decoded(content)
    except UnicodeDecodeError:
        raise OSError(None, "it is not UTF-8 text") from None


def typed_path(text: str) -> Path:
    """Return a typed path with ``~`` expanded; raises InputError if invalid or not allowed."""
    if "\0" in text:
        raise InputError("is not a valid path", place=text)
    if is_confined():
        try:
            if text.startswith("~") and text[1:2] not in ("", "/"):
                raise PermissionError  # another user's home
            check_mine(Path(text).expanduser())
        except PermissionError:
            raise InputError(f"can't be used: {REFUSAL}", place=text) from None
    try:
        return Path(text).expanduser()
    except RuntimeError as error:
        hint = "Name another folder."
        raise InputError("There is no such home", place=text, hint=hint) from error


def pasted_path(text: str) -> str:
    """Return a typed or pasted text; of a path that a terminal pasted for a file, the path itself.

    Terminals paste the path of a file that is dropped into them in quotes, with backslashes before
    spaces, or as a ``file://`` address.
    """
    import shlex  # only dialogs need them
    from urllib.parse import unquote

    text = text.strip()
    if text.startswith("file://"):
        _host, slash, path = text.removeprefix("file://").partition("/")
        return unquote(slash + path)
    if "/" in text and any(sign in text for sign in "\\'\""):
        try:
            words = shlex.split(text)
        except ValueError:  # a quote that is not closed
            return text
        if len(words) == 1 and not os.path.lexists(text):
            return words[0]
    return text


ShippedKind: TypeAlias = Literal["levels", "programs"]


ARENAS = "arenas"
"""The folder inside that of the levels, and of the programs, with those for several teams."""


def shipped_folder(kind: ShippedKind) -> Path:
    """Return the folder of shipped files, in an installed package or beside it in a checkout."""
    package = Path(__file__).resolve().parent
    packaged = package / kind
    return packaged if packaged.is_dir() else package.parent / kind


def shipped_names(kind: ShippedKind, suffix: str, subfolder: str = "") -> list[str]:
    folder = shipped_folder(kind) / subfolder
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


_MOST_OPTIONS = 1_000
_LONGEST_WORD = 100  # characters; the time to compare grows with the square


def did_you_mean(word: str, options: Iterable[str]) -> str:
    by_folded = {option.casefold(): option for option in islice(options, _MOST_OPTIONS)}
    word = word[:_LONGEST_WORD].casefold()
    matches = difflib.get_close_matches(word, by_folded, n=1, cutoff=0.6)
    return f'Did you mean "{by_folded[matches[0]]}"?' if matches else ""


_TEMPORARY = re.compile(r"\.(.+)\.[0-9a-f]{8}")


def name_and_folder(path: Path) -> str:
    """Return where a file is, in words that a line is broken between rather than in its name."""
    home, folder = Path.home(), path.parent
    is_at_home = folder.is_relative_to(home)
    return f"{path.name} in {Path('~', folder.relative_to(home)) if is_at_home else folder}"


def write_atomically(path: Path, text: str | bytes) -> None:
    """Replace a file's content in one step, keeping its permissions, or raise OSError.

    The folder must exist. Follows a symbolic link, and writes directly to a device or a pipe.
    Text is written as UTF-8 with its line ends; on an error the old content is intact.
    """
    content = text.encode("utf-8") if isinstance(text, str) else text
    if is_there(path) and not is_file(path):
        path.write_bytes(content)
        return
    path = real(path)
    check_name(path)
    check_quota(path, len(content))
    temporary, handle = _open_beside(path)
    try:
        with os.fdopen(handle, "wb") as file:
            if path.exists():
                os.fchmod(handle, path.stat().st_mode & 0o777)
            file.write(content)
            file.flush()
            os.fsync(handle)
            temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    _sweep(path)


def _open_beside(path: Path) -> tuple[Path, int]:
    """Create a temporary file in the same folder, locked while it is being written."""
    while True:
        temporary = path.with_name(f".{path.name}.{os.urandom(4).hex()}")
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        with suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(handle).st_nlink:
            return temporary, handle
        os.close(handle)  # removed before it was locked


def _sweep(path: Path) -> None:
    """Remove temporary files in this folder that killed processes left behind."""
    with suppress(OSError):
        for name in os.listdir(path.parent):  # noqa: PTH208 - names are looked at first
            match = _TEMPORARY.fullmatch(name)
            if match and (match[1] == path.name or (path.parent / match[1]).exists()):
                _remove_if_unlocked(path.parent / name)


def _remove_if_unlocked(temporary: Path) -> None:
    with suppress(OSError):
        handle = os.open(temporary, os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails while another process writes
            temporary.unlink()
        finally:
            os.close(handle)
