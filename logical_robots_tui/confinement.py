"""Confine a player's files on a shared computer to one folder with a quota, process-wide.

Without `confine` everything is allowed. Memory is bounded by the process's address space.
"""

from __future__ import annotations

import mmap
import os
import resource
from errno import EACCES, EDQUOT
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

WHY = "restricted mode allows only your own files"


class _Confinement(NamedTuple):
    own: str
    readable: tuple[str, ...]


_confined: list[_Confinement] = []


def confine(own: Path, *readable: Path) -> None:
    """Allow only files in the player's folder, permanently, and reading `readable` folders."""
    folders = tuple(os.path.realpath(folder) for folder in readable)
    _confined.append(_Confinement(os.path.realpath(own), folders))


def is_confined() -> bool:
    return bool(_confined)


def check_mine(path: str | Path) -> None:
    """Raise PermissionError for a foreign path, without revealing whether it exists."""
    where = os.path.realpath(path)
    for confined in _confined:
        folders = (confined.own, *confined.readable)
        if not any(where == folder or where.startswith(folder + os.sep) for folder in folders):
            raise PermissionError(EACCES, WHY, str(path))


def check_name(path: Path) -> None:
    """Raise PermissionError for a file that another program might run or read as settings.

    It allows only the game's endings, and no hidden folders.
    """
    for confined in _confined:
        parts = Path(os.path.relpath(path, confined.own)).parts
        is_hidden = any(part.startswith(".") for part in parts)
        if is_hidden or path.suffix not in WRITABLE:
            said = f"restricted mode writes only files that end in {', '.join(WRITABLE)}"
            raise PermissionError(EACCES, f"{said}, in no hidden folder", str(path))


def check_quota(path: Path, size: int) -> None:
    """Raise OSError if a file of this size would exceed the player's quota."""
    for confined in _confined:
        sizes = _sizes(confined.own)
        before = sizes.get(os.path.realpath(path))
        if before is None:
            _check_number(len(sizes), path)
        if size > (before or 0) and sum(sizes.values()) - (before or 0) + size > MOST_BYTES:
            said = f"your folder is full: at most {MOST_BYTES // 2**20} MB are allowed"
            raise OSError(EDQUOT, said, str(path))


def check_new_folder(path: str | Path) -> None:
    """Raise OSError if a folder is too deep, or the player's folder is full."""
    where = os.path.realpath(path)
    for confined in _confined if not os.path.lexists(where) else ():
        if len(Path(os.path.relpath(where, confined.own)).parts) > MOST_DEPTH:
            said = f"at most {MOST_DEPTH} folders can be in each other"
            raise OSError(EDQUOT, said, str(path))
        _check_number(len(_sizes(confined.own)), path)


def _check_number(number: int, path: str | Path) -> None:
    if number >= MOST_FILES:
        said = f"your folder is full: it holds {MOST_FILES:,} files and folders, the most allowed"
        raise OSError(EDQUOT, said, str(path))


def _sizes(folder: str) -> dict[str, int]:
    """Return the sizes of all files below a folder by path; those of folders are 0."""
    sizes: dict[str, int] = {}
    folders = [folder]
    while folders:
        try:
            with os.scandir(folders.pop()) as entries:
                for entry in entries:
                    if entry.is_dir(follow_symlinks=False):
                        folders.append(entry.path)
                        sizes[entry.path] = 0
                    elif entry.is_file(follow_symlinks=False):
                        sizes[entry.path] = entry.stat().st_size
        except OSError:
            continue
    return sizes


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
