"""A tuned query in DuckDB's SQL, for the tables that `loading` makes. Runs in the compile process.

Only what is known to give the same is translated: numbers, truth values, and texts that are
compared and passed on, over sensors and rays in columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

from sqlglot import exp

from logical_robots_tui.mind.duck.expressions import Expressions
from logical_robots_tui.mind.duck.scopes import Scope, Source, input_source
from logical_robots_tui.mind.duck.terms import Kind, Term, UnlikeError, as_kind, common, condition
from logical_robots_tui.mind.program import Duck
from logical_robots_tui.mind.tuning import sql

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["Sight", "in_duckdb", "translated"]

Sight: TypeAlias = Literal["own", "memories", "all"]
"""What robots see: their own sensor and other memories; their own sensor and all memories; all."""

_LONGEST = 200_000  # characters of a query

_ONE_BY_ONE = "can't be computed for all robots at once unless all see everything"

_UNUSUAL = {
    "having": "has a condition on groups",
    "order": "sorts rows",
    "limit": "limits the number of rows",
    "offset": "limits the number of rows",
    "windows": "looks at rows around a row",
}


def in_duckdb(
    tree: exp.Expr,
    together: exp.Expr | None,
    result: Sequence[tuple[str, tuple[str, ...]]],
    read: Mapping[str, tuple[str, ...]],
) -> Duck:
    """What DuckDB can be asked instead of a tuned query.

    Args:
        tree: The tuned query of one viewer.
        together: The same for all viewers, each of which sees its own sensor only; or None.
        result: As `Tuned.result` has it.
        read: As `Tuned.columns` has it.
    """
    columns = {"Sensor": ("robot_name",), **read}
    try:
        names, everything = translated(tree, result, "all")
        if together is None:
            return Duck(names, columns, all=everything, unlike=_ONE_BY_ONE)
        _, own = translated(together, result, "own")
        _, memories = translated(together, result, "memories")
        return Duck(names, columns, own, memories, everything)
    except UnlikeError as error:
        return Duck(unlike=str(error))
    except (ValueError, RecursionError):
        return Duck(unlike="has an unusual form")


def translated(
    tree: exp.Expr, result: Sequence[tuple[str, tuple[str, ...]]], sight: Sight
) -> tuple[tuple[str, ...], str]:
    """The names of the columns of the query, and its text in DuckDB's SQL.

    Args:
        tree: A tuned query, of one viewer that sees all or of all viewers at once; not changed.
        result: As `Tuned.result` has it.
        sight: What the viewers see.

    Raises:
        UnlikeError: It can't be translated; the message says why.
    """
    loose = [
        (name, field) in (("desire", "left_engine"), ("desire", "right_engine"))
        for name, fields in result
        for field in fields or ("",)
    ]
    query = _Query(sight)
    text, source = query.write(tree, Scope({}, None))
    kinds = [kind for _, kind in source.columns.values()]
    wider = [
        Term(name, kind) if kind != "truth" else as_kind(Term(name, kind), "whole")
        for name, kind in source.columns.values()
    ]
    for place, kind in enumerate(kinds):
        if kind == "number" and not (place < len(loose) and loose[place]):
            raise UnlikeError("has a number in its answer that is whole only sometimes")
    text = f"SELECT {', '.join(term.sql for term in wider)} FROM ({text}) AS answer"  # noqa: S608 - our own
    if len(text) > _LONGEST:
        raise UnlikeError("is too long")
    return tuple(source.columns), text


class _Query:
    """Writes selects; the names of programs do not occur in what it writes."""

    def __init__(self, sight: Sight) -> None:
        self._sight = sight
        self._count = 0
        self._expressions = Expressions(self._subquery)

    def write(self, query: exp.Expr, outer: Scope) -> tuple[str, Source]:
        """A query and its columns.

        Args:
            query: A select, a union, or one of these in parentheses.
            outer: What the queries around it read.
        """
        if isinstance(query, exp.Subquery):
            return self.write(query.this, outer)
        inner = Scope({}, outer)
        named = query.args.get("with_")
        begun = []
        for one in named.expressions if named is not None else ():
            text, source = self.write(one.this, inner)
            name = self._fresh("q")
            inner.named[one.alias.lower()] = source.called(name)
            begun.append(f"{name} AS ({text})")
        if isinstance(query, exp.Union):
            text, source = self._union(query, inner)
        elif isinstance(query, exp.Select):
            text, source = self._select(query, inner)
        else:
            raise UnlikeError("is no query")
        return (f"WITH {', '.join(begun)} {text}" if begun else text), source

    # -- inside --------------------------------------------------------------------------------

    def _fresh(self, letter: str) -> str:
        self._count += 1
        return f"{letter}{self._count}"

    def _subquery(self, query: exp.Expr, scope: Scope) -> tuple[str, Kind]:
        """A query that stands for a value, in parentheses, and the kind of its only column."""
        text, source = self.write(query, scope)
        if len(source.columns) != 1:
            raise UnlikeError("takes several columns for one")
        ((_, kind),) = source.columns.values()
        return f"({text})", kind

    def _union(self, union: exp.Union, scope: Scope) -> tuple[str, Source]:
        if any(union.args.get(part) for part in _UNUSUAL):
            raise UnlikeError("sorts rows or limits their number")
        arms = [self.write(arm, scope) for arm in (union.this, union.expression)]
        first, second = (list(source.columns.items()) for _, source in arms)
        if len(first) != len(second):
            raise UnlikeError("joins rows of different width")
        columns: dict[str, tuple[str, Kind]] = {}
        for (name, (_, one)), (_, (_, other)) in zip(first, second, strict=True):
            columns[name] = (f"c{len(columns) + 1}", common([one, other]))
        texts = []
        for text, source in arms:
            values = [
                f"{as_kind(Term(old, kind), wide).sql} AS {new}"
                for (old, kind), (new, wide) in zip(
                    source.columns.values(), columns.values(), strict=True
                )
            ]
            name = self._fresh("s")
            texts.append(f"SELECT {', '.join(values)} FROM ({text}) AS {name}")  # noqa: S608 - our own
        operator = " UNION " if union.args.get("distinct") else " UNION ALL "
        return f"({operator.join(texts)})", Source("", columns)

    def _select(self, select: exp.Select, scope: Scope) -> tuple[str, Source]:
        for part, reason in _UNUSUAL.items():
            if select.args.get(part):
                raise UnlikeError(reason)
        tables = []
        for name, table in sql.sources(select).items():
            text, source = self._read(table, scope)
            scope.sources[name.lower()] = source
            tables.append(f"{text} AS {source.name}")
        conditions = [self._condition(node, scope) for node in sql.conjuncts(select)]
        columns: dict[str, tuple[str, Kind]] = {}
        values = []
        for name, term in self._columns(select, scope):
            if name.lower() in map(str.lower, columns):
                raise UnlikeError("has two columns of one name")
            columns[name] = (f"c{len(columns) + 1}", term.kind)
            values.append(f"{term.sql} AS {columns[name][0]}")
        parts = ["SELECT DISTINCT" if select.args.get("distinct") else "SELECT", ", ".join(values)]
        if tables:
            parts.append(f"FROM {', '.join(tables)}")
        if kept := [text for text in conditions if text]:
            parts.append(f"WHERE {' AND '.join(kept)}")
        if (group := select.args.get("group")) is not None:
            keys = [self._expressions.write(key, scope).sql for key in group.expressions]
            parts.append(f"GROUP BY {', '.join(keys)}")
        return " ".join(parts), Source("", columns)

    def _columns(self, select: exp.Select, scope: Scope) -> list[tuple[str, Term]]:
        if select.is_star:
            if len(select.expressions) != 1 or len(scope.sources) != 1:
                raise UnlikeError("takes all columns of several tables")
            ((source,)) = scope.sources.values()
            return [
                (name, Term(f"{source.name}.{column}", kind))
                for name, (column, kind) in source.columns.items()
            ]
        bare = self._expressions.beside_best(select, scope)
        if bare is not None:
            return bare
        return [
            (node.alias or f"unnamed {place}", self._expressions.write(node, scope))
            for place, node in enumerate(select.expressions)
        ]

    def _read(self, table: exp.Expr, scope: Scope) -> tuple[str, Source]:
        """What a select reads from, and its columns under a name of their own."""
        name = self._fresh("s")
        if isinstance(table, exp.Subquery):
            # It sees the queries around the select, but not what stands beside it.
            text, source = self.write(table.this, Scope({}, scope.outer, scope.named))
            return f"({text})", source.called(name)
        if not isinstance(table, exp.Table) or not isinstance(table.this, exp.Identifier):
            return self._list(table, scope, name)
        known = scope.find_named(table.name.lower())
        if known is not None:
            return known.name, known.called(name)
        return table.name, input_source(table.name, name)

    def _list(self, table: exp.Expr, scope: Scope, name: str) -> tuple[str, Source]:
        """A list that is written out, as rows."""
        items = table.find(exp.Anonymous) if sql.call_name(table.this) == "json_each" else None
        items = items.expressions[0] if items is not None else None
        if items is None or sql.call_name(items) != "json_array" or not items.expressions:
            raise UnlikeError("reads the elements of a list that it was given or makes")
        terms = [self._expressions.write(item, scope) for item in items.expressions]
        kind = common(term.kind for term in terms)
        if kind in ("number", "truth", "nothing"):
            raise UnlikeError("reads a list of values of different kinds")
        rows = ", ".join(f"({as_kind(term, kind).sql})" for term in terms)
        text = f"(SELECT col0 AS value FROM (VALUES {rows}) AS items)"  # noqa: S608 - our own
        return text, Source(name, {"value": ("value", kind)})

    def _condition(self, node: exp.Expr, scope: Scope) -> str:
        if isinstance(node, exp.Between):
            bounds = self._bounds(node, scope)
            if bounds is not None:
                return bounds
        return condition(self._expressions.write(node, scope))

    def _bounds(self, node: exp.Between, scope: Scope) -> str | None:
        """Which rows belong to a viewer or to a radar, or None if these are other bounds."""
        column, low = node.this, node.args["low"]
        if not isinstance(column, exp.Column) or column.name.lower() != "id":
            return None
        source = scope.find(column.table)
        if isinstance(low, exp.Var) and (source.table == "sensor" or self._sight == "all"):
            return ""  # all rows, since all viewers are asked for
        if source.table == "memory":
            if self._sight == "memories":
                return ""
            viewer = low.find(exp.Column)
            if viewer is None:
                raise UnlikeError("looks at memories in an unusual way")
            return f"({source.name}.viewer = {self._expressions.write(viewer, scope).sql})"
        if source.table == "ray":
            if not isinstance(low, exp.Mul):
                raise UnlikeError("looks at rays in an unusual way")
            return f"({source.name}.sensor = {self._expressions.write(low.this, scope).sql})"
        if low == node.args["high"]:
            return f"({source.name}.id = {self._expressions.write(low, scope).sql})"
        return None
