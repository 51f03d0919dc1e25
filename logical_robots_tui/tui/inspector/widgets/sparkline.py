"""A row of values as a line of characters, one for each tick."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["BARS", "Sample", "scale", "sparkline"]

BARS = "▁▂▃▄▅▆▇█"
_PLAIN_BARS = "_.-:=+*#"
_SAME, _OTHER, _NONE, _UNKNOWN = "─", "┼", "·", " "
_PLAIN = {_SAME: "-", _OTHER: "|", _NONE: "."}


class Sample(NamedTuple):
    """What a line shows of one tick.

    Attributes:
        number: The value, if it is a number.
        likeness: Something that equal values have in common; None if there is no value.
    """

    number: float | None
    likeness: int | None


def sparkline(samples: Sequence[Sample | None], *, counts: bool, plain: bool = False) -> str:
    """A character for each tick: a bar for a number; for other values whether they change.

    Args:
        samples: The ticks; None where nothing is known.
        counts: Whether the bars stand on 0, as they should for numbers of rows.
        plain: Whether to use characters that every terminal has.
    """
    found = scale(samples, counts=counts)
    bars = _PLAIN_BARS if plain else BARS
    line = []
    for before, sample in pairwise((None, *samples)):
        if sample is not None and sample.number is not None and found is not None:
            line.append(bars[_height(sample.number, *found)])
        else:
            sign = _sign(before, sample)
            line.append(_PLAIN.get(sign, sign) if plain else sign)
    return "".join(line)


def scale(samples: Sequence[Sample | None], *, counts: bool) -> tuple[float, float] | None:
    """The lowest and the highest number of a line, or None if it has no numbers."""
    numbers = [each.number for each in samples if each is not None and each.number is not None]
    if not numbers:
        return None
    return min([0.0, *numbers] if counts else numbers), max(numbers)


def _height(number: float, low: float, high: float) -> int:
    """Which bar; numbers that are all the same are halfway up, or at the bottom if they are 0."""
    if low == high:
        return len(BARS) // 2 - 1 if number else 0
    if math.isinf(high - low):
        number, low, high = number / 2, low / 2, high / 2
    share = (number - low) / (high - low)
    return min(int(share * len(BARS)), len(BARS) - 1)


def _sign(before: Sample | None, sample: Sample | None) -> str:
    if sample is None:
        return _UNKNOWN
    if sample.likeness is None:
        return _NONE
    return _OTHER if before is not None and before.likeness != sample.likeness else _SAME
