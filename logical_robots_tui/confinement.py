"""Confine a player's files on a shared computer to one folder with a quota, process-wide.

Without `confine` everything is allowed. Memory is bounded by the process's address space.
"""

from __future__ import annotations

import mmap
import os
import resource
import time
from contextlib import suppress
from errno import EACCES, EDQUOT
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

MOST_FILES = 2_000
"""Files and folders in a player's folder."""

MOST_DEPTH = 10
"""Folders in each other below a player's folder."""

MOST_BYTES = 200 * 2**20
"""Total size of all files in a player's folder."""

WRITABLE = (".l", ".toml", ".json", ".replay", ".csv", ".svg", ".txt")
"""Endings of the files that a player can write."""

REFUSAL = "restricted mode allows only your own files"


class _Confinement(NamedTuple):
    folder: str
    readable: tuple[str, ...]


_confinements: list[_Confinement] = []


def confine(own_folder: Path, *readable: Path) -> None:
    """Allow only files in the player's folder, permanently, and reading `readable` folders."""
    folders = tuple(os.path.realpath(folder) for folder in readable)
    _confinements.append(_Confinement(os.path.realpath(own_folder), folders))


def is_confined() -> bool:
    return bool(_confinements)


def check_mine(path: str | Path) -> None:
    """Raise PermissionError for a foreign path, without revealing whether it exists."""
    real_path = os.path.realpath(path)
    for confinement in _confinements:
        folders = (confinement.folder, *confinement.readable)
        if not any(
            real_path == folder or real_path.startswith(folder + os.sep) for folder in folders
        ):
            raise PermissionError(EACCES, REFUSAL, str(path))


def check_name(path: Path) -> None:
    """Raise PermissionError for a file that another program might run or read as settings.

    It allows only the game's endings, and no hidden folders.
    """
    for confinement in _confinements:
        parts = Path(os.path.relpath(path, confinement.folder)).parts
        is_hidden = any(part.startswith(".") for part in parts)
        if is_hidden or path.suffix not in WRITABLE:
            message = f"restricted mode writes only files that end in {', '.join(WRITABLE)}"
            raise PermissionError(EACCES, f"{message}, in no hidden folder", str(path))


def check_quota(path: Path, size: int) -> None:
    """Raise OSError if a file of this size would exceed the player's quota."""
    for confinement in _confinements:
        number, total = _usage(confinement.folder)
        old_size = path.stat().st_size if path.is_file() else None
        if old_size is None:
            _check_number(number, path)
        if size > (old_size or 0) and total - (old_size or 0) + size > MOST_BYTES:
            message = f"your folder is full: at most {MOST_BYTES // 2**20} MB are allowed"
            raise OSError(EDQUOT, message, str(path))


def check_new_folder(path: str | Path) -> None:
    """Raise OSError if a folder is too deep, or the player's folder is full."""
    real_path = os.path.realpath(path)
    for confinement in _confinements if not os.path.lexists(real_path) else ():
        if len(Path(os.path.relpath(real_path, confinement.folder)).parts) > MOST_DEPTH:
            message = f"at most {MOST_DEPTH} folders can be in each other"
            raise OSError(EDQUOT, message, str(path))
        _check_number(_usage(confinement.folder)[0], path)


def _check_number(number: int, path: str | Path) -> None:
    if number >= MOST_FILES:
        reason = f"your folder is full: it holds {MOST_FILES:,} files and folders, the most allowed"
        raise OSError(EDQUOT, reason, str(path))


_SETTLED = 2 * 10**9  # nanoseconds after which another change gets another time of change


def _usage(folder: str) -> tuple[int, int]:
    """Return the number of files and folders below a folder, and the sum of the files' sizes.

    Only folders that have changed are read again. That is enough, whichever process writes:
    files are renamed into place, and a database that grows has a journal meanwhile.
    """
    number = total = 0
    folders = [folder]
    while folders:
        with suppress(OSError):
            path = folders.pop()
            changed = Path(path).stat().st_ctime_ns
            is_settled = time.time_ns() - changed > _SETTLED
            read = _read_folder if is_settled else _read_folder.__wrapped__
            inner_folders, sizes = read(path, changed)
            folders += inner_folders
            number += len(inner_folders) + len(sizes)
            total += sum(sizes)
    return number, total


@lru_cache(maxsize=MOST_FILES)
def _read_folder(folder: str, _changed: int) -> tuple[list[str], list[int]]:
    """Return the folders in a folder and the sizes of its files, as of its time of change."""
    folders, sizes = [], []
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                folders.append(entry.path)
            elif entry.is_file(follow_symlinks=False):
                with suppress(FileNotFoundError):
                    sizes.append(entry.stat().st_size)
    return folders, sizes


def check_room(size: int) -> None:
    """Raise MemoryError if a bounded address space has no room for so many bytes.

    Checked in advance because orjson and numpy crash when memory runs out.
    """
    if resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY:
        return
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | _NO_RESERVE).close()
    except OSError:
        raise MemoryError from None


_NO_RESERVE = getattr(mmap, "MAP_NORESERVE", 0)
