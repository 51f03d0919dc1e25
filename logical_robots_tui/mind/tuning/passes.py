"""The passes that rewrite a query, in order. All but the required ones can be left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.mind.tuning import (
    aggregates,
    columns,
    common_subexpressions,
    json,
    planning,
)
from logical_robots_tui.mind.tuning.all_viewers import for_all_viewers
from logical_robots_tui.mind.tuning.memories import items_as_rows, memory_fields_as_columns
from logical_robots_tui.mind.tuning.records import pairs_as_columns, records_as_columns

if TYPE_CHECKING:
    from collections.abc import Callable

    from sqlglot import exp

    from logical_robots_tui.mind.tuning.memories import MemoryColumns


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
        """The query of one viewer and those for all viewers."""
        return self.tree, self.together, self.alike


@dataclass(frozen=True, slots=True)
class Pass:
    """One step of rewriting.

    Attributes:
        name: In lower case with hyphens, as `docs/speed.md` lists it.
        apply: Changes a query.
        after: Names of the passes that it must follow.
        required: Whether the query would be wrong without it.
    """

    name: str
    apply: Callable[[Rewriting], None]
    after: tuple[str, ...] = ()
    required: bool = False


def _on_tree(change: Callable[[exp.Query], None]) -> Callable[[Rewriting], None]:
    return lambda work: change(work.tree)


def _on_each(change: Callable[[exp.Query], None]) -> Callable[[Rewriting], None]:
    def apply(work: Rewriting) -> None:
        for query in filter(None, work.queries):
            change(query)

    return apply


def _memory_columns(work: Rewriting) -> None:
    memory_fields_as_columns(work.tree, work.known.fields)


def _item_rows(work: Rewriting) -> None:
    work.items = items_as_rows(work.tree, work.known.fields, work.known.items)


def _result_columns(work: Rewriting) -> None:
    work.result = records_as_columns(work.tree)


def _all_viewers(work: Rewriting) -> None:
    if work.is_for_all:
        work.together = for_all_viewers(work.tree)
        work.alike = for_all_viewers(work.tree, alike=True)


def _materialized_by_robot(work: Rewriting) -> None:
    # The query of one viewer is asked once where all see everything.
    planning.computed_once(work.tree, by_robots=True)


def _list_indexes(work: Rewriting) -> None:
    work.crowd = tuple(None if query is None else query.copy() for query in work.queries)
    for query in filter(None, work.queries):
        planning.indexed_where_lists_are_joined(query)


PASSES = (
    Pass("self-joins", _on_tree(columns.one_alias_per_robot)),
    Pass("ray-rows", _on_tree(columns.rays_as_rows)),
    Pass("sensor-columns", _on_tree(columns.sensor_fields_as_columns), after=("ray-rows",)),
    Pass("viewer-bounds", _on_tree(columns.bound_to_viewer), after=("self-joins",), required=True),
    Pass("arg-min-pairs", _on_tree(pairs_as_columns)),
    Pass("memory-columns", _memory_columns, after=("arg-min-pairs",)),
    Pass("item-rows", _item_rows, after=("memory-columns",)),
    Pass("untangled-aggregates", _on_tree(aggregates.untangled)),
    Pass("arg-min", _on_tree(aggregates.native_arg_min), after=("untangled-aggregates",)),
    Pass("result-columns", _result_columns),
    Pass(
        "common-subexpressions",
        _on_tree(common_subexpressions.shared),
        after=("ray-rows", "sensor-columns", "memory-columns", "result-columns"),
    ),
    Pass("materialized", _on_tree(planning.computed_once), after=("common-subexpressions",)),
    Pass("division", _on_tree(aggregates.native_division)),
    Pass("numbers", _on_tree(json.native_numbers), after=("result-columns",)),
    Pass("all-viewers", _all_viewers, after=("viewer-bounds", "materialized", "numbers")),
    Pass("materialized-by-robot", _materialized_by_robot, after=("all-viewers",)),
    Pass("choice", _on_each(aggregates.native_choice)),
    Pass("late-rays", _on_each(columns.whole_rays_when_wanted), after=("ray-rows",)),
    Pass("lookups", _on_each(planning.looked_up), after=("materialized-by-robot",)),
    Pass("range-scans", _on_each(planning.found_by_number), after=("ray-rows", "item-rows")),
    Pass("list-indexes", _list_indexes, after=("lookups", "range-scans")),
)
"""Repeated expressions are looked for once all of them have their final form."""
