"""DuckDB's static types, made explicit in a query that both evaluations start from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot.errors import SqlglotError

from logical_robots_tui.language.types import Plain
from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.typed.reading import Reader

if TYPE_CHECKING:
    from sqlglot import exp

__all__ = ["as_on_duckdb"]


def as_on_duckdb(statement: str) -> tuple[str, exp.Query | None, tuple[str, ...]]:
    """Make SQLite compute what DuckDB's types imply.

    Returns:
        The statement, its tree, or None if it can't be read, and its boolean columns.
    """
    try:
        tree = sql.parse(statement)
        before = tree.copy()
        columns = Reader().query(tree)
        sql.drop_parentheses(tree)
    except (SqlglotError, ValueError, RecursionError):
        return statement, None, ()
    truths = tuple(name for name, kind in columns.items() if kind is Plain.TRUTH)
    return statement if tree == before else f"{sql.render(tree, pretty=True)};", tree, truths
