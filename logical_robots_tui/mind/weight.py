"""What values weigh: bytes that they take as objects, by a rule that is the same everywhere.

Text says little about it: an empty record has two characters and takes 64 bytes.
"""

from __future__ import annotations

import mmap
import resource
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["HEAVIEST_CHARACTER", "check_room", "is_bounded", "weight_of", "weight_of_text"]

HEAVIEST_CHARACTER = 44
"""Bytes that no value takes for each character of its JSON text."""

_RECORD, _FIELD = 184, 28  # CPython's dict, for its least size and for each field
_LIST, _ITEM = 56, 8
_TEXT = 50
_NUMBER = 32

_LONG = 10_000  # characters of a text from which on it is looked at closely


def weight_of(value: Value, most: int) -> int:
    """Bytes that a value takes as objects, or some number above `most`.

    Args:
        value: Any value.
        most: Where to stop counting.
    """
    weight = 0
    left: list[Value] = [value]
    while left and weight <= most:
        value = left.pop()
        if isinstance(value, dict):
            weight += _RECORD + _FIELD * len(value) if value else 64
            weight += sum([_TEXT + len(name) for name in value])
            left += value.values()
        elif isinstance(value, list):
            weight += _LIST + _ITEM * len(value)
            left += value
        elif isinstance(value, str):
            weight += _TEXT + len(value) * (1 if value.isascii() else 4)
        else:
            weight += _NUMBER
    return weight


def weight_of_text(text: str) -> int:
    """At least as many bytes as what JSON text stands for takes as objects."""
    if len(text) < _LONG:
        return len(text) * HEAVIEST_CHARACTER
    parts = text.count(",") * (_ITEM + _FIELD + _NUMBER) + text.count('"') * _TEXT
    opened = text.count("{") * (_RECORD + _FIELD + _NUMBER) + text.count("[") * (_LIST + _NUMBER)
    return len(text) * (1 if text.isascii() else 4) + parts + opened


def is_bounded() -> bool:
    """Whether the address space of the process has a bound, as that of a restricted game has.

    Where it has none, what is the bound is the machine's memory, and nobody can ask for that.
    """
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def check_room(size: int) -> None:
    """See whether the process may still take so many bytes of address space.

    Not all that a thought needs fails softly where there is no room: orjson crashes. So there has
    to be enough before it begins.

    Raises:
        MemoryError: There is less.
    """
    if not is_bounded():
        return
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | _NO_RESERVE).close()
    except OSError:
        raise MemoryError from None


_NO_RESERVE = getattr(mmap, "MAP_NORESERVE", 0)
