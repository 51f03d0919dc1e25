"""The SQL functions and aggregates that programs call and SQLite lacks. Null in, null out.

Lists and records are JSON text inside SQLite. Functions have no side effects.
"""

from __future__ import annotations

import hashlib
import json
import math
import sqlite3
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

from logical_robots_tui.mind.limits import weight_of_scalar
from logical_robots_tui.mind.sqlite import budget, casting, texts
from logical_robots_tui.mind.sqlite.budget import MeteredWork
from logical_robots_tui.mind.sqlite.casting import Scalar, element, list_in
from logical_robots_tui.mind.sqlite.stored import to_json

# -- aggregates ----------------------------------------------------------------------------------

_PAIR_BYTES = 200  # bytes of a pair and its sort key


class _CollectingAggregate:
    """An aggregate that collects values; null if there are none, as in DuckDB."""

    compares: ClassVar[bool] = False

    def __init__(self) -> None:
        self.limit = budget.CollectionLimit()


class _Distinct(_CollectingAggregate):
    """`Set`: each value once, in ascending order, null last."""

    def __init__(self) -> None:
        super().__init__()
        self.unique: dict[str, Any] = {}

    def step(self, value: Scalar) -> int:
        item = element(value)
        key = to_json(item)
        if key in self.unique:
            return 0
        self.unique[key] = item
        return 2 * self.limit.add(key)  # as an item and as a key

    def finalize(self) -> str | None:
        return to_json(casting.in_order(self.unique.values())) if self.unique else None


class _Concat(_CollectingAggregate):
    """`++=`: one list of the elements of all lists, or one text of all texts."""

    def __init__(self) -> None:
        super().__init__()
        self.items: list[Any] = []
        self.texts: list[str] = []
        self.is_empty = True

    def step(self, value: Scalar) -> int:
        if value is None:
            return 0
        self.is_empty = False
        if isinstance(value, str) and not isinstance(element(value), list):
            self.texts.append(value)
            return self.limit.add(value)
        items = list_in(value)
        size = self.limit.add(value, len(items))
        self.items.extend(items)
        return size

    def finalize(self) -> str | None:
        if self.is_empty:
            return None
        return "".join(self.texts) if self.texts else to_json(self.items)


class _RankedPairs(_CollectingAggregate):
    """An aggregate over pairs without nulls; equal values keep their order."""

    def __init__(
        self, key: Callable[[Any], Any] = casting.order, *, descending: bool = False
    ) -> None:
        super().__init__()
        self.key, self.descending = key, descending
        self.pairs: list[tuple[Any, Scalar]] = []
        self.count: float | None = None

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> int:
        self.count = count
        if value is None or argument is None:
            return 0
        size = self.limit.add(value) + self.limit.add(argument, 0)
        self.pairs.append((self.key(value), argument))
        return size + _PAIR_BYTES

    def finalize(self) -> str | None:
        self.pairs.sort(key=lambda pair: pair[0], reverse=self.descending)
        count = None if self.count is None else max(0, int(self.count))
        return to_json([element(a) for _, a in self.pairs[:count]]) if self.pairs else None


class _Array(_RankedPairs):
    """`Array{position -> value}`: the values in the order of their positions, null last."""

    def step(self, argument: Scalar, value: Scalar, count: float | None = None) -> int:
        size = self.limit.add(argument) + self.limit.add(value, 0)
        self.pairs.append(((argument is None, casting.order(argument)), value))
        return size + _PAIR_BYTES


class _Best:
    """The argument of the least or greatest value, the first of equal ones; nulls are ignored."""

    compares: ClassVar[bool] = True

    def __init__(
        self, key: Callable[[Any], Any] = casting.order, *, descending: bool = False
    ) -> None:
        self.key, self.descending = key, descending
        self.best_rank: tuple[int, Any] | None = None
        self.argument: Scalar = None
        self.size = 0

    def step(self, argument: Scalar, value: Scalar) -> int:
        if value is None or argument is None:
            return 0
        rank = self.key(value)
        if self.best_rank is not None and not (
            rank > self.best_rank if self.descending else rank < self.best_rank
        ):
            return 0
        self.best_rank, self.argument, previous_size = rank, argument, self.size
        self.size = weight_of_scalar(value) + weight_of_scalar(argument)
        return self.size - previous_size

    def finalize(self) -> Scalar:
        return self.argument


class _BestNested(_Best):
    """The least or greatest of records or lists, ignoring null."""

    def step(self, value: Scalar) -> int:  # type: ignore[override]  # it is the argument, too
        return super().step(value, value)


class _AnyValue:
    compares: ClassVar[bool] = False

    def __init__(self) -> None:
        self.value: Scalar = None

    def step(self, value: Scalar) -> int:
        if self.value is not None or value is None:
            return 0
        self.value = value
        return weight_of_scalar(value)

    def finalize(self) -> Scalar:
        return self.value


AGGREGATES: dict[str, tuple[int, Callable[[], budget.AggregateFunction]]] = {
    "list_of_distinct": (1, _Distinct),
    "concat_lists": (1, _Concat),
    "array_by": (2, _Array),
    "arg_min": (2, _Best),
    "arg_max": (2, partial(_Best, descending=True)),
    "arg_min_k": (3, _RankedPairs),
    "arg_max_k": (3, partial(_RankedPairs, descending=True)),
    "arg_min_of_nested": (2, partial(_Best, casting.order_of_scalar)),
    "arg_max_of_nested": (2, partial(_Best, casting.order_of_scalar, descending=True)),
    "arg_min_k_of_nested": (3, partial(_RankedPairs, casting.order_of_scalar)),
    "arg_max_k_of_nested": (3, partial(_RankedPairs, casting.order_of_scalar, descending=True)),
    "least_nested": (1, partial(_BestNested, casting.order_of_scalar)),
    "greatest_nested": (1, partial(_BestNested, casting.order_of_scalar, descending=True)),
    "any_value": (1, _AnyValue),
}
"""Numbers of arguments, and what makes the aggregate, by SQL name."""


# -- functions -----------------------------------------------------------------------------------

_MAX_COMPARED = 16  # arguments of Least and Greatest


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
    return _or_null(math.fmod)(left, right)


def _concatenate(left: Scalar, right: Scalar) -> str:
    """Return two lists as one, or anything else as a text."""
    is_list = isinstance(left, str) and left[:1] == "[" and isinstance(element(left), list)
    if is_list and isinstance(element(right), list):
        return _concat(left, right)
    return _text(left) + _text(right)


def _join(items: Scalar, separator: str) -> str | None:
    elements = list_in(items)
    texts = [_text(item) for item in elements if item is not None]
    budget.check_text(len(separator) * len(texts))
    return separator.join(texts) if texts or not elements else None


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else to_json(value)


def _split(text: str, separator: str) -> str:
    budget.check_items(text.count(separator))
    return to_json(text.split(separator) if separator else list(text) or [""])


def _concat(*lists: Scalar) -> str:
    return to_json([item for text in lists for item in list_in(text)])


def _range(count: float) -> str:
    budget.check_items(count, budget.MAX_RANGE)
    return to_json(list(range(int(count))))


def _generate(first: float, last: float, step: float = 1) -> str:
    """Return the numbers from `first` to `last`, both included."""
    if not step:
        raise ValueError("a step of 0")
    count = math.floor((last - first) / step) + 1
    budget.check_items(count, budget.MAX_RANGE)
    return to_json([first + step * number for number in range(count)])


def _hash(value: Scalar) -> int:
    digest = hashlib.blake2b(_text(value).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 1


def _has(items: Scalar, searched_item: Scalar) -> int:
    element_value = element(searched_item)
    return int(any(not casting.in_json(item, element_value) for item in list_in(items)))


def _disassemble(record: Scalar) -> str:
    fields = json.loads(record) if isinstance(record, str) else {}
    return to_json([{"arg": k, "value": v} for k, v in fields.items()])


def _or_null(function: Callable[..., float]) -> Callable[..., float | None]:
    """Return a function that is null where a mathematical one fails."""

    def compute(*numbers: float) -> float | None:
        try:
            return function(*numbers)
        except (ValueError, OverflowError):
            return None

    return compute


_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "join_list": (2, _join),
    "split_text": (2, _split),
    "sort_list": (1, lambda items: to_json(casting.in_order(list_in(items)))),
    "number_range": (1, _range),
    "natural_hash": (1, _hash),
    "real_as_json": (1, casting.real_as_json),
    "record_as_json": (1, lambda record: to_json(element(record))),
    "assemble_record": (
        1,
        lambda pairs: to_json({str(p["arg"]): p["value"] for p in list_in(pairs)}),
    ),
    "disassemble_record": (1, _disassemble),
    "compare_values": (2, casting.compare),
    "concatenate": (2, _concatenate),
    "decimal_to_text": (2, texts.decimal_to_text),
    "divide": (2, _divide),
    "formatted": (-1, texts.format_text),
    "generate_array": (-1, _generate),
    "character": (1, texts.character),
    "ends_with": (2, lambda text, end: int(text.endswith(end))),
    "modulo": (2, _modulo),
    "pad_left": (-1, texts.pad_left),
    "pad_right": (-1, texts.pad_right),
    "regexp_extract": (2, texts.regexp_extract),
    "repeat_text": (2, texts.repeat),
    "reverse": (1, texts.reverse),
    "list_has": (2, _has),
    "lower_text": (1, texts.lower),
    "round_to": (2, texts.round_to),
    "starts_with": (2, lambda text, start: int(text.startswith(start))),
    "to_text": (1, casting.to_text),
    "to_whole": (1, lambda value: casting.whole(value) or 0),
    "truth_to_text": (1, lambda truth: "true" if truth else "false"),
    "try_cast": (2, casting.try_cast),
    "try_cast_like": (2, casting.try_cast_like),
    "unicode_of": (1, lambda text: ord(text[0]) if text else -1),
    "unique_list": (
        1,
        lambda items: to_json(casting.in_order({to_json(i): i for i in list_in(items)}.values())),
    ),
    "upper_text": (1, texts.upper),
    "value_as_json": (1, casting.value_as_json),
}

_NULL_MEANS_ABSENT: dict[str, Callable[..., Any]] = {
    "concat_some_lists": lambda *lists: _concat(*present) if (present := _present(lists)) else None,
    "greatest": lambda *values: max(_present(values), key=casting.order_of_scalar, default=None),
    "least": lambda *values: min(_present(values), key=casting.order_of_scalar, default=None),
}
"""Functions that accept null arguments."""

_MATHS: dict[str, tuple[int, Callable[..., Any]]] = {
    "acos": (1, _or_null(math.acos)),
    "asin": (1, _or_null(math.asin)),
    "atan": (1, _or_null(math.atan)),
    "atan2": (2, math.atan2),
    "ceil": (1, math.ceil),
    "ceiling": (1, math.ceil),
    "cos": (1, _or_null(math.cos)),
    "degrees": (1, math.degrees),
    "exp": (1, _or_null(math.exp)),
    "floor": (1, math.floor),
    "ln": (1, _or_null(math.log)),
    "log": (1, _or_null(math.log10)),
    "log10": (1, _or_null(math.log10)),
    "mod": (2, lambda a, b: math.fmod(a, b) if b else None),
    "pi": (0, lambda: math.pi),
    "pow": (2, _or_null(math.pow)),
    "power": (2, _or_null(math.pow)),
    "radians": (1, math.radians),
    "sin": (1, _or_null(math.sin)),
    "sqrt": (1, _or_null(math.sqrt)),
    "tan": (1, _or_null(math.tan)),
}
"""Functions that SQLite has only if it was built with mathematical functions."""


def _sorting_steps(items: Any) -> int:
    return 7 * len(items) if isinstance(items, str) else 0


def _search_steps(items: Any, searched_item: Any) -> int:
    """Return the cost of null fields, which are compared even with records that lack them."""
    if isinstance(items, str) and isinstance(searched_item, str):
        return items.count("{") * searched_item.count("null")
    return 0


_TOO_MANY = 250_000_000  # steps, more than there are for a thought or a query


def _match_steps(text: Any, pattern: Any) -> int:
    """Return the cost of a regular expression, whose states may be tried at each character."""
    are_texts = isinstance(text, str) and isinstance(pattern, str)
    return min(4 * len(text) * texts.states_of(pattern), _TOO_MANY) if are_texts else 0


_EXTRA_STEPS: dict[str, Callable[..., int]] = {
    "list_has": _search_steps,
    "regexp_extract": _match_steps,
    "sort_list": _sorting_steps,
    "unique_list": _sorting_steps,
}
"""Further steps of calls whose work is more than proportional to what they take and return."""

NAMES = frozenset(
    {"unique_number", *_FUNCTIONS, *_NULL_MEANS_ABSENT, *_MATHS, *AGGREGATES, *texts.REPLACED}
)
"""Names of all functions of this module, in lower case as SQLite's authorizer reports them."""


def install(connection: sqlite3.Connection, work: MeteredWork | None = None) -> None:
    work = work or MeteredWork(lambda: None)
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
        extra = _EXTRA_STEPS.get(name)
        safe = budget.charge(
            function, work, null_safe=null_safe, checks_size=True, extra_steps=extra
        )
        connection.create_function(name, arity, safe, deterministic=True)

    for name, (arity, function) in functions.items():
        create(name, arity, function)
    connection.create_function("unique_number", 0, work.next_number)
    for name, (arities, function) in texts.REPLACED.items():
        for arity in arities:
            create(name, arity, function)
    for name, function in _NULL_MEANS_ABSENT.items():
        for arity in range(1, _MAX_COMPARED + 1):
            create(name, arity, function, null_safe=False)
    for name, (arity, aggregate) in AGGREGATES.items():
        connection.create_aggregate(name, arity, partial(budget.ChargedAggregate, aggregate, work))
