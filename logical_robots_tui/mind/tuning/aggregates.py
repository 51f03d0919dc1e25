"""Aggregates, divisions and choices as native SQL, where it means the same.

Calling a Python function from SQLite costs more than most of what it computes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.tuning import json, sql

if TYPE_CHECKING:
    from collections.abc import Iterator

_NATIVE = {"arg_min": "MIN", "arg_max": "MAX"}


def untie_aggregates(tree: exp.Expr) -> None:
    """Remove what ties an aggregated expression to its select, where one of its columns does.

    An aggregate belongs to the select that its columns come from. The compiler writes
    ``IIF(x.value = 0, expression, NULL)`` over a table of a single 0 to make sure of that.
    """
    for select in list(tree.find_all(exp.Select)):
        zeros = {name for name, table in sql.sources(select).items() if _is_zero(table)}
        for name in zeros:
            columns = [c for c in select.find_all(exp.Column) if c.table == name]
            tied = [_tied(column) for column in columns]
            loose = [node for node in tied if node is not None and _is_of(node, select, zeros)]
            for node in loose:
                node.replace(node.expressions[1])
            if len(loose) == len(columns) and len(sql.sources(select)) > 1:
                sql.drop_source(select, name)


def native_arg_min(tree: exp.Expr) -> None:
    """ArgMin and ArgMax by SQLite's MIN and MAX, beside which a bare column is of the best row.

    It is of the first of several. Beside a second MIN or MAX it is not said of which row.
    """
    for select in list(tree.find_all(exp.Select)):
        if select.args.get("having") or select.args.get("order"):
            continue
        calls = [call for item in select.expressions for call in _own_calls(item)]
        best = [call for call in calls if sql.call_name(call) in _NATIVE]
        extremes = {
            (_NATIVE.get(sql.call_name(call), call.name.upper()), call.expressions[-1])
            for call in calls
            if sql.call_name(call) in {*_NATIVE, "min", "max"} and call.expressions
        }
        if len(extremes) != 1 or any(len(call.expressions) != 2 for call in best):
            continue
        ((native, value),) = extremes
        if any(map(_aggregates_inside, [value, *(call.expressions[0] for call in best)])):
            continue
        for call in best:
            chosen = f"CASE WHEN NOT {native}(value) IS NULL THEN argument END"
            call.replace(sql.expression(chosen, value=value, argument=call.expressions[0]))


def _own_calls(node: exp.Expr) -> Iterator[exp.Anonymous]:
    if isinstance(node, exp.Select):
        return
    if isinstance(node, exp.Anonymous):
        yield node
    for child in node.iter_expressions():
        yield from _own_calls(child)


def _is_zero(table: exp.Expr) -> bool:
    if not isinstance(table, exp.Table) or sql.call_name(table.this) != "json_each":
        return False
    arguments = table.this.expressions
    if len(arguments) != 1 or sql.call_name(arguments[0]) != "json_array":
        return False
    items = arguments[0].expressions
    return len(items) == 1 and isinstance(items[0], exp.Literal) and items[0].this == "0"


def _tied(column: exp.Column) -> exp.Expr | None:
    test = column.parent
    call = test.parent if isinstance(test, exp.EQ) and test.this is column else None
    if sql.call_name(call) != "iif" or not isinstance(call, exp.Anonymous):
        return None
    if len(call.expressions) != 3 or call.expressions[0] is not test:
        return None
    return call if isinstance(call.expressions[2], exp.Null) else None


def _is_of(tied: exp.Expr, select: exp.Select, zeros: set[str]) -> bool:
    columns = list(tied.expressions[1].find_all(exp.Column))
    if any(column.find_ancestor(exp.Select) is not select for column in columns):
        return False
    own = sql.sources(select).keys() - zeros
    return not columns or any(column.table in own for column in columns)


def _aggregates_inside(node: exp.Expr) -> bool:
    return node.find(exp.Select) is not None or any(
        sql.call_name(call) in sql.AGGREGATES for call in node.find_all(exp.Anonymous)
    )


_NUMBERS = frozenset({"abs", "avg", "count", "sqrt", "sum", "total"})
_CHOICES = {"greatest": "MAX", "least": "MIN"}


def native_division(tree: exp.Expr) -> None:
    """Divide natively, checking for zero if necessary; SQLite computes a repeated sum once."""
    for call in reversed(list(tree.find_all(exp.Anonymous))):  # what stands in another, first
        if sql.call_name(call) != "divide" or not all(map(_is_number, call.expressions)):
            continue
        above, below = call.expressions
        parts = {"above": above, "below": below, "otherwise": call}
        quotient = "CAST(above AS REAL) / below"
        if isinstance(below, exp.Literal) and float(below.this):
            call.replace(sql.expression(f"({quotient})", **parts))
        elif _is_light(above) and _is_light(below):
            checked = f"CASE WHEN below <> 0 THEN {quotient} ELSE otherwise END"
            call.replace(sql.expression(checked, **parts))


def native_choice(tree: exp.Expr) -> None:
    """Use native MAX and MIN of a value and a literal; ignore null, prefer the first equal."""
    for call in reversed(list(tree.find_all(exp.Anonymous))):
        native = _CHOICES.get(sql.call_name(call))
        if native is None or len(call.expressions) != 2:
            continue
        if not all(map(json.is_plain, call.expressions)):
            continue
        literals = [value for value in call.expressions if isinstance(value, exp.Literal)]
        if not literals:
            continue
        first, second = call.expressions[::-1] if native == "MIN" else call.expressions
        text = f"COALESCE({native}(first, second), literal)"
        call.replace(sql.expression(text, first=first, second=second, literal=literals[0]))


def _is_number(node: exp.Expr) -> bool:
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
    calls = node.find_all(exp.Anonymous)
    return node.find(exp.Select, exp.Case) is None and all(
        sql.call_name(call) in _NUMBERS for call in calls
    )
