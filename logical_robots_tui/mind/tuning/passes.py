"""The passes that rewrite a query, in order, and their application to the queries of a program.

All but the required ones can be left out.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Mapping
from dataclasses import dataclass
from functools import partial

from sqlglot import exp
from sqlglot.errors import SqlglotError

from logical_robots_tui.mind.program import STEPS, Tuned
from logical_robots_tui.mind.tuning import columns, common_subexpressions, planning, records, sql
from logical_robots_tui.mind.tuning.all_viewers import for_all_viewers
from logical_robots_tui.mind.tuning.columns import MemoryColumns
from logical_robots_tui.schema import INPUTS


@dataclass(slots=True)
class Rewriting:
    """A query between two passes.

    Attributes:
        tree: The query of one viewer.
        memory_columns: The columns of memory fields, shared by all queries of a program; mutable.
        is_for_all: Whether to make a query for all viewers at once, too.
        result: As `records_as_columns` gives it.
        items: As `items_as_rows` gives it.
        together: The query for all viewers at once.
        alike: The same for viewers that all see the same memories.
        crowd: The queries for many robots, if they differ.
    """

    tree: exp.Query
    memory_columns: MemoryColumns
    is_for_all: bool = False
    result: tuple[tuple[str, tuple[str, ...]], ...] = ()
    items: tuple[str, ...] = ()
    together: exp.Query | None = None
    alike: exp.Query | None = None
    crowd: tuple[exp.Query | None, ...] = ()

    @property
    def queries(self) -> tuple[exp.Query | None, ...]:
        return self.tree, self.together, self.alike


@dataclass(frozen=True, slots=True)
class Pass:
    """One step of rewriting.

    Attributes:
        name: In lower case with hyphens, as `docs/speed.md` lists it.
        apply: Changes a query.
        required: Whether the query would be wrong without it.
    """

    name: str
    apply: Callable[[Rewriting], None]
    required: bool = False


def _on_tree(change: Callable[[exp.Query], None]) -> Callable[[Rewriting], None]:
    return lambda rewriting: change(rewriting.tree)


def _on_queries(change: Callable[[exp.Query], None]) -> Callable[[Rewriting], None]:
    def apply(rewriting: Rewriting) -> None:
        for query in filter(None, rewriting.queries):
            change(query)

    return apply


def _item_rows(rewriting: Rewriting) -> None:
    rewriting.items = columns.items_as_rows(
        rewriting.tree, rewriting.memory_columns.fields, rewriting.memory_columns.items
    )


def _result_columns(rewriting: Rewriting) -> None:
    rewriting.result = records.records_as_columns(rewriting.tree)


def _all_viewers(rewriting: Rewriting) -> None:
    if rewriting.is_for_all:
        rewriting.together = for_all_viewers(rewriting.tree)
        rewriting.alike = for_all_viewers(rewriting.tree, alike=True)


def _list_indexes(rewriting: Rewriting) -> None:
    rewriting.crowd = tuple(None if query is None else query.copy() for query in rewriting.queries)
    for query in filter(None, rewriting.queries):
        planning.limit_indexes(query)


PASSES = (
    Pass("self-joins", _on_tree(columns.merge_self_joins)),
    Pass("ray-rows", _on_tree(columns.rays_as_rows)),
    Pass("sensor-columns", _on_tree(columns.sensor_fields_as_columns)),
    Pass("viewer-bounds", _on_tree(columns.bind_viewers), required=True),
    Pass("arg-min-pairs", _on_tree(records.pairs_as_columns)),
    Pass(
        "memory-columns",
        lambda rewriting: columns.memory_fields_as_columns(
            rewriting.tree, rewriting.memory_columns.fields
        ),
    ),
    Pass("item-rows", _item_rows),
    Pass("untangled-aggregates", _on_tree(records.untie_aggregates)),
    Pass("arg-min", _on_tree(records.native_arg_min)),
    Pass("result-columns", _result_columns),
    Pass("common-subexpressions", _on_tree(common_subexpressions.share)),
    Pass("materialized", _on_tree(planning.materialize)),
    Pass("division", _on_tree(records.native_division)),
    Pass("numbers", _on_tree(sql.native_numbers)),
    Pass("all-viewers", _all_viewers),
    # One viewer's query runs once where all see everything.
    Pass("materialized-by-robot", _on_tree(partial(planning.materialize, by_robots=True))),
    Pass("choice", _on_queries(records.native_choice)),
    Pass("late-rays", _on_queries(columns.fetch_whole_rays)),
    Pass("lookups", _on_queries(planning.index_lookups)),
    Pass("range-scans", _on_queries(planning.scan_ranges)),
    Pass("list-indexes", _list_indexes),
)
"""Columns come before what reads them, and repeated expressions are compared in their final form.
Indexes are decided on last."""

_MAX_LENGTH = 100_000  # characters of a statement
MOST_TUNED = 400_000
"""Characters of all statements of a program that are tuned."""

_RESERVED_COLUMNS = frozenset({"id", "rowid", "oid", "_rowid_"})
"""Columns that exist for tuned queries only."""

_TUNED_TABLES = frozenset(sql.TABLES).difference(name.lower() for name in INPUTS)
"""Tables that exist for tuned queries only."""


def tune_all(
    statements: Mapping[str, str],
    trees: dict[str, exp.Query] | None = None,
    *,
    for_all: Container[str] = ("Robot",),
    without: Collection[str] = (),
) -> dict[str, Tuned]:
    """Tune queries in order until a size limit; consumes `trees`, the parsed statements.

    Those named in `for_all` are made for all viewers at once as well.
    """
    tuned = {}
    trees = {} if trees is None else trees
    memory_columns = MemoryColumns()
    characters_left = MOST_TUNED
    for name, statement in statements.items():
        characters_left -= len(statement)
        if characters_left < 0:
            break
        if len(statement) <= _MAX_LENGTH:
            query = tune(
                statement,
                memory_columns,
                tree=trees.pop(statement, None),
                for_all=name in for_all,
                without=without,
            )
            if query is not None:
                tuned[name] = query
    return tuned


def tune(
    statement: str,
    memory_columns: MemoryColumns | None = None,
    *,
    tree: exp.Query | None = None,
    for_all: bool = False,
    without: Collection[str] = (),
) -> Tuned | None:
    """Return the same query for the tables of the columns layout, or None if it can't be rewritten.

    Args:
        statement: A query as it was generated.
        memory_columns: The columns of memory fields, shared by all queries of a program.
        tree: Its tree, if there is one already; it is changed.
        for_all: Whether to make, if possible, one for all viewers at once as well.
        without: Names of passes to leave out.
    """
    if STEPS in statement:
        return None  # rows that pass from step to step as a list can't be told apart by viewer
    try:
        tree = tree or sql.parse(statement)
        if not _is_movable(tree):
            return None
        rewriting = Rewriting(tree, memory_columns or MemoryColumns(), is_for_all=for_all)
        for tuning_pass in PASSES:
            if tuning_pass.required or tuning_pass.name not in without:
                tuning_pass.apply(rewriting)
        return _result_of(rewriting)
    except (SqlglotError, ValueError, RecursionError):
        return None


def _result_of(rewriting: Rewriting) -> Tuned:
    viewer_columns = columns.columns_read([rewriting.tree])
    bounds = 4 if "Memory" in viewer_columns else 2 if "Sensor" in viewer_columns else 0
    read_columns = columns.columns_read(filter(None, rewriting.queries))
    if rewriting.together or rewriting.alike:
        read_columns["Sensor"] = read_columns["Sensor"] or ("robot_name",)
    if "Memory" in read_columns:
        fields = {column: name for name, column in rewriting.memory_columns.fields.items()}
        names = read_columns["Memory"]
        read_columns["Memory"] = tuple(f"{n}={fields[n]}" if n in fields else n for n in names)
    if rewriting.items:
        read_columns["Item"] = rewriting.items
    for query in filter(None, (*rewriting.queries, *rewriting.crowd)):
        common_subexpressions.stream(query)
    variants, crowd_variants = (
        tuple("" if query is None else sql.render(query) for query in queries)
        for queries in (rewriting.queries, rewriting.crowd)
    )
    crowd_only = crowd_variants if crowd_variants != variants else ()
    query_sql, together, alike = variants
    return Tuned(query_sql, bounds, read_columns, rewriting.result, together, alike, crowd_only)


def _is_movable(tree: exp.Expr) -> bool:
    """Return whether a query keeps its meaning when it reads other tables."""
    if any(column.name.lower() in _RESERVED_COLUMNS for column in tree.find_all(exp.Column)):
        return False
    if tree.find(exp.Placeholder, exp.Parameter):
        return False
    for star in tree.find_all(exp.Star):  # others only count
        select = star.parent
        if isinstance(select, exp.Select) and any(
            map(columns.is_input, sql.sources(select).values())
        ):
            return False
    if any(sql.call_name(call) == "unique_number" for call in tree.find_all(exp.Anonymous)):
        return False  # each of its calls is another number
    tables = tree.find_all(exp.Table)
    return not any(table.name.lower() in _TUNED_TABLES or table.args.get("db") for table in tables)
