"""Recordings: what the ticks of a run left behind, in memory and on disk.

A file is a digest of the line that follows, that line, which is JSON and holds the length, the
digest and the number of moments of each piece, and then the pieces. A piece is some moments as
packed JSON: text that can do nothing, whoever wrote it. What is read is compared with the level
before it is given to anybody.
"""

from __future__ import annotations

import hashlib
import json
import math
import zlib
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any, get_args

from logical_robots_tui.caching import CacheFolder, cache_place
from logical_robots_tui.game.packing import Moment, laid_out, moment_in
from logical_robots_tui.mind import NoticeKind
from logical_robots_tui.mind.limits import weight_of_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from logical_robots_tui.world import Level

__all__ = ["MAX_BYTES", "MAX_ENTRIES", "MAX_FOLDER_BYTES", "DamagedError", "Recording"]

MAX_BYTES = 64_000_000
"""The largest file; of a longer run as many of the first ticks are kept as there is room for."""

MAX_ENTRIES = 200
MAX_FOLDER_BYTES = 256_000_000
SUFFIX = ".run"

_TOGETHER = 32  # moments in a piece, unless they are heavy
_HEAVY = 12_000_000  # bytes of objects in what is not packed, unless one moment has more
_HEAVIEST = (
    48_000_000  # bytes that the objects of a piece may take at most, unless it is one moment
)
_DEEPEST = 200  # that a memory may be nested
_QUICK = 2  # of zlib's levels
_KEPT_OPEN = 2  # pieces, for those who go through them


class DamagedError(ValueError):
    """What was read is no recording of this run."""


class Recording:
    """What each tick of a run left behind, from tick 0 on without gaps.

    Args:
        key: Stands for everything on which the run depends, as a file name.
        level: Where the run happens.
        start: The moment of tick 0.
    """

    def __init__(self, key: str, level: Level, start: Moment) -> None:
        self._key = key
        self._level = level
        self._start = start
        self._pieces: list[_Piece] = []
        self._loose = [start]
        self._is_new = False
        self._lasting: float = math.inf
        self._read()

    @property
    def last(self) -> int:
        """The latest tick that is known."""
        return self._packed + len(self._loose) - 1

    @property
    def lasts(self) -> bool:
        """Whether every tick would be the same again: no guard ended a thought."""
        return self._lasting >= self.last

    def moment(self, tick: int) -> Moment:
        """What a known tick left behind.

        Raises:
            DamagedError: It was read from a file that is damaged or false.
        """
        if tick >= self._packed:
            return self._loose[tick - self._packed]
        piece = self._pieces[bisect_right(self._pieces, tick, key=_first_of) - 1]
        return self._checked(_moment_of(piece, tick - piece.first), tick)

    def add(self, moment: Moment) -> None:
        """Take in what the next tick left behind.

        If a guard ended a thought in it, it may be otherwise on another day: then it is kept for
        this process only, and so are the ticks after it.
        """
        self._loose.append(moment)
        self._is_new = True
        if not moment.is_reliable:
            self._lasting = min(self._lasting, self.last - 1)
        if len(self._loose) >= _TOGETHER or sum(each.weight for each in self._loose) > _HEAVY:
            self._pieces += _pieces_of(self._loose)
            self._loose = []

    def forget(self) -> None:
        """Begin anew with the start, also on disk."""
        if (folder := _folder()) is not None:
            folder.drop(self._key)
        self._pieces, self._loose = [], [self._start]
        self._lasting = math.inf

    def save(self) -> None:
        """Keep on disk what was added, as far as there is room, unless more is there already."""
        folder = _folder()
        if folder is None or not self._is_new:
            return
        self._is_new = False
        pieces = _that_fit(self._up_to(min(self._lasting, self.last)))
        count = sum(piece.count for piece in pieces)
        there = folder.read(self._key, MAX_BYTES)
        if there is not None and _count(there) >= count:
            return
        index = {
            "key": self._key,
            "moments": count,
            "pieces": [[len(p.content), p.digest, p.count] for p in pieces],
        }
        line = json.dumps(index).encode()
        contents = [piece.content for piece in pieces]
        folder.keep(self._key, [_digest(line).encode(), b"\n", line, b"\n", *contents])

    # -- inside --------------------------------------------------------------------------------

    @property
    def _packed(self) -> int:
        """How many moments are packed."""
        return self._pieces[-1].first + self._pieces[-1].count if self._pieces else 0

    def _up_to(self, last: float) -> Iterator[_Piece]:
        """All up to a tick in pieces."""
        for piece in self._pieces:
            if piece.first + piece.count - 1 > last:
                few = range(piece.first, int(last) + 1)
                yield from _pieces_of([self.moment(tick) for tick in few])
                return
            yield piece
        few = range(self._packed, int(last) + 1)
        yield from _pieces_of([self.moment(tick) for tick in few])

    def _read(self) -> None:
        """Take over what is on disk, if that is a recording of this run."""
        folder = _folder()
        content = None if folder is None else folder.read(self._key, MAX_BYTES)
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
                self._loose = [
                    self.moment(tick) for tick in range(self._pieces[-1].first, self._packed)
                ]
                del self._pieces[-1]
            if self.moment(0) != self._start:
                raise DamagedError("another start")
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            self.forget()

    def _checked(self, moment: Moment, tick: int) -> Moment:
        """A moment that was read.

        Raises:
            DamagedError: It can't be one of this run.
        """
        try:
            is_right = _is_moment(moment, tick, self._level)
        except TypeError:  # a list in place of a name
            is_right = False
        if not is_right:
            raise DamagedError(f"this is not tick {tick}")
        return moment


@dataclass(frozen=True, slots=True)
class _Piece:
    """Some moments as packed JSON.

    Attributes:
        first: Tick of the first one.
        count: How many they are.
        content: The packed text.
        digest: Of that.
        own: Whether this process packed it, so that it is known to hold no more than it may.
        fits: Whether another process will read it, too.
    """

    first: int
    count: int
    content: bytes
    digest: str
    own: bool = True
    fits: bool = True


_first_of = attrgetter("first")


def _pieces_of(moments: Sequence[Moment]) -> Iterator[_Piece]:
    """Moments in as few pieces as can be opened without taking too much memory."""
    if not moments:
        return
    text = _text_of(moments)
    fits = _may_be_opened(text)
    if not fits and len(moments) > 1:
        half = len(moments) // 2
        yield from _pieces_of(moments[:half])
        yield from _pieces_of(moments[half:])
        return
    content = zlib.compress(text.encode(), _QUICK)
    yield _Piece(moments[0].after.tick, len(moments), content, _digest(content), fits=fits)


def _text_of(moments: Sequence[Moment]) -> str:
    return json.dumps(laid_out(moments), separators=(",", ":"))


def _may_be_opened(text: str) -> bool:
    """Whether what a text holds surely takes no more memory than that of a piece may."""
    return len(text) <= _HEAVIEST and weight_of_text(text) <= _HEAVIEST


def _moment_of(piece: _Piece, at: int) -> Moment:
    """One of the moments of a piece.

    Raises:
        DamagedError: There is none, or the piece is damaged.
    """
    try:
        return moment_in(_unpacked(piece), at)
    except DamagedError:
        raise
    except (ValueError, TypeError, LookupError, StopIteration, RecursionError) as error:
        raise DamagedError("these are no moments") from error


@lru_cache(maxsize=_KEPT_OPEN)
def _unpacked(piece: _Piece) -> Any:
    if _digest(piece.content) != piece.digest:
        raise DamagedError("the piece is damaged")
    unpacking = zlib.decompressobj()
    try:
        text = unpacking.decompress(piece.content, 0 if piece.own else _HEAVIEST).decode()
    except zlib.error as error:
        raise DamagedError("the piece can't be unpacked") from error
    if not unpacking.eof or not (piece.own or _may_be_opened(text)):
        raise DamagedError("the piece is too large")
    return json.loads(text)


def _folder() -> CacheFolder | None:
    place = cache_place("runs", named="runs")
    return None if place is None else CacheFolder(place, SUFFIX, MAX_ENTRIES, MAX_FOLDER_BYTES)


def _index(content: bytes) -> tuple[dict[str, Any], int]:
    """The index of a file, and how many bytes follow it.

    Raises:
        DamagedError: It is damaged.
    """
    digest, _, rest = content.partition(b"\n")
    line, _, pieces = rest.partition(b"\n")
    if digest.decode() != _digest(line):
        raise DamagedError("the index is damaged")
    index: dict[str, Any] = json.loads(line)
    return index, len(pieces)


def _count(content: bytes) -> int:
    """How many moments a file holds, as it says; 0 if it is damaged."""
    try:
        return int(_index(content)[0]["moments"])
    except (ValueError, TypeError, KeyError):
        return 0


def _that_fit(pieces: Iterable[_Piece]) -> list[_Piece]:
    """Those of the first pieces that fit into a file, with room for the index."""
    total, found = 0, []
    for piece in pieces:
        total += len(piece.content) + 100
        if total > MAX_BYTES - 1000 or not piece.fits:
            break
        found.append(piece)
    return found


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _is_moment(moment: Moment, tick: int, level: Level) -> bool:
    """Whether a moment can be what a tick left behind in a level, down to every type."""
    after, names = moment.after, [robot.name for robot in level.robots]
    return (
        type(after.tick) is int
        and after.tick == tick
        and (after.won_at is None or (type(after.won_at) is int and 0 < after.won_at <= tick))
        and [robot.name for robot in after.robots] == names
        and all(_is_body(robot) for robot in after.robots)
        and [area.name for area in after.areas] == [area.name for area in level.areas]
        and all(
            type(area.active) is bool and set(area.visitors) <= set(names) for area in after.areas
        )
        and _are_numbers(moment.think_milliseconds, moment.driven)
        and type(moment.weight) is int
        and moment.weight >= 0
        and list(moment.memories) == names
        and all(_is_value(memory, _DEEPEST) for memory in moment.memories.values())
        and [each.robot_name for each in moment.decisions] == (names if tick else [])
        and all(_is_decision(each) for each in moment.decisions)
    )


def _is_body(robot: Any) -> bool:
    numbers = (robot.x, robot.y, robot.angle, robot.battery_level)
    return (
        _are_numbers(*numbers, robot.left_engine, robot.right_engine)
        and type(robot.blocked) is bool
        and type(robot.dead) is bool
    )


def _is_decision(decision: Any) -> bool:
    desire = decision.desire
    return (desire is None or _are_numbers(desire.left_engine, desire.right_engine)) and all(
        notice.kind in get_args(NoticeKind) and type(notice.message) is str
        for notice in decision.notices
    )


def _are_numbers(*values: Any) -> bool:
    return all(type(value) in (int, float) and math.isfinite(value) for value in values)


def _is_value(value: Any, depth: int) -> bool:
    """Whether a value is nested no deeper than that; it is out of JSON, so its type is right."""
    if type(value) not in (list, dict):
        return True
    inside = value.values() if type(value) is dict else value
    return depth > 0 and all(_is_value(each, depth - 1) for each in inside)
