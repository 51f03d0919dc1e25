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
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import orjson

from logical_robots_tui.caching import CacheFolder, cache_place
from logical_robots_tui.game.history.packing import (
    Opened,
    TickState,
    is_moment,
    lay_out,
    memory_in,
    moment_in,
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


class DamagedError(ValueError):
    """The file is not a recording of this run."""


class Recording:
    """The state after each tick of a run, from tick 0 on.

    Beyond `MAX_HELD_BYTES` there is a gap of ticks to recompute. The key, a digest of
    everything on which the run depends, names the file.
    """

    def __init__(self, key: str, level: Level, start: TickState) -> None:
        self._key = key
        self._level = level
        self._start = start
        self._pieces: list[_Piece] = []
        self._loose = [start]
        self._opened = Opened(_HEAVIEST)
        self._is_new = False
        self._lasting: float = math.inf
        self._read()

    @property
    def last(self) -> int:
        return self._packed + len(self._loose) - 1

    @property
    def first(self) -> int:
        """The first tick after the gap, or 0."""
        at = self._packed
        for piece in reversed(self._pieces):
            if piece.ticks.stop != at:
                return at
            at = piece.first
        return at

    @property
    def lasts(self) -> bool:
        """Whether every tick is reproducible: no time limit cut off a thought."""
        return self._lasting >= self.last

    def is_in_gap(self, tick: int) -> bool:
        """Return whether the state after a tick was stored, but has been dropped."""
        return tick < self._packed and tick not in self._piece(tick).ticks

    def return_to_gap(self) -> None:
        before = list(_contiguous_prefix(self._pieces))
        if len(before) < len(self._pieces):
            self._pieces, self._loose = before, []

    def moment(self, tick: int) -> TickState:
        """Return the state after a stored tick; raises DamagedError if its file is invalid."""
        if tick >= self._packed:
            return self._loose[tick - self._packed]
        piece = self._piece(tick)
        with _damage_told():
            moment = moment_in(self._opened.runs(piece), tick - piece.first)
            if not (piece.own or is_moment(moment, tick, self._level)):
                raise DamagedError(f"this is not tick {tick}")
        return moment

    def memory(self, tick: int, robot: str) -> Value:
        """Return a robot's memory after a stored tick; raises DamagedError as `moment` does."""
        if tick >= self._packed:
            return self._loose[tick - self._packed].memories[robot]
        piece = self._piece(tick)
        with _damage_told():
            return memory_in(self._opened.runs(piece), tick - piece.first, robot)

    def add(self, moment: TickState) -> None:
        """Store the state after the next tick; not on disk once the clock has cut off a thought."""
        self._loose.append(moment)
        self._is_new = True
        if not moment.is_reliable:
            self._lasting = min(self._lasting, self.last - 1)
        if len(self._loose) >= _TOGETHER or sum(each.weight for each in self._loose) > _HEAVY:
            self._pieces += _pieces_of(self._loose)
            self._loose = []
            total = sum(len(piece.content) for piece in self._pieces)
            at = len(_fitting_prefix(_contiguous_prefix(self._pieces))) or 1
            while total > MAX_HELD_BYTES and at < len(self._pieces) - 1:
                total -= len(self._pieces.pop(at).content)

    def forget(self) -> None:
        """Discard everything after the start, also on disk."""
        _folder().drop(self._key)
        self._pieces, self._loose = [], [self._start]
        self._lasting = math.inf

    def save(self) -> None:
        """Write the added ticks to disk, up to a size limit, unless the file holds more ticks."""
        folder = _folder()
        if folder.place is None or not self._is_new:
            return
        self._is_new = False
        pieces = _fitting_prefix(self._up_to(min(self._lasting, self.last)))
        count = sum(piece.count for piece in pieces)
        there = folder.read(self._key, MAX_BYTES)
        with suppress(ValueError, TypeError, KeyError):  # a damaged file holds nothing
            if there is not None and int(_index(there)[0]["moments"]) >= count:
                return
        parts = [[len(p.content), p.digest, p.count] for p in pieces]
        line = json.dumps({"key": self._key, "moments": count, "pieces": parts}).encode()
        contents = [piece.content for piece in pieces]
        folder.keep(self._key, [_digest(line).encode(), b"\n", line, b"\n", *contents])

    @property
    def _packed(self) -> int:
        return self._pieces[-1].ticks.stop if self._pieces else 0

    def _piece(self, tick: int) -> _Piece:
        return self._pieces[bisect_right(self._pieces, tick, key=_first_of) - 1]

    def _up_to(self, last: float) -> Iterator[_Piece]:
        before = list(_contiguous_prefix(self._pieces))
        for piece in before:
            if piece.ticks[-1] > last:
                few = range(piece.first, int(last) + 1)
                yield from _pieces_of([self.moment(tick) for tick in few])
                return
            yield piece
        if len(before) == len(self._pieces):
            few = range(self._packed, int(last) + 1)
            yield from _pieces_of([self.moment(tick) for tick in few])

    def _read(self) -> None:
        content = _folder().read(self._key, MAX_BYTES)
        if content is None:
            return
        try:
            index, rest = _index(content)
            if index["key"] != self._key or not index["moments"] > 0:
                raise DamagedError("another run")
            at = len(content) - rest
            for length, digest, count in index["pieces"]:
                if not 0 < count <= _TOGETHER:
                    raise DamagedError("no such piece")
                piece = _Piece(self._packed, count, content[at : at + length], digest, own=False)
                self._pieces.append(piece)
                at += length
            if at != len(content) or self._packed != index["moments"]:
                raise DamagedError("not all of it")
            self._loose = []
            if self._pieces[-1].count < _TOGETHER:
                self._loose = [self.moment(tick) for tick in self._pieces[-1].ticks]
                del self._pieces[-1]
            if self.moment(0) != self._start:
                raise DamagedError("another start")
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            self.forget()


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """Some moments as compressed JSON; `own` pieces are known to unpack within limits."""

    first: int
    count: int
    content: bytes
    digest: str
    own: bool = True
    fits: bool = True

    @property
    def ticks(self) -> range:
        return range(self.first, self.first + self.count)

    def opened(self) -> tuple[int, list[Any]]:
        """Return its runs, and the approximate bytes of their objects, or raise DamagedError."""
        if _digest(self.content) != self.digest:
            raise DamagedError("the piece is damaged")
        unpacking = zlib.decompressobj()
        try:
            text = unpacking.decompress(self.content, 0 if self.own else _HEAVIEST).decode()
        except zlib.error as error:
            raise DamagedError("the piece can't be unpacked") from error
        if not unpacking.eof or not (self.own or _may_be_opened(text)):
            raise DamagedError("the piece is too large")
        try:
            runs = orjson.loads(text)
        except ValueError:
            runs = json.loads(text)  # infinite numbers, lone surrogates
        if not self.own:
            orjson.dumps(runs)  # raises TypeError for what is nested too deeply
        return weight_of_text(text), runs


_first_of = attrgetter("first")


def _contiguous_prefix(pieces: Sequence[_Piece]) -> Iterator[_Piece]:
    last = 0
    for piece in pieces:
        if piece.first != last:
            return
        last = piece.ticks.stop
        yield piece


def _pieces_of(moments: Sequence[TickState]) -> Iterator[_Piece]:
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
    yield _Piece(moments[0].after.tick, len(moments), content, _digest(content), fits=fits)


def _may_be_opened(text: str) -> bool:
    return len(text) <= _HEAVIEST and weight_of_text(text) <= _HEAVIEST


_WRONG = (ValueError, TypeError, LookupError, AttributeError, StopIteration, RecursionError)


@contextmanager
def _damage_told() -> Iterator[None]:
    """Raise DamagedError for whatever reading a piece raises that is not a piece."""
    try:
        yield
    except DamagedError:
        raise
    except _WRONG as error:
        raise DamagedError("these are not moments") from error


def _folder() -> CacheFolder:
    place = cache_place("runs", named="runs")
    return CacheFolder(place, SUFFIX, MAX_ENTRIES, MAX_FOLDER_BYTES)


def _index(content: bytes) -> tuple[dict[str, Any], int]:
    """Return the index of a file and the number of bytes after it, or raise DamagedError."""
    digest, _, rest = content.partition(b"\n")
    line, _, pieces = rest.partition(b"\n")
    if digest.decode() != _digest(line):
        raise DamagedError("the index is damaged")
    index: dict[str, Any] = json.loads(line)
    return index, len(pieces)


def _fitting_prefix(pieces: Iterable[_Piece]) -> list[_Piece]:
    total, found = 0, []
    for piece in pieces:
        total += len(piece.content) + 100
        if total > MAX_BYTES - 1000 or not piece.fits:
            break
        found.append(piece)
    return found


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
