"""Files that a browser sends: they become the player's, and are opened."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.game.replay import Replay, load_replay
from logical_robots_tui.game.source import SUFFIX, target
from logical_robots_tui.paths import is_there, name_and_folder, write_atomically
from logical_robots_tui.world import Level, load_level
from logical_robots_tui.world.levels.load import SUFFIXES

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen

Item: TypeAlias = ProgramSource | Level | Replay

MOST_BYTES = 1_000_000
_LONGEST = 60  # characters of a name; four bytes each are less than a file system's bound
_MOST_NAMES = 100  # of files with the same name


_SAVING = Lock()  # between the choice of a name and its file

_SHELVES: dict[str, tuple[str, Callable[[Path], Item]]] = {
    SUFFIX: ("programs", load_program),
    **dict.fromkeys(SUFFIXES, ("levels", load_level)),
    ".replay": ("replays", load_replay),
}
"""The folder of files with an ending, and how one is read."""


async def keep_and_open(screen: MainScreen, name: str, content: bytes) -> None:
    """Keep a file in the player's folder; open it as soon as nothing covers the game."""
    try:
        path, item = await asyncio.to_thread(keep, screen.data_dir, name, content)
    except InputError as error:
        screen.warn(str(error))
        return
    screen.tell(f"Saved {name_and_folder(path)}.")
    await screen.offers.free()
    if isinstance(item, ProgramSource):
        screen.library.open_program(item)
    elif isinstance(item, Level):
        await screen.library.open_level(item)
    else:
        await screen.replays.open_with_level(item)


def keep(data_dir: Path, name: str, content: bytes) -> tuple[Path, Item]:
    """Save a file under a name that is free; return its path and what it holds. Blocks.

    Raises InputError for one that can't be opened, of which nothing is kept.
    """
    name = re.sub(r"[^\w.+-]+", "-", re.split(r"[/\\]", name)[-1])
    suffix = Path(name).suffix.lower()
    if suffix not in _SHELVES:
        hint = "A program ends in .l, a level in .toml or .json, a replay in .replay."
        raise InputError("can't be opened here.", place=name[-_LONGEST:] or "This", hint=hint)
    stem = name[: -len(suffix)].strip("-.+")[:_LONGEST] or "upload"
    name = f"{stem}{suffix}"
    if not content:
        raise InputError("is empty.", place=name, hint="Choose another file.")
    if len(content) > MOST_BYTES:
        raise InputError("is larger than 1 MB.", place=name, hint="Choose a smaller file.")
    folder, load = _SHELVES[suffix]
    with _SAVING:
        path = _free_path(data_dir / folder, stem, suffix)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, content)
        except OSError as error:
            message = f"can't be saved: {error.strerror or error}."
            raise InputError(message, place=str(path)) from error
        try:
            return path, load(path)
        except InputError as error:
            path.unlink(missing_ok=True)
            place = error.place.replace(str(path), name)
            raise InputError(error.message, place=place, hint=error.hint) from error


def _free_path(folder: Path, stem: str, suffix: str) -> Path:
    for number in range(1, _MOST_NAMES):
        candidate = stem if number == 1 else f"{stem}-{number}"
        with suppress(InputError):  # a name of the game's own files, or of a folder
            if suffix in SUFFIXES:
                path = target(candidate, folder, folder="levels", suffixes=SUFFIXES, usual=suffix)
            else:
                path = target(candidate, folder, usual=suffix)
            if not is_there(path):
                return path
    hint = "Give it another name."
    raise InputError("has the name of too many files.", place=f"{stem}{suffix}", hint=hint)
