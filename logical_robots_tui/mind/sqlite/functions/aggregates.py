"""Aggregates of compiled programs that SQLite lacks, or can't compute for records."""

from __future__ import annotations

from typing import Any

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

__all__ = ["AGGREGATES"]


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

    descending = False
    key = staticmethod(order)

    def __init__(self) -> None:
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None
        self.room = Room()

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.count = count
        if value is not None:
            self.room.take(value)
            self.room.take(argument, 0)
            self.pairs.append((self.key(value), argument))

    def ordered(self) -> list[Scalar]:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        return [argument for _, argument in self.pairs]


class _ArgMin:
    """The argument of the best value; the first of equal ones, ignoring nulls."""

    descending = False
    key = staticmethod(order)

    def __init__(self) -> None:
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


class _ArgMax(_ArgMin):
    descending = True


class _ArgMinK(_Pairs):
    def finalize(self) -> str | None:
        count = None if self.count is None else max(0, int(self.count))
        return to_json([element(a) for a in self.ordered()[:count]]) if self.pairs else None


class _ArgMaxK(_ArgMinK):
    descending = True


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.room.take(argument)
        self.room.take(value, 0)
        self.pairs.append((order(argument), value))

    def finalize(self) -> str | None:
        return to_json([element(a) for a in self.ordered()]) if self.pairs else None


class _ArgMinOfNested(_ArgMin):
    key = staticmethod(order_of_scalar)


class _ArgMaxOfNested(_ArgMinOfNested):
    descending = True


class _ArgMinKOfNested(_ArgMinK):
    key = staticmethod(order_of_scalar)


class _ArgMaxKOfNested(_ArgMinKOfNested):
    descending = True


class _LeastNested(_ArgMinOfNested):
    """The least of records or lists, ignoring null."""

    def step(self, value: Scalar) -> None:  # type: ignore[override]  # it is the argument, too
        super().step(value, value)


class _GreatestNested(_LeastNested):
    descending = True


class _AnyValue:
    """The first value that is not null."""

    def __init__(self) -> None:
        self.found: Scalar = None

    def step(self, value: Scalar) -> None:
        if self.found is None:
            self.found = value

    def finalize(self) -> Scalar:
        return self.found


AGGREGATES: dict[str, tuple[int, type[Any]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _ConcatLists),
    "arg_min": (2, _ArgMin),
    "arg_max": (2, _ArgMax),
    "arg_min_k": (3, _ArgMinK),
    "arg_max_k": (3, _ArgMaxK),
    "array_by": (2, _Array),
    "arg_min_of_nested": (2, _ArgMinOfNested),
    "arg_max_of_nested": (2, _ArgMaxOfNested),
    "arg_min_k_of_nested": (3, _ArgMinKOfNested),
    "arg_max_k_of_nested": (3, _ArgMaxKOfNested),
    "least_nested": (1, _LeastNested),
    "greatest_nested": (1, _GreatestNested),
    "any_value": (1, _AnyValue),
}
"""Numbers of arguments and class by SQL name."""
