"""DuckDB's static types, made explicit in a query that both evaluations start from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot.errors import SqlglotError

from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.typed.reading import Reader

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sqlglot import exp

    from logical_robots_tui.language.types import Kind, Tables

__all__ = ["as_on_duckdb"]


def as_on_duckdb(
    statement: str, tables: Tables | None = None
) -> tuple[str, exp.Query | None, Mapping[str, Kind]]:
    """Make SQLite compute what DuckDB's types imply; `tables` are those besides the inputs.

    Returns:
        The statement, its tree, or None if it can't be read, and the types of its columns.
    """
    try:
        tree = sql.parse(statement)
        before = tree.copy()
        columns = Reader(tables or {}).query(tree)
        sql.drop_parentheses(tree)
    except (SqlglotError, ValueError, RecursionError):
        return statement, None, {}
    return statement if tree == before else f"{sql.render(tree, pretty=True)};", tree, columns
