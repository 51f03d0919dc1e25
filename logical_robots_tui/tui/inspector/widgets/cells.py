"""Values of a program, written the short way."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from logical_robots_tui.tui.theme.safe_text import clip, visible
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

FULL = 20_000
"""Characters after which even the full view of a value ends."""

_WORDS = {"null", "true", "false", ""}


def is_number(value: Value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def cell(value: Value, limit: int = 120) -> tuple[str, str]:
    """A value's text and colour, by kind; text without quotes where that is clear."""
    if isinstance(value, str) and not _could_be_taken_for_another(value):
        return clip(visible(value[: limit + 1]), limit), INK.string
    return written(value, limit), _colour(value)


def written(value: Value, limit: int = FULL) -> str:
    """Return a value in program syntax, in at most `limit` characters."""
    parts: list[str] = []
    _write(value, parts, [limit])
    return clip("".join(parts), limit)


def _write(value: Value, parts: list[str], room: list[int]) -> None:
    """Append the value's text to `parts` until the room is used up."""
    if room[0] < 0:
        return
    if isinstance(value, str):
        _put(f'"{visible(value[: max(room[0], 0) + 1])}"', parts, room)
    elif isinstance(value, Mapping):
        for number, (key, item) in enumerate(value.items()):
            _put(f"{', ' if number else '{'}{visible(key)}: ", parts, room)
            _write(item, parts, room)
            if room[0] < 0:
                return
        _put("}" if value else "{}", parts, room)
    elif isinstance(value, Sequence):
        for number, item in enumerate(value):
            _put(", " if number else "[", parts, room)
            _write(item, parts, room)
            if room[0] < 0:
                return
        _put("]" if value else "[]", parts, room)
    else:
        _put(_scalar(value), parts, room)


def _put(text: str, parts: list[str], room: list[int]) -> None:
    parts.append(text)
    room[0] -= len(text)


def _scalar(value: float | bool | None) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        # Python refuses to print whole numbers of thousands of digits.
        return str(value) if value.bit_length() < 256 else f"{value:#x}"
    if not math.isfinite(value):
        return str(value)
    if value == int(value) and abs(value) < 1e6:
        return f"{value:.1f}"
    return f"{value:.6g}"


def _could_be_taken_for_another(text: str) -> bool:
    if text in _WORDS or text[0] in '{["' or text != text.strip():
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True


def _colour(value: Value) -> str:
    if value is None:
        return INK.dim
    if isinstance(value, str):
        return INK.string
    if isinstance(value, (bool, int, float)):
        return INK.number
    return INK.record
