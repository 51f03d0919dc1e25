"""The SQL functions that compiled programs call and SQLite lacks. Null in, null out.

Lists and records are JSON text inside SQLite. Nothing here reads or writes anything outside it.
"""

from __future__ import annotations

import hashlib
import json
import math
import sqlite3
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.stored import to_json

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["AGGREGATES", "FUNCTIONS", "install"]

Scalar: TypeAlias = "int | float | str | None"

MAX_LIST = 100_000


def _list(text: Scalar) -> list[Any]:
    value = json.loads(text) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def _element(value: Scalar) -> Any:
    """A value to put in a list: what is JSON text goes in as the list or record that it is."""
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(value)
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


def _null_safe(function: Callable[..., Any]) -> Callable[..., Any]:
    def safe(*arguments: Scalar) -> Any:
        if any(a is None for a in arguments):
            return None
        return function(*arguments)

    return safe


def _join(items: Scalar, separator: str) -> str:
    return separator.join(_text(i) for i in _list(items) if i is not None)


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else to_json(value)


def _split(text: str, separator: str) -> str:
    return to_json(text.split(separator) if separator else list(text))


def _sort(items: Scalar) -> str:
    return to_json(sorted(_list(items), key=_order))


def _concat(left: Scalar, right: Scalar) -> str:
    return to_json(_list(left) + _list(right))


def _range(count: float) -> str:
    if count > MAX_LIST:
        raise ValueError(f"Range({count}) is longer than {MAX_LIST}")
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


FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "join_list": (2, _join),
    "split_text": (2, _split),
    "sort_list": (1, _sort),
    "concat_two_lists": (2, _concat),
    "number_range": (1, _range),
    "natural_hash": (1, _hash),
    "record_as_json": (1, _record_as_json),
    "assemble_record": (1, _assemble),
    "disassemble_record": (1, _disassemble),
    "ends_with": (2, lambda text, end: int(text.endswith(end))),
    "greatest": (-1, max),
    "least": (-1, min),
}

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
    """An aggregate that collects values and makes JSON of them at the end."""

    def __init__(self) -> None:
        self.items: list[Any] = []

    def step(self, value: Scalar) -> None:
        self.items.append(_element(value))

    def finalize(self) -> str:
        return to_json(self.items)


class _Distinct(_Collect):
    """`Set`: each value once, in ascending order, without null."""

    def finalize(self) -> str:
        unique = {to_json(i): i for i in self.items if i is not None}
        return to_json(sorted(unique.values(), key=_order))


class _ConcatLists(_Collect):
    """`++=`: one list of the elements of all lists."""

    def step(self, value: Scalar) -> None:
        if value is not None:
            self.items.extend(_list(value))


class _Pairs:
    """An aggregate over pairs; of equal values the first seen comes first, null never."""

    descending = False

    def __init__(self) -> None:
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.count = count
        if value is not None:
            self.pairs.append((_order(value), argument))

    def ordered(self) -> list[Scalar]:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        return [argument for _, argument in self.pairs]


class _ArgMin(_Pairs):
    def finalize(self) -> Scalar:
        pick = max if self.descending else min
        return pick(self.pairs, key=lambda pair: pair[0])[1] if self.pairs else None


class _ArgMax(_ArgMin):
    descending = True


class _ArgMinK(_Pairs):
    def finalize(self) -> str:
        count = None if self.count is None else max(0, int(self.count))
        return to_json([_element(a) for a in self.ordered()[:count]])


class _ArgMaxK(_ArgMinK):
    descending = True


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
        self.pairs.append((_order(argument), value))

    def finalize(self) -> str:
        return to_json([_element(a) for a in self.ordered()])


AGGREGATES: dict[str, tuple[int, type[Any]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _ConcatLists),
    "arg_min": (2, _ArgMin),
    "arg_max": (2, _ArgMax),
    "arg_min_k": (3, _ArgMinK),
    "arg_max_k": (3, _ArgMaxK),
    "array_by": (2, _Array),
}


def install(connection: sqlite3.Connection) -> None:
    """Give a connection all functions of this module, and mathematics if it has none."""
    functions = dict(FUNCTIONS)
    for name, (arity, function) in _MATHS.items():
        try:
            arguments = ",".join(["1"] * arity)
            connection.execute(f"SELECT {name}({arguments})").fetchone()
        except sqlite3.OperationalError:
            functions[name] = (arity, function)
    for name, (arity, function) in functions.items():
        connection.create_function(name, arity, _null_safe(function), deterministic=True)
    for name, (arity, aggregate) in AGGREGATES.items():
        connection.create_aggregate(name, arity, aggregate)
