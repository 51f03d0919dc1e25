"""Values as SQLite stores them: records and lists are JSON text."""

from __future__ import annotations

import json
import math
import re
from typing import Any

import orjson

from logical_robots_tui.values import Value

_MAX_DEPTH = 100
_LONG = 10_000  # characters
_LARGEST = 2**63

_SUSPECTS = ("\\", '"{', '"[', "Inf")
_HUGE = re.compile(r"e\+?\d\d\d")
"""Characters of a text that may contain a record, a lone surrogate, or an infinite number."""

_REPLACEMENT = "\N{REPLACEMENT CHARACTER}"

_INFINITE = re.compile(r"(?<=[:\[,-])Inf(?=[,\]}])")


class TooDeepError(ValueError):
    """Records and lists are nested too deeply."""


_TOO_DEEP = "records and lists are nested too deeply in its result"

to_json = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
"""Writes a value as JSON text."""


def to_input(value: Any) -> str:
    """Return a sensor or memory as JSON text, fast; numbers that JSON lacks become null."""
    try:
        return orjson.dumps(value).decode()
    except TypeError:
        return to_json(value)  # integers of more than 64 bits, lone surrogates


def size_of(value: Value) -> int:
    """Return the bytes of the JSON text of a value; 0 for a number or null."""
    if isinstance(value, str) and len(value) > _LONG:
        return len(to_json(value).encode("utf-8", "replace"))  # orjson crashes when memory runs out
    if not isinstance(value, str | list | dict):
        return 0
    try:
        return len(orjson.dumps(value))
    except TypeError:
        return len(to_json(value).encode("utf-8", "replace"))


def to_sql(value: Value) -> int | float | str | None:
    if isinstance(value, int) and not -_LARGEST <= value < _LARGEST:
        return float(value) if abs(value) < _LARGEST**16 else None
    if value is None or isinstance(value, int | float | str):
        return value
    return to_input(value)


def from_sql(value: Any, max_depth: int = _MAX_DEPTH) -> Value:
    """Return a value from a table, with JSON text parsed; raise TooDeepError."""
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, max_depth)
        return _clean(value) if "\0" in value else value
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value  # type: ignore[no-any-return]  # SQLite has nothing else but numbers and null


def _from_json(text: str, max_depth: int) -> Value:
    try:
        try:
            parsed: Value = orjson.loads(text)
        except ValueError:
            # Older SQLite writes infinity as Inf, which is not JSON.
            parsed = json.loads(_INFINITE.sub("Infinity", text))
        depth_bound = text.count("[") + text.count("{")
        if depth_bound > max_depth:  # of siblings one counts
            depth_bound -= text.count("},{") + text.count("],[")
        is_shallow = depth_bound <= max_depth
        if is_shallow and not any(map(text.__contains__, _SUSPECTS)) and not _HUGE.search(text):
            return parsed
    except RecursionError:
        raise TooDeepError(_TOO_DEEP) from None
    except ValueError:
        return _clean(text)
    return _unescape(parsed, max_depth)


def _unescape(value: Any, depth_left: int) -> Value:
    """Parse records and lists in texts as well: SQLite forgets that a text is JSON.

    Other constants become null; lone surrogates and NUL become the replacement character.
    """
    if isinstance(value, dict):
        if depth_left <= 0:
            raise TooDeepError(_TOO_DEEP)
        return {_clean(k): _unescape(v, depth_left - 1) for k, v in value.items()}
    if isinstance(value, list):
        if depth_left <= 0:
            raise TooDeepError(_TOO_DEEP)
        return [_unescape(v, depth_left - 1) for v in value]
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, depth_left)
        return _clean(value)
    if isinstance(value, float) and math.isnan(value):
        return None
    return value  # type: ignore[no-any-return]  # the rest of JSON is a Value


def _clean(text: str) -> str:
    encodable = text if text.isascii() else text.encode("utf-8", "replace").decode()
    return encodable.replace("\0", _REPLACEMENT)


_SHORT = 100  # characters; parsing a shorter text is as fast as a lookup
_MAX_CACHED_LENGTH = 100_000  # characters; the objects of longer texts take far more
_CACHED_CHARACTERS = 400_000  # parsed before unused entries are dropped


class Interner:
    """Parses values for callers that never change them; equal ones stay the same objects."""

    def __init__(self) -> None:
        self._recent: dict[str, Value] = {}
        self._previous: dict[str, Value] = {}
        self._characters_left = _CACHED_CHARACTERS

    def read(self, value: Any, max_depth: int) -> Value:
        """Return a value as `from_sql` does, with the same depth each time."""
        is_nested = value.__class__ is str and value[:1] in _OPENING
        if not is_nested or not _SHORT <= len(value) < _MAX_CACHED_LENGTH:
            return from_sql(value, max_depth)
        parsed = self._recent.get(value)
        if parsed is None:
            parsed = self._previous.get(value)
            if parsed is None:
                parsed = from_sql(value, max_depth)
            self._characters_left -= len(value)
            if self._characters_left < 0:
                self._previous, self._recent = self._recent, {}
                self._characters_left = _CACHED_CHARACTERS
            self._recent[value] = parsed
        return parsed


_OPENING = frozenset("{[")
