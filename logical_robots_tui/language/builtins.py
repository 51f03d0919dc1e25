"""Logica's built-in functions: which of them exist here, and their numbers of arguments."""

from __future__ import annotations

import functools
import math
import sqlite3

from logica.compiler import expr_translate

from logical_robots_tui.mind.compiling.dialect import RobotDialect
from logical_robots_tui.mind.sqlite.database import Database

_QL = expr_translate.QL
_SPECIAL = frozenset({"Aggr", "Cast"})
"""Functions that the package compiles without a template."""

_TWO_ARGUMENTS = frozenset(
    {"Concat", "DateAddDay", "DateDiffDay", "Element", "Join", "Like", "MagicalEntangle", "Split"}
)
_INTERNAL = frozenset(
    {"Constraint", "Container", "FlagValue", "MagicalEntangle", "SqlExpr"}
    | {"ToUInt64", "ValueOfUnnested"}
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


@functools.cache
def runs(name: str) -> bool:
    """Return whether a built-in function works in a mind's SQLite, by trying it."""
    if name in _INTERNAL:
        return False
    if name in _SPECIAL or name in _QL.BUILT_IN_INFIX_OPERATORS:
        return True
    if name in _QL.ANALYTIC_FUNCTIONS:
        template = _QL.ANALYTIC_FUNCTIONS[name].format("NULL", "NULL", "NULL", "0")
        return _compiles(template)
    template = _templates().get(name)
    if not template:
        return False
    least, most = arity(name)
    counts = range(least, min(int(most), least + 2) + 1) if most < math.inf else range(2, 3)
    return any(_compiles(_filled(template, count)) for count in counts)


def _filled(template: str, count: int) -> str:
    nulls = ["NULL"] * count
    try:
        return template % ", ".join(nulls) if "%s" in template else template.format(*nulls)
    except (IndexError, TypeError):
        return ""


@functools.cache
def _templates() -> dict[str, str | None]:
    names()  # reads the package's own table
    return {
        **_QL.BULK_FUNCTIONS,
        **_QL.BUILT_IN_FUNCTIONS,
        **RobotDialect().BuiltInFunctions(),
    }


def _compiles(expression: str) -> bool:
    try:
        _database().prepare(f"SELECT {expression}")
    except sqlite3.Error:
        return False
    return bool(expression)


@functools.cache
def _database() -> Database:
    return Database()
