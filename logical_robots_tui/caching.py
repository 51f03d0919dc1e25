"""Cache folders on disk: bounded, written atomically; disk errors are never raised.

Many processes may read and write at once. Readers must check the entries that they get.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from logical_robots_tui.confinement import is_confined
from logical_robots_tui.paths import read_ordinary

FOLDER_VARIABLE = "LOGICAL_ROBOTS_CACHE_DIR"
"""Environment variable that names another folder; if empty, there is no cache on disk."""

_UNFINISHED = ".unfinished"
_CONFINED_SHARE = 8  # on a shared computer, where caches count as files of the player


def cache_place(name: str, *, subfolder: str = "") -> Path | None:
    """Return the folder for a kind of entries, or None if there is no cache on disk.

    `subfolder` is its name in the folder set in the environment, by default that folder itself.
    """
    folder = os.environ.get(FOLDER_VARIABLE)
    if folder is not None:
        return Path(folder) / subfolder if folder else None
    from platformdirs import user_cache_path

    return user_cache_path("logical-robots", appauthor=False) / name


@dataclass(frozen=True, slots=True)
class CacheFolder:
    """A folder of entries that evicts the oldest when it is full; None as place keeps nothing."""

    place: Path | None
    suffix: str
    most_entries: int
    most_bytes: int

    def read(self, name: str, max_bytes: int) -> bytes | None:
        """Return an entry, or None; an entry of more than `max_bytes` bytes is removed."""
        if self.place is None:
            return None
        path = self.place / f"{name}{self.suffix}"
        try:
            content = read_ordinary(path, max_bytes + 1)
        except OSError:
            return None
        if len(content) > max_bytes:
            self.drop(name)
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # the most recently used entries are evicted last
        return content

    def keep(self, name: str, content: Iterable[bytes]) -> None:
        """Store an entry, given in pieces, and evict the oldest if there are too many."""
        if self.place is None:
            return
        with contextlib.suppress(OSError):
            self.place.mkdir(mode=0o700, parents=True, exist_ok=True)
            handle, unfinished = tempfile.mkstemp(suffix=_UNFINISHED, dir=self.place)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.writelines(content)
                Path(unfinished).replace(self.place / f"{name}{self.suffix}")
            except BaseException:
                with contextlib.suppress(OSError):
                    Path(unfinished).unlink()
                raise
            self._evict(self.place)

    def drop(self, name: str) -> None:
        if self.place is not None:
            with contextlib.suppress(OSError):
                (self.place / f"{name}{self.suffix}").unlink()

    def _evict(self, place: Path) -> None:
        """Evict the oldest entries beyond the limits, including leftovers of killed processes."""
        files = []
        with os.scandir(place) as entries:
            for entry in entries:
                if entry.name.endswith((self.suffix, _UNFINISHED)):
                    with contextlib.suppress(OSError):
                        status = entry.stat(follow_symlinks=False)
                        files.append((status.st_mtime, status.st_size, entry.path))
        files.sort(reverse=True)
        share = _CONFINED_SHARE if is_confined() else 1
        most_entries, most_bytes = self.most_entries // share, self.most_bytes // share
        total = 0
        for number, (_, size, path) in enumerate(files, 1):
            total += size
            if number > most_entries or total > most_bytes:
                with contextlib.suppress(OSError):
                    Path(path).unlink()


def digest_of_code(places: Iterable[Path], packages: Iterable[str]) -> bytes:
    """Return a digest of files, all Python files in folders, and packages' versions."""
    from importlib import metadata  # slow to load, and most processes don't need it

    digest = hashlib.sha256()
    for package in packages:
        with contextlib.suppress(metadata.PackageNotFoundError):
            digest.update(b"\0" + metadata.version(package).encode())
    for place in places:
        for path in sorted(place.rglob("*.py")) if place.is_dir() else (place,):
            digest.update(b"\0" + path.name.encode() + b"\0" + path.read_bytes())
    return digest.digest()
