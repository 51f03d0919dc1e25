"""Tuning: rewriting the SQL of a program so that SQLite needs less time for the same rows.

Rows of all robots are loaded once a tick, with sensor fields and radar rays in columns of their
own; repeated expressions are computed once. Runs in the compile process only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp
from sqlglot.errors import SqlglotError

from logical_robots_tui.mind.program import INPUTS, STEPS, Tuned
from logical_robots_tui.mind.tuning import columns, sql
from logical_robots_tui.mind.tuning.memories import MemoryColumns, named_fields
from logical_robots_tui.mind.tuning.passes import PASSES, Rewriting

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

__all__ = ["MOST_TUNED", "MemoryColumns", "tune", "tune_all"]

_LONGEST = 100_000  # characters of a statement
MOST_TUNED = 400_000
"""Characters of all statements of a program that are tuned."""

_TAKEN = frozenset({"id", "rowid", "oid", "_rowid_"})
"""Columns that exist for tuned queries only."""

_OURS = frozenset(columns.TABLES).difference(name.lower() for name in INPUTS)
"""Tables that exist for tuned queries only."""


def tune_all(
    statements: Mapping[str, str],
    trees: dict[str, exp.Query] | None = None,
    *,
    without: Collection[str] = (),
) -> dict[str, Tuned]:
    """Tune what can be tuned of several queries, the first ones first.

    `trees` are those of statements that have been read already; they are used up.
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
                for_all=name == "Robot",
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
        return None  # rows that pass from step to step as a list can't be told apart by viewers
    try:
        tree = tree or sql.parse(statement)
        if not _can_be_moved(tree):
            return None
        work = Rewriting(tree, known or MemoryColumns(), is_for_all=for_all)
        for each in PASSES:
            if each.required or each.name not in without:
                each.apply(work)
        return _finished(work)
    except (SqlglotError, ValueError, RecursionError):
        return None


def _finished(work: Rewriting) -> Tuned:
    one = columns.read_by([work.tree])
    bounds = 4 if "Memory" in one else 2 if "Sensor" in one else 0
    read = columns.read_by(filter(None, work.queries))
    if work.together or work.alike:
        read["Sensor"] = read["Sensor"] or ("robot_name",)
    if "Memory" in read:
        read["Memory"] = named_fields(read["Memory"], work.known.fields)
    if work.items:
        read["Item"] = work.items
    few, crowd = _texts(work.queries), _texts(work.crowd)
    others = crowd if crowd != few else ()
    return Tuned(few[0], bounds, read, work.result, few[1], few[2], others)


def _texts(queries: Iterable[exp.Query | None]) -> tuple[str, ...]:
    return tuple("" if query is None else sql.written(query) for query in queries)


def _can_be_moved(tree: exp.Expr) -> bool:
    """Return whether a query has nothing that means something else over other tables."""
    if any(column.name.lower() in _TAKEN for column in tree.find_all(exp.Column)):
        return False
    if tree.find(exp.Placeholder, exp.Parameter, exp.Star) and not _only_counts(tree):
        return False
    tables = tree.find_all(exp.Table)
    return not any(table.name.lower() in _OURS or table.args.get("db") for table in tables)


def _only_counts(tree: exp.Expr) -> bool:
    """Return whether a star stands only in COUNT(*) and over a query that is written out."""
    if tree.find(exp.Placeholder, exp.Parameter):
        return False
    for star in tree.find_all(exp.Star):
        select = star.find_ancestor(exp.Select)
        if (
            select is not None
            and star.parent is select
            and any(columns.is_input(table) for table in sql.sources(select).values())
        ):
            return False
    return True
