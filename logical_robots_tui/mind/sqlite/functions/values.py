"""SQLite values in functions: lists and records are JSON text; which value comes first."""

from __future__ import annotations

import json
from functools import cmp_to_key
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.sqlite.budget import MAX_ITEMS, check_long
from logical_robots_tui.mind.sqlite.stored import to_input

if TYPE_CHECKING:
    from collections.abc import Iterable

Scalar: TypeAlias = "int | float | str | None"

ENDLESS = "9.0e+999"
"""Infinity in JSON."""


def bounded(text: str) -> str:
    """Return the text if a function may parse it; else raise TooLargeError."""
    if len(text) > MAX_ITEMS:
        check_long(text)
    return text


def list_in(text: Scalar) -> list[Any]:
    """Return the list in a value, or raise TypeError."""
    value = json.loads(bounded(text)) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def element(value: Scalar) -> Any:
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(bounded(value))
        except ValueError:
            return value
    return value


def real_as_json(value: Any) -> str | None:
    """Return a number as JSON text with all digits, integers as reals; null stays null."""
    if value.__class__ is float:
        text = repr(value)
        if "n" not in text:
            return text
        return ENDLESS if value > 0 else f"-{ENDLESS}"
    return value_as_json(float(value) if isinstance(value, int) else value)


def value_as_json(value: Any) -> str | None:
    """Return a value as JSON text, parsing records and lists in texts; null stays null."""
    kind = value.__class__
    if kind is str:
        return value if element(value) is not value else to_input(value)
    if kind is float:
        return real_as_json(value)
    return None if value is None else str(value)


def compared(left: Scalar, right: Scalar) -> int:
    """Return -1, 0 or 1; fields in the left record's order, nested nulls are equal and last."""
    return in_json(element(left), element(right))


def in_json(left: Any, right: Any) -> int:
    """Compare values from JSON: -1, 0 or 1; a missing field counts as null."""
    ranks = _rank(left), _rank(right)
    if ranks[0] != ranks[1]:
        return -1 if ranks[0] < ranks[1] else 1
    if isinstance(left, dict):
        names = [*left, *(name for name in right if name not in left)]
        pairs = [(left.get(name), right.get(name)) for name in names]
    elif isinstance(left, list):
        pairs = list(zip(left, right, strict=False))
        pairs.append((len(left), len(right)))
    else:
        return 0 if left is None or left == right else -1 if left < right else 1
    return next((found for one, other in pairs if (found := in_json(one, other))), 0)


def _rank(value: Any) -> int:
    if value is None:
        return 4
    if isinstance(value, int | float):
        return 0
    return 1 if isinstance(value, str) else 2 if isinstance(value, list) else 3


_key = cmp_to_key(in_json)


def order(value: Any) -> tuple[int, Any]:
    """Return a sort key for values of all types: null, numbers, texts, then the rest."""
    if value is None:
        return (0, 0)
    if isinstance(value, int | float):
        return (1, value)
    if isinstance(value, str):
        return (2, value)
    return (3, _key(value))


def order_of_scalar(value: Scalar) -> tuple[int, Any]:
    return order(element(value))


def in_order(values: Iterable[Any]) -> list[Any]:
    values = list(values)
    types = {type(value) for value in values}
    if types <= {int, float} or types == {str}:
        return sorted(values)
    return sorted(values, key=order)
