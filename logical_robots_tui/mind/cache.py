"""Compiled programs on disk, by content. Whatever is wrong with the disk, nothing is wrong here.

An entry is a file: a digest of the rest, then JSON. Many processes may read and write at once,
because a file appears whole or not at all. What is read is checked, and a mind trusts no entry
more than it trusts a program.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import tempfile
from dataclasses import asdict
from functools import cache
from importlib import metadata
from pathlib import Path

from logical_robots_tui.mind.program import Program
from logical_robots_tui.mind.records import record

__all__ = ["FOLDER_VARIABLE", "MAX_BYTES", "MAX_ENTRIES", "find", "folder", "keep"]

FOLDER_VARIABLE = "LOGICAL_ROBOTS_CACHE_DIR"
"""Environment variable that names another folder; empty for no cache on disk."""

MAX_ENTRIES = 500
MAX_BYTES = 50_000_000
_LARGEST = 5_000_000  # bytes of one entry
_SUFFIX = ".program"
_UNFINISHED = ".unfinished"


def folder() -> Path | None:
    """Where compiled programs are kept, or None for nowhere."""
    chosen = os.environ.get(FOLDER_VARIABLE)
    if chosen is not None:
        return Path(chosen) if chosen else None
    from platformdirs import user_cache_path

    return user_cache_path("logical-robots", appauthor=False) / "compiled"


def find(text: str) -> Program | None:
    """The program that was kept for a text by the compiler as it is now, or None."""
    place = folder()
    if place is None:
        return None
    path = place / _name(text)
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST + 1)
        digest, _, body = content.partition(b"\n")
        if len(content) > _LARGEST or digest != _digest(body):
            raise ValueError("not an entry")
        program = record(Program, json.loads(body))
        if program.text != text:
            raise ValueError("the entry of another program")
    except FileNotFoundError:
        return None
    except (OSError, ValueError, RecursionError):
        with contextlib.suppress(OSError):
            path.unlink()
        return None
    with contextlib.suppress(OSError):
        os.utime(path)  # the entries used last are the last to go
    return program


def keep(program: Program) -> None:
    """Keep a compiled program, and remove the oldest if there are too many."""
    place = folder()
    if place is None:
        return
    body = json.dumps(asdict(program), separators=(",", ":")).encode()
    content = _digest(body) + b"\n" + body
    if len(content) > min(_LARGEST, MAX_BYTES):
        return
    with contextlib.suppress(OSError):
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, unfinished = tempfile.mkstemp(suffix=_UNFINISHED, dir=place)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            Path(unfinished).replace(place / _name(program.text))
        except BaseException:
            with contextlib.suppress(OSError):
                Path(unfinished).unlink()
            raise
        _make_room(place)


def _make_room(place: Path) -> None:
    """Remove the oldest entries beyond the bounds, leftovers of killed processes among them."""
    found = []
    with os.scandir(place) as entries:
        for entry in entries:
            if entry.name.endswith((_SUFFIX, _UNFINISHED)):
                with contextlib.suppress(OSError):
                    about = entry.stat(follow_symlinks=False)
                    found.append((about.st_mtime, about.st_size, entry.path))
    found.sort(reverse=True)
    total = 0
    for number, (_, size, path) in enumerate(found, 1):
        total += size
        if number > MAX_ENTRIES or total > MAX_BYTES:
            with contextlib.suppress(OSError):
                Path(path).unlink()


def _name(text: str) -> str:
    digest = hashlib.sha256(_maker())
    digest.update(text.encode("utf-8", "surrogatepass"))
    return digest.hexdigest() + _SUFFIX


def _digest(body: bytes) -> bytes:
    return hashlib.sha256(body).hexdigest().encode()


@cache
def _maker() -> bytes:
    """What stands for everything that turns a text into a program, as it is now."""
    digest = hashlib.sha256()
    for package in ("logica", "sqlglot"):
        with contextlib.suppress(metadata.PackageNotFoundError):
            digest.update(b"\0" + metadata.version(package).encode())
    from logical_robots_tui import __version__

    digest.update(b"\0" + __version__.encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(b"\0" + path.name.encode() + b"\0" + path.read_bytes())
    return digest.digest()
