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
        known: The columns of memory fields, shared by all queries of a program; mutable.
        is_for_all: Whether to make a query for all viewers at once, too.
        result: As `records_as_columns` gives it.
        items: As `items_as_rows` gives it.
        together: The query for all viewers at once.
        alike: The same for viewers that all see the same memories.
        crowd: The queries for many robots, if they differ.
    """

    tree: exp.Query
    known: MemoryColumns
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
    return lambda work: change(work.tree)


def _on_each(change: Callable[[exp.Query], None]) -> Callable[[Rewriting], None]:
    def apply(work: Rewriting) -> None:
        for query in filter(None, work.queries):
            change(query)

    return apply


def _item_rows(work: Rewriting) -> None:
    work.items = columns.items_as_rows(work.tree, work.known.fields, work.known.items)


def _result_columns(work: Rewriting) -> None:
    work.result = records.records_as_columns(work.tree)


def _all_viewers(work: Rewriting) -> None:
    if work.is_for_all:
        work.together = for_all_viewers(work.tree)
        work.alike = for_all_viewers(work.tree, alike=True)


def _list_indexes(work: Rewriting) -> None:
    work.crowd = tuple(None if query is None else query.copy() for query in work.queries)
    for query in filter(None, work.queries):
        planning.limit_indexes(query)


PASSES = (
    Pass("self-joins", _on_tree(columns.merge_self_joins)),
    Pass("ray-rows", _on_tree(columns.rays_as_rows)),
    Pass("sensor-columns", _on_tree(columns.sensor_fields_as_columns)),
    Pass("viewer-bounds", _on_tree(columns.bind_viewers), required=True),
    Pass("arg-min-pairs", _on_tree(records.pairs_as_columns)),
    Pass(
        "memory-columns",
        lambda work: columns.memory_fields_as_columns(work.tree, work.known.fields),
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
    # The query of one viewer is asked once where all see everything.
    Pass("materialized-by-robot", _on_tree(partial(planning.materialize, by_robots=True))),
    Pass("choice", _on_each(records.native_choice)),
    Pass("late-rays", _on_each(columns.fetch_whole_rays)),
    Pass("lookups", _on_each(planning.index_lookups)),
    Pass("range-scans", _on_each(planning.scan_ranges)),
    Pass("list-indexes", _list_indexes),
)
"""Columns come before what reads them, and repeated expressions are looked for in their final form.
Indexes are decided on last."""

_LONGEST = 100_000  # characters of a statement
MOST_TUNED = 400_000
"""Characters of all statements of a program that are tuned."""

_TAKEN = frozenset({"id", "rowid", "oid", "_rowid_"})
"""Columns that exist for tuned queries only."""

_OURS = frozenset(sql.TABLES).difference(name.lower() for name in INPUTS)
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
    known = MemoryColumns()
    left = MOST_TUNED
    for name, statement in statements.items():
        left -= len(statement)
        if left < 0:
            break
        if len(statement) <= _LONGEST:
            found = tune(
                statement,
                known,
                tree=trees.pop(statement, None),
                for_all=name in for_all,
                without=without,
            )
            if found is not None:
                tuned[name] = found
    return tuned


def tune(
    statement: str,
    known: MemoryColumns | None = None,
    *,
    tree: exp.Query | None = None,
    for_all: bool = False,
    without: Collection[str] = (),
) -> Tuned | None:
    """Return the same query for the tables of the columns layout, or None if it can't be rewritten.

    Args:
        statement: A query as it was generated.
        known: The columns of memory fields, shared by all queries of a program.
        tree: Its tree, if there is one already; it is changed.
        for_all: Whether to make, if possible, one for all viewers at once as well.
        without: Names of passes to leave out.
    """
    if STEPS in statement:
        return None  # rows that pass from step to step as a list can't be told apart by viewer
    try:
        tree = tree or sql.parse(statement)
        if not _can_be_moved(tree):
            return None
        work = Rewriting(tree, known or MemoryColumns(), is_for_all=for_all)
        for each in PASSES:
            if each.required or each.name not in without:
                each.apply(work)
        return _result_of(work)
    except (SqlglotError, ValueError, RecursionError):
        return None


def _result_of(work: Rewriting) -> Tuned:
    one = columns.read_by([work.tree])
    bounds = 4 if "Memory" in one else 2 if "Sensor" in one else 0
    read = columns.read_by(filter(None, work.queries))
    if work.together or work.alike:
        read["Sensor"] = read["Sensor"] or ("robot_name",)
    if "Memory" in read:
        read["Memory"] = columns.name_fields(read["Memory"], work.known.fields)
    if work.items:
        read["Item"] = work.items
    for query in filter(None, (*work.queries, *work.crowd)):
        common_subexpressions.stream(query)
    few, crowd = (
        tuple("" if query is None else sql.render(query) for query in queries)
        for queries in (work.queries, work.crowd)
    )
    others = crowd if crowd != few else ()
    return Tuned(few[0], bounds, read, work.result, few[1], few[2], others)


def _can_be_moved(tree: exp.Expr) -> bool:
    """Return whether a query keeps its meaning when it reads other tables."""
    if any(column.name.lower() in _TAKEN for column in tree.find_all(exp.Column)):
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
    return not any(table.name.lower() in _OURS or table.args.get("db") for table in tables)
