"""One query for all robots' thinks, instead of one per robot.

A tuned query is bounded to its viewer's rows. If each robot sees only its own sensor, the
viewer's number is that of its sensor row; each named query has it as a column, and joins
match viewers. Subqueries that are evaluated per viewer are bounded to that viewer's rows.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from sqlglot import exp

from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.tuning.planning import materialized_queries

_VIEWER = "t_0_viewer"
_EVERYBODY = "t_0_everybody"

_UNSUPPORTED_PARTS = ("having", "order", "limit", "offset", "windows")


def for_all_viewers(tree: exp.Query, *, alike: bool = False) -> exp.Query | None:
    """Return a copy of a tuned query for all viewers, or None.

    The last column is the viewer's number. The parameters are the first and last row of
    ``Sensor``, those of viewer 0's ``Memory``, and, unless viewers see the same memories
    (`alike`), the offset of the next viewer's.
    """
    if not isinstance(tree, exp.Select):
        return None
    tree = tree.copy()
    try:
        return tree if _Lifter(tree, alike=alike).lift(tree) else None
    except _UnsuitableError:
        return None


class _UnsuitableError(Exception):
    """This query can't be asked for all viewers at once."""


class _Lifter:
    """Adds the viewer as a column to a query, its common table expressions first."""

    def __init__(self, tree: exp.Query, *, alike: bool) -> None:
        self._bounds = ("?1",) if alike else ("?1", "?3")
        # Named queries that depend on the viewer, before the change.
        self._dependent: dict[str, exp.Expr] = {}
        self._mentions = Counter(table.name for table in tree.find_all(exp.Table))
        self._materialized = materialized_queries(tree)

    def lift(self, query: exp.Expr, *, is_required: bool = False) -> bool:
        """Add the viewer as last column, in place, if needed or `must`."""
        if isinstance(query, exp.Subquery):
            return self.lift(query.this, is_required=is_required)
        if isinstance(query, exp.Union):
            return self._lift_union(query, is_required=is_required)
        if not isinstance(query, exp.Select):
            raise _UnsuitableError
        clause = query.args.get("with_")
        query.set("with_", None)
        for cte in clause.expressions if clause else ():
            original = cte.this.copy()
            if self.lift(cte.this):
                self._dependent[cte.alias] = original
        lift = self._lift_all_columns if query.is_star else self._lift_select
        is_lifted = lift(query, is_required=is_required)
        if clause is not None:
            tables_read = {table.name for table in query.find_all(exp.Table)}
            for cte in reversed(clause.expressions):
                if cte.alias in tables_read:
                    tables_read |= {table.name for table in cte.this.find_all(exp.Table)}
            clause.set(
                "expressions", [cte for cte in clause.expressions if cte.alias in tables_read]
            )
            query.set("with_", clause if clause.expressions else None)
        return is_lifted

    def _lift_union(self, union: exp.Union, *, is_required: bool) -> bool:
        if any(union.args.get(part) for part in ("with_", *_UNSUPPORTED_PARTS)):
            raise _UnsuitableError
        arms = (union.this, union.expression)
        are_lifted = [self.lift(arm, is_required=is_required) for arm in arms]
        if any(are_lifted):
            for arm, is_lifted in zip(arms, are_lifted, strict=True):
                if not is_lifted:
                    self.lift(arm, is_required=True)
        return any(are_lifted)

    def _lift_all_columns(self, select: exp.Select, *, is_required: bool) -> bool:
        sources = list(sql.sources(select).values())
        unsupported_parts = ("where", "group", "joins", "distinct", *_UNSUPPORTED_PARTS)
        if len(sources) != 1 or any(select.args.get(part) for part in unsupported_parts):
            raise _UnsuitableError
        if isinstance(sources[0], exp.Subquery):
            return self.lift(sources[0].this, is_required=is_required)
        is_lifted = self._is_lifted(sources[0])
        if is_required and not is_lifted:
            raise _UnsuitableError
        return is_lifted

    def _lift_select(self, select: exp.Select, *, is_required: bool) -> bool:
        if not select.args.get("group") and any(map(sql.own_aggregates, select.expressions)):
            is_bounded = any(map(self._is_bound, select.find_all(exp.Between)))
            if not is_required and not is_bounded and not self._depends(select):
                return False
            _as_scalar_subqueries(select)
            if len(select.expressions) > 1:  # their sources are better computed once
                self._mentions.update(table.name for table in select.find_all(exp.Table))
        sources = sql.sources(select)
        viewers = {
            name: viewer for name, t in sources.items() if (viewer := self._viewer_of(name, t))
        }
        if not viewers:
            if not is_required and not self._depends(select):
                return False
            items = [exp.alias_(exp.to_table("Sensor"), _EVERYBODY, table=True)]
            items += sql.sources(select).values()
            first, *joined_items = items
            select.set("from_", exp.From(this=first))
            select.set("joins", [exp.Join(this=item, kind="CROSS") for item in joined_items])
            low, high = exp.Var(this="?1"), exp.Var(this="?2")
            sql.restrict(select, exp.Between(this=exp.column("id", _EVERYBODY), low=low, high=high))
            viewers = {_EVERYBODY: exp.column("id", _EVERYBODY)}
        if any(select.args.get(part) for part in _UNSUPPORTED_PARTS):
            raise _UnsuitableError
        group = select.args.get("group")
        sensors = (name for name in viewers if sql.table_name(sources.get(name)) == "sensor")
        leader = next(sensors, next(iter(viewers)))
        viewer = viewers.pop(leader)
        self._bind(select, leader, viewer)
        for column in viewers.values():
            sql.restrict(select, exp.EQ(this=column, expression=viewer.copy()))
        if group is not None:
            group.append("expressions", viewer.copy())
        select.append("expressions", exp.alias_(viewer.copy(), _VIEWER))
        return True

    def _viewer_of(self, name: str, table: exp.Expr) -> exp.Column | None:
        """Return the column of a source that is its viewer, or None if it has none."""
        if sql.table_name(table) == "sensor":
            return exp.column("id", name)
        if self._is_lifted(table) or (isinstance(table, exp.Subquery) and self.lift(table)):
            return exp.column(_VIEWER, name)
        return None

    def _is_lifted(self, table: exp.Expr) -> bool:
        return isinstance(table, exp.Table) and table.name in self._dependent

    def _depends(self, select: exp.Select) -> bool:
        return any(True for _ in self._bounds_in(select)) or any(
            self._is_lifted(table) for table in select.find_all(exp.Table)
        )

    def _bounds_in(self, select: exp.Select) -> Iterator[exp.Between]:
        for node in select.find_all(exp.Between):
            if self._is_bound(node) and not _is_read_by(node, select):
                yield node

    def _is_bound(self, node: exp.Between) -> bool:
        return isinstance(node.args["low"], exp.Var) and node.args["low"].name in self._bounds

    def _bind(self, select: exp.Select, leader: str, viewer: exp.Column) -> None:
        for bounds in list(self._bounds_in(select)):
            if bounds.this.table != leader or bounds.find_ancestor(exp.Select) is not select:
                _narrow(bounds, viewer)
        for inner in list(select.find_all(exp.Select)):
            if inner is not select and not _is_read_by(inner, select):
                self._inline(inner, viewer)

    def _inline(self, select: exp.Select, viewer: exp.Column) -> None:
        """Inline the common table expressions of a select that depend on the viewer."""
        sources = sql.sources(select)
        if viewer.table in sources:
            raise _UnsuitableError  # here the name means something else
        for name, table in sources.items():
            if not self._is_lifted(table):
                continue
            if self._mentions[table.name] > 1 or table.name in self._materialized:
                inner_viewer = exp.column(_VIEWER, name)
                sql.restrict(select, exp.EQ(this=inner_viewer, expression=viewer.copy()))
                continue
            body = self._dependent[table.name].copy()
            alias = exp.TableAlias(this=exp.to_identifier(name))
            table.replace(exp.Subquery(this=body, alias=alias))
            for bounds in list(body.find_all(exp.Between)):
                if self._is_bound(bounds):
                    _narrow(bounds, viewer)
            for inner in list(body.find_all(exp.Select)):
                self._inline(inner, viewer)


def _as_scalar_subqueries(select: exp.Select) -> None:
    """Turn an aggregate over all rows into a value: grouped, a viewer without rows lacks one."""
    if select.args.get("distinct") or not all(item.alias for item in select.expressions):
        raise _UnsuitableError
    values = []
    for item in select.expressions:
        subquery = exp.Select(expressions=[item.copy()])
        for part in ("from_", "joins", "where"):
            if (clause := select.args.get(part)) is not None:
                subquery.set(
                    part, [join.copy() for join in clause] if part == "joins" else clause.copy()
                )
        values.append(exp.Alias(this=exp.Subquery(this=subquery), alias=item.args["alias"].copy()))
    select.set("expressions", values)
    for part in ("from_", "joins", "where"):
        select.set(part, None)


def _narrow(bounds: exp.Between, viewer: exp.Column) -> None:
    for side in ("low", "high"):
        bound = bounds.args[side]
        if bound.name in ("?1", "?2"):
            bounds.set(side, viewer.copy())
        else:
            offset = exp.Mul(this=viewer.copy(), expression=exp.Var(this="?5"))
            bounds.set(side, exp.Add(this=offset, expression=bound.copy()))


def _is_read_by(node: exp.Expr, select: exp.Select) -> bool:
    parent = node.parent
    while parent is not None and parent is not select:
        if isinstance(parent, exp.From | exp.Join) and parent.parent is select:
            return True
        parent = parent.parent
    return False
