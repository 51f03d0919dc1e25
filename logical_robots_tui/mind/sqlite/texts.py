"""Text functions: as DuckDB formats, and in place of SQLite's own that can take minutes.

SQLite compares every position of a text with every position of another. The functions of
`REPLACED` use linear algorithms, or refuse.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from logical_robots_tui.mind.sqlite.budget import TooLargeError, check_text

_DIRECTIVE = re.compile(r"%([-+ 0#]*)(\d*)(?:\.(\d*))?[hlLqjzt]*(.)", re.DOTALL)
_WHOLE = frozenset("diuoxXc")
_REAL = frozenset("eEfFgG")

_CAPITALS = {"ß": "ẞ"}  # Python has no single upper-case character for these


def decimal_to_text(value: float, scale: int) -> str:
    if not math.isfinite(value):
        return str(value)
    check_text(scale)
    return f"{value + 0.0 if value else 0.0:.{scale}f}"


def format_text(template: str, *values: Any) -> str:
    """Format as C's printf does; ValueError for an unknown directive or a missing value."""
    arguments = list(values)
    length = 0

    def formatted(match: re.Match[str]) -> str:
        nonlocal length
        flags, width, digits, kind = match.groups()
        if kind == "%":
            return "%"
        length += int(width or 0) + int(digits or 0)
        check_text(length)
        value = arguments.pop(0) if arguments else None
        if value is None:
            raise ValueError(f"no value for {match.group()}")
        precision = "" if digits is None else f".{digits or 0}"
        if kind in _WHOLE:
            value = value if kind == "c" and isinstance(value, str) else int(float(value))
        elif kind in _REAL:
            value = float(value)
        elif kind != "s":
            raise ValueError(f"no directive {match.group()}")
        return f"%{flags}{width}{precision}{kind}" % value

    return _DIRECTIVE.sub(formatted, template)


def round_to(value: float, digits: float) -> float:
    """Round halves away from zero, to digits after the point or, if negative, before it."""
    if digits > (0 if isinstance(value, int) else sys.float_info.max_10_exp):
        return value
    if digits < -sys.float_info.max_10_exp:
        return 0 * value
    factor = 10 ** abs(int(digits))
    scaled = abs(value * factor if digits >= 0 else value / factor)
    if not math.isfinite(scaled):
        return value
    rounded = math.copysign(math.floor(scaled + 0.5), value)
    quotient = rounded / factor if digits >= 0 else rounded * factor
    return int(quotient) if isinstance(value, int) else quotient


def upper(text: str) -> str:
    """Return a text in upper case, character by character."""
    if text.isascii():
        return text.upper()
    pairs = ((character, character.upper()) for character in text)
    return "".join(
        capital if len(capital) == 1 else _CAPITALS.get(character, character)
        for character, capital in pairs
    )


def lower(text: str) -> str:
    """Return a text in lower case, character by character."""
    return text.lower() if text.isascii() else "".join(c.lower()[:1] for c in text)


def character(code: int) -> str:
    """Return a character by its number; U+FFFD if there is none."""
    is_one = 0 <= code <= sys.maxunicode and not 0xD800 <= code < 0xE000
    return chr(code) if is_one else "\ufffd"


def reverse(text: str) -> str:
    """Return a text backwards, with marks after the letters that they belong to."""
    if text.isascii():
        return text[::-1]
    from wcwidth import iter_graphemes  # here, because hardly a program needs it

    return "".join(list(iter_graphemes(text))[::-1])


def repeat(text: str, times: float) -> str:
    check_text(len(text) * max(0, int(times)))
    return text * int(times)


def pad_left(text: str, length: float, fill: str = " ") -> str:
    """Return a text of exactly that length: filled on the left, or without its end."""
    return _filling(text, length, fill) + text[: max(0, int(length))]


def pad_right(text: str, length: float, fill: str = " ") -> str:
    """Return a text of exactly that length: filled on the right, or without its end."""
    return text[: max(0, int(length))] + _filling(text, length, fill)


def _filling(text: str, length: float, fill: str) -> str:
    check_text(int(length))
    missing = max(0, int(length) - len(text))
    if missing and not fill:
        raise ValueError("nothing to fill with")
    return (fill * missing)[:missing]


_MAX_PATTERN_LENGTH = 1_000
_PATTERN_BYTES = 250_000  # of a compiled one, which so has at most some 15,000 states


def regexp_extract(text: str, pattern: str) -> str:
    """Return the first match of a regular expression of RE2, DuckDB's library, or ""."""
    match = _compiled(pattern).search(text)
    return match.group() if match else ""


def states_of(pattern: str) -> int:
    """Return the states of a pattern, which RE2 tries at each character if they are many."""
    if len(pattern) > _MAX_PATTERN_LENGTH:
        raise TooLargeError(f"a pattern of {len(pattern):,} characters")
    states: int = _compiled(pattern).programsize
    return states


@lru_cache(maxsize=64)
def _compiled(pattern: str) -> Any:
    import re2  # here, because few programs use it

    options = re2.Options()
    options.log_errors = False
    options.max_mem = _PATTERN_BYTES
    return re2.compile(pattern, options)


_MAX_TRIMMED = 30
_MAX_COMPARISONS = 5_000_000


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _like(pattern: Any, text: Any, escape: str = "") -> int:
    pattern, text = _text(pattern), _text(text)
    if len(pattern) > _MAX_PATTERN_LENGTH:
        raise TooLargeError(f"a pattern of {len(pattern):,} characters")
    pieces: list[list[str]] = [[]]
    characters = iter(pattern)
    for character in characters:
        if escape and character == escape:
            pieces[-1].append(next(characters, ""))
        elif character == "%":
            pieces.append([])
        else:
            pieces[-1].append("" if character == "_" else character)
    first, *middle_pieces = pieces
    if not middle_pieces:
        return int(len(text) == len(first) and _find(first, text, 0, len(text)) == 0)
    last = middle_pieces.pop()
    start, end = len(first), len(text) - len(last)
    if start > end or _find(first, text, 0, start) != 0 or _find(last, text, end, len(text)) < 0:
        return 0
    for piece in middle_pieces:
        index = _find(piece, text, start, end)
        if index < 0:
            return 0
        start = index + len(piece)
    return 1


def _find(piece: list[str], text: str, start: int, end: int) -> int:
    if "" not in piece:
        return text.find("".join(piece), start, end)
    if (end - start) * len(piece) > _MAX_COMPARISONS and end - start > len(piece):
        raise TooLargeError("a pattern with many _ on a long string")
    pattern = re.compile("".join(re.escape(c) if c else "." for c in piece), re.DOTALL)
    match = pattern.search(text, start, end)
    return match.start() if match else -1


def _replace(text: Any, old: Any, new: Any) -> Any:
    text, old, new = _text(text), _text(old), _text(new)
    if not old:
        return text
    if len(new) > len(old):
        check_text(len(text) + text.count(old) * (len(new) - len(old)))
    return text.replace(old, new)


def _trimmer(strip: Callable[[str, str], str]) -> Callable[..., str]:
    def trim(text: Any, characters: Any = " ") -> str:
        trimmed_set = "".join(set(_text(characters)))
        if len(trimmed_set) > _MAX_TRIMMED:
            raise TooLargeError(f"{len(trimmed_set):,} different characters to trim")
        return strip(_text(text), trimmed_set)

    return trim


REPLACED: dict[str, tuple[tuple[int, ...], Callable[..., Any]]] = {
    "instr": ((2,), lambda text, part: _text(text).find(_text(part)) + 1),
    "like": ((2, 3), _like),
    "ltrim": ((1, 2), _trimmer(str.lstrip)),
    "replace": ((3,), _replace),
    "rtrim": ((1, 2), _trimmer(str.rstrip)),
    "trim": ((1, 2), _trimmer(str.strip)),
}
"""Numbers of arguments and function by SQL name. Null in, null out."""
