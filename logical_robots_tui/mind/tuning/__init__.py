"""Tuning: the SQL of a program, rewritten so that SQLite has less to do for the same rows.

Rows of all robots are loaded once a tick, with sensor fields and radar rays in columns of their
own; what a program computes several times is computed once. Runs in the compile process only.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from sqlglot import exp
from sqlglot.errors import SqlglotError

from logical_robots_tui.mind.program import INPUTS, STEPS, Tuned
from logical_robots_tui.mind.sqlite.remembered import ITEM_FIELDS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import aggregates, columns, json, native, records, sharing, sql
from logical_robots_tui.mind.tuning.indexes import (
    found_by_number,
    indexed_where_lists_are_joined,
    memories_by_name,
)
from logical_robots_tui.mind.tuning.items import items_as_rows
from logical_robots_tui.mind.tuning.memories import memory_fields_as_columns
from logical_robots_tui.mind.tuning.often import computed_once, looked_up
from logical_robots_tui.mind.tuning.pairs import pairs_as_columns
from logical_robots_tui.mind.tuning.together import together
from logical_robots_tui.mind.tuning.whole_rays import still_read, whole_rays_when_wanted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


__all__ = ["Known", "tune", "tune_all"]

_LONGEST = 100_000  # characters of a statement
_MOST = 400_000  # characters of all statements of a program

_TAKEN = frozenset({"id", "rowid", "oid", "_rowid_"})
"""Columns that the tables of a tuned query have and those of a program have not."""

_OURS = frozenset(columns.TABLES).difference(name.lower() for name in INPUTS)
"""Tables that a tuned query has and those of a program have not."""


@dataclass(frozen=True, slots=True)
class Known:
    """Which columns hold what of memories, for all queries of a program; added to.

    Attributes:
        fields: By name of a field of memories its column of ``Memory``.
        items: By name of a field of records in their lists its column of ``Item``.
    """

    fields: dict[str, str] = field(default_factory=dict)
    items: dict[str, str] = field(default_factory=dict)

    @classmethod
    def closed(cls, read: Mapping[str, Sequence[str]]) -> Known:
        """What the columns are that are read already, with no room for more.

        Args:
            read: By name of a table its columns, as a tuned query names them.
        """
        fields, items = {}, {}
        for name in read.get("Memory", ()):
            column, _, known = name.partition("=")
            if known:
                fields[known] = column
        for name in read.get("Item", ()):
            column, _, known = name.partition("=")
            items[known.rpartition(".")[2]] = column
        # No field has a number for its name.
        fields |= {str(at): c for at, c in enumerate(MEMORY_FIELDS) if c not in fields.values()}
        items |= {str(at): c for at, c in enumerate(ITEM_FIELDS) if c not in items.values()}
        return cls(fields, items)


def tune_all(statements: Mapping[str, str]) -> dict[str, Tuned]:
    """Tune what can be tuned of several queries, the first ones first.

    Args:
        statements: Queries by name.
    """
    tuned = {}
    known = Known()
    left = _MOST
    for name, statement in statements.items():
        left -= len(statement)
        if left < 0:
            break
        if len(statement) <= _LONGEST:
            found = tune(statement, known, for_all=name == "Robot")
            if found is not None:
                tuned[name] = found
    return tuned


def tune(
    statement: str,
    known: Known | None = None,
    *,
    for_all: bool = False,
    by_name: bool = False,
) -> Tuned | None:
    """The same query for the tables of the columns layout, or None if it can't be rewritten.

    Args:
        statement: A query as it was generated.
        known: Columns for fields of memories, the same for all queries of a program.
        for_all: Whether to make, if possible, one for all viewers at once as well.
        by_name: Whether many robots look up memories by name: quicker, but sums are made in another
            order, so that a robot would drive another way by a last digit.
    """
    known = known or Known()
    if STEPS in statement:
        return None  # rows that pass from step to step as a list can't be told apart by viewers
    try:
        tree = sql.parse(statement)
        if not _can_be_moved(tree):
            return None
        columns.one_alias_per_robot(tree)
        columns.rays_as_rows(tree)
        columns.sensor_fields_as_columns(tree)
        columns.bound_to_viewer(tree)
        pairs_as_columns(tree)
        memory_fields_as_columns(tree, known.fields)
        items = items_as_rows(tree, known.fields, known.items)
        aggregates.grouped_arg_min(tree)
        result, read = _finished(tree)
        at_once = [together(tree), together(tree, alike=True)] if for_all else [None, None]
        if "Memory" in read:
            read["Memory"] = _with_fields(read["Memory"], known.fields)
        if items:
            read["Item"] = items
        bounds = 4 if "Memory" in read else 2 if "Sensor" in read else 0
        if any(at_once):
            read.setdefault("Sensor", ("robot_name",))
        computed_once(tree, by_robots=True)  # for it is asked once where all see everything
        queries = [tree, *at_once]
        for query in queries:
            if query is not None:
                sharing.rows_as_they_come(query)
                native.native_choice(query)
                whole_rays_when_wanted(query)
                looked_up(query)
                found_by_number(query)
        read = still_read(read, [query for query in queries if query is not None])
        crowd = _texts([_for_crowd(query) for query in queries] if by_name else queries)
        for query in queries:
            if query is not None:
                indexed_where_lists_are_joined(query)
        few = _texts(queries)
        tuned = Tuned(few[0], bounds, read, result, few[1], few[2])
        return tuned if few == crowd else replace(tuned, crowd=crowd)
    except (SqlglotError, ValueError, RecursionError):
        return None


def _finished(
    tree: exp.Query,
) -> tuple[tuple[tuple[str, tuple[str, ...]], ...], dict[str, tuple[str, ...]]]:
    """Tune a query whose inputs are columns; what it gives and what it reads."""
    aggregates.untangled(tree)
    aggregates.native_arg_min(tree)
    result = records.records_as_columns(tree)
    read = columns.read_by(tree)
    sharing.shared(tree)
    computed_once(tree)
    native.native_division(tree)
    json.native_numbers(tree)
    return result, read


def _for_crowd(query: exp.Query | None) -> exp.Query | None:
    """A query as it is for many robots."""
    if query is not None:
        query = query.copy()
        memories_by_name(query)
    return query


def _texts(queries: Sequence[exp.Query | None]) -> tuple[str, str, str]:
    one, together_, alike = ("" if query is None else sql.written(query) for query in queries)
    return one, together_, alike


def _with_fields(names: tuple[str, ...], fields: Mapping[str, str]) -> tuple[str, ...]:
    """Names of columns of ``Memory``, those of fields with the field."""
    by_column = {column: field for field, column in fields.items()}
    return tuple(f"{n}={by_column[n]}" if n in by_column else n for n in names)


def _can_be_moved(tree: exp.Expr) -> bool:
    """Whether a query has nothing that means something else over other tables."""
    if any(column.name.lower() in _TAKEN for column in tree.find_all(exp.Column)):
        return False
    if tree.find(exp.Placeholder, exp.Parameter, exp.Star) and not _only_counts(tree):
        return False
    tables = tree.find_all(exp.Table)
    return not any(table.name.lower() in _OURS or table.args.get("db") for table in tables)


def _only_counts(tree: exp.Expr) -> bool:
    """Whether a star stands only in COUNT(*) and over a query that is written out."""
    if tree.find(exp.Placeholder, exp.Parameter):
        return False
    for star in tree.find_all(exp.Star):
        select = sql.nearest_select(star)
        if (
            select is not None
            and star.parent is select
            and any(columns.is_input(table) for table in sql.sources(select).values())
        ):
            return False
    return True
