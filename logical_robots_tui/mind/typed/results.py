"""Types of what functions and operators give.

SQLite checks the type of a value when it computes with it. DuckDB decides beforehand, and some of
what a program means depends on that: how a whole real number is printed, how records are compared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.language.types import (
    MOST_DIGITS,
    Decimal,
    Kind,
    ListOf,
    Plain,
    common,
    digits,
    is_number,
    is_whole,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_GIVE: dict[Kind, tuple[str, ...]] = {
    Plain.TEXT: (
        *("char", "format", "formatted", "group_concat", "join_list", "lower_text", "ltrim"),
        *("replace", "reverse", "rtrim", "string_agg", "substr", "substring", "to_text", "trim"),
        *("truth_to_text", "typeof", "upper_text", "lower", "upper", "decimal_to_text", "printf"),
    ),
    Plain.WHOLE: (
        *("count", "cume_dist", "dense_rank", "instr", "json_array_length", "length"),
        *("natural_hash", "ntile", "rank", "row_number", "sign", "unicode", "unicode_of"),
    ),
    Plain.REAL: (
        *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "avg", "cos", "cosh"),
        *("degrees", "divide", "exp", "ln", "log", "log10", "log2", "median", "percentile", "pi"),
        *("pow", "power", "radians", "sin", "sinh", "sqrt", "tan", "tanh", "total"),
    ),
    Plain.TRUTH: ("ends_with", "json_valid", "like", "list_has", "starts_with"),
}

_GIVES = {name: kind for kind, names in _GIVE.items() for name in names}

_FIRST = frozenset(
    {
        *("abs", "any_value", "arg_max", "arg_max_of_nested", "arg_min", "arg_min_of_nested"),
        *("first_value", "greatest_nested", "lag", "last_value", "lead", "least_nested"),
        *("likelihood", "likely", "nth_value", "nullif", "sort_list", "unique_list", "unlikely"),
    }
)

_ONE_OF_THEM = frozenset({"coalesce", "concat_two_lists", "greatest", "ifnull", "least"})

_SHORT_DIGITS = 18
"""Decimal numbers of no more digits are multiplied to one of no more, if that holds the scale."""

_ROUNDING = frozenset({"ceil", "ceiling", "floor", "trunc"})


def result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of what a function gives."""
    if name in _GIVES:
        return _GIVES[name]
    if name in _ONE_OF_THEM:
        return common(kinds)
    if not kinds:
        return Plain.ANY
    if name in _FIRST:
        return kinds[0]
    made = _MADE.get(name)
    return made(kinds) if made is not None else Plain.ANY


def sum_of(kinds: Sequence[Kind]) -> Kind:
    return common(kinds) if all(map(is_number, kinds)) else Plain.ANY


def product_of(left: Kind, right: Kind) -> Kind:
    found = sum_of((left, right))
    if not isinstance(found, Decimal):
        return found
    scale = sum(k.scale for k in (left, right) if isinstance(k, Decimal))
    most = digits(left) + digits(right)
    if max(digits(left), digits(right)) <= _SHORT_DIGITS < most:
        most = _SHORT_DIGITS
    return Decimal(scale, min(most, MOST_DIGITS) - scale)


def _total(kinds: Sequence[Kind]) -> Kind:
    kind = sum_of(kinds[:1])
    if isinstance(kind, Decimal):
        return Decimal(kind.scale, MOST_DIGITS - kind.scale)
    return Plain.LARGE if is_whole(kind) else kind


def _rounded(kinds: Sequence[Kind]) -> Kind:
    kind = kinds[0]
    return Decimal(0, digits(kind)) if isinstance(kind, Decimal) else sum_of(kinds[:1])


def _cut(kinds: Sequence[Kind]) -> Kind:
    """Return the type of a floor or ceiling; DuckDB's of a whole number is real."""
    return Plain.REAL if is_whole(kinds[0]) else _rounded(kinds)


def _collected_values(kinds: Sequence[Kind]) -> Kind:
    return ListOf(kinds[1]) if len(kinds) > 1 else Plain.ANY


def _concatenated(kinds: Sequence[Kind]) -> Kind:
    if all(isinstance(kind, ListOf) for kind in kinds):
        return common(kinds)
    return Plain.TEXT if Plain.TEXT in kinds else Plain.ANY


_MADE: dict[str, Callable[[Sequence[Kind]], Kind]] = {
    **dict.fromkeys(_ROUNDING, _cut),
    "arg_max_k": lambda kinds: ListOf(kinds[0]),
    "arg_max_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "arg_min_k": lambda kinds: ListOf(kinds[0]),
    "arg_min_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "array_by": _collected_values,
    "concat_lists": lambda kinds: kinds[0],
    "concatenate": _concatenated,
    "if": lambda kinds: common(kinds[1:]),
    "iif": lambda kinds: common(kinds[1:]),
    "json_group_array": lambda kinds: ListOf(kinds[0]),
    "list_of_distinct": lambda kinds: ListOf(kinds[0]),
    "max": common,
    "min": common,
    "modulo": sum_of,
    "number_range": lambda _: ListOf(Plain.WHOLE),
    "round": _rounded,
    "round_to": _rounded,
    "split_text": lambda _: ListOf(Plain.TEXT),
    "sum": _total,
}
