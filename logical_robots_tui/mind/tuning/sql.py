"""SQL as sqlglot trees, parsed and written without a change of meaning.

sqlglot translates functions between databases, so its function tables are emptied.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, ClassVar

from sqlglot import exp
from sqlglot.dialects.sqlite import SQLite

from logical_robots_tui.mind.sqlite.layouts import KINDS

_NEED_NO_PARENTHESES = (
    *(exp.Anonymous, exp.Boolean, exp.Case, exp.Column, exp.Literal, exp.Null, exp.Paren),
    exp.Subquery,
)

TABLES = {table.lower(): table for table in ("Sensor", "Memory", "Ray", "Item", *KINDS)}
"""The tables that a tuned query reads, by their names in lower case."""

AGGREGATES = frozenset(
    {
        *("avg", "count", "group_concat", "json_group_array", "json_group_object", "max", "median"),
        *("min", "percentile", "string_agg", "sum", "total"),
        *("list_of_distinct", "concat_lists", "arg_min", "arg_max", "arg_min_k", "arg_max_k"),
        *("arg_min_of_nested", "arg_max_of_nested", "arg_min_k_of_nested", "arg_max_k_of_nested"),
        *("any_value", "array_by", "greatest_nested", "least_nested"),
    }
)
"""Functions that are, or may be, aggregates."""


class _Statements(SQLite):
    class Parser(SQLite.Parser):  # type: ignore[misc, valid-type]  # made at run time
        FUNCTIONS: ClassVar[dict[str, Any]] = {}
        FUNCTION_PARSERS: ClassVar[dict[str, Any]] = {}
        NO_PAREN_FUNCTIONS: ClassVar[dict[Any, Any]] = {}

    class Generator(SQLite.Generator):  # type: ignore[misc, valid-type]  # made at run time
        def join_sql(self, expression: exp.Join) -> str:
            """Return a comma, or CROSS JOIN, which forbids SQLite to choose the order."""
            operator = " CROSS JOIN" if expression.kind else ","
            return f"{operator} {self.sql(expression, 'this')}"


_DIALECT = _Statements()


def parse(sql: str) -> exp.Query:
    """Return the tree of one query; ValueError for other SQL or joins that Logica never makes."""
    tree = _DIALECT.parse(sql)[0]
    if not isinstance(tree, exp.Query):
        raise ValueError("not a query")
    for join in tree.find_all(exp.Join):
        if {part for part, value in join.args.items() if value} != {"this", "kind"}:
            raise ValueError("a join with conditions")
        if join.kind != "CROSS":
            raise ValueError("not a plain join")
        join.set("kind", None)
    drop_parentheses(tree)
    return tree


@cache
def _template(text: str) -> exp.Expr:
    return parse(f"SELECT {text}").selects[0]


def expression(text: str, **parts: exp.Expr) -> exp.Expr:
    """Return the tree of an expression, with copies of parts for the columns of their names."""
    found = _template(text).copy()
    for column in list(found.find_all(exp.Column)):
        if column.name in parts:
            column.replace(parts[column.name].copy())
    return found


def drop_parentheses(tree: exp.Query) -> None:
    for wrapped in reversed(list(tree.find_all(exp.Paren, exp.Subquery))):
        if isinstance(wrapped, exp.Paren):
            needless = isinstance(wrapped.this, _NEED_NO_PARENTHESES)
        else:
            needless = isinstance(wrapped.this, exp.Subquery) and not wrapped.alias
        if needless:
            wrapped.replace(wrapped.this)


def render(tree: exp.Expr, *, pretty: bool = False) -> str:
    """Return the text of a tree; `pretty` for people, with functions' case preserved."""
    functions = False if pretty else "upper"
    return _DIALECT.generate(tree, copy=False, pretty=pretty, normalize_functions=functions)


def sources(select: exp.Select) -> dict[str, exp.Expr]:
    found: dict[str, exp.Expr] = {}
    first = select.args.get("from_")
    for item in ([first] if first else []) + (select.args.get("joins") or []):
        table = item.this
        found[table.alias_or_name] = table
    return found


def source(column: exp.Column) -> tuple[exp.Select, exp.Expr] | None:
    name = column.table
    node: exp.Expr | None = column.parent
    while node is not None and not isinstance(node, exp.CTE):
        if isinstance(node, exp.Select):
            found = sources(node).get(name)
            if found is not None:
                return node, found
        node = node.parent
    return None


def columns_of(select: exp.Select, name: str) -> Iterator[exp.Column]:
    for column in select.find_all(exp.Column):
        found = source(column) if column.table == name else None
        if found is not None and found[0] is select:
            yield column


def call_name(node: exp.Expr | None) -> str:
    return node.name.lower() if isinstance(node, exp.Anonymous) else ""


def extract_path(node: exp.Expr | None) -> str:
    """Return the path of a call of json_extract with one, or ""."""
    if call_name(node) != "json_extract":
        return ""
    assert node is not None
    arguments = node.expressions
    path = arguments[1] if len(arguments) == 2 else None
    return path.this if isinstance(path, exp.Literal) and path.is_string else ""


def own_aggregates(node: exp.Expr) -> bool:
    if isinstance(node, exp.Select):
        return False
    if call_name(node) in AGGREGATES or isinstance(node, exp.Window):
        return True
    return any(own_aggregates(child) for child in node.iter_expressions())


def table_name(source: exp.Expr | None) -> str:
    if not isinstance(source, exp.Table) or not isinstance(source.this, exp.Identifier):
        return ""
    return source.name.lower()


def conjuncts(select: exp.Select) -> list[exp.Expr]:
    where = select.args.get("where")
    found: list[exp.Expr] = []
    waiting = [where.this] if where else []
    while waiting:
        node = waiting.pop()
        if isinstance(node, exp.And):
            waiting += [node.expression, node.this]
        elif isinstance(node, exp.Paren):
            waiting.append(node.this)
        else:
            found.append(node)
    return found


def restrict(select: exp.Select, condition: exp.Expr) -> None:
    where = select.args.get("where")
    if where is None:
        select.set("where", exp.Where(this=condition))
    else:
        where.set("this", exp.And(this=condition, expression=exp.Paren(this=where.this)))


def drop_condition(select: exp.Select, condition: exp.Expr) -> None:
    node, parent = condition, condition.parent
    while isinstance(parent, exp.Paren):
        node, parent = parent, parent.parent
    if isinstance(parent, exp.And):
        parent.replace(parent.expression if parent.this is node else parent.this)
    else:
        select.set("where", None)


def drop_source(select: exp.Select, name: str) -> None:
    joins = select.args.get("joins") or []
    first = select.args["from_"]
    if first.this.alias_or_name == name:
        first.set("this", joins.pop(0).this)
    else:
        joins = [join for join in joins if join.this.alias_or_name != name]
    select.set("joins", joins)


def read_after(select: exp.Select, followers: Mapping[str, str]) -> None:
    """Fix the order of sources: each of `followers` is read right after the one it maps to."""
    items = sources(select)
    leaders = [name for name in items if name in followers.values()]
    ordered = [
        n for lead in leaders for n in (lead, *(f for f in items if followers.get(f) == lead))
    ]
    first, *rest = [*ordered, *(name for name in items if name not in ordered)]
    select.set("from_", exp.From(this=items[first]))
    joins = [exp.Join(this=items[n], kind="CROSS" if n in followers else None) for n in rest]
    select.set("joins", joins)
