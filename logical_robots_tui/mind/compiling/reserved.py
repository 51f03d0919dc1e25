"""Columns and predicates that are called like a word of SQL, such as ``from`` and ``Index``.

The package writes their names as they are, and SQLite stumbles over some.
"""

from __future__ import annotations

from typing import Any

from logica.compiler import rule_translate

__all__ = ["install", "sql_field", "table_name"]

_WORDS = """
    add all alter and as autoincrement between case cast check collate commit constraint create
    current_date current_time current_timestamp default deferrable delete distinct drop else escape
    except exists foreign from group having in index insert intersect into is isnull join limit not
    nothing notnull null on or order primary raise references returning select set table then to
    transaction union unique update using values when where
"""

_RESERVED = frozenset(_WORDS.split())

_MORE_WORDS = """
    abort action after always analyze anti any array asc asof attach before begin both by cascade
    collate column conflict cross current database desc describe detach do each end except exclude
    exclusive explain fail false filter first following for full generated glob groups ignore
    immediate indexed initially inner instead interval key lateral last leading left like map match
    materialized natural no nulls of offset only others outer over partition pivot plan positional
    pragma preceding qualify query range recursive regexp reindex release rename replace restrict
    right rollback row rows savepoint semi show some struct summarize temp temporary ties trailing
    trigger true unbounded unpivot vacuum view virtual window with within without
"""

_NO_ALIASES = _RESERVED | frozenset(_MORE_WORDS.split())
"""What a table can't be called in a query."""

_as_it_is = rule_translate.LogicaFieldToSqlField


def sql_field(field: Any) -> Any:
    """The name of a column in SQL.

    Args:
        field: Its name in Logica, or its number.
    """
    name = _as_it_is(field)
    return f'"{name}"' if isinstance(name, str) and name.lower() in _RESERVED else name


_allocate = rule_translate.NamesAllocator.AllocateTable


def table_name(self: Any, hint_for_user: Any = None) -> Any:
    """A name for a table of a query.

    Args:
        self: The package's allocator of names.
        hint_for_user: The name of the predicate whose rows it has.
    """
    if isinstance(hint_for_user, str) and hint_for_user.lower() in _NO_ALIASES:
        self.allocated_tables.add(hint_for_user)
    return _allocate(self, hint_for_user)


def install() -> None:
    """Let the package use them."""
    rule_translate.LogicaFieldToSqlField = sql_field
    rule_translate.NamesAllocator.AllocateTable = table_name
