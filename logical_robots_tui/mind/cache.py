"""Checked results of the compile process on disk, keyed by the content of the request."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from logical_robots_tui import schema
from logical_robots_tui.caching import CacheFolder, cache_place, digest_of_code
from logical_robots_tui.records import record

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

MAX_ENTRIES = 5_000
MAX_BYTES = 50_000_000
_LARGEST = 5_000_000  # bytes of one entry
_SUFFIX = ".program"

T = TypeVar("T")


def folder() -> Path | None:
    """Return the folder for compiled programs, or None for no cache."""
    return cache_place("compiled")


def find(request: bytes, kind: type[T]) -> T | None:
    entries, name = _entries(), _name(request)
    content = entries.read(name, _LARGEST)
    if content is None:
        return None
    digest, _, body = content.partition(b"\n")
    try:
        if digest != _digest(body):
            raise ValueError("not an entry")
        asked, made = json.loads(body)
        if asked != request.decode():
            raise ValueError("the entry of another request")
        return record(kind, made)
    except (ValueError, TypeError, RecursionError):
        entries.drop(name)
        return None


def keep(request: bytes, made: DataclassInstance) -> None:
    entries = _entries()
    if entries.place is None:
        return
    entry: list[Any] = [request.decode(), asdict(made)]
    body = json.dumps(entry, separators=(",", ":")).encode()
    content = _digest(body) + b"\n" + body
    if len(content) <= min(_LARGEST, MAX_BYTES):
        entries.keep(_name(request), [content])


def _entries() -> CacheFolder:
    return CacheFolder(folder(), _SUFFIX, MAX_ENTRIES, MAX_BYTES)


def _name(request: bytes) -> str:
    return hashlib.sha256(_maker() + request).hexdigest()


def _digest(body: bytes) -> bytes:
    return hashlib.sha256(body).hexdigest().encode()


@cache
def _maker() -> bytes:
    package = Path(schema.__file__).parent
    places = [package / part for part in ("language", "mind", "explain", "schema.py")]
    return digest_of_code(places, ("logica", "sqlglot"))
