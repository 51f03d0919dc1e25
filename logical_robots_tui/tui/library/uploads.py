"""Files that a browser sends: they become the player's, and are opened."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
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
    from logical_robots_tui.player.library import Library
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.timeline.controller import Replays

Item: TypeAlias = ProgramSource | Level | Replay

_MOST_BYTES = 1_000_000
_LONGEST = 60  # characters of a name; four bytes each are less than a file system's bound
_MOST_NAMES = 100  # of files with the same name
_SAVING = Lock()  # between the choice of a name and its file
_SHELVES: dict[str, tuple[str, Callable[[Path], Item]]] = {
    SUFFIX: ("programs", load_program),
    **dict.fromkeys(SUFFIXES, ("levels", load_level)),
    ".replay": ("replays", load_replay),
}
"""The folder of files with an ending, and how one is read."""


@dataclass(eq=False)
class Uploads:
    """Keeps files in the player's folder; `free` waits until nothing covers the game."""

    data_dir: Path
    ui: Dialogs
    library: Library
    replays: Replays
    free: Callable[[], Awaitable[None]]

    async def receive(self, name: str, content: bytes) -> None:
        path, item = await asyncio.to_thread(_keep, self.data_dir, name, content)
        self.ui.tell(f"Saved {name_and_folder(path)}.")
        await self.free()
        if isinstance(item, ProgramSource):
            self.library.open_program(item)
        elif isinstance(item, Level):
            await self.library.open_level(item)
        else:
            await self.replays.open_with_level(item)


def _keep(data_dir: Path, name: str, content: bytes) -> tuple[Path, Item]:
    """Save a file under a free name; return its path and what it holds, or raise InputError."""
    name = re.sub(r"[^\w.+-]+", "-", re.split(r"[/\\]", name)[-1])
    suffix = Path(name).suffix.lower()
    if suffix not in _SHELVES:
        hint = "A program ends in .l, a level in .toml or .json, a replay in .replay."
        raise InputError("can't be opened here.", place=name[-_LONGEST:] or "This", hint=hint)
    stem = name[: -len(suffix)].strip("-.+")[:_LONGEST] or "upload"
    name = f"{stem}{suffix}"
    if not content or len(content) > _MOST_BYTES:
        message = "is larger than 1 MB." if content else "is empty."
        raise InputError(message, place=name, hint="Choose another file.")
    folder, load = _SHELVES[suffix]
    with _SAVING:
        path = _free_path(data_dir / folder, stem, suffix)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, content)
            return path, load(path)
        except OSError as error:
            raise InputError(f"can't be saved: {error.strerror or error}.", place=name) from error
        except InputError as error:
            path.unlink(missing_ok=True)
            place = error.place.replace(str(path), name)
            raise InputError(error.message, place=place, hint=error.hint) from error


def _free_path(folder: Path, stem: str, suffix: str) -> Path:
    for number in range(1, _MOST_NAMES):
        with suppress(InputError):  # a name of the game's own files, or of a folder
            path = target(
                f"{stem}-{number}".removesuffix("-1"),
                folder,
                folder="levels" if suffix in SUFFIXES else "programs",
                suffixes=SUFFIXES if suffix in SUFFIXES else (suffix,),
                usual=suffix,
            )
            if not is_there(path):
                return path
    raise InputError("has the name of too many files.", place=stem, hint="Choose another name.")
