"""Values as SQLite stores them: records and lists are JSON text."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from logical_robots_tui.values import Value

__all__ = ["from_sql", "to_json", "to_sql"]

_INFINITE = re.compile(r"(?<=[:\[,-])Inf(?=[,\]}])")


def to_json(value: Any) -> str:
    """A value as the JSON text that stands for it."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def to_sql(value: Value) -> int | float | str | None:
    """A value as it stands in a table: records and lists as JSON text."""
    if value is None or isinstance(value, int | float | str):
        return value
    return to_json(value)


def from_sql(value: Any) -> Value:
    """A value out of a table: JSON text is the record or list that it stands for."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return _unescaped(_parsed(value))
        except (ValueError, RecursionError):
            return value
    if isinstance(value, int | float | str) or value is None:
        return value
    return str(value)


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        # Older SQLite writes an infinite number as Inf, which is no JSON.
        return json.loads(_INFINITE.sub("Infinity", text))


def _unescaped(value: Any) -> Value:
    """JSON in which no record or list hides in a text: SQLite forgets that a text is JSON.

    Numbers that JSON can't hold become null, and half characters a replacement character.
    """
    if isinstance(value, dict):
        return {k: _unescaped(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_unescaped(v) for v in value]
    if isinstance(value, str):
        if value[:1] in ("{", "["):
            return from_sql(value)
        return value if value.isascii() else value.encode("utf-8", "replace").decode()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value  # type: ignore[no-any-return]  # the rest of JSON is a Value
