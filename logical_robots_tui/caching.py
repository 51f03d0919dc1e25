"""Folders of what can be made again: bounded, written whole, and never in the way.

Many processes may read and write at once, because a file appears whole or not at all. Whatever is
wrong with the disk, nothing is raised here. Whoever reads an entry checks it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.confinement import is_confined

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["FOLDER_VARIABLE", "CacheFolder", "cache_place", "digest_of_code"]

FOLDER_VARIABLE = "LOGICAL_ROBOTS_CACHE_DIR"
"""Environment variable that names another folder; empty for no cache on disk."""

_UNFINISHED = ".unfinished"
_CONFINED_SHARE = 8  # on a shared machine, where caches count as files of the player


def cache_place(name: str, *, named: str = "") -> Path | None:
    """Where entries of a kind are kept, or None for nowhere.

    Args:
        name: The folder's name in the system's place for caches.
        named: Its name in the folder that the environment names, by default that folder itself.
    """
    chosen = os.environ.get(FOLDER_VARIABLE)
    if chosen is not None:
        return Path(chosen) / named if chosen else None
    from platformdirs import user_cache_path

    return user_cache_path("logical-robots", appauthor=False) / name


@dataclass(frozen=True, slots=True)
class CacheFolder:
    """A folder of entries, of which the oldest go when there is no room.

    Attributes:
        place: The folder; it need not be there.
        suffix: How the names of entries end.
        most_entries: How many there may be.
        most_bytes: How large they may be together.
    """

    place: Path
    suffix: str
    most_entries: int
    most_bytes: int

    def read(self, name: str, largest: int) -> bytes | None:
        """The content of an entry, or None if there is none, or none that can be read.

        Args:
            name: Of the entry, without the suffix.
            largest: How many bytes it may have; a larger one is removed.
        """
        path = self._path(name)
        try:
            with path.open("rb") as file:
                content = file.read(largest + 1)
        except OSError:
            return None
        if len(content) > largest:
            self.drop(name)
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # the entries used last are the last to go
        return content

    def keep(self, name: str, content: Iterable[bytes]) -> None:
        """Keep an entry, given in pieces, and remove the oldest if there are too many."""
        with contextlib.suppress(OSError):
            self.place.mkdir(mode=0o700, parents=True, exist_ok=True)
            handle, unfinished = tempfile.mkstemp(suffix=_UNFINISHED, dir=self.place)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.writelines(content)
                Path(unfinished).replace(self._path(name))
            except BaseException:
                with contextlib.suppress(OSError):
                    Path(unfinished).unlink()
                raise
            self._make_room()

    def drop(self, name: str) -> None:
        """Remove an entry."""
        with contextlib.suppress(OSError):
            self._path(name).unlink()

    def _path(self, name: str) -> Path:
        return self.place / f"{name}{self.suffix}"

    def _make_room(self) -> None:
        """Remove the oldest entries beyond the bounds, leftovers of killed processes among them."""
        found = []
        with os.scandir(self.place) as entries:
            for entry in entries:
                if entry.name.endswith((self.suffix, _UNFINISHED)):
                    with contextlib.suppress(OSError):
                        about = entry.stat(follow_symlinks=False)
                        found.append((about.st_mtime, about.st_size, entry.path))
        found.sort(reverse=True)
        share = _CONFINED_SHARE if is_confined() else 1
        most_entries, most_bytes = self.most_entries // share, self.most_bytes // share
        total = 0
        for number, (_, size, path) in enumerate(found, 1):
            total += size
            if number > most_entries or total > most_bytes:
                with contextlib.suppress(OSError):
                    Path(path).unlink()


def digest_of_code(folders: Iterable[Path], packages: Iterable[str]) -> bytes:
    """What stands for code as it is now.

    Args:
        folders: All Python files in them count.
        packages: Their versions count, of those that are installed.
    """
    from importlib import metadata  # slow to load, and most processes don't need it

    digest = hashlib.sha256()
    for package in packages:
        with contextlib.suppress(metadata.PackageNotFoundError):
            digest.update(b"\0" + metadata.version(package).encode())
    for folder in folders:
        for path in sorted(folder.rglob("*.py")):
            digest.update(b"\0" + path.name.encode() + b"\0" + path.read_bytes())
    return digest.digest()
