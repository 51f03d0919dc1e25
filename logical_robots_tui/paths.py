"""Asking about paths that players type or the system names, whatever they are.

Of a path in a folder that may not be looked into, or with a name that is too long, pathlib raises
an error where there is nothing but a question; here the answer is no.
"""

from __future__ import annotations

import os.path
from pathlib import Path

from logical_robots_tui.errors import InputError

__all__ = ["is_file", "is_folder", "is_there", "real", "typed_path"]


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


def typed_path(text: str) -> Path:
    """The path that a player has typed, in which ``~`` stands for a home.

    Raises:
        InputError: It can't be a path, or it is nobody's home.
    """
    if "\0" in text:
        raise InputError("is no path", place=text)
    try:
        return Path(text).expanduser()
    except RuntimeError as error:
        hint = "Name another folder."
        raise InputError("there is no such home", place=text, hint=hint) from error
