"""The file for a player's own level or program, from the name that was typed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.paths import is_file, is_folder, is_there, real, typed_path
from logical_robots_tui.shipped import shipped_folder, shipped_names

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["target"]


def target(
    name: str,
    own: Path,
    *,
    folder: Literal["levels", "programs"] = "programs",
    suffixes: tuple[str, ...] = (SUFFIX,),
    usual: str = SUFFIX,
) -> Path:
    """Return the file for a name; a name with a slash is a path.

    Args:
        name: What was typed.
        own: The folder of the player's files.
        folder: ``programs`` or ``levels``.
        suffixes: The allowed endings.
        usual: The ending that is added to a name without one.

    Raises:
        InputError: The name can't be used for a player's file.
    """
    if not name:
        raise InputError(f"A {folder.removesuffix('s')} needs a name.")
    if "/" in name:
        path = _from_root(typed_path(name))
        path = path if path.suffix or not path.name else path.with_suffix(usual)
    else:
        stem = name.removesuffix(usual)
        if not re.fullmatch(r"[\w][\w .+-]*", stem):
            raise InputError(
                "A name is made of letters, digits, spaces and the signs _ - + .",
                hint="Put a slash in it to name a file anywhere.",
            )
        if any(stem in shipped_names(folder, suffix) for suffix in suffixes):
            raise InputError(
                f"{stem} is part of the game and can't be changed.", hint="Choose another name."
            )
        path = own / f"{stem}{usual}"
    if is_folder(path):
        raise InputError("is a folder.", place=str(path), hint="Choose another name.")
    if is_there(path) and not is_file(path):
        raise InputError("is not a regular file.", place=str(path), hint="Choose another name.")
    if real(path).parent == shipped_folder(folder).resolve():
        raise InputError(
            f"The {folder} of the game can't be changed.",
            hint="Save it in another folder.",
        )
    return path


def _from_root(path: Path) -> Path:
    try:
        return path.absolute()
    except OSError as error:
        hint = "Use an absolute path such as /tmp/name."
        raise InputError(
            "the current folder no longer exists", place=str(path), hint=hint
        ) from error
