"""Aggregates of compiled programs that SQLite lacks, or can't compute for records."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

from logical_robots_tui.mind.limits import weight_of_scalar
from logical_robots_tui.mind.sqlite.budget import Aggregate, Room
from logical_robots_tui.mind.sqlite.functions.casting import (
    Scalar,
    element,
    in_order,
    list_in,
    order,
    order_of_scalar,
)
from logical_robots_tui.mind.sqlite.stored import to_json

_PAIR = 200  # bytes of a pair and its sort key


class _Collect:
    """An aggregate that collects values in a list; null if there are none, as in DuckDB."""

    compares: ClassVar[bool] = False

    def __init__(self) -> None:
        self.items: list[Any] = []
        self.room = Room()

    def step(self, value: Scalar) -> int:
        size = self.room.take(value)
        self.items.append(element(value))
        return size

    def finalize(self) -> str | None:
        return to_json(self.items) if self.items else None


class _Distinct:
    """`Set`: each value once, in ascending order, without null."""

    compares: ClassVar[bool] = False

    def __init__(self) -> None:
        self.unique: dict[str, Any] = {}
        self.room = Room()

    def step(self, value: Scalar) -> int:
        item = element(value)
        key = to_json(item)
        if item is None or key in self.unique:
            return 0
        self.unique[key] = item
        return 2 * self.room.take(key)  # as an item and as a key

    def finalize(self) -> str | None:
        return to_json(in_order(self.unique.values())) if self.unique else None


class _Concat(_Collect):
    """`++=`: one list of the elements of all lists, or one text of all texts."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.is_empty = True

    def step(self, value: Scalar) -> int:
        if value is None:
            return 0
        self.is_empty = False
        if isinstance(value, str) and not isinstance(element(value), list):
            self.texts.append(value)
            return self.room.take(value)
        items = list_in(value)
        size = self.room.take(value, len(items))
        self.items.extend(items)
        return size

    def finalize(self) -> str | None:
        if self.is_empty:
            return None
        return "".join(self.texts) if self.texts else to_json(self.items)


class _Pairs:
    """An aggregate over pairs; equal values keep their order, nulls are ignored."""

    compares: ClassVar[bool] = False

    def __init__(self, key: Callable[[Any], Any] = order, *, descending: bool = False) -> None:
        self.key, self.descending = key, descending
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None
        self.room = Room()

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> int:
        self.count = count
        if value is None:
            return 0
        size = self.room.take(value) + self.room.take(argument, 0)
        self.pairs.append((self.key(value), argument))
        return size + _PAIR

    def finalize(self) -> str | None:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        count = None if self.count is None else max(0, int(self.count))
        return to_json([element(a) for _, a in self.pairs[:count]]) if self.pairs else None


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions, null last."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> int:
        size = self.room.take(argument) + self.room.take(value, 0)
        self.pairs.append(((argument is None, order(argument)), value))
        return size + _PAIR


class _Best:
    """The argument of the least or greatest value; the first of equal ones, ignoring nulls."""

    compares: ClassVar[bool] = True

    def __init__(self, key: Callable[[Any], Any] = order, *, descending: bool = False) -> None:
        self.key, self.descending = key, descending
        self.best: tuple[int, Any] | None = None
        self.argument: Scalar = None
        self.size = 0

    def step(self, argument: Scalar, value: Scalar) -> int:
        if value is None:
            return 0
        found = self.key(value)
        if self.best is not None and not (
            found > self.best if self.descending else found < self.best
        ):
            return 0
        self.best, self.argument, before = found, argument, self.size
        self.size = weight_of_scalar(value) + weight_of_scalar(argument)
        return self.size - before

    def finalize(self) -> Scalar:
        return self.argument


class _BestNested(_Best):
    """The least or greatest of records or lists, ignoring null."""

    def step(self, value: Scalar) -> int:  # type: ignore[override]  # it is the argument, too
        return super().step(value, value)


class _AnyValue:
    compares: ClassVar[bool] = False

    def __init__(self) -> None:
        self.found: Scalar = None

    def step(self, value: Scalar) -> int:
        if self.found is not None or value is None:
            return 0
        self.found = value
        return weight_of_scalar(value)

    def finalize(self) -> Scalar:
        return self.found


AGGREGATES: dict[str, tuple[int, Callable[[], Aggregate]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _Concat),
    "array_by": (2, _Array),
    "arg_min": (2, _Best),
    "arg_max": (2, partial(_Best, descending=True)),
    "arg_min_k": (3, _Pairs),
    "arg_max_k": (3, partial(_Pairs, descending=True)),
    "arg_min_of_nested": (2, partial(_Best, order_of_scalar)),
    "arg_max_of_nested": (2, partial(_Best, order_of_scalar, descending=True)),
    "arg_min_k_of_nested": (3, partial(_Pairs, order_of_scalar)),
    "arg_max_k_of_nested": (3, partial(_Pairs, order_of_scalar, descending=True)),
    "least_nested": (1, partial(_BestNested, order_of_scalar)),
    "greatest_nested": (1, partial(_BestNested, order_of_scalar, descending=True)),
    "any_value": (1, _AnyValue),
}
"""Numbers of arguments, and what makes the aggregate, by SQL name."""
