"""Walls: where rays meet them, the clearance around them, comparing and packing them."""

from __future__ import annotations

import math
import zlib
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Bits = NDArray[np.bool_]
    _Bytes = NDArray[np.uint8]
    _Floats = NDArray[np.float64]
    _Ints = NDArray[np.int64]

FEWEST = 64
"""Up to this many rays are faster tested at every step at once."""

FEW = 640
"""Up to this many rays, fewer numpy calls are faster than fewer tests."""

_RIM = 2  # cells of wall around the map: rounding may carry a ray over one of them
_WALL = 255
_HALF_WINDOW = 4  # steps before and after a tested one that it may stand for
_WINDOW = 2 * _HALF_WINDOW + 1
_WINDOW_STEPS = np.arange(float(_WINDOW))[:, None]
_PLACES = np.arange(256)[:, None]
# Steps tested at once, about: with fewer there are more calls, with more each is slower.
_SAMPLES = 2048


class Walls:
    """The walls of a labyrinth, (height, width), not to be changed; outside is wall as well.

    Distances to the nearest wall tell how many steps of a ray to skip. A ray ends one map unit
    before `reach`, at most 254; `like` has nearly the same walls, for speed.
    """

    def __init__(self, walls: _Bits, reach: int, *, like: Walls | None = None) -> None:
        height, width = walls.shape
        self._reach = reach
        self._stride = width + 2 * _RIM
        self._end_x, self._end_y = width + 1.5, height + 1.5
        self._ahead = np.arange(float(reach))[:, None]
        self._walls = walls
        if like is not None and like._walls.shape == walls.shape and like._reach == reach:
            self._room = self._updated_room(like)
            return
        self._room = _rolled_room(PackedBits.pack(walls), reach)

    def distances(self, x: _Floats, y: _Floats, cos: _Floats, sin: _Floats) -> _Ints:
        """Return the first step of every ray in a wall, map units from 1, or the reach.

        Starts are of shape (robots,) and may be in a wall; `cos`, `sin` and result (robots, rays).
        """
        shape = cos.shape
        cos, sin = cos.reshape(-1), sin.reshape(-1)
        # From further outside the first step is in the margin, as it is from the margin.
        x = np.minimum(np.maximum(x, -2.0), self._end_x)
        y = np.minimum(np.maximum(y, -2.0), self._end_y)
        if len(cos) <= FEW:
            places = zip(x.tolist(), y.tolist(), strict=True)
            rooms = [
                self._room.item(math.floor(b) * self._stride + math.floor(a)) for a, b in places
            ]
            # The steps that are free of walls in any direction.
            free = min((0 if room == _WALL else room for room in rooms), default=self._reach - 1)
            x, y = x.repeat(shape[1]), y.repeat(shape[1])
            scan = self._scan_all_steps if len(cos) <= FEWEST else self._scan_near_walls
            return scan(x, y, cos, sin, free).reshape(shape)
        room = self._room_at(np.floor(x), np.floor(y))
        room[room == _WALL] = 0
        # Steps in which a ray crosses at most one cell, per cell. Slightly less, so that rounding
        # never carries a ray further than the free space.
        pace = (1 - 1e-9) / np.maximum(np.abs(cos), np.abs(sin))
        room = room.repeat(shape[1])
        x, y = x.repeat(shape[1]), y.repeat(shape[1])
        step = np.floor(room * pace) + 1
        rays = np.arange(len(step))
        first_steps = np.full(len(step), float(self._reach))
        while True:
            active = (step < self._reach).nonzero()[0]
            if not len(active):
                distances: _Ints = np.minimum(first_steps, self._reach).astype(np.int64)
                return distances.reshape(shape)
            if len(active) < len(rays):
                rays, pace, step = rays[active], pace[active], step[active]
                x, y, cos, sin = x[active], y[active], cos[active], sin[active]
            # The fewer rays are left, the more steps of each are tested at once. No ray gets past
            # the margin without being found in it, and behind a wall its position doesn't matter.
            ahead = self._ahead[: max(_SAMPLES // len(rays), 1)]
            steps = step + ahead
            room = self._room_at(np.floor(steps * cos + x), np.floor(steps * sin + y))
            best = room.argmax(axis=0)
            room = room[best, np.arange(len(rays))]
            stops = step + best
            step = np.maximum(step + len(ahead), stops + np.floor(room * pace) + 1)
            stops[room < _WALL] = self._reach
            first_steps[rays] = stops

    def _scan_all_steps(
        self, x: _Floats, y: _Floats, cos: _Floats, sin: _Floats, free: int
    ) -> _Ints:
        """Like `distances`, for arrays (rays,); the first `free` steps are not in walls."""
        # A ray behind a wall may be anywhere; only its first wall matters.
        x, y, cos, sin = x[:, None], y[:, None], cos[:, None], sin[:, None]
        in_wall = self._room_on(x, y, cos, sin, self._ahead[free:, 0] + 1) == _WALL
        in_wall[:, -1] = True  # the reach itself
        first_steps: _Ints = in_wall.argmax(axis=1)
        return first_steps + (free + 1)

    def _updated_room(self, like: Walls) -> _Bytes:
        """Return the free space around cells, recomputed only where the walls differ."""
        box = difference_box(like._walls, self._walls)
        if box is None:
            return like._room
        # The walls nearest to a cell in the part that may change may be as far away again.
        room = like._room.copy()
        part, outer = (
            [
                slice(max(changed.start - margin, 0), min(changed.stop + margin, length))
                for changed, length in zip(box, self._walls.shape, strict=True)
            ]
            for margin in (self._reach, 2 * self._reach)
        )
        pads = [
            (_RIM * (span.start == 0), _RIM * (span.stop == length))
            for span, length in zip(outer, self._walls.shape, strict=True)
        ]
        walls = np.pad(self._walls[tuple(outer)], pads, constant_values=True)
        inner = tuple(
            slice(span.start - wide.start + pad, span.stop - wide.start + pad)
            for span, wide, (pad, _) in zip(part, outer, pads, strict=True)
        )
        room[tuple(part)] = _room(walls, self._reach)[inner]
        return room

    def _scan_near_walls(
        self, x: _Floats, y: _Floats, cos: _Floats, sin: _Floats, free: int
    ) -> _Ints:
        """Return the same, testing only steps with little free space around them."""
        first = min(free + 1 + _HALF_WINDOW, self._reach)
        samples = np.arange(float(first), self._reach + _HALF_WINDOW, _WINDOW)
        room = self._room_on(x, y, cos, sin, samples[:, None])
        room += np.uint8(1)  # and a wall has none
        near = room < _HALF_WINDOW + 2
        in_wall = room == 0
        in_wall[-1] = True
        near &= _PLACES[: len(samples)] <= in_wall.argmax(axis=0)
        place, ray = np.divmod(near.reshape(-1).nonzero()[0], len(x))
        start = samples[place] - _HALF_WINDOW
        in_wall = self._room_on(x[ray], y[ray], cos[ray], sin[ray], start + _WINDOW_STEPS) == _WALL
        best = in_wall.argmax(axis=0)
        # Last to first, so that the first of each ray is the one that stays.
        which = in_wall[best, np.arange(len(best))].nonzero()[0][::-1]
        first_steps = np.full(len(x), self._reach)
        first_steps[ray[which]] = (start + best)[which]
        np.minimum(first_steps, self._reach, out=first_steps)
        return first_steps

    def _room_on(
        self, x: _Floats, y: _Floats, cos: _Floats, sin: _Floats, steps: _Floats
    ) -> _Bytes:
        column, row = cos * steps, sin * steps
        column += x
        row += y
        return self._room_at(np.floor(column, out=column), np.floor(row, out=row))

    def _room_at(self, column: _Floats, row: _Floats) -> _Bytes:
        row *= self._stride
        row += column
        return self._room.take(row.astype(np.int32), mode="wrap")


def _room(walls: _Bits, reach: int) -> _Bytes:
    """Return how many cells around each are free in every direction, less than the reach.

    The -1 of a wall itself wraps to 255, more than any reach, and so ends a ray.
    """
    room = clearances(walls, reach)
    room -= np.uint8(1)
    return room


@lru_cache(maxsize=4)
def _rolled_room(walls: PackedBits, reach: int) -> _Bytes:
    """Return the free space around cells with a rim, not to be changed; worlds share their level's.

    It is rolled so that cell (0, 0) comes first; the margin to the left and above is at the end.
    """
    room = _room(np.pad(walls.bits(), _RIM, constant_values=True), reach)
    room = np.roll(room, -room.shape[1] * _RIM - _RIM)
    room.flags.writeable = False
    return room


_ROWS_AT_ONCE = 64  # bounds the memory for distances along rows


def clearances(walls: _Bits, limit: int) -> _Bytes:
    """Return every cell's distance to the nearest wall; diagonal steps count as 1.

    The shape is that of `walls`, (height, width): 0 in a wall, 1 beside one, at most `limit`
    (1 to 254).
    """
    distances = row_clearances(walls, limit)
    # A shortest path to a wall goes to the wall's row first, diagonally as far as that helps,
    # and then along the row.
    _carry_over(distances)
    _carry_over(distances[::-1])
    return distances


def row_clearances(walls: _Bits, limit: int) -> _Bytes:
    """Like `clearances`, but within each row."""
    distances = np.empty(walls.shape, dtype=np.uint8)
    column = np.arange(walls.shape[1], dtype=np.int32)
    outside = np.int32(walls.shape[1] + limit)
    for start in range(0, len(walls), _ROWS_AT_ONCE):
        rows = walls[start : start + _ROWS_AT_ONCE]
        left = np.maximum.accumulate(np.where(rows, column, -limit), axis=1)
        right = np.minimum.accumulate(np.where(rows, column, outside)[:, ::-1], axis=1)[:, ::-1]
        near = np.minimum(np.minimum(column - left, right - column), limit)
        distances[start : start + _ROWS_AT_ONCE] = near
    return distances


def _carry_over(distances: _Bytes) -> None:
    """Limit each row from the second on to 1 more than its neighbours in the row before."""
    limits = np.empty_like(distances[0])
    for previous, row in pairwise(distances):
        np.minimum(previous[1:], previous[:-1], out=limits[1:])
        limits[0] = previous[0]
        np.minimum(limits[:-1], previous[1:], out=limits[:-1])
        limits += 1
        np.minimum(row, limits, out=row)


class PackedBits(NamedTuple):
    shape: tuple[int, int]
    compressed: bytes

    @classmethod
    def pack(cls, bits: _Bits) -> PackedBits:
        height, width = bits.shape
        return cls((height, width), zlib.compress(np.packbits(bits).tobytes(), 1))

    def bits(self) -> _Bits:
        """Return the bits as a read-only array."""
        height, width = self.shape
        packed = np.frombuffer(zlib.decompress(self.compressed), np.uint8)
        bits: _Bits = np.unpackbits(packed, count=height * width).view(np.bool_)
        bits.flags.writeable = False
        return bits.reshape(self.shape)


def difference_box(old: _Bits, new: _Bits) -> tuple[slice, slice] | None:
    if old is new:
        return None
    old_words: NDArray[Any] = old
    new_words: NDArray[Any] = new
    if old.shape[1] % 8 == 0 and old.flags.c_contiguous and new.flags.c_contiguous:
        old_words, new_words = old.view(np.uint64), new.view(np.uint64)  # eight units at a time
    rows = np.flatnonzero((old_words != new_words).any(axis=1))
    if not len(rows):
        return None
    down = slice(int(rows[0]), int(rows[-1]) + 1)
    columns = np.flatnonzero((old[down] != new[down]).any(axis=0))
    return down, slice(int(columns[0]), int(columns[-1]) + 1)
