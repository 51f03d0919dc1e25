"""The SQL functions that compiled programs call and SQLite lacks. Null in, null out.

Lists and records are JSON text inside SQLite. Functions have no side effects.
"""

from __future__ import annotations

import hashlib
import json
import math
import sqlite3
from collections.abc import Callable
from functools import partial
from typing import Any

from logical_robots_tui.mind.sqlite.budget import (
    MAX_RANGE,
    ChargedAggregate,
    Work,
    charge,
    check_items,
    check_text,
)
from logical_robots_tui.mind.sqlite.functions import texts
from logical_robots_tui.mind.sqlite.functions.aggregates import AGGREGATES
from logical_robots_tui.mind.sqlite.functions.casting import (
    Scalar,
    compare,
    element,
    in_json,
    in_order,
    list_in,
    order_of_scalar,
    real_as_json,
    to_text,
    try_cast,
    try_cast_like,
    value_as_json,
    whole,
)
from logical_robots_tui.mind.sqlite.functions.texts import REPLACED
from logical_robots_tui.mind.sqlite.stored import to_json

_MOST_COMPARED = 16  # arguments of Least and Greatest


def _present(values: tuple[Scalar, ...]) -> list[Scalar]:
    return [v for v in values if v is not None]


def _divide(left: float, right: float) -> float | None:
    """Divide real numbers; x / 0 is infinite, as on DuckDB, and 0 / 0 is null."""
    if right:
        return left * 1.0 / (right * 1.0)  # like SQLite and DuckDB with large integers
    return math.copysign(math.inf, left) * math.copysign(1, right) if left else None


def _modulo(left: float, right: float) -> float | None:
    """Return the remainder with the sign of the dividend, exact for integers."""
    if not right:
        return None
    if isinstance(left, int) and isinstance(right, int):
        remainder = abs(left) % abs(right)
        return remainder if left >= 0 else -remainder
    return _finite(lambda: math.fmod(left, right))


def _concatenate(left: Scalar, right: Scalar) -> str:
    """Return two lists as one, or anything else as a text."""
    if _islist_in(left) and _islist_in(right):
        return _concat(left, right)
    return _text(left) + _text(right)


def _islist_in(value: Scalar) -> bool:
    return isinstance(value, str) and value[:1] == "[" and isinstance(element(value), list)


def _unique(items: Scalar) -> str:
    return to_json(in_order({to_json(i): i for i in list_in(items)}.values()))


def _join(items: Scalar, separator: str) -> str | None:
    listed = list_in(items)
    texts = [_text(item) for item in listed if item is not None]
    check_text(len(separator) * len(texts))
    return separator.join(texts) if texts or not listed else None


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else to_json(value)


def _split(text: str, separator: str) -> str:
    check_items(text.count(separator))
    return to_json(text.split(separator) if separator else list(text) or [""])


def _concat(*lists: Scalar) -> str:
    return to_json([item for each in lists for item in list_in(each)])


def _range(count: float) -> str:
    check_items(count, MAX_RANGE)
    return to_json(list(range(int(count))))


def _generate(first: float, last: float, step: float = 1) -> str:
    """Return the numbers from `first` to `last`, both included."""
    if not step:
        raise ValueError("a step of 0")
    count = math.floor((last - first) / step) + 1
    check_items(count, MAX_RANGE)
    return to_json([first + step * number for number in range(count)])


def _hash(value: Scalar) -> int:
    digest = hashlib.blake2b(_text(value).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 1


def _assemble(pairs: Scalar) -> str:
    return to_json({str(p["arg"]): p["value"] for p in list_in(pairs)})


def _has(items: Scalar, wanted: Scalar) -> int:
    value = element(wanted)
    return int(any(not in_json(item, value) for item in list_in(items)))


def _disassemble(record: Scalar) -> str:
    fields = json.loads(record) if isinstance(record, str) else {}
    return to_json([{"arg": k, "value": v} for k, v in fields.items()])


def _power(base: float, exponent: float) -> float | None:
    return _finite(lambda: math.pow(base, exponent))


def _finite(compute: Callable[[], float]) -> float | None:
    try:
        return compute()
    except (ValueError, OverflowError):
        return None


def _unary(function: Callable[[float], float]) -> Callable[[float], float | None]:
    return lambda x: _finite(lambda: function(x))


_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "join_list": (2, _join),
    "split_text": (2, _split),
    "sort_list": (1, lambda items: to_json(in_order(list_in(items)))),
    "number_range": (1, _range),
    "natural_hash": (1, _hash),
    "real_as_json": (1, real_as_json),
    "record_as_json": (1, lambda record: to_json(element(record))),
    "assemble_record": (1, _assemble),
    "disassemble_record": (1, _disassemble),
    "compare_values": (2, compare),
    "concatenate": (2, _concatenate),
    "decimal_to_text": (2, texts.decimal_to_text),
    "divide": (2, _divide),
    "formatted": (-1, texts.format_text),
    "generate_array": (-1, _generate),
    "ends_with": (2, lambda text, end: int(text.endswith(end))),
    "modulo": (2, _modulo),
    "pad_left": (-1, texts.pad_left),
    "pad_right": (-1, texts.pad_right),
    "regexp_extract": (2, texts.regexp_extract),
    "repeat_text": (2, texts.repeat),
    "reverse": (1, lambda text: text[::-1]),
    "list_has": (2, _has),
    "lower_text": (1, texts.lower),
    "round_to": (2, texts.round_to),
    "starts_with": (2, lambda text, start: int(text.startswith(start))),
    "to_text": (1, to_text),
    "to_whole": (1, lambda value: whole(value) or 0),
    "truth_to_text": (1, lambda truth: "true" if truth else "false"),
    "try_cast": (2, try_cast),
    "try_cast_like": (2, try_cast_like),
    "unicode_of": (1, lambda text: ord(text[0]) if text else -1),
    "unique_list": (1, _unique),
    "upper_text": (1, texts.upper),
    "value_as_json": (1, value_as_json),
}

_NULL_MEANS_ABSENT: dict[str, Callable[..., Any]] = {
    "concat_some_lists": lambda *lists: _concat(*present) if (present := _present(lists)) else None,
    "greatest": lambda *values: max(_present(values), key=order_of_scalar, default=None),
    "least": lambda *values: min(_present(values), key=order_of_scalar, default=None),
}
"""Functions that accept null arguments."""

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
"""Functions that SQLite has only if it was built with mathematical functions."""


def _sorting(items: Any) -> int:
    return 7 * len(items) if isinstance(items, str) else 0


def _searching(items: Any, wanted: Any) -> int:
    """Return the cost of null fields, which are compared even with records that lack them."""
    if isinstance(items, str) and isinstance(wanted, str):
        return items.count("{") * wanted.count("null")
    return 0


def _matching(text: Any, pattern: Any) -> int:
    """Return the cost of a regular expression, whose states are tried at each character."""
    is_asked = isinstance(text, str) and isinstance(pattern, str)
    return len(text) * len(pattern) // 20 if is_asked else 0


_EXTRA: dict[str, Callable[..., int]] = {
    "list_has": _searching,
    "regexp_extract": _matching,
    "sort_list": _sorting,
    "unique_list": _sorting,
}
"""Further steps of calls whose work is more than proportional to what they take and return."""

NAMES = frozenset(
    {"unique_number", *_FUNCTIONS, *_NULL_MEANS_ABSENT, *_MATHS, *AGGREGATES, *REPLACED}
)
"""Names of all functions of this module, in lower case as SQLite's authorizer reports them."""


def install(connection: sqlite3.Connection, work: Work | None = None) -> None:
    work = work or Work(lambda: None)
    functions = dict(_FUNCTIONS)
    for name, (arity, function) in _MATHS.items():
        try:
            arguments = ",".join(["1"] * arity)
            connection.execute(f"SELECT {name}({arguments})").fetchone()
        except sqlite3.OperationalError:
            functions[name] = (arity, function)

    def create(
        name: str, arity: int, function: Callable[..., Any], *, null_safe: bool = True
    ) -> None:
        extra = _EXTRA.get(name)
        safe = charge(function, work, null_safe=null_safe, checks=True, extra=extra)
        connection.create_function(name, arity, safe, deterministic=True)

    for name, (arity, function) in functions.items():
        create(name, arity, function)
    connection.create_function("unique_number", 0, work.next_number)
    for name, (arities, function) in REPLACED.items():
        for arity in arities:
            create(name, arity, function)
    for name, function in _NULL_MEANS_ABSENT.items():
        for arity in range(1, _MOST_COMPARED + 1):
            create(name, arity, function, null_safe=False)
    for name, (arity, aggregate) in AGGREGATES.items():
        connection.create_aggregate(name, arity, partial(ChargedAggregate, aggregate, work))
