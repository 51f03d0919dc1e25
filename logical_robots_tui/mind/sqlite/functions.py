"""The SQL functions that compiled programs call and SQLite lacks. Null in, null out.

Lists and records are JSON text inside SQLite. Nothing here reads or writes anything outside it.
"""

from __future__ import annotations

import hashlib
import json
import math
import sqlite3
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.sqlite.bounds import (
    MAX_ITEMS,
    MAX_RANGE,
    Room,
    check_items,
    check_long,
    check_text,
    guarded,
)
from logical_robots_tui.mind.sqlite.casting import to_text, try_cast
from logical_robots_tui.mind.sqlite.replaced import REPLACED
from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from logical_robots_tui.mind.sqlite.watch import Work

__all__ = ["NAMES", "install"]

Scalar: TypeAlias = "int | float | str | None"

_MOST_COMPARED = 16  # arguments of Least and Greatest


def _bounded(text: str) -> str:
    if len(text) > MAX_ITEMS:
        check_long(text)
    return text


def _list(text: Scalar) -> list[Any]:
    value = json.loads(_bounded(text)) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def _element(value: Scalar) -> Any:
    """A value to put in a list: what is JSON text goes in as the list or record that it is."""
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(_bounded(value))
        except ValueError:
            return value
    return value


def _order(value: Any) -> tuple[int, Any]:
    """Sort key over values of all types: null, numbers, texts, then the rest."""
    if value is None:
        return (0, 0)
    if isinstance(value, int | float):
        return (1, value)
    if isinstance(value, str):
        return (2, value)
    return (3, to_json(value))


def _sorted(values: Iterable[Any]) -> list[Any]:
    """Values in ascending order; of one type, which is usual, without the detour of a key."""
    values = list(values)
    types = {type(value) for value in values}
    if types <= {int, float} or types == {str}:
        return sorted(values)
    return sorted(values, key=_order)


def _present(values: tuple[Scalar, ...]) -> list[Scalar]:
    return [v for v in values if v is not None]


def _divide(left: float, right: float) -> float | None:
    """Real division; a number over zero is infinite, as on DuckDB, and zero over zero is null."""
    if right:
        return left * 1.0 / (right * 1.0)  # as SQLite and DuckDB do with large whole numbers
    return math.copysign(math.inf, left) * math.copysign(1, right) if left else None


def _modulo(left: float, right: float) -> float | None:
    """The remainder with the sign of the dividend, whole and exact if both are whole."""
    if not right:
        return None
    if isinstance(left, int) and isinstance(right, int):
        remainder = abs(left) % abs(right)
        return remainder if left >= 0 else -remainder
    return _finite(lambda: math.fmod(left, right))


def _concatenate(left: Scalar, right: Scalar) -> str:
    """`++`: two lists make a list, everything else a text."""
    if _is_list(left) and _is_list(right):
        return _concat(left, right)
    return _text(left) + _text(right)


def _is_list(value: Scalar) -> bool:
    return isinstance(value, str) and value[:1] == "[" and isinstance(_element(value), list)


def _unique(items: Scalar) -> str:
    return to_json(_sorted({to_json(i): i for i in _list(items)}.values()))


def _join(items: Scalar, separator: str) -> str:
    texts = [_text(i) for i in _list(items) if i is not None]
    check_text(len(separator) * len(texts))
    return separator.join(texts)


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else to_json(value)


def _split(text: str, separator: str) -> str:
    check_items(text.count(separator))
    return to_json(text.split(separator) if separator else list(text))


def _sort(items: Scalar) -> str:
    return to_json(_sorted(_list(items)))


def _concat(left: Scalar, right: Scalar) -> str:
    return to_json(_list(left) + _list(right))


def _range(count: float) -> str:
    check_items(count, MAX_RANGE)
    return to_json(list(range(int(count))))


def _hash(value: Scalar) -> int:
    digest = hashlib.blake2b(_text(value).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 1


def _record_as_json(record: Scalar) -> str:
    return to_json(_element(record))


def _assemble(pairs: Scalar) -> str:
    return to_json({str(p["arg"]): p["value"] for p in _list(pairs)})


def _disassemble(record: Scalar) -> str:
    fields = json.loads(record) if isinstance(record, str) else {}
    return to_json([{"arg": k, "value": v} for k, v in fields.items()])


def _power(base: float, exponent: float) -> float | None:
    return _finite(lambda: math.pow(base, exponent))


def _finite(compute: Callable[[], float]) -> float | None:
    """The number, or null where mathematics has none."""
    try:
        return compute()
    except (ValueError, OverflowError):
        return None


def _unary(function: Callable[[float], float]) -> Callable[[float], float | None]:
    return lambda x: _finite(lambda: function(x))


_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "join_list": (2, _join),
    "split_text": (2, _split),
    "sort_list": (1, _sort),
    "concat_two_lists": (2, _concat),
    "number_range": (1, _range),
    "natural_hash": (1, _hash),
    "record_as_json": (1, _record_as_json),
    "assemble_record": (1, _assemble),
    "disassemble_record": (1, _disassemble),
    "concatenate": (2, _concatenate),
    "divide": (2, _divide),
    "ends_with": (2, lambda text, end: int(text.endswith(end))),
    "modulo": (2, _modulo),
    "reverse": (1, lambda text: text[::-1]),
    "lower_text": (1, str.lower),
    "starts_with": (2, lambda text, start: int(text.startswith(start))),
    "to_text": (1, to_text),
    "truth_to_text": (1, lambda truth: "true" if truth else "false"),
    "try_cast": (2, try_cast),
    "unicode_of": (1, lambda text: ord(text[0]) if text else 0),
    "unique_list": (1, _unique),
    "upper_text": (1, str.upper),
}

_NULL_MEANS_ABSENT: dict[str, tuple[int, Callable[..., Any]]] = {
    "greatest": (-1, lambda *values: max(_present(values), key=_order, default=None)),
    "least": (-1, lambda *values: min(_present(values), key=_order, default=None)),
}
"""Functions that pass over null instead of giving it back."""

_MATHS: dict[str, tuple[int, Callable[..., Any]]] = {
    "acos": (1, _unary(math.acos)),
    "asin": (1, _unary(math.asin)),
    "atan": (1, _unary(math.atan)),
    "atan2": (2, math.atan2),
    "ceil": (1, math.ceil),
    "ceiling": (1, math.ceil),
    "cos": (1, _unary(math.cos)),
    "degrees": (1, math.degrees),
    "exp": (1, _unary(math.exp)),
    "floor": (1, math.floor),
    "ln": (1, _unary(math.log)),
    "log": (1, _unary(math.log10)),
    "log10": (1, _unary(math.log10)),
    "mod": (2, lambda a, b: math.fmod(a, b) if b else None),
    "pi": (0, lambda: math.pi),
    "pow": (2, _power),
    "power": (2, _power),
    "radians": (1, math.radians),
    "sin": (1, _unary(math.sin)),
    "sqrt": (1, _unary(math.sqrt)),
    "tan": (1, _unary(math.tan)),
}
"""What SQLite has only where it was built with mathematical functions."""


class _Collect:
    """An aggregate that makes a list of values; of nothing it makes null, as DuckDB does."""

    def __init__(self) -> None:
        self.items: list[Any] = []
        self.room = Room()

    def step(self, value: Scalar) -> None:
        self.room.take(value)
        self.items.append(_element(value))

    def finalize(self) -> str | None:
        return to_json(self.items) if self.items else None


class _Distinct:
    """`Set`: each value once, in ascending order, without null."""

    def __init__(self) -> None:
        self.unique: dict[str, Any] = {}
        self.room = Room()

    def step(self, value: Scalar) -> None:
        item = _element(value)
        key = to_json(item)
        if item is not None and key not in self.unique:
            self.room.take(key)
            self.unique[key] = item

    def finalize(self) -> str | None:
        return to_json(_sorted(self.unique.values())) if self.unique else None


class _ConcatLists(_Collect):
    """`++=`: one list of the elements of all lists."""

    def step(self, value: Scalar) -> None:
        if value is not None:
            items = _list(value)
            self.room.take(value, len(items))
            self.items.extend(items)


class _Pairs:
    """An aggregate over pairs; of equal values the first seen comes first, null never."""

    descending = False

    def __init__(self) -> None:
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None
        self.room = Room()

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.count = count
        if value is not None:
            self.room.take(value)
            self.room.take(argument, 0)
            self.pairs.append((_order(value), argument))

    def ordered(self) -> list[Scalar]:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        return [argument for _, argument in self.pairs]


class _ArgMin:
    """The argument of the best value; of equal ones the first seen, null never."""

    descending = False

    def __init__(self) -> None:
        self.best: tuple[int, Any] | None = None
        self.argument: Scalar = None

    def step(self, argument: Scalar, value: Scalar) -> None:
        if value is None:
            return
        order = _order(value)
        if self.best is None or (order > self.best if self.descending else order < self.best):
            self.best = order
            self.argument = argument

    def finalize(self) -> Scalar:
        return self.argument


class _ArgMax(_ArgMin):
    descending = True


class _ArgMinK(_Pairs):
    def finalize(self) -> str | None:
        count = None if self.count is None else max(0, int(self.count))
        return to_json([_element(a) for a in self.ordered()[:count]]) if self.pairs else None


class _ArgMaxK(_ArgMinK):
    descending = True


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.room.take(argument)
        self.room.take(value, 0)
        self.pairs.append((_order(argument), value))

    def finalize(self) -> str | None:
        return to_json([_element(a) for a in self.ordered()]) if self.pairs else None


_AGGREGATES: dict[str, tuple[int, type[Any]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _ConcatLists),
    "arg_min": (2, _ArgMin),
    "arg_max": (2, _ArgMax),
    "arg_min_k": (3, _ArgMinK),
    "arg_max_k": (3, _ArgMaxK),
    "array_by": (2, _Array),
}


NAMES = frozenset({*_FUNCTIONS, *_NULL_MEANS_ABSENT, *_MATHS, *_AGGREGATES, *REPLACED})
"""Names of all functions of this module, in lower case as SQLite's authorizer tells them."""


def install(connection: sqlite3.Connection, work: Work | None = None) -> None:
    """Give a connection all functions of this module, and mathematics if it has none.

    Args:
        connection: An open connection.
        work: What the functions will be called for; when it is halted, they fail.
    """
    functions = dict(_FUNCTIONS)
    for name, (arity, function) in _MATHS.items():
        try:
            arguments = ",".join(["1"] * arity)
            connection.execute(f"SELECT {name}({arguments})").fetchone()
        except sqlite3.OperationalError:
            functions[name] = (arity, function)

    def create(name: str, arity: int, function: Callable[..., Any], *, null_safe: bool) -> None:
        safe = guarded(function, work, null_safe=null_safe)
        connection.create_function(name, arity, safe, deterministic=True)

    for name, (arity, function) in functions.items():
        create(name, arity, function, null_safe=True)
    for name, (arities, function) in REPLACED.items():
        for arity in arities:
            create(name, arity, function, null_safe=True)
    for name, (_, function) in _NULL_MEANS_ABSENT.items():
        for arity in range(1, _MOST_COMPARED + 1):
            create(name, arity, function, null_safe=False)
    for name, (arity, aggregate) in _AGGREGATES.items():
        connection.create_aggregate(name, arity, aggregate)
