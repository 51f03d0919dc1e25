"""Columns that are called like a word of SQL, such as ``from`` and ``to``.

The package writes names of columns as they are, and SQLite stumbles over some.
"""

from __future__ import annotations

from typing import Any

from logica.compiler import rule_translate

__all__ = ["install", "sql_field"]

_WORDS = """
    add all alter and as autoincrement between case cast check collate commit constraint create
    current_date current_time current_timestamp default deferrable delete distinct drop else escape
    except exists foreign from group having in index insert intersect into is isnull join limit not
    nothing notnull null on or order primary raise references returning select set table then to
    transaction union unique update using values when where
"""

_RESERVED = frozenset(_WORDS.split())

_as_it_is = rule_translate.LogicaFieldToSqlField


def sql_field(field: Any) -> Any:
    """The name of a column in SQL.

    Args:
        field: Its name in Logica, or its number.
    """
    name = _as_it_is(field)
    return f'"{name}"' if isinstance(name, str) and name.lower() in _RESERVED else name


def install() -> None:
    """Let the package use it."""
    rule_translate.LogicaFieldToSqlField = sql_field
