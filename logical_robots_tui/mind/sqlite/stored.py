"""Values as SQLite stores them: records and lists are JSON text."""

from __future__ import annotations

import json
import math
import re
from typing import Any

import orjson

from logical_robots_tui.values import Value

_DEEPEST = 100
_LONG = 10_000  # characters
_LARGEST = 2**63

_HIDING = ("\\", '"{', '"[', "Inf")
_ENDLESS = re.compile(r"e\+?\d\d\d")
"""Characters of a text that may contain a record, a lone surrogate, or an infinite number."""

_UNFIT = "\N{REPLACEMENT CHARACTER}"

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


def from_sql(value: Any, deepest: int = _DEEPEST) -> Value:
    """Return a value from a table, with JSON text parsed; raise TooDeepError."""
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, deepest)
        return _whole(value) if "\0" in value else value
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value  # type: ignore[no-any-return]  # SQLite has nothing else but numbers and null


def _from_json(text: str, deepest: int) -> Value:
    try:
        try:
            parsed: Value = orjson.loads(text)
        except ValueError:
            # Older SQLite writes infinity as Inf, which is not JSON.
            parsed = json.loads(_INFINITE.sub("Infinity", text))
        opened = text.count("[") + text.count("{")
        if opened > deepest:  # of siblings one counts
            opened -= text.count("},{") + text.count("],[")
        is_shallow = opened <= deepest
        if is_shallow and not any(map(text.__contains__, _HIDING)) and not _ENDLESS.search(text):
            return parsed
    except RecursionError:
        raise TooDeepError(_TOO_DEEP) from None
    except ValueError:
        return _whole(text)
    return _unescape(parsed, deepest)


def _unescape(value: Any, deepest: int) -> Value:
    """Parse records and lists in texts as well: SQLite forgets that a text is JSON.

    Other constants become null; lone surrogates and NUL become the replacement character.
    """
    if isinstance(value, dict):
        if deepest <= 0:
            raise TooDeepError(_TOO_DEEP)
        return {_whole(k): _unescape(v, deepest - 1) for k, v in value.items()}
    if isinstance(value, list):
        if deepest <= 0:
            raise TooDeepError(_TOO_DEEP)
        return [_unescape(v, deepest - 1) for v in value]
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, deepest)
        return _whole(value)
    if isinstance(value, float) and math.isnan(value):
        return None
    return value  # type: ignore[no-any-return]  # the rest of JSON is a Value


def _whole(text: str) -> str:
    whole = text if text.isascii() else text.encode("utf-8", "replace").decode()
    return whole.replace("\0", _UNFIT)


_SHORT = 100  # characters; parsing a shorter text is as fast as looking it up
_LONG_KEPT = 100_000  # characters; longer texts are not kept, because their objects take far more
_ROOM = 400_000  # characters parsed before entries that were not used meanwhile are dropped


class Interner:
    """Parses values for callers that never change them; equal ones stay the same objects."""

    def __init__(self) -> None:
        self._now: dict[str, Value] = {}
        self._before: dict[str, Value] = {}
        self._room = _ROOM

    def read(self, value: Any, deepest: int) -> Value:
        """Return a value as `from_sql` does, with the same depth each time."""
        is_nested = value.__class__ is str and value[:1] in _OPENING
        if not is_nested or not _SHORT <= len(value) < _LONG_KEPT:
            return from_sql(value, deepest)
        found = self._now.get(value)
        if found is None:
            found = self._before.get(value)
            if found is None:
                found = from_sql(value, deepest)
            self._room -= len(value)
            if self._room < 0:
                self._before, self._now, self._room = self._now, {}, _ROOM
            self._now[value] = found
        return found


_OPENING = frozenset("{[")
