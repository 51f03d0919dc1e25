"""Checks on arbitrary paths; where pathlib raises an error, these return False."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from logical_robots_tui.confinement import WHY, check_mine, is_confined
from logical_robots_tui.errors import InputError

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


def read_ordinary(path: Path, most: int) -> bytes:
    """Return the first bytes of a regular file; raises OSError for anything that could block."""
    check_mine(path)
    where = real(path)
    if any(where.is_relative_to(folder) for folder in _OF_THE_KERNEL):
        raise OSError(None, "not a regular file", str(path))
    with open(path, "rb", opener=_open_without_waiting) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(None, "not a regular file", str(path))
        return file.read(most)


def _open_without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))


def typed_path(text: str) -> Path:
    """Return a typed path with ``~`` expanded; raises InputError if invalid or not allowed."""
    if "\0" in text:
        raise InputError("is not a valid path", place=text)
    if is_confined():
        try:
            if text.startswith("~") and text[1:2] not in ("", "/"):
                raise PermissionError  # whoever that is
            check_mine(Path(text).expanduser())
        except PermissionError:
            raise InputError(WHY, place=text) from None
    try:
        return Path(text).expanduser()
    except RuntimeError as error:
        hint = "Name another folder."
        raise InputError("there is no such home", place=text, hint=hint) from error
