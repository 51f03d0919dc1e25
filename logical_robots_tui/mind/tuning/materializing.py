"""Named queries that a subquery reads again and again, computed once.

If a subquery reads nothing else, SQLite computes the query again each time that it evaluates the
subquery, unless told not to. The compiler adds a table of a single 0, which prevents this, but
another pass removes that table.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.layouts import KINDS
from logical_robots_tui.mind.tuning import columns, common_subexpressions, sql

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["asked_often", "computed_once", "is_looked_up", "looked_up"]

_ZERO = "t_0_zero"
_KINDS = frozenset(table.lower() for table in KINDS)


def computed_once(tree: exp.Query, *, by_robots: bool = False) -> None:
    """Let SQLite keep the rows of named queries that are asked for row by row of others.

    Args:
        tree: A query; changed in place.
        by_robots: Whether also of those that are asked for once for each robot that is seen.
    """
    named = _named(tree)
    for table in tree.find_all(exp.Table):
        query = named.get(table.name)
        if query is not None and _is_asked_often(table, named, by_robots=by_robots):
            query.set("materialized", True)


def asked_often(tree: exp.Query) -> frozenset[str]:
    """Return names of the named queries that `computed_once` has found."""
    return frozenset(
        name
        for name, query in _named(tree).items()
        if query.args.get("materialized") and not common_subexpressions.is_shared(name)
    )


def looked_up(tree: exp.Query) -> None:
    """Let SQLite make an index where rows of these queries are looked up.

    SQLite estimates the cost of evaluating a subquery once. So an index seems to pay only if rows
    are looked up for those of another source: a table of a single 0.
    """
    named, often = _named(tree), asked_often(tree)
    for table in list(tree.find_all(exp.Table)):
        select = sql.nearest_select(table) if table.name in often else None
        if select is None or len(sql.sources(select)) > 1 or not _compares(select):
            continue
        if _is_asked_often(table, named):
            array = exp.Anonymous(this="JSON_ARRAY", expressions=[exp.Literal.number(0)])
            zero = exp.Table(this=exp.Anonymous(this="JSON_EACH", expressions=[array]))
            select.append("joins", exp.Join(this=exp.alias_(zero, _ZERO, table=True)))


def is_looked_up(select: exp.Select) -> bool:
    """Return whether `looked_up` has put that table beside what a select reads."""
    return _ZERO in sql.sources(select)


def _compares(select: exp.Select) -> bool:
    """Return whether a select wants rows in which a column of them is equal to something."""
    tests = [test for test in sql.conjuncts(select) if isinstance(test, exp.EQ)]
    sides = [side for test in tests for side in (test.this, test.expression)]
    found = [sql.source(side) for side in sides if isinstance(side, exp.Column)]
    return any(source is not None and source[0] is select for source in found)


def _named(tree: exp.Query) -> Mapping[str, exp.CTE]:
    named = tree.args.get("with_")
    return {query.alias: query for query in named.expressions} if named else {}


def _is_asked_often(
    table: exp.Table, named: Mapping[str, exp.CTE], *, by_robots: bool = False
) -> bool:
    """Return whether a query is read by a subquery that is evaluated for each of many rows."""
    node: exp.Expr = table
    is_source = True
    while (parent := node.parent) is not None and not isinstance(parent, exp.CTE):
        if isinstance(parent, exp.From | exp.Join):
            is_source = True
        elif isinstance(parent, exp.Select):
            if not is_source and (by_robots or not _has_few_rows(parent, named)):
                return True
            is_source = False
        node = parent
    return False


def _has_few_rows(select: exp.Select, named: Mapping[str, exp.CTE]) -> bool:
    """Return whether a select has a row for each robot, memory, or ray of a kind, and not more."""
    kinds = 0
    for source in sql.sources(select).values():
        query = named.get(source.name) if isinstance(source, exp.Table) else None
        if query is not None and common_subexpressions.is_shared(query.alias):
            if not _has_few_rows(query.this, named):
                return False
        elif sql.table_name(source) in _KINDS:
            kinds += 1
        elif not columns.is_input(source):
            return False
    return kinds < 2
