"""SQLite's note that a text is a record or a list, and where it is lost and missed.

A value that passes through a query of its own is text again. Put into a record, it would be an
escaped text there; so it is marked as JSON once more, where that makes a difference.
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.sqlite.remembered import ITEM_FIELDS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import columns, sql

__all__ = ["is_plain", "is_stored", "marked", "noted"]

_MAKES_JSON = frozenset({"json_array", "json_object", "json_quote"})
_COLLECTS_JSON = frozenset({"json_group_array", "json_group_object"})
_UNPLAIN = frozenset({"memory", "sensor", "value", *MEMORY_FIELDS, *ITEM_FIELDS})
_PASSES_ON = frozenset({"coalesce", "iif", "if", "ifnull", "nullif", "min", "max", "any_value"})


def is_plain(node: exp.Expr) -> bool:
    """Whether a value is certainly no record and no list."""
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
    """Whether a column holds numbers and plain text only."""
    if isinstance(table, exp.Subquery) and isinstance(table.this, exp.Select):
        for made in table.this.expressions:
            if made.alias_or_name.lower() == column.name.lower():
                return is_plain(made)
    return is_stored(table) and column.name.lower() not in _UNPLAIN


def _is_noticed(node: exp.Expr, is_result: bool) -> bool:
    """Whether it makes a difference that a value is marked as a record or a list."""
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


def noted(value: exp.Column, place: exp.Expr, *, is_result: bool) -> exp.Expr:
    """A value that is marked again as the record or list that it is, where that is noticed."""
    return marked(value, value) if _is_noticed(place, is_result) else value


def marked(value: exp.Column, otherwise: exp.Expr) -> exp.Expr:
    """A value as JSON if it is the text of a record or a list, or else another expression."""
    begins = exp.Anonymous(
        this="SUBSTR", expressions=[value.copy(), exp.Literal.number(1), exp.Literal.number(1)]
    )
    brackets = [exp.Literal.string("{"), exp.Literal.string("[")]
    valid = exp.Anonymous(this="JSON_VALID", expressions=[value.copy()])
    as_json = exp.Anonymous(this="JSON", expressions=[value.copy()])
    test = exp.And(this=exp.In(this=begins, expressions=brackets), expression=valid)
    return exp.Case(ifs=[exp.If(this=test, true=as_json)], default=otherwise)


def is_stored(table: exp.Expr) -> bool:
    """Whether a source is a table, in which no value has the note anyway."""
    return sql.table_name(table) in columns.TABLES
