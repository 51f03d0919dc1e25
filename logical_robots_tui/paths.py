"""Asking about paths that players type or the system names, whatever they are.

Of a path in a folder that may not be looked into, or with a name that is too long, pathlib raises
an error where there is nothing but a question; here the answer is no.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from logical_robots_tui.confinement import WHY, check_mine, is_confined
from logical_robots_tui.errors import InputError

__all__ = [
    "is_file",
    "is_folder",
    "is_there",
    "read_ordinary",
    "real",
    "typed_path",
]

_OF_THE_KERNEL = ("/proc", "/sys", "/dev")


def is_there(path: Path) -> bool:
    """Whether there is anything that this process can see."""
    return os.path.exists(path)  # noqa: PTH110 - pathlib raises errors


def is_file(path: Path) -> bool:
    """Whether there is a file that this process can see."""
    return os.path.isfile(path)  # noqa: PTH113 - pathlib raises errors


def is_folder(path: Path) -> bool:
    """Whether there is a folder that this process can see."""
    return os.path.isdir(path)  # noqa: PTH112 - pathlib raises errors


def real(path: Path) -> Path:
    """Where a path leads to through all symbolic links; as far as that goes, if in a circle."""
    return Path(os.path.realpath(path))


def read_ordinary(path: Path, most: int) -> bytes:
    """The first bytes of an ordinary file, and nothing that could block or answer without end.

    Args:
        path: The file.
        most: How many bytes.

    Raises:
        OSError: It is none, or can't be read.
    """
    check_mine(path)
    where = real(path)
    if any(where.is_relative_to(folder) for folder in _OF_THE_KERNEL):
        raise OSError(None, "is no ordinary file", str(path))
    with open(path, "rb", opener=_open_without_waiting) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(None, "is no ordinary file", str(path))
        return file.read(most)


def _open_without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))


def typed_path(text: str) -> Path:
    """The path that a player has typed, in which ``~`` stands for a home.

    Raises:
        InputError: It can't be a path, or it is nobody's home, or the player may not name it.
    """
    if "\0" in text:
        raise InputError("is no path", place=text)
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
