"""Bitmaps such as walls: comparing and compressing them."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["PackedBits", "changed_box"]


class PackedBits(NamedTuple):
    """A compressed two-dimensional bool array.

    Attributes:
        shape: Of the array.
        data: Its bytes.
    """

    shape: tuple[int, int]
    data: bytes

    @classmethod
    def of(cls, bits: NDArray[np.bool_]) -> PackedBits:
        """Pack an array."""
        height, width = bits.shape
        return cls((height, width), zlib.compress(np.packbits(bits).tobytes(), 1))

    def bits(self) -> NDArray[np.bool_]:
        """Return the array."""
        height, width = self.shape
        packed = np.frombuffer(zlib.decompress(self.data), np.uint8)
        return np.unpackbits(packed, count=height * width).reshape(self.shape).view(np.bool_)


def changed_box(before: NDArray[np.bool_], after: NDArray[np.bool_]) -> tuple[slice, slice] | None:
    """Return the smallest rows and columns that hold all differences of arrays of one shape."""
    if before is after:
        return None
    rows = np.flatnonzero(_unequal_rows(before, after))
    if not len(rows):
        return None
    down = slice(int(rows[0]), int(rows[-1]) + 1)
    columns = np.flatnonzero((before[down] != after[down]).any(axis=0))
    return down, slice(int(columns[0]), int(columns[-1]) + 1)


def _unequal_rows(before: NDArray[Any], after: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which rows differ; compares eight units at a time where the width allows."""
    if before.shape[1] % 8 == 0 and before.flags.c_contiguous and after.flags.c_contiguous:
        before, after = before.view(np.uint64), after.view(np.uint64)
    unequal: NDArray[np.bool_] = (before != after).any(axis=1)
    return unequal
