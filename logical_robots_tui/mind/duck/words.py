"""The wall before DuckDB: a query may hold only what the translation writes.

DuckDB has no authorizer that is asked what a statement may read and call. A query comes out of the
cache of compiled programs, where somebody may have put another one; so each of its words is looked
at before DuckDB sees it.
"""

from __future__ import annotations

import re

__all__ = ["is_harmless"]

_TEXT = re.compile(r"'(?:[^'\0]|'')*'")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])", re.ASCII)
_CHARACTERS = re.compile(r"[\w\0 <>=+\-*/%(),.]*", re.ASCII)
_STRANGE = re.compile(r"--|/\*|FROM *\0")
"""Comments, and a text that names what to read."""

_WORD = re.compile(r"([A-Za-z_]\w*)( *\()?", re.ASCII)

_NAME = re.compile(r"[csq]\d+", re.ASCII)

_WORDS = frozenset(
    {
        *("SELECT", "DISTINCT", "FROM", "AS", "WITH", "WHERE", "GROUP", "BY", "UNION"),
        *("ALL", "VALUES", "FILTER", "CASE", "WHEN", "THEN", "ELSE", "END", "AND", "OR"),
        *("NOT", "IS", "IN", "NULL", "TRUE", "FALSE", "BIGINT", "DOUBLE", "VARCHAR"),
        *("BOOLEAN", "Sensor", "Memory", "Ray", "RobotRay", "BeaconRay", "answer"),
        *("items", "id", "robot_name", "forward_distance", "forward_object"),
        *("forward_label", "clock", "can_charge", "has_battery", "battery_level"),
        *("battery_capacity", "viewer", "sensor", "ray", "angle", "distance", "object"),
        *("label", "value", "col0"),
    }
)

_BEFORE_PARENTHESES = frozenset(
    {
        *("SELECT", "FROM", "AS", "WHERE", "BY", "UNION", "ALL", "VALUES", "FILTER"),
        *("WHEN", "THEN", "ELSE", "AND", "OR", "NOT", "IN", "EXISTS", "CAST", "abs"),
        *("arg_max_null", "arg_min_null", "atan", "atan2", "avg", "ceil", "coalesce"),
        *("cos", "count", "degrees", "exp", "floor", "greatest", "least", "ln", "log10"),
        *("log2", "max", "min", "nullif", "pi", "pow", "radians", "round", "row", "sin"),
        *("sqrt", "sum", "tan", "trunc"),
    }
)


def is_harmless(query: str) -> bool:
    """Whether a query reads the tables of a tick and calls listed functions, and does no more."""
    bare = _NUMBER.sub("0", _TEXT.sub("\0", query))
    if "\0" in query or not _CHARACTERS.fullmatch(bare) or _STRANGE.search(bare):
        return False
    return bare.startswith(("SELECT ", "WITH ")) and all(
        word in _BEFORE_PARENTHESES if opens else word in _WORDS or _NAME.fullmatch(word)
        for word, opens in _WORD.findall(bare)
    )
