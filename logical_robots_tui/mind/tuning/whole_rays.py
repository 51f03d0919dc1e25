"""Rays that are wanted as a whole, written as JSON only where it is known which one is wanted.

The nearest ray of a radar, as in ``ArgMin{ray -> ray.distance}``, is one of 31. Beside MIN a column
of a group comes from the row that has the least value, so SQLite can ask for that ray alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.filling import KINDS, WHOLE_RAY
from logical_robots_tui.mind.tuning import sql

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

__all__ = ["still_read", "whole_rays_when_wanted"]

_TABLES = frozenset({"ray", *(table.lower() for table in KINDS)})
_WHOLE = "value"


def whole_rays_when_wanted(tree: exp.Expr) -> None:
    """Ask for whole rays once for each group, where they stand beside an aggregate."""
    for column, select, _ in list(_whole_rays(tree)):
        if _is_beside_aggregate(column, select):
            number = exp.column("id", column.table)
            column.replace(exp.Anonymous(this=WHOLE_RAY, expressions=[number]))


def still_read(
    read: Mapping[str, tuple[str, ...]], trees: Sequence[exp.Expr]
) -> dict[str, tuple[str, ...]]:
    """Return the columns that are still read of those that queries read before.

    Args:
        read: By name of a table the columns of it.
        trees: The queries.
    """
    whole = {table for tree in trees for _, _, table in _whole_rays(tree)}
    return {
        table: tuple(name for name in names if name != _WHOLE or table.lower() in whole)
        for table, names in read.items()
    }


def _whole_rays(tree: exp.Expr) -> Iterator[tuple[exp.Column, exp.Select, str]]:
    """Columns that are whole rays, with the select that reads the rays, and from which table."""
    for column in tree.find_all(exp.Column):
        found = sql.source(column) if column.name.lower() == _WHOLE else None
        if found is not None and (table := sql.table_name(found[1])) in _TABLES:
            yield column, found[0], table


def _is_beside_aggregate(column: exp.Column, select: exp.Select) -> bool:
    """Whether a column is one of a group's in what a select gives, and not aggregated itself."""
    node: exp.Expr = column
    while node.parent is not select:
        parent = node.parent
        if (
            parent is None
            or isinstance(parent, exp.Select)
            or sql.call_name(parent) in sql.AGGREGATES
        ):
            return False
        node = parent
    return node.arg_key == "expressions" and any(map(sql.own_aggregates, select.expressions))
