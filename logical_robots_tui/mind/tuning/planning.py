"""Which rows SQLite keeps and where it makes indexes; its planner can't tell what pays.

SQLite evaluates a named query again for each evaluation of a subquery that reads only it.
The compiler prevents this with a table of a single 0, which another pass removes.

SQLite indexes every join. This pays for list records and for queries read repeatedly, but
not for few robots' sensors and memories: there ``NOT a <> b`` prevents it.
"""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Set as AbstractSet

from sqlglot import exp

from logical_robots_tui.mind.sqlite.layouts import KINDS
from logical_robots_tui.mind.tuning import columns, common_subexpressions, sql

_ZERO = "t_0_zero"
_KINDS = frozenset(table.lower() for table in KINDS)


def materialize(tree: exp.Query, *, by_robots: bool = False) -> None:
    """Let SQLite keep the rows of named queries that run for each row of others.

    Args:
        tree: A query; changed in place.
        by_robots: Whether also of those that run once for each visible robot.
    """
    queries = _names(tree)
    for table in tree.find_all(exp.Table):
        query = queries.get(table.name)
        if query is not None and _repeats(table, queries, by_robots=by_robots):
            query.set("materialized", True)


def materialized_queries(tree: exp.Query) -> frozenset[str]:
    """Return the names of the queries that `materialize` marked."""
    return frozenset(
        name
        for name, query in _names(tree).items()
        if query.args.get("materialized") and not common_subexpressions.is_shared(name)
    )


def index_lookups(tree: exp.Query) -> None:
    """Let SQLite make an index where rows of these queries are looked up.

    SQLite estimates the cost of evaluating a subquery once. So an index seems to pay only if rows
    are looked up for those of another source: a table of a single 0.
    """
    queries, materialized = _names(tree), materialized_queries(tree)
    for table in list(tree.find_all(exp.Table)):
        select = table.find_ancestor(exp.Select) if table.name in materialized else None
        if select is None or len(sql.sources(select)) > 1:
            continue
        tests = [test for test in sql.conjuncts(select) if isinstance(test, exp.EQ)]
        sides = [side for test in tests for side in (test.this, test.expression)]
        if not any(_read_by(side, select) is not None for side in sides):
            continue
        if _repeats(table, queries):
            zero = exp.Table(this=sql.expression("JSON_EACH(JSON_ARRAY(0))"))
            select.append("joins", exp.Join(this=exp.alias_(zero, _ZERO, table=True)))


def _names(tree: exp.Query) -> Mapping[str, exp.CTE]:
    return {query.alias: query for query in sql.named_queries(tree)}


def _repeats(table: exp.Table, queries: Mapping[str, exp.CTE], *, by_robots: bool = False) -> bool:
    node: exp.Expr = table
    is_source = True
    while (parent := node.parent) is not None and not isinstance(parent, exp.CTE):
        if isinstance(parent, exp.From | exp.Join):
            is_source = True
        elif isinstance(parent, exp.Select):
            if not is_source and (by_robots or not _has_few_rows(parent, queries)):
                return True
            is_source = False
        node = parent
    return False


def _has_few_rows(select: exp.Select, queries: Mapping[str, exp.CTE]) -> bool:
    """Return whether a select has at most one row per robot, memory, or ray of a kind."""
    kinds = 0
    for source in sql.sources(select).values():
        query = queries.get(source.name) if isinstance(source, exp.Table) else None
        if query is not None and common_subexpressions.is_shared(query.alias):
            if not _has_few_rows(query.this, queries):
                return False
        elif sql.table_name(source) in _KINDS:
            kinds += 1
        elif not columns.is_input(source):
            return False
    return kinds < 2


_NUMBERED_TABLES = frozenset({"item", "ray", *(table.lower() for table in KINDS)})
_INPUTS = frozenset({"memory", "sensor"})


def scan_ranges(tree: exp.Query) -> None:
    """Keep SQLite from finding rows by their content among those of all robots.

    Rays of one radar and records of one list have numbers that follow each other, and come in this
    order. Visible memories are few, and found by number or name: an index of all those with
    ``memory.settled == true`` costs more than testing them, and the joins that it leads to are
    slower still.
    """
    for select in list(tree.find_all(exp.Select)):
        for equation in sql.conjuncts(select):
            if isinstance(equation, exp.EQ) and _finds_numbered(equation, select):
                _without_index(equation)


def limit_indexes(tree: exp.Query) -> None:
    """Keep SQLite from making indexes, but where rows of lists are joined or rows looked up."""
    queries: set[str] = set()  # those of lists
    for name, query in _names(tree).items():
        if _reads_lists(query.this, queries):
            queries.add(name)
    unhelpful_equations, needs_index = [], False
    for select in tree.find_all(exp.Select):
        looks_up = _ZERO in sql.sources(select)
        for equation in sql.conjuncts(select):
            if isinstance(equation, exp.EQ):
                sources = _sources_of_one_select(equation)
                # The table of all lists itself would be indexed again.
                joins_lists = any(
                    sql.table_name(source) != "item" and _reads_lists(source, queries)
                    for source in sources
                )
                if looks_up or joins_lists:
                    needs_index = True
                elif not sources or "id" not in (equation.this.name, equation.expression.name):
                    unhelpful_equations.append(equation)
    for equation in unhelpful_equations if needs_index else ():
        _without_index(equation)


def _without_index(equation: exp.EQ) -> None:
    equation.replace(sql.expression("(NOT a <> b)", a=equation.this, b=equation.expression))


def _finds_numbered(equation: exp.EQ, select: exp.Select) -> bool:
    """Return whether a condition could only serve to find rays, records or inputs by content."""
    for side, other_side in (
        (equation.this, equation.expression),
        (equation.expression, equation.this),
    ):
        table_name, other_table = _read_by(side, select), _read_by(other_side, select)
        if table_name in _NUMBERED_TABLES and side.name != "id":
            return other_table is None or (
                other_table in _INPUTS and other_side.name != "robot_name"
            )
        if table_name in _INPUTS and side.name not in ("id", "robot_name"):
            return other_side.find(exp.Column) is None
    return False


def _read_by(node: exp.Expr, select: exp.Select) -> str | None:
    """Return the select's table that owns a column, "" for a query, None for neither."""
    source = sql.source(node) if isinstance(node, exp.Column) else None
    return sql.table_name(source[1]) if source is not None and source[0] is select else None


def _reads_lists(query: exp.Expr, queries: AbstractSet[str]) -> bool:
    return any(
        sql.table_name(table) == "item" or table.name in queries
        for table in query.find_all(exp.Table)
    )


def _sources_of_one_select(equation: exp.EQ) -> tuple[exp.Expr, ...]:
    left, right = (
        sql.source(side) if isinstance(side, exp.Column) else None
        for side in (equation.this, equation.expression)
    )
    if left is None or right is None or left[0] is not right[0] or left[1] is right[1]:
        return ()
    return left[1], right[1]
