"""The order of values: records field by field, lists element by element."""

from __future__ import annotations

from functools import cmp_to_key
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.functions.values import Scalar, element

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["compared", "in_json", "in_order", "order", "order_of_scalar"]


def compared(left: Scalar, right: Scalar) -> int:
    """Return whether a value comes before another (-1), after it (1), or is equal (0).

    Fields of records are compared in the left record's order. A null inside a record or list equals
    another null, and comes after everything else.
    """
    return in_json(element(left), element(right))


def in_json(left: Any, right: Any) -> int:
    """Compare values as they come out of JSON."""
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
    """Return a sort key for a value of SQLite, with JSON text as the record or list in it."""
    return order(element(value))


def in_order(values: Iterable[Any]) -> list[Any]:
    """Return values in ascending order; without sort keys if all have the same simple type."""
    values = list(values)
    types = {type(value) for value in values}
    if types <= {int, float} or types == {str}:
        return sorted(values)
    return sorted(values, key=order)
