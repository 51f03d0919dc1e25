"""Expressions of a tuned query in DuckDB's SQL."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from sqlglot import exp

from logical_robots_tui.mind.duck import calls
from logical_robots_tui.mind.duck.terms import (
    NUMBERS,
    Kind,
    Term,
    UnlikeError,
    as_kind,
    common,
    condition,
    number,
)
from logical_robots_tui.mind.sqlite.filling import RAYS
from logical_robots_tui.mind.tuning import sql

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.mind.duck.scopes import Scope

__all__ = ["Expressions"]

Subquery: TypeAlias = "Callable[[exp.Expr, Scope], tuple[str, Kind]]"
"""Writes a query that stands for a value, and tells its kind."""

_COMPARISONS: dict[type[exp.Expr], str] = {
    exp.EQ: "=",
    exp.NEQ: "<>",
    exp.LT: "<",
    exp.LTE: "<=",
    exp.GT: ">",
    exp.GTE: ">=",
}
_ARITHMETIC: dict[type[exp.Expr], str] = {exp.Add: "+", exp.Sub: "-", exp.Mul: "*"}
_LOGIC: dict[type[exp.Expr], str] = {exp.And: "AND", exp.Or: "OR"}

_EXACT = 2**53  # whole numbers up to this are the same as real ones
_NO_TEXT = frozenset("\0")


class Expressions:
    """Writes expressions.

    Args:
        subquery: Writes the queries in them.
    """

    def __init__(self, subquery: Subquery) -> None:
        self._subquery = subquery

    def write(self, node: exp.Expr, scope: Scope) -> Term:
        """An expression in DuckDB's SQL.

        Raises:
            UnlikeError: It might mean something else there.
        """
        if isinstance(node, exp.Alias | exp.Paren):
            return self.write(node.this, scope)
        if isinstance(node, exp.Column):
            return _column(node, scope)
        if isinstance(node, exp.Literal):
            return _literal(node)
        if isinstance(node, exp.Null):
            return Term("NULL", "nothing")
        if isinstance(node, exp.Boolean):
            return Term("TRUE" if node.this else "FALSE", "truth")
        if isinstance(node, exp.Anonymous):
            return self._call(node, scope)
        if isinstance(node, exp.Case):
            return self._case(node, scope)
        if isinstance(node, exp.Subquery | exp.Select | exp.Union):
            return Term(*self._subquery(node, scope))
        return self._operator(node, scope)

    def beside_best(self, select: exp.Select, scope: Scope) -> list[tuple[str, Term]] | None:
        """The columns of a select of an expression beside MIN or MAX, or None if it is another.

        Such an expression comes from the first row that has the least, or the largest, value.
        """
        items = [item for item in select.expressions if isinstance(item, exp.Alias)]
        if len(items) != 2 or len(select.expressions) != 2 or select.args.get("group"):
            return None
        bare, best = (item.this for item in items)
        function = sql.call_name(best)
        if function not in ("min", "max") or len(best.expressions) != 1:
            return None
        if sql.own_aggregates(bare):
            return None
        value = self.write(best.expressions[0], scope)
        chosen = _best(f"arg_{function}", self.write(bare, scope), value, scope)
        extreme = calls.aggregate(function, value)
        return [(items[0].alias, chosen), (items[1].alias, extreme)]

    # -- inside --------------------------------------------------------------------------------

    def _call(self, node: exp.Anonymous, scope: Scope) -> Term:
        function = sql.call_name(node)
        arguments = node.expressions
        if function == "cast":
            (what,) = arguments
            if not isinstance(what, exp.Alias):
                raise calls.refuse(function)
            return calls.cast(self.write(what.this, scope), what.alias.upper())
        if function not in sql.AGGREGATES or (function in ("min", "max") and len(arguments) > 1):
            return calls.computed(function, [self.write(a, scope) for a in arguments])
        if function not in calls.AGGREGATES:
            raise calls.refuse(function)
        if function in ("arg_min", "arg_max"):
            argument, value = (self.write(a, scope) for a in arguments)
            return _best(function, argument, value, scope)
        if len(arguments) != 1:
            raise calls.refuse(function)
        (only,) = arguments
        if isinstance(only, exp.Star) and function == "count":
            return Term("count(*)", "whole")
        if isinstance(only, exp.Distinct):
            (only,) = only.expressions
            return calls.aggregate(function, self.write(only, scope), distinct=True)
        return calls.aggregate(function, self.write(only, scope))

    def _case(self, node: exp.Case, scope: Scope) -> Term:
        if node.this is not None:
            raise UnlikeError("chooses by comparing with several values")
        branches = node.args["ifs"]
        values = [self.write(branch.args["true"], scope) for branch in branches]
        if node.args.get("default") is not None:
            values.append(self.write(node.args["default"], scope))
        return calls.choice([self.write(branch.this, scope) for branch in branches], values)

    def _operator(self, node: exp.Expr, scope: Scope) -> Term:
        kind = type(node)
        if kind in _COMPARISONS:
            left, right = (self.write(n, scope) for n in (node.this, node.expression))
            return _compared(_COMPARISONS[kind], left, right)
        if kind in _ARITHMETIC:
            left, right = (self.write(n, scope) for n in (node.this, node.expression))
            return calls.arithmetic(_ARITHMETIC[kind], left, right)
        if kind in _LOGIC:
            sides = [condition(self.write(n, scope)) for n in (node.this, node.expression)]
            return Term(f"({f' {_LOGIC[kind]} '.join(sides)})", "truth")
        if isinstance(node, exp.Not):
            return Term(f"(NOT {condition(self.write(node.this, scope))})", "truth")
        if isinstance(node, exp.Is) and isinstance(node.expression, exp.Null):
            return Term(f"({self.write(node.this, scope).sql} IS NULL)", "truth")
        if isinstance(node, exp.Neg):
            value = number(self.write(node.this, scope))
            return Term(f"(- {value.sql})", value.kind)
        if isinstance(node, exp.Div):
            above = self.write(node.this, scope)
            below = as_kind(number(self.write(node.expression, scope)), "real")
            if above.kind == "real":
                return calls.real(f"({above.sql} / nullif({below.sql}, 0))")
        if isinstance(node, exp.Cast):
            return calls.cast(self.write(node.this, scope), node.to.sql("sqlite").upper())
        if isinstance(node, exp.Exists):
            return Term(f"EXISTS {self._subquery(node.this, scope)[0]}", "truth")
        if isinstance(node, exp.In) and node.args.get("query") is not None:
            return self._membership(node, scope)
        if isinstance(node, exp.DPipe | exp.Like):
            raise UnlikeError("makes texts or takes them apart")
        raise UnlikeError(f"uses {kind.__name__.upper()}")

    def _membership(self, node: exp.In, scope: Scope) -> Term:
        value = self.write(node.this, scope)
        query, kind = self._subquery(node.args["query"], scope)
        if value.kind != kind and not {value.kind, kind} <= NUMBERS:
            raise UnlikeError("looks for a value among values of another kind")
        return Term(f"({value.sql} IN {query})", "truth")


def _column(node: exp.Column, scope: Scope) -> Term:
    source = scope.find(node.table)
    found = source.columns.get(node.name)
    if found is not None:
        return Term(f"{source.name}.{found[0]}", found[1])
    if source.table == "memory":
        raise UnlikeError("reads what robots remember, which may be of any kind")
    if source.table:
        raise UnlikeError("takes a sensor, a radar or a ray as a whole")
    raise UnlikeError("names a column that is not there")


def _literal(node: exp.Literal) -> Term:
    if node.is_string:
        if _NO_TEXT.intersection(node.this):
            raise UnlikeError("has a text with characters that can't be shown")
        quoted = node.this.replace("'", "''")
        return Term(f"'{quoted}'", "text")
    if node.this.isdecimal():
        if int(node.this) > _EXACT:
            raise UnlikeError("has a very large whole number")
        return Term(f"CAST({node.this} AS BIGINT)", "whole")
    digits = repr(float(node.this))
    if not digits[-1].isdigit():
        raise UnlikeError("has an infinite number")
    return Term(digits if "e" in digits else f"{digits}e0", "real")


def _compared(operator: str, left: Term, right: Term) -> Term:
    if "text" in (left.kind, right.kind):
        common([left.kind, right.kind])  # of texts and numbers there is none
    else:
        left, right = number(left), number(right)
    return Term(f"({left.sql} {operator} {right.sql})", "truth")


def _best(function: str, argument: Term, value: Term, scope: Scope) -> Term:
    """The argument of the least or the largest value, of equal ones that of the first row.

    Raises:
        UnlikeError: It is not known which row comes first.
    """
    rays = [source.name for source in scope.sources.values() if source.table == "ray"]
    others = [source.table for source in scope.sources.values() if source.table != "ray"]
    if len(rays) != 1 or others not in ([], ["sensor"]):
        raise UnlikeError("chooses the best of rows in no certain order")
    sign = "" if function == "arg_min" else "- "
    row = f"{rays[0]}.sensor * {RAYS} + {rays[0]}.ray"
    ordered = f"row({value.sql}, {sign}({row}))"
    sql_text = f"{function}_null({argument.sql}, {ordered}) FILTER (WHERE {value.sql} IS NOT NULL)"
    return Term(f"({sql_text})", argument.kind)
