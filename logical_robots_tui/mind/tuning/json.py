"""Values in JSON: unwrapped if no JSON is needed, written without Python, marked as JSON.

A value that passes through a query of its own loses SQLite's JSON mark and would become an
escaped text in a record.
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.sqlite.layouts import ITEM_FIELDS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import sql

_CHEAP = frozenset({"abs", "atan2", "cos", "sin", "sqrt"})
_WRITTEN = frozenset({"real_as_json", "value_as_json"})
_MAKES_JSON = frozenset({"json_array", "json_object", "json_quote"})
_COLLECTS_JSON = frozenset({"json_group_array", "json_group_object"})
_UNPLAIN = frozenset({"memory", "sensor", "value", *MEMORY_FIELDS, *ITEM_FIELDS})
_PASSES_ON = frozenset({"coalesce", "iif", "if", "ifnull", "nullif", "min", "max", "any_value"})


def unwrap(value: exp.Expr) -> exp.Expr:
    """Return what was written as JSON, as it was before; a truth is a number then."""
    truth = truth_in(value)
    if truth is not None:
        return truth
    if sql.call_name(value) != "json" or len(value.expressions) != 1:
        return value
    inner: exp.Expr = value.expressions[0]
    return inner.expressions[0] if sql.call_name(inner) in _WRITTEN else inner


def truth_in(value: exp.Expr) -> exp.Expr | None:
    inner = value.expressions[0] if sql.call_name(value) == "json" else None
    if isinstance(inner, exp.Literal) and inner.is_string and inner.name in ("true", "false"):
        return exp.Literal.number(int(inner.name == "true"))
    if not isinstance(inner, exp.Case) or inner.this is None or len(inner.args["ifs"]) != 2:
        return None
    names = [branch.args["true"].name for branch in inner.args["ifs"]]
    return inner.this if names == ["true", "false"] else None


def truth(value: exp.Expr) -> exp.Expr:
    """Return a boolean, which SQLite stores as a number, as JSON."""
    return sql.expression("JSON(CASE x WHEN 1 THEN 'true' WHEN 0 THEN 'false' END)", x=value)


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
        name = sql.call_name(call)
        if name == "real_as_json":
            number = call.expressions[0]
            if _is_cheap(number):
                call.replace(sql.expression(_DIGITS, x=number))
        elif name == "value_as_json" and isinstance(call.expressions[0], exp.Column):
            (value,) = call.expressions
            assert call.parent is not None
            call.parent.replace(sql.expression(_OF_ANY_TYPE, x=value, marked=mark(value, value)))


def _is_cheap(number: exp.Expr) -> bool:
    calls = number.find_all(exp.Anonymous)
    return not number.find(exp.Query) and all(sql.call_name(call) in _CHEAP for call in calls)


def is_plain(node: exp.Expr) -> bool:
    if isinstance(node, exp.Paren):
        return is_plain(node.this)
    if isinstance(node, exp.Subquery) and isinstance(node.this, exp.Select):
        only = node.this.expressions
        return len(only) == 1 and is_plain(only[0])
    if isinstance(node, exp.Alias):
        return is_plain(node.this)
    if isinstance(node, exp.Case):
        arms = [branch.args["true"] for branch in node.args["ifs"]]
        default = node.args.get("default")
        return all(map(is_plain, [*arms, *([default] if default is not None else [])]))
    if isinstance(node, exp.Column):
        found = sql.source(node)
        return found is not None and _is_plain_column(node, found[1])
    if isinstance(node, exp.Anonymous):
        name = sql.call_name(node)
        if name in _PASSES_ON:
            return all(map(is_plain, node.expressions))
        return name in {"sum", "avg", "count", "total", "divide", "modulo", "abs", "sqrt"}
    return isinstance(node, exp.Binary | exp.Not | exp.Neg | exp.Literal | exp.Null)


def _is_plain_column(column: exp.Column, table: exp.Expr) -> bool:
    if isinstance(table, exp.Subquery) and isinstance(table.this, exp.Select):
        for made in table.this.expressions:
            if made.alias_or_name.lower() == column.name.lower():
                return is_plain(made)
    return is_stored(table) and column.name.lower() not in _UNPLAIN


def _is_noticed(node: exp.Expr, is_result: bool) -> bool:
    while True:
        parent = node.parent
        if isinstance(parent, exp.Anonymous):
            name = sql.call_name(parent)
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


def remark(value: exp.Column, place: exp.Expr, *, is_result: bool) -> exp.Expr:
    """Return a value marked again as a record or list, where that matters."""
    return mark(value, value) if _is_noticed(place, is_result) else value


def mark(value: exp.Column, otherwise: exp.Expr) -> exp.Expr:
    """Return a value as JSON if it is the text of a record or list, else another expression."""
    return sql.expression(_MARKED, x=value, otherwise=otherwise)


def is_stored(table: exp.Expr) -> bool:
    """Return whether a source is a table, whose values are never marked as JSON."""
    return sql.table_name(table) in sql.TABLES
