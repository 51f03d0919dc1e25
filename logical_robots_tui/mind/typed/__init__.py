"""DuckDB's static types, made explicit in a query.

Both ways to evaluate a program start from the result.
"""

from __future__ import annotations

from sqlglot.errors import SqlglotError

from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.typed.reading import Reader

__all__ = ["as_on_duckdb"]


def as_on_duckdb(statement: str) -> str:
    """Return a query in which SQLite computes what DuckDB would because of the types of values."""
    try:
        tree = sql.parse(statement)
        before = tree.copy()
        Reader().query(tree)
    except (SqlglotError, ValueError, RecursionError):
        return statement
    return statement if tree == before else f"{sql.written(tree, pretty=True)};"
