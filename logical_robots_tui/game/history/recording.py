"""Recordings: the states after each tick of a run, in memory and on disk.

A file is the digest of an index line, that JSON line, and pieces of compressed JSON. All is
checked against the level before use.
"""

from __future__ import annotations

import hashlib
import json
import math
import zlib
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import takewhile
from operator import attrgetter
from typing import Any

import orjson

from logical_robots_tui.caching import CacheFolder, cache_place
from logical_robots_tui.game.frame import NoSuchTickError
from logical_robots_tui.game.history.packing import (
    Moment,
    OpenPacks,
    is_moment,
    lay_out,
)
from logical_robots_tui.mind.limits import weight_of_text
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level

MAX_BYTES = 64_000_000
"""The largest file; of a longer run only the first ticks are kept."""

MAX_HELD_BYTES = 192_000_000
"""The most packed bytes in memory: the first ticks that fit into a file, and the latest ones."""

MAX_ENTRIES = 200
MAX_FOLDER_BYTES = 256_000_000
SUFFIX = ".run"

_TOGETHER = 32  # moments in a piece, unless they are large
_HEAVY = 12_000_000  # bytes of unpacked objects, unless a single moment has more
_HEAVIEST = 48_000_000  # most bytes of the objects of a piece, unless it is a single moment
_QUICK = 2  # zlib level


class DamagedRunError(ValueError):
    """The file is not a recording of this run."""


class Recording:
    """The state after each tick of a run, from tick 0 on.

    Beyond `MAX_HELD_BYTES` there is a gap of ticks to recompute. The key, a digest of
    everything on which the run depends, names the file.
    """

    def __init__(self, key: str, level: Level, start: Moment) -> None:
        self._key = key
        self._level = level
        self._start = start
        self._pieces: list[_RecordedPiece] = []
        self._loose = [start]
        self._open_packs = OpenPacks(_HEAVIEST)
        self._is_new = False
        self.last_reliable: float = math.inf  # later ones may differ on another machine
        self._read()

    @property
    def last(self) -> int:
        return self._packed + len(self._loose) - 1

    def first_before(self, last: int) -> int:
        """Return the first tick from which on all up to this one can be restored."""
        for piece in reversed(self._pieces):
            if not piece.content and piece.first <= last:
                return piece.ticks.stop + 1  # the state before is lost as well
        return 0

    def is_in_gap(self, tick: int) -> bool:
        """Return whether the state after a tick was stored, but has been dropped."""
        return tick < self._packed and not self._piece(tick).content

    def return_to_gap(self) -> None:
        if len(self._prefix) < len(self._pieces):
            self._pieces, self._loose = self._prefix, []

    def moment(self, tick: int) -> Moment:
        """Return the state after a stored tick.

        Raises NoSuchTickError if it was dropped, DamagedRunError if its file is invalid.
        """
        if tick >= self._packed:
            return self._loose[tick - self._packed]
        piece = self._piece(tick)
        with _damage_errors():
            moment = self._open_packs.moment(piece, tick - piece.first)
            if not (piece.is_own or is_moment(moment, tick, self._level)):
                raise DamagedRunError(f"this is not tick {tick}")
        return moment

    def memory(self, tick: int, robot: str) -> Value:
        """Return a robot's memory after a stored tick, with the errors of `moment`."""
        if tick >= self._packed:
            return self._loose[tick - self._packed].memories[robot]
        piece = self._piece(tick)
        with _damage_errors():
            return self._open_packs.memory(piece, tick - piece.first, robot)

    def add(self, moment: Moment) -> None:
        """Store the state after the next tick; not on disk once the clock has cut off a thought."""
        self._loose.append(moment)
        self._is_new = True
        if not moment.is_reliable:
            self.last_reliable = min(self.last_reliable, self.last - 1)
        if len(self._loose) >= _TOGETHER or sum(m.weight for m in self._loose) > _HEAVY:
            self._pieces += _pieces_of(self._loose)
            self._loose = []
            total = sum(len(piece.content) for piece in self._pieces)
            for index in range(len(_fitting_prefix(self._prefix)) or 1, len(self._pieces) - 1):
                if total > MAX_HELD_BYTES:
                    total -= len(self._pieces[index].content)
                    self._pieces[index] = replace(self._pieces[index], content=b"")

    def forget(self) -> None:
        """Discard everything after the start, also on disk."""
        _folder().drop(self._key)
        self._pieces, self._loose = [], [self._start]
        self.last_reliable = math.inf

    def save(self) -> None:
        """Write the added ticks to disk, up to a size limit, unless the file holds more ticks."""
        folder = _folder()
        if folder.place is None or not self._is_new:
            return
        self._is_new = False
        pieces = _fitting_prefix(self._up_to(min(self.last_reliable, self.last)))
        count = sum(piece.count for piece in pieces)
        old_content = folder.read(self._key, MAX_BYTES)
        with suppress(ValueError, TypeError, KeyError):  # a damaged file holds nothing
            if old_content is not None and int(_index(old_content)[0]["moments"]) >= count:
                return
        parts = [[len(p.content), p.digest, p.count] for p in pieces]
        line = json.dumps({"key": self._key, "moments": count, "pieces": parts}).encode()
        contents = [piece.content for piece in pieces]
        folder.keep(self._key, [_digest(line).encode(), b"\n", line, b"\n", *contents])

    @property
    def _packed(self) -> int:
        return self._pieces[-1].ticks.stop if self._pieces else 0

    @property
    def _prefix(self) -> list[_RecordedPiece]:
        """The pieces before the gap."""
        return list(takewhile(_content_of, self._pieces))

    def _piece(self, tick: int) -> _RecordedPiece:
        return self._pieces[bisect_right(self._pieces, tick, key=_first_of) - 1]

    def _up_to(self, last: float) -> Iterator[_RecordedPiece]:
        for piece in self._prefix:
            if piece.ticks[-1] > last:
                ticks = range(piece.first, int(last) + 1)
                yield from _pieces_of([self.moment(tick) for tick in ticks])
                return
            yield piece
        if all(map(_content_of, self._pieces)):
            ticks = range(self._packed, int(last) + 1)
            yield from _pieces_of([self.moment(tick) for tick in ticks])

    def _read(self) -> None:
        content = _folder().read(self._key, MAX_BYTES)
        if content is None:
            return
        try:
            index, size = _index(content)
            if index["key"] != self._key or not index["moments"] > 0:
                raise DamagedRunError("another run")
            offset = len(content) - size
            for length, digest, count in index["pieces"]:
                if not (0 < count <= _TOGETHER and length > 0):
                    raise DamagedRunError("no such piece")
                body = content[offset : offset + length]
                piece = _RecordedPiece(self._packed, count, body, digest, is_own=False)
                self._pieces.append(piece)
                offset += length
            if offset != len(content) or self._packed != index["moments"]:
                raise DamagedRunError("not all of it")
            self._loose = []
            if self._pieces[-1].count < _TOGETHER:
                self._loose = [self.moment(tick) for tick in self._pieces[-1].ticks]
                del self._pieces[-1]
            if self.moment(0) != self._start:
                raise DamagedRunError("another start")
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            self.forget()


@dataclass(frozen=True, slots=True, eq=False)
class _RecordedPiece:
    """Some moments as compressed JSON; `is_own` pieces are known to unpack within limits.

    One in the gap has no content.
    """

    first: int
    count: int
    content: bytes
    digest: str
    is_own: bool = True
    fits: bool = True

    @property
    def ticks(self) -> range:
        return range(self.first, self.first + self.count)

    def unpack(self) -> tuple[int, list[Any]]:
        """Return segments and the approximate bytes of their objects, or raise DamagedRunError."""
        if not self.content:
            raise NoSuchTickError("These ticks were dropped.")
        if _digest(self.content) != self.digest:
            raise DamagedRunError("the piece is damaged")
        unpacking = zlib.decompressobj()
        try:
            text = unpacking.decompress(self.content, 0 if self.is_own else _HEAVIEST).decode()
        except zlib.error as error:
            raise DamagedRunError("the piece can't be unpacked") from error
        if not unpacking.eof or not (self.is_own or _may_be_opened(text)):
            raise DamagedRunError("the piece is too large")
        try:
            segments = orjson.loads(text)
        except ValueError:
            segments = json.loads(text)  # infinite numbers, lone surrogates
        if not self.is_own:
            orjson.dumps(segments)  # raises TypeError for what is nested too deeply
        return weight_of_text(text), segments


_first_of, _content_of = attrgetter("first"), attrgetter("content")


def _pieces_of(moments: Sequence[Moment]) -> Iterator[_RecordedPiece]:
    if not moments:
        return
    text = json.dumps(lay_out(moments), separators=(",", ":"))
    fits = _may_be_opened(text)
    if not fits and len(moments) > 1:
        half = len(moments) // 2
        yield from _pieces_of(moments[:half])
        yield from _pieces_of(moments[half:])
        return
    content = zlib.compress(text.encode(), _QUICK)
    yield _RecordedPiece(moments[0].after.tick, len(moments), content, _digest(content), fits=fits)


def _may_be_opened(text: str) -> bool:
    return len(text) <= _HEAVIEST and weight_of_text(text) <= _HEAVIEST


_WRONG = (ValueError, TypeError, LookupError, AttributeError, StopIteration, RecursionError)


@contextmanager
def _damage_errors() -> Iterator[None]:
    """Raise DamagedRunError for whatever reading a damaged piece raises."""
    try:
        yield
    except DamagedRunError:
        raise
    except _WRONG as error:
        raise DamagedRunError("these are not moments") from error


def _folder() -> CacheFolder:
    place = cache_place("runs", subfolder="runs")
    return CacheFolder(place, SUFFIX, MAX_ENTRIES, MAX_FOLDER_BYTES)


def _index(content: bytes) -> tuple[dict[str, Any], int]:
    """Return the index of a file and the number of bytes after it, or raise DamagedRunError."""
    digest, _, tail = content.partition(b"\n")
    line, _, pieces = tail.partition(b"\n")
    if digest.decode() != _digest(line):
        raise DamagedRunError("the index is damaged")
    index: dict[str, Any] = json.loads(line)
    return index, len(pieces)


def _fitting_prefix(pieces: Iterable[_RecordedPiece]) -> list[_RecordedPiece]:
    total, prefix = 0, []
    for piece in pieces:
        total += len(piece.content) + 100
        if total > MAX_BYTES - 1000 or not piece.fits:
            break
        prefix.append(piece)
    return prefix


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
