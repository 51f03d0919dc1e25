"""Recordings: what the ticks of a run left behind, in memory and on disk.

A file is a digest of the line that follows, that line, which is JSON and holds the length and the
digest of each piece, and then the pieces. A piece is some moments as packed JSON: text that can do
nothing, whoever wrote it. What is read is compared with the level before it is given to anybody.
"""

from __future__ import annotations

import hashlib
import json
import math
import zlib
from functools import lru_cache
from typing import TYPE_CHECKING, Any, get_args

from logical_robots_tui.caching import CacheFolder, cache_place
from logical_robots_tui.game.packing import Moment, laid_out, moment_in
from logical_robots_tui.mind import NoticeKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.world import Level

__all__ = ["MAX_BYTES", "MAX_ENTRIES", "MAX_FOLDER_BYTES", "DamagedError", "Recording"]

MAX_BYTES = 64_000_000
"""The largest file; of a longer run as many of the first ticks are kept as there is room for."""

MAX_ENTRIES = 200
MAX_FOLDER_BYTES = 256_000_000
SUFFIX = ".run"

_TOGETHER = 32  # moments in a piece
_LARGEST_PIECE = 16_000_000  # bytes, unpacked
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
        self._pieces: list[bytes] = []
        self._digests: list[str] = []
        self._loose = [start]
        self._is_new = False
        self._lasting: float = math.inf
        self._read()

    @property
    def last(self) -> int:
        """The latest tick that is known."""
        return len(self._pieces) * _TOGETHER + len(self._loose) - 1

    @property
    def lasts(self) -> bool:
        """Whether every tick would be the same again."""
        return self._lasting >= self.last

    def moment(self, tick: int) -> Moment:
        """What a known tick left behind.

        Raises:
            DamagedError: It was read from a file that is damaged or false.
        """
        piece, place = divmod(tick, _TOGETHER)
        if piece == len(self._pieces):
            return self._loose[place]
        return self._checked(moment_of(self._pieces[piece], self._digests[piece], place), tick)

    def add(self, moment: Moment, *, lasts: bool = True) -> None:
        """Take in the next tick.

        Args:
            moment: What it left behind.
            lasts: Whether it would be the same again; if not, it is kept for this process only, and
                so are the ticks after it.
        """
        self._loose.append(moment)
        self._is_new = True
        if not lasts:
            self._lasting = min(self._lasting, self.last - 1)
        if len(self._loose) == _TOGETHER:
            self._pack(self._loose)
            self._loose = []

    def forget(self) -> None:
        """Begin anew with the start, also on disk."""
        if (folder := _folder()) is not None:
            folder.drop(self._key)
        self._pieces, self._digests, self._loose = [], [], [self._start]
        self._lasting = math.inf

    def save(self) -> None:
        """Keep on disk what was added, as far as there is room, unless more is there already."""
        folder = _folder()
        if folder is None or not self._is_new:
            return
        self._is_new = False
        pieces, digests, loose = self._pieces, self._digests, self._loose
        if self._lasting < self.last:
            whole, more = divmod(int(self._lasting) + 1, _TOGETHER)
            loose = [self.moment(whole * _TOGETHER + at) for at in range(more)]
            pieces, digests = pieces[:whole], digests[:whole]
        count = len(pieces) * _TOGETHER + len(loose)
        if loose:
            pieces = [*pieces, packed(loose)]
            digests = [*digests, _digest(pieces[-1])]
        fits = _number_that_fits(map(len, pieces))
        if fits < len(pieces):
            pieces, digests, count = pieces[:fits], digests[:fits], fits * _TOGETHER
        there = folder.read(self._key, MAX_BYTES)
        if there is not None and _count(there) >= count:
            return
        index = {
            "key": self._key,
            "moments": count,
            "pieces": [[len(p), d] for p, d in zip(pieces, digests, strict=True)],
        }
        line = json.dumps(index).encode()
        folder.keep(self._key, [_digest(line).encode(), b"\n", line, b"\n", *pieces])

    # -- inside --------------------------------------------------------------------------------

    def _pack(self, moments: Sequence[Moment]) -> None:
        self._pieces.append(packed(moments))
        self._digests.append(_digest(self._pieces[-1]))

    def _read(self) -> None:
        """Take over what is on disk, if that is a recording of this run."""
        folder = _folder()
        content = None if folder is None else folder.read(self._key, MAX_BYTES)
        if content is None:
            return
        try:
            index, rest = _index(content)
            lengths = [length for length, _ in index["pieces"]]
            count, whole = index["moments"], index["moments"] // _TOGETHER
            if index["key"] != self._key or sum(lengths) != rest or not count > 0:
                raise DamagedError("another run, or not all of it")
            if len(lengths) != -(-count // _TOGETHER):
                raise DamagedError("not as many pieces as that takes")
            at = len(content) - rest
            for length, digest in index["pieces"]:
                self._pieces.append(content[at : at + length])
                self._digests.append(digest)
                at += length
            self._loose = []
            if more := count % _TOGETHER:
                piece, digest = self._pieces.pop(), self._digests.pop()
                self._loose = [
                    self._checked(moment_of(piece, digest, at), whole * _TOGETHER + at)
                    for at in range(more)
                ]
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


def packed(moments: Sequence[Moment]) -> bytes:
    """Moments as packed JSON."""
    return zlib.compress(json.dumps(laid_out(moments), separators=(",", ":")).encode(), _QUICK)


def moment_of(piece: bytes, digest: str, at: int) -> Moment:
    """One of the moments of a piece.

    Raises:
        DamagedError: There is none, or the piece is damaged.
    """
    try:
        return moment_in(_unpacked(piece, digest), at)
    except DamagedError:
        raise
    except (ValueError, TypeError, LookupError, StopIteration, RecursionError) as error:
        raise DamagedError("these are no moments") from error


@lru_cache(maxsize=_KEPT_OPEN)
def _unpacked(piece: bytes, digest: str) -> Any:
    if _digest(piece) != digest:
        raise DamagedError("the piece is damaged")
    unpacking = zlib.decompressobj()
    try:
        text = unpacking.decompress(piece, _LARGEST_PIECE)
    except zlib.error as error:
        raise DamagedError("the piece can't be unpacked") from error
    if not unpacking.eof:
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


def _number_that_fits(lengths: Iterable[int]) -> int:
    """How many of the first pieces fit into a file, with room for the index."""
    total, number = 0, 0
    for length in lengths:
        total += length + 100
        if total > MAX_BYTES - 1000:
            break
        number += 1
    return number


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
