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

__all__ = ["NAMES", "install"]

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


def _present(values: tuple[Scalar, ...]) -> list[Scalar]:
    return [v for v in values if v is not None]


def _divide(left: float, right: float) -> float | None:
    """Real division; a number over zero is infinite, as on DuckDB, and zero over zero is null."""
    if right:
        return left / right
    return math.copysign(math.inf, left) * math.copysign(1, right) if left else None


def _modulo(left: float, right: float) -> float | None:
    """The remainder with the sign of the dividend, whole if both are."""
    if not right:
        return None
    remainder = math.fmod(left, right)
    return int(remainder) if isinstance(left, int) and isinstance(right, int) else remainder


def _concatenate(left: Scalar, right: Scalar) -> str:
    """`++`: two lists make a list, everything else a text."""
    if _is_list(left) and _is_list(right):
        return _concat(left, right)
    return _text(left) + _text(right)


def _is_list(value: Scalar) -> bool:
    return isinstance(value, str) and value[:1] == "[" and isinstance(_element(value), list)


def _unique(items: Scalar) -> str:
    return to_json(sorted({to_json(i): i for i in _list(items)}.values(), key=_order))


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
    "starts_with": (2, lambda text, start: int(text.startswith(start))),
    "unicode_of": (1, lambda text: ord(text[0]) if text else 0),
    "unique_list": (1, _unique),
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

    def step(self, value: Scalar) -> None:
        self.items.append(_element(value))

    def finalize(self) -> str | None:
        return to_json(self.items) if self.items else None


class _Distinct(_Collect):
    """`Set`: each value once, in ascending order, without null."""

    def finalize(self) -> str | None:
        unique = {to_json(i): i for i in self.items if i is not None}
        return to_json(sorted(unique.values(), key=_order)) if unique else None


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
    def finalize(self) -> str | None:
        count = None if self.count is None else max(0, int(self.count))
        return to_json([_element(a) for a in self.ordered()[:count]]) if self.pairs else None


class _ArgMaxK(_ArgMinK):
    descending = True


class _Array(_Pairs):
    """`Array{position -> value}`: the values in the order of their positions."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> None:
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


NAMES = frozenset({*_FUNCTIONS, *_NULL_MEANS_ABSENT, *_MATHS, *_AGGREGATES})
"""Names of all functions of this module, in lower case as SQLite's authorizer tells them."""


def install(connection: sqlite3.Connection) -> None:
    """Give a connection all functions of this module, and mathematics if it has none."""
    functions = dict(_FUNCTIONS)
    for name, (arity, function) in _MATHS.items():
        try:
            arguments = ",".join(["1"] * arity)
            connection.execute(f"SELECT {name}({arguments})").fetchone()
        except sqlite3.OperationalError:
            functions[name] = (arity, function)
    for name, (arity, function) in functions.items():
        connection.create_function(name, arity, _null_safe(function), deterministic=True)
    for name, (arity, function) in _NULL_MEANS_ABSENT.items():
        connection.create_function(name, arity, function, deterministic=True)
    for name, (arity, aggregate) in _AGGREGATES.items():
        connection.create_aggregate(name, arity, aggregate)
