"""Values of SQLite as functions take them: lists and records are JSON text there."""

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
"""How a number without end is written in JSON."""


def bounded(text: str) -> str:
    """The text, if a function may take it apart.

    Raises:
        TooLargeError: It may not.
    """
    if len(text) > MAX_ITEMS:
        check_long(text)
    return text


def list_in(text: Scalar) -> list[Any]:
    """The list that a value is.

    Raises:
        TypeError: It is none.
    """
    value = json.loads(bounded(text)) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def element(value: Scalar) -> Any:
    """A value to put in a list: what is JSON text goes in as the list or record that it is."""
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(bounded(value))
        except ValueError:
            return value
    return value


def real_as_json(value: Any) -> str | None:
    """A number as JSON text with all of its digits, whole ones as real ones; null is null."""
    if value.__class__ is float:
        text = repr(value)
        if "n" not in text:
            return text
        return ENDLESS if value > 0 else f"-{ENDLESS}"
    return value_as_json(float(value) if isinstance(value, int) else value)


def value_as_json(value: Any) -> str | None:
    """Any value as JSON text, a text that spells a record or a list as that; null is null."""
    kind = value.__class__
    if kind is str:
        return value if element(value) is not value else to_input(value)
    if kind is float:
        return real_as_json(value)
    return None if value is None else str(value)
