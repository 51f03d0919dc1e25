"""Repeated expressions of a select, computed once.

The compiler writes an expression out wherever the program mentions it. Here the repeated ones,
and those that stand inside a subquery but do not depend on its rows, are computed first, in a
query of their own that SQLite keeps::

    WITH t_0_shared AS MATERIALIZED (SELECT s.id AS c0, (SELECT ...) AS c1 FROM Sensor AS s)
    SELECT ... t_0_shared.c1 ... t_0_shared.c1 ... FROM t_0_shared

SQLite need not even keep the rows that the result alone reads, but passes them on as they come.

A record or list that passes through such a query loses SQLite's mark that it is JSON; the mark is
restored where it matters.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from sqlglot import exp

from logical_robots_tui.mind.tuning import sql

_NAME = "t_0_shared"

_SUBQUERY_WEIGHT = 100
_WORTH_SHARING = 60  # nodes that need not be computed again

_TIMES = 15  # that a subquery computes what stands in it, as a guess
_LIGHT = 10  # nodes; less than that may as well be computed for every row

_IN_JSON = frozenset({"json"})


def share(tree: exp.Query) -> None:
    """Compute repeated expressions once in every select outside of subqueries."""
    number = 0
    for select in list(_outer_selects(tree)):
        current = select
        while (added := _share(tree, current, f"{_NAME}_{number}")) is not None:
            number += 1
            current = added


def stream(tree: exp.Query) -> None:
    """Stream shared expressions into the result instead of materialising them.

    A limit in the one query and a condition in the other keep SQLite from merging them again.
    """
    queries = {query.alias: query for query in sql.named_queries(tree)}
    select: exp.Expr = tree
    while isinstance(select, exp.Select) and len(names := [*sql.sources(select)]) == 1:
        query = queries.get(names[0])
        if query is None or not is_shared(query.alias):
            return
        query.set("materialized", False)
        query.this.set("limit", exp.Limit(expression=exp.Neg(this=exp.Literal.number(1))))
        if not select.args.get("where"):
            select.set("where", exp.Where(this=exp.Literal.number(1)))
        select = query.this


def is_shared(name: str) -> bool:
    return name.startswith(_NAME)


def _outer_selects(tree: exp.Query) -> Iterator[exp.Select]:
    waiting: list[exp.Expr] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, exp.Select):
            yield node
            items = [s for s in sql.sources(node).values() if isinstance(s, exp.Subquery)]
            waiting += [item.this for item in items]
        elif isinstance(node, exp.Union):
            waiting += [node.this, node.expression]
        elif isinstance(node, exp.Subquery):
            waiting.append(node.this)
        waiting += [query.this for query in sql.named_queries(node)]


@dataclass(slots=True)
class _Seen:
    """An expression in an examined select.

    Attributes:
        key: Equal for expressions that compute the same.
        open: How many selects around it, inside the examined one, its columns belong to.
        inside: How many selects stand between it and the examined one.
    """

    key: int
    weight: int
    open: int
    fixed: bool
    inside: int


@dataclass
class _Examination:
    """All expressions of one select; `strange` marks a column of unknown source."""

    select: exp.Select
    seen: dict[int, _Seen] = field(default_factory=dict)
    counts: Counter[int] = field(default_factory=Counter)
    strange: bool = False
    _keys: dict[Any, int] = field(default_factory=dict)

    def key(self, what: Any) -> int:
        return self._keys.setdefault(what, len(self._keys))

    def visit(self, node: exp.Expr, around: list[exp.Select]) -> _Seen:
        """Examine an expression and its parts; `around` are the inner selects, outermost first."""
        if isinstance(node, exp.Column):
            found = self._column(node, around)
        else:
            is_select = isinstance(node, exp.Select)
            if isinstance(node, exp.Select):
                around = [*around, node]
            parts, inner = [], []
            for name, value in node.args.items():
                if value is None or value is False or value == []:
                    continue
                items = value if isinstance(value, list) else [value]
                keys = []
                for item in items:
                    if isinstance(item, exp.Expr):
                        if isinstance(item, exp.TableAlias):
                            continue
                        seen = self.visit(item, around)
                        inner.append(seen)
                        keys.append(seen.key)
                    else:
                        text = item.lower() if isinstance(node, exp.Anonymous) else item
                        keys.append(self.key((name, str(text))))
                parts.append((name, tuple(keys)))
            opened = max((seen.open for seen in inner), default=0)
            found = _Seen(
                self.key((type(node).__name__, tuple(parts))),
                sum(seen.weight for seen in inner) + (_SUBQUERY_WEIGHT if is_select else 1),
                max(0, opened - 1) if is_select else opened,
                all(seen.fixed for seen in inner) and not is_select,
                len(around) - is_select,
            )
        self.seen[id(node)] = found
        self.counts[found.key] += 1
        return found

    def _column(self, column: exp.Column, around: list[exp.Select]) -> _Seen:
        name = column.table
        for hops, select in enumerate(reversed(around), 1):
            here = list(sql.sources(select))
            if name in here or (not name and len(here) == 1):
                place = here.index(name) if name else 0
                key = self.key(("inner", hops, place, column.name.lower()))
                return _Seen(key, 1, hops, False, len(around))
        if not name or name not in sql.sources(self.select):
            self.strange = True
        key = self.key(("outer", name, column.name.lower()))
        return _Seen(key, 1, 0, False, len(around))


def _share(tree: exp.Query, select: exp.Select, name: str) -> exp.Select | None:
    unusual = ("group", "having", "distinct", "order", "limit", "offset", "windows")
    if not select.args.get("from_") or any(select.args.get(part) for part in unusual):
        return None
    if any(sql.own_aggregates(e) for e in select.expressions):
        return None
    examination = _Examination(select)
    for expression in select.expressions:
        examination.visit(expression, [])
    chosen = _choose(examination)
    if not chosen or examination.strange:
        return None
    return _move(tree, select, name, chosen, examination)


def _choose(examination: _Examination) -> list[exp.Expr]:
    found: list[exp.Expr] = []

    def look(node: exp.Expr) -> None:
        seen = examination.seen.get(id(node))
        if seen is None:
            return
        repeated = examination.counts[seen.key] > 1 and seen.weight > _LIGHT
        needless = seen.inside > 0 and seen.weight > _LIGHT
        wanted = (repeated or needless) and not seen.open and not seen.fixed
        if wanted and _is_value(node):
            found.append(node)
            return
        for child in node.iter_expressions():
            look(child)

    for expression in examination.select.expressions:
        look(expression)
    gains = {}
    for node in found:
        seen = examination.seen[id(node)]
        times = _TIMES if seen.inside else examination.counts[seen.key] - 1
        gains[seen.key] = seen.weight * times
    return found if sum(gains.values()) >= _WORTH_SHARING else []


def _move(
    tree: exp.Query,
    select: exp.Select,
    name: str,
    chosen: list[exp.Expr],
    examination: _Examination,
) -> exp.Select:
    columns: dict[Any, tuple[str, exp.Expr]] = {}

    def reference(key: Any, make: Callable[[], exp.Expr]) -> exp.Column:
        if key not in columns:
            columns[key] = (f"c{len(columns)}", make())
        return exp.column(columns[key][0], name)

    is_result = select is tree
    for node in chosen:
        seen = reference(examination.seen[id(node)].key, node.copy)
        node.replace(seen if sql.is_plain(node) else sql.remark(seen, node, is_result=is_result))
    for expression in select.expressions:
        for column in list(expression.find_all(exp.Column)):
            found = sql.source(column)
            if found is not None and found[0] is select:
                seen = reference((column.table, column.name.lower()), column.copy)
                stored = sql.is_stored(found[1])
                column.replace(seen if stored else sql.remark(seen, column, is_result=is_result))
    first = exp.Select(
        # Not `exp.alias_`: a subquery that is given the alias itself would be another one.
        expressions=[
            exp.Alias(this=made, alias=exp.to_identifier(alias)) for alias, made in columns.values()
        ],
        from_=select.args["from_"],
        joins=select.args.get("joins"),
        where=select.args.get("where"),
    )
    select.set("from_", exp.From(this=exp.to_table(name)))
    select.set("joins", None)
    select.set("where", None)
    _name_query(tree, select, name, first)
    return first


def _name_query(tree: exp.Query, select: exp.Select, name: str, first: exp.Select) -> None:
    """Insert a common table expression where this select, but no earlier query, may use it."""
    alias = exp.TableAlias(this=exp.to_identifier(name))
    query = exp.CTE(this=first, alias=alias, materialized=True)
    named, user = sql.named_queries(tree), select.find_ancestor(exp.CTE)
    place = next((i for i, item in enumerate(named) if item is user), len(named))
    named.insert(place, query)
    if (both := tree.args.get("with_")) is None:
        tree.set("with_", exp.With(expressions=named))
    else:
        both.set("expressions", named)


def _is_value(node: exp.Expr) -> bool:
    if isinstance(node, exp.Select):
        return False
    if isinstance(node, exp.Subquery):
        return not isinstance(node.parent, exp.From | exp.Join | exp.In | exp.Exists)
    if {sql.call_name(node), sql.call_name(node.parent)} & _IN_JSON:
        return False  # what a value is in JSON is said where it is put there
    return isinstance(
        node, exp.Case | exp.Anonymous | exp.Binary | exp.Paren | exp.Not | exp.Neg
    ) and not (isinstance(node.parent, exp.Table) or sql.call_name(node) in sql.AGGREGATES)
