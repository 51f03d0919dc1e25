"""Aggregates of compiled programs that SQLite lacks, or can't compute for records."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.budget import Room
from logical_robots_tui.mind.sqlite.functions.values import (
    Scalar,
    element,
    in_order,
    list_in,
    order,
    order_of_scalar,
)
from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from collections.abc import Callable


class _Collect:
    """An aggregate that collects values in a list; null if there are none, as in DuckDB."""

    def __init__(self) -> None:
        self.items: list[Any] = []
        self.room = Room()

    def step(self, value: Scalar) -> None:
        self.room.take(value)
        self.items.append(element(value))

    def finalize(self) -> str | None:
        return to_json(self.items) if self.items else None


class _Distinct:
    """`Set`: each value once, in ascending order, without null."""

    def __init__(self) -> None:
        self.unique: dict[str, Any] = {}
        self.room = Room()

    def step(self, value: Scalar) -> None:
        item = element(value)
        key = to_json(item)
        if item is not None and key not in self.unique:
            self.room.take(key)
            self.unique[key] = item

    def finalize(self) -> str | None:
        return to_json(in_order(self.unique.values())) if self.unique else None


class _ConcatLists(_Collect):
    """`++=`: one list of the elements of all lists."""

    def step(self, value: Scalar) -> None:
        if value is not None:
            items = list_in(value)
            self.room.take(value, len(items))
            self.items.extend(items)


class _Pairs:
    """An aggregate over pairs; the first of equal values comes first, nulls are ignored."""

    def __init__(self, key: Callable[[Any], Any] = order, *, descending: bool = False) -> None:
        self.key, self.descending = key, descending
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None
        self.room = Room()

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.count = count
        if value is not None:
            self.room.take(value)
            self.room.take(argument, 0)
            self.pairs.append((self.key(value), argument))

    def finalize(self) -> str | None:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        count = None if self.count is None else max(0, int(self.count))
        return to_json([element(a) for _, a in self.pairs[:count]]) if self.pairs else None


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.room.take(argument)
        self.room.take(value, 0)
        self.pairs.append((order(argument), value))


class _Best:
    """The argument of the least or greatest value; the first of equal ones, ignoring nulls."""

    def __init__(self, key: Callable[[Any], Any] = order, *, descending: bool = False) -> None:
        self.key, self.descending = key, descending
        self.best: tuple[int, Any] | None = None
        self.argument: Scalar = None

    def step(self, argument: Scalar, value: Scalar) -> None:
        if value is None:
            return
        found = self.key(value)
        if self.best is None or (found > self.best if self.descending else found < self.best):
            self.best = found
            self.argument = argument

    def finalize(self) -> Scalar:
        return self.argument


class _BestNested(_Best):
    """The least or greatest of records or lists, ignoring null."""

    def step(self, value: Scalar) -> None:  # type: ignore[override]  # it is the argument, too
        super().step(value, value)


class _AnyValue:
    """The first value that is not null."""

    def __init__(self) -> None:
        self.found: Scalar = None

    def step(self, value: Scalar) -> None:
        if self.found is None:
            self.found = value

    def finalize(self) -> Scalar:
        return self.found


AGGREGATES: dict[str, tuple[int, Callable[[], Any]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _ConcatLists),
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
