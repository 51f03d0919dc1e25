"""Values as SQLite stores them: records and lists are JSON text."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING, Any

import orjson

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["TooDeepError", "from_sql", "size_of", "to_input", "to_json", "to_sql"]

_DEEPEST = 100
_LONG = 10_000  # characters
_LARGEST = 2**63

_HIDING = ("\\", '"{', '"[', "Inf")
_ENDLESS = re.compile(r"e\+?\d\d\d")
"""What a text has that may hide a record in a text, half a character, or a number without end."""

_UNFIT = "\N{REPLACEMENT CHARACTER}"

_INFINITE = re.compile(r"(?<=[:\[,-])Inf(?=[,\]}])")


class TooDeepError(ValueError):
    """Records and lists are nested more deeply than they may be."""


_encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode


def to_json(value: Any) -> str:
    """A value as the JSON text that stands for it."""
    return _encode(value)


def to_input(value: Any) -> str:
    """A sensor or a memory as JSON text: quicker, and a number that JSON can't hold is null."""
    try:
        return orjson.dumps(value).decode()
    except TypeError:
        return _encode(value)  # whole numbers of more than 64 bits, halves of characters


def size_of(value: Value) -> int:
    """Bytes of the JSON text of a value; 0 for a number or null."""
    if isinstance(value, str) and len(value) > _LONG:
        return len(_encode(value).encode("utf-8", "replace"))  # orjson would crash without memory
    if not isinstance(value, str | list | dict):
        return 0
    try:
        return len(orjson.dumps(value))
    except TypeError:
        return len(_encode(value).encode("utf-8", "replace"))


def to_sql(value: Value) -> int | float | str | None:
    """A value as it stands in a table: records and lists as JSON text."""
    if isinstance(value, int) and not -_LARGEST <= value < _LARGEST:
        return float(value) if abs(value) < _LARGEST**16 else None
    if value is None or isinstance(value, int | float | str):
        return value
    return to_input(value)


def from_sql(value: Any, deepest: int = _DEEPEST) -> Value:
    """A value out of a table: JSON text is the record or list that it stands for.

    Args:
        value: As SQLite gave it.
        deepest: How deep records and lists may be nested.

    Raises:
        TooDeepError: They are nested more deeply.
    """
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, deepest)
        return _whole(value) if "\0" in value else value
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value  # type: ignore[no-any-return]  # SQLite has nothing else but numbers and null


def _from_json(text: str, deepest: int) -> Value:
    try:
        parsed = _parsed(text)
        if _is_shallow(text, deepest) and not _may_hide(text):
            return parsed  # type: ignore[no-any-return]  # there is nothing to unescape
    except RecursionError:
        raise _too_deep() from None
    except ValueError:
        return _whole(text)
    return _unescaped(parsed, deepest)


def _is_shallow(text: str, deepest: int) -> bool:
    """Whether JSON text is certainly nested no deeper; a list of records opens one after another.

    What opens right after another of its kind was closed lies no deeper than that did.
    """
    opened = text.count("[") + text.count("{")
    return opened <= deepest or opened - text.count("},{") - text.count("],[") <= deepest


def _may_hide(text: str) -> bool:
    """Whether JSON text may have to be looked at value by value."""
    return any(map(text.__contains__, _HIDING)) or _ENDLESS.search(text) is not None


def _parsed(text: str) -> Any:
    try:
        return orjson.loads(text)
    except ValueError:
        # Older SQLite writes an infinite number as Inf, which is no JSON.
        return json.loads(_INFINITE.sub("Infinity", text))


def _unescaped(value: Any, deepest: int) -> Value:
    """JSON in which no record or list hides in a text: SQLite forgets that a text is JSON.

    What is not a number becomes null; half characters, and NUL, with which a text in JSON
    ends for SQLite, a replacement character.
    """
    if isinstance(value, dict):
        if deepest <= 0:
            raise _too_deep()
        return {_whole(k): _unescaped(v, deepest - 1) for k, v in value.items()}
    if isinstance(value, list):
        if deepest <= 0:
            raise _too_deep()
        return [_unescaped(v, deepest - 1) for v in value]
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return _from_json(value, deepest)
        return _whole(value)
    if isinstance(value, float) and math.isnan(value):
        return None
    return value  # type: ignore[no-any-return]  # the rest of JSON is a Value


def _whole(text: str) -> str:
    """A text in which half characters and NUL are replaced."""
    whole = text if text.isascii() else text.encode("utf-8", "replace").decode()
    return whole.replace("\0", _UNFIT)


def _too_deep() -> TooDeepError:
    return TooDeepError("records and lists are nested too deeply in its result")
