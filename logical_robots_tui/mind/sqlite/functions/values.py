"""SQLite values in functions: lists and records are JSON text."""

from __future__ import annotations

import json
from typing import Any, TypeAlias

from logical_robots_tui.mind.sqlite.bounds import MAX_ITEMS, check_long
from logical_robots_tui.mind.sqlite.stored import to_input

__all__ = [
    "ENDLESS",
    "Scalar",
    "bounded",
    "element",
    "list_in",
    "real_as_json",
    "value_as_json",
]

Scalar: TypeAlias = "int | float | str | None"

ENDLESS = "9.0e+999"
"""Infinity in JSON."""


def bounded(text: str) -> str:
    """Return the text, if a function may parse it.

    Raises:
        TooLargeError: It is too large.
    """
    if len(text) > MAX_ITEMS:
        check_long(text)
    return text


def list_in(text: Scalar) -> list[Any]:
    """Return the list in a value.

    Raises:
        TypeError: It is not a list.
    """
    value = json.loads(bounded(text)) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def element(value: Scalar) -> Any:
    """Return a value as a list element; JSON text becomes the list or record in it."""
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(bounded(value))
        except ValueError:
            return value
    return value


def real_as_json(value: Any) -> str | None:
    """Return a number as JSON text with all of its digits, integers as reals; null is null."""
    if value.__class__ is float:
        text = repr(value)
        if "n" not in text:
            return text
        return ENDLESS if value > 0 else f"-{ENDLESS}"
    return value_as_json(float(value) if isinstance(value, int) else value)


def value_as_json(value: Any) -> str | None:
    """Return any value as JSON text, with records and lists in texts parsed; null is null."""
    kind = value.__class__
    if kind is str:
        return value if element(value) is not value else to_input(value)
    if kind is float:
        return real_as_json(value)
    return None if value is None else str(value)
