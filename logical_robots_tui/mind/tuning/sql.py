"""SQL as sqlglot trees, parsed and written without a change of meaning; and JSON in it.

sqlglot translates functions between databases, so its function tables are emptied. A value that
passes through a query of its own loses SQLite's mark that it is JSON, and would become an escaped
text in a record.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, ClassVar

from sqlglot import exp
from sqlglot.dialects.sqlite import SQLite

from logical_robots_tui.mind.sqlite.layouts import ITEM_FIELDS, KINDS, MEMORY_FIELDS

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
    tree = _template(text).copy()
    for column in list(tree.find_all(exp.Column)):
        if column.name in parts:
            column.replace(parts[column.name].copy())
    return tree


def drop_parentheses(tree: exp.Query) -> None:
    for node in reversed(list(tree.find_all(exp.Paren, exp.Subquery))):
        if isinstance(node, exp.Paren):
            is_redundant = isinstance(node.this, _NEED_NO_PARENTHESES)
        else:
            is_redundant = isinstance(node.this, exp.Subquery) and not node.alias
        if is_redundant:
            node.replace(node.this)


def render(tree: exp.Expr, *, pretty: bool = False) -> str:
    """Return the text of a tree; `pretty` for people, with functions' case preserved."""
    functions = False if pretty else "upper"
    return _DIALECT.generate(tree, copy=False, pretty=pretty, normalize_functions=functions)


def sources(select: exp.Select) -> dict[str, exp.Expr]:
    tables: dict[str, exp.Expr] = {}
    from_clause = select.args.get("from_")
    for item in ([from_clause] if from_clause else []) + (select.args.get("joins") or []):
        table = item.this
        tables[table.alias_or_name] = table
    return tables


def source(column: exp.Column) -> tuple[exp.Select, exp.Expr] | None:
    name = column.table
    node: exp.Expr | None = column.parent
    while node is not None and not isinstance(node, exp.CTE):
        if isinstance(node, exp.Select):
            table = sources(node).get(name)
            if table is not None:
                return node, table
        node = node.parent
    return None


def named_queries(tree: exp.Expr) -> list[exp.CTE]:
    """Return the common table expressions of a query."""
    with_clause = tree.args.get("with_")
    return list(with_clause.expressions) if with_clause else []


def arms(case: exp.Case) -> list[exp.Expr]:
    """Return the values that a CASE chooses from; without ELSE null is not among them."""
    default = case.args.get("default")
    values = [branch.args["true"] for branch in case.args["ifs"]]
    return values if default is None else [*values, default]


def columns_of(select: exp.Select, name: str) -> Iterator[exp.Column]:
    for column in select.find_all(exp.Column):
        column_source = source(column) if column.table == name else None
        if column_source is not None and column_source[0] is select:
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
    conditions: list[exp.Expr] = []
    pending = [where.this] if where else []
    while pending:
        node = pending.pop()
        if isinstance(node, exp.And):
            pending += [node.expression, node.this]
        elif isinstance(node, exp.Paren):
            pending.append(node.this)
        else:
            conditions.append(node)
    return conditions


def is_condition(node: exp.Expr) -> bool:
    """Return whether only rows for which an expression is true count, so that null is false."""
    parent = node.parent
    while isinstance(parent, exp.Paren | exp.And):
        parent = parent.parent
    return isinstance(parent, exp.Where)


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
    first, *following = [*ordered, *(name for name in items if name not in ordered)]
    select.set("from_", exp.From(this=items[first]))
    joins = [exp.Join(this=items[n], kind="CROSS" if n in followers else None) for n in following]
    select.set("joins", joins)


_CHEAP = frozenset({"abs", "atan2", "cos", "sin", "sqrt"})
_JSON_WRITERS = frozenset({"real_as_json", "value_as_json"})
_MAKES_JSON = frozenset({"json_array", "json_object", "json_quote"})
_COLLECTS_JSON = frozenset({"json_group_array", "json_group_object"})
_MAYBE_JSON = frozenset({"memory", "sensor", "value", *MEMORY_FIELDS, *ITEM_FIELDS})
_PASSES_ON = frozenset({"coalesce", "iif", "if", "ifnull", "nullif", "min", "max", "any_value"})


def unwrap(value: exp.Expr) -> exp.Expr:
    """Return the value that was written as JSON; a truth becomes a number."""
    truth = truth_in(value)
    if truth is not None:
        return truth
    if call_name(value) != "json" or len(value.expressions) != 1:
        return value
    inner: exp.Expr = value.expressions[0]
    return inner.expressions[0] if call_name(inner) in _JSON_WRITERS else inner


def truth_in(value: exp.Expr) -> exp.Expr | None:
    inner = value.expressions[0] if call_name(value) == "json" else None
    if isinstance(inner, exp.Literal) and inner.is_string and inner.name in ("true", "false"):
        return exp.Literal.number(int(inner.name == "true"))
    if not isinstance(inner, exp.Case) or inner.this is None or len(inner.args["ifs"]) != 2:
        return None
    names = [branch.args["true"].name for branch in inner.args["ifs"]]
    return inner.this if names == ["true", "false"] else None


def truth(value: exp.Expr) -> exp.Expr:
    """Return a boolean, which SQLite stores as a number, as JSON."""
    return expression("JSON(CASE x WHEN 1 THEN 'true' WHEN 0 THEN 'false' END)", x=value)


_DIGITS = "CASE WHEN x IS NOT NULL THEN PRINTF('%!.17g', x) END"

_OF_ANY_TYPE = """
CASE WHEN x >= '' THEN marked WHEN TYPEOF(x) = 'real' THEN JSON(PRINTF('%!.17g', x)) ELSE x END
"""
"""Texts come after all numbers; to compare is quicker than to ask for the type."""

_MARKED = """
CASE WHEN SUBSTR(x, 1, 1) IN ('{', '[') AND JSON_VALID(x) THEN JSON(x) ELSE otherwise END
"""


def native_numbers(tree: exp.Expr) -> None:
    """Write real numbers natively, unless expensive; infinity makes the query fail."""
    for call in list(tree.find_all(exp.Anonymous)):
        name = call_name(call)
        if name == "real_as_json":
            number = call.expressions[0]
            calls = number.find_all(exp.Anonymous)
            if not number.find(exp.Query) and all(call_name(call) in _CHEAP for call in calls):
                call.replace(expression(_DIGITS, x=number))
        elif name == "value_as_json" and isinstance(call.expressions[0], exp.Column):
            (value,) = call.expressions
            assert call.parent is not None
            call.parent.replace(expression(_OF_ANY_TYPE, x=value, marked=mark(value, value)))


def is_plain(node: exp.Expr) -> bool:
    if isinstance(node, exp.Paren | exp.Alias):
        return is_plain(node.this)
    if isinstance(node, exp.Subquery) and isinstance(node.this, exp.Select):
        items = node.this.expressions
        return len(items) == 1 and is_plain(items[0])
    if isinstance(node, exp.Case):
        return all(map(is_plain, arms(node)))
    if isinstance(node, exp.Column):
        column_source = source(node)
        return column_source is not None and _is_plain_column(node, column_source[1])
    if isinstance(node, exp.Anonymous):
        name = call_name(node)
        if name in _PASSES_ON:
            return all(map(is_plain, node.expressions))
        return name in {"sum", "avg", "count", "total", "divide", "modulo", "abs", "sqrt"}
    return isinstance(node, exp.Binary | exp.Not | exp.Neg | exp.Literal | exp.Null)


def _is_plain_column(column: exp.Column, table: exp.Expr) -> bool:
    if isinstance(table, exp.Subquery) and isinstance(table.this, exp.Select):
        for item in table.this.expressions:
            if item.alias_or_name.lower() == column.name.lower():
                return is_plain(item)
    return is_stored(table) and column.name.lower() not in _MAYBE_JSON


def _reaches_json(node: exp.Expr, is_result: bool) -> bool:
    while True:
        parent = node.parent
        if isinstance(parent, exp.Anonymous):
            name = call_name(parent)
            if name in _MAKES_JSON or name in _COLLECTS_JSON:
                return True
            if name not in _PASSES_ON:
                return False
        elif isinstance(parent, exp.If):
            if parent.this is node:
                return False
        elif isinstance(parent, exp.Select):
            if isinstance(parent.parent, exp.Subquery) and not isinstance(
                parent.parent.parent, exp.From | exp.Join
            ):
                node = parent
                parent = parent.parent
            else:
                return not is_result
        elif not isinstance(parent, exp.Case | exp.Paren | exp.Alias | exp.Subquery):
            return False
        node = parent


def restore_mark(value: exp.Column, place: exp.Expr, *, is_result: bool) -> exp.Expr:
    """Return a value marked again as a record or list, where that matters."""
    return mark(value, value) if _reaches_json(place, is_result) else value


def mark(value: exp.Column, otherwise: exp.Expr) -> exp.Expr:
    """Return a value as JSON if it is the text of a record or list, else `otherwise`."""
    return expression(_MARKED, x=value, otherwise=otherwise)


def is_stored(table: exp.Expr) -> bool:
    """Return whether a source is a table, whose values are never marked as JSON."""
    return table_name(table) in TABLES
