"""Whole rays, written as JSON only once it is known which one is needed.

The nearest ray of a radar, as in ``ArgMin{ray -> ray.distance}``, is one of 31. Beside MIN a column
of a group comes from the row that has the least value, so SQLite can ask for that ray alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.filling import KINDS, WHOLE_RAY
from logical_robots_tui.mind.tuning import sql

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["whole_rays_when_wanted"]

_TABLES = frozenset({"ray", *(table.lower() for table in KINDS)})
_WHOLE = "value"


def whole_rays_when_wanted(tree: exp.Expr) -> None:
    """Ask for whole rays once for each group, where they stand beside an aggregate."""
    for column, select in list(_whole_rays(tree)):
        if _is_beside_aggregate(column, select):
            number = exp.column("id", column.table)
            column.replace(exp.Anonymous(this=WHOLE_RAY, expressions=[number]))


def _whole_rays(tree: exp.Expr) -> Iterator[tuple[exp.Column, exp.Select]]:
    """Yield columns that are whole rays, with the select that reads the rays."""
    for column in tree.find_all(exp.Column):
        found = sql.source(column) if column.name.lower() == _WHOLE else None
        if found is not None and sql.table_name(found[1]) in _TABLES:
            yield column, found[0]


def _is_beside_aggregate(column: exp.Column, select: exp.Select) -> bool:
    """Return whether a column is in the result of an aggregating select, not aggregated itself."""
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
