"""Calls of our own functions, written as SQLite's own expressions where these mean the same.

A call of ours takes SQLite to Python and back, which costs more than most of what it computes.
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.tuning import json, sql

__all__ = ["native_choice", "native_division"]

_NUMBERS = frozenset({"abs", "avg", "count", "sqrt", "sum", "total"})
_CHOICES = {"greatest": "MAX", "least": "MIN"}


def native_division(tree: exp.Expr) -> None:
    """Divide numbers natively, after a check for zero if necessary.

    Our own function handles division by zero; SQLite computes a repeated sum only once.
    """
    for call in reversed(list(tree.find_all(exp.Anonymous))):  # what stands in another, first
        if sql.call_name(call) != "divide" or not all(map(_is_number, call.expressions)):
            continue
        above, below = call.expressions
        real = exp.Cast(this=above.copy(), to=exp.DataType.build("REAL", dialect="sqlite"))
        quick = exp.Div(this=real, expression=below.copy())
        if isinstance(below, exp.Literal) and float(below.this):
            call.replace(exp.Paren(this=quick))
        elif _is_light(above) and _is_light(below):
            not_zero = exp.NEQ(this=below.copy(), expression=exp.Literal.number(0))
            call.replace(exp.Case(ifs=[exp.If(this=not_zero, true=quick)], default=call.copy()))


def native_choice(tree: exp.Expr) -> None:
    """Compute the greater or lesser of a plain value and a literal natively; null is ignored.

    Of equal values our functions return the first, as SQLite's MAX does; its MIN returns the last.
    """
    for call in reversed(list(tree.find_all(exp.Anonymous))):
        native = _CHOICES.get(sql.call_name(call))
        if native is None or len(call.expressions) != 2:
            continue
        if not all(map(json.is_plain, call.expressions)):
            continue
        literals = [value for value in call.expressions if isinstance(value, exp.Literal)]
        if not literals:
            continue
        values = [value.copy() for value in call.expressions]
        chosen = exp.Anonymous(this=native, expressions=values[::-1] if native == "MIN" else values)
        call.replace(exp.Anonymous(this="COALESCE", expressions=[chosen, literals[0].copy()]))


def _is_number(node: exp.Expr) -> bool:
    """Return whether a value is certainly a number, or null."""
    if isinstance(node, exp.Paren | exp.Alias):
        return _is_number(node.this)
    if isinstance(node, exp.Subquery) and isinstance(node.this, exp.Select):
        return all(map(_is_number, node.this.expressions))
    if isinstance(node, exp.Literal):
        return not node.is_string
    if isinstance(node, exp.Anonymous):
        return sql.call_name(node) in _NUMBERS
    return isinstance(node, exp.Add | exp.Sub | exp.Mul | exp.Div | exp.Neg)


def _is_light(node: exp.Expr) -> bool:
    """Return whether a value may as well be computed twice."""
    calls = node.find_all(exp.Anonymous)
    return node.find(exp.Select, exp.Case) is None and all(
        sql.call_name(call) in _NUMBERS for call in calls
    )
