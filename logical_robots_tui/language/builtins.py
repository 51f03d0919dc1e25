"""Logica's built-in functions, and their numbers of arguments."""

from __future__ import annotations

import functools
import math

from logica.compiler import expr_translate

_QL = expr_translate.QL
_TWO_ARGUMENTS = frozenset(
    {"Concat", "DateAddDay", "DateDiffDay", "Element", "Join", "Like", "MagicalEntangle", "Split"}
)


@functools.cache
def names() -> frozenset[str]:
    """Return the names of all functions, operators and aggregates that the package has built in."""
    return frozenset(_QL.BasisFunctions())


def is_built_in(name: str) -> bool:
    """Return whether the package treats a call of this name as a built-in function."""
    return name in names()


@functools.cache
def arity(name: str) -> tuple[int, float]:
    """Return the fewest and most arguments of a built-in function."""
    if name in _QL.ANALYTIC_FUNCTIONS:
        count = 4 if name.startswith("Window") else 3
        return count, count
    if name == "If":
        return 3, 3
    if name == "Cast":
        return 2, 2
    if name in _QL.BUILT_IN_FUNCTIONS:
        return (2, 2) if name in _TWO_ARGUMENTS else (1, 1)
    least, most = _QL.BULK_FUNCTIONS_ARITY_RANGE.get(name, (0, math.inf))
    return least, most
