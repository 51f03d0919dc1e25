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
        while (shared_select := _share(tree, current, f"{_NAME}_{number}")) is not None:
            number += 1
            current = shared_select


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
    pending: list[exp.Expr] = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, exp.Select):
            yield node
            items = [s for s in sql.sources(node).values() if isinstance(s, exp.Subquery)]
            pending += [item.this for item in items]
        elif isinstance(node, exp.Union):
            pending += [node.this, node.expression]
        elif isinstance(node, exp.Subquery):
            pending.append(node.this)
        pending += [query.this for query in sql.named_queries(node)]


@dataclass(slots=True)
class _ExpressionFacts:
    """An expression in an examined select.

    Attributes:
        key: Equal for expressions that compute the same.
        free_depth: How many selects around it, inside the examined one, its columns belong to.
        depth: How many selects stand between it and the examined one.
    """

    key: int
    weight: int
    free_depth: int
    is_constant: bool
    depth: int


@dataclass
class _Examination:
    """All expressions of one select; `has_unknown_source` if a column's source is unknown."""

    select: exp.Select
    facts: dict[int, _ExpressionFacts] = field(default_factory=dict)
    counts: Counter[int] = field(default_factory=Counter)
    has_unknown_source: bool = False
    _keys: dict[Any, int] = field(default_factory=dict)

    def key(self, content: Any) -> int:
        return self._keys.setdefault(content, len(self._keys))

    def visit(self, node: exp.Expr, enclosing: list[exp.Select]) -> _ExpressionFacts:
        """Examine an expression and its parts, given the selects around it, outermost first."""
        if isinstance(node, exp.Column):
            facts = self._column(node, enclosing)
        else:
            is_select = isinstance(node, exp.Select)
            if isinstance(node, exp.Select):
                enclosing = [*enclosing, node]
            parts, parts_facts = [], []
            for name, value in node.args.items():
                if value is None or value is False or value == []:
                    continue
                items = value if isinstance(value, list) else [value]
                keys = []
                for item in items:
                    if isinstance(item, exp.Expr):
                        if isinstance(item, exp.TableAlias):
                            continue
                        part_facts = self.visit(item, enclosing)
                        parts_facts.append(part_facts)
                        keys.append(part_facts.key)
                    else:
                        text = item.lower() if isinstance(node, exp.Anonymous) else item
                        keys.append(self.key((name, str(text))))
                parts.append((name, tuple(keys)))
            free_depth = max((part_facts.free_depth for part_facts in parts_facts), default=0)
            facts = _ExpressionFacts(
                self.key((type(node).__name__, tuple(parts))),
                sum(part_facts.weight for part_facts in parts_facts)
                + (_SUBQUERY_WEIGHT if is_select else 1),
                max(0, free_depth - 1) if is_select else free_depth,
                all(part_facts.is_constant for part_facts in parts_facts) and not is_select,
                len(enclosing) - is_select,
            )
        self.facts[id(node)] = facts
        self.counts[facts.key] += 1
        return facts

    def _column(self, column: exp.Column, enclosing: list[exp.Select]) -> _ExpressionFacts:
        name = column.table
        for hops, select in enumerate(reversed(enclosing), 1):
            source_names = list(sql.sources(select))
            if name in source_names or (not name and len(source_names) == 1):
                index = source_names.index(name) if name else 0
                key = self.key(("inner", hops, index, column.name.lower()))
                return _ExpressionFacts(key, 1, hops, False, len(enclosing))
        if not name or name not in sql.sources(self.select):
            self.has_unknown_source = True
        key = self.key(("outer", name, column.name.lower()))
        return _ExpressionFacts(key, 1, 0, False, len(enclosing))


def _share(tree: exp.Query, select: exp.Select, name: str) -> exp.Select | None:
    unsupported_parts = ("group", "having", "distinct", "order", "limit", "offset", "windows")
    if not select.args.get("from_") or any(select.args.get(part) for part in unsupported_parts):
        return None
    if any(sql.own_aggregates(e) for e in select.expressions):
        return None
    examination = _Examination(select)
    for expression in select.expressions:
        examination.visit(expression, [])
    candidates = _choose(examination)
    if not candidates or examination.has_unknown_source:
        return None
    return _move(tree, select, name, candidates, examination)


def _choose(examination: _Examination) -> list[exp.Expr]:
    candidates: list[exp.Expr] = []

    def collect(node: exp.Expr) -> None:
        facts = examination.facts.get(id(node))
        if facts is None:
            return
        is_repeated = examination.counts[facts.key] > 1 and facts.weight > _LIGHT
        is_invariant = facts.depth > 0 and facts.weight > _LIGHT
        is_worthwhile = (
            (is_repeated or is_invariant) and not facts.free_depth and not facts.is_constant
        )
        if is_worthwhile and _is_value(node):
            candidates.append(node)
            return
        for child in node.iter_expressions():
            collect(child)

    for expression in examination.select.expressions:
        collect(expression)
    gains = {}
    for node in candidates:
        facts = examination.facts[id(node)]
        repetitions = _TIMES if facts.depth else examination.counts[facts.key] - 1
        gains[facts.key] = facts.weight * repetitions
    return candidates if sum(gains.values()) >= _WORTH_SHARING else []


def _move(
    tree: exp.Query,
    select: exp.Select,
    name: str,
    candidates: list[exp.Expr],
    examination: _Examination,
) -> exp.Select:
    columns: dict[Any, tuple[str, exp.Expr]] = {}

    def reference(key: Any, make: Callable[[], exp.Expr]) -> exp.Column:
        if key not in columns:
            columns[key] = (f"c{len(columns)}", make())
        return exp.column(columns[key][0], name)

    is_result = select is tree
    for node in candidates:
        replacement = reference(examination.facts[id(node)].key, node.copy)
        node.replace(
            replacement
            if sql.is_plain(node)
            else sql.restore_mark(replacement, node, is_result=is_result)
        )
    for expression in select.expressions:
        for column in list(expression.find_all(exp.Column)):
            source = sql.source(column)
            if source is not None and source[0] is select:
                replacement = reference((column.table, column.name.lower()), column.copy)
                is_stored = sql.is_stored(source[1])
                column.replace(
                    replacement
                    if is_stored
                    else sql.restore_mark(replacement, column, is_result=is_result)
                )
    shared_select = exp.Select(
        # Not `exp.alias_`, which would give the alias to a subquery itself.
        expressions=[
            exp.Alias(this=value, alias=exp.to_identifier(alias))
            for alias, value in columns.values()
        ],
        from_=select.args["from_"],
        joins=select.args.get("joins"),
        where=select.args.get("where"),
    )
    select.set("from_", exp.From(this=exp.to_table(name)))
    select.set("joins", None)
    select.set("where", None)
    _name_query(tree, select, name, shared_select)
    return shared_select


def _name_query(tree: exp.Query, select: exp.Select, name: str, shared_select: exp.Select) -> None:
    """Insert a common table expression where this select, but no earlier query, may use it."""
    alias = exp.TableAlias(this=exp.to_identifier(name))
    query = exp.CTE(this=shared_select, alias=alias, materialized=True)
    queries, user = sql.named_queries(tree), select.find_ancestor(exp.CTE)
    index = next((i for i, item in enumerate(queries) if item is user), len(queries))
    queries.insert(index, query)
    if (with_clause := tree.args.get("with_")) is None:
        tree.set("with_", exp.With(expressions=queries))
    else:
        with_clause.set("expressions", queries)


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
