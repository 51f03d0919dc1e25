"""Records in lists of memories as rows, so that no list is written as text and parsed again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.remembered import (
    ITEM_FIELDS,
    ITEMS,
    MEMORY_FIELDS,
    spelled_item,
)
from logical_robots_tui.mind.tuning import json, sql

if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping

__all__ = ["items_as_rows"]


def items_as_rows(
    tree: exp.Expr, fields: Mapping[str, str], known: MutableMapping[str, str]
) -> tuple[str, ...]:
    """Read records in lists of memories from a table of such records.

    Args:
        tree: A query in which fields of memories are columns; changed in place.
        fields: By name of a field of memories its column of ``Memory``.
        known: By name of a field of such a record its column of ``Item``, for all queries of a
            program; added to.

    Returns:
        The columns that the query reads, as `fillings` wants them.
    """
    by_column = {column: name for name, column in fields.items()}
    read: set[str] = set()
    for table in list(tree.find_all(exp.Table)):
        select, items = sql.nearest_select(table), _list_of(table)
        if select is None or items is None or not _joins_before(select, table, items.table):
            continue
        alias = table.alias_or_name
        uses = list(sql.columns_of(select, alias))
        keys = {sql.extracted(use.parent).removeprefix("$.") for use in uses}
        new = sorted(key for key in keys if key not in known)
        if not all(map(str.isidentifier, keys)) or len(known) + len(new) > len(ITEM_FIELDS):
            continue
        if not keys or any(use.name != "value" for use in uses):
            continue
        known.update(zip(new, ITEM_FIELDS[len(known) :], strict=False))
        for use in uses:
            call = use.parent
            assert call is not None
            column = known[sql.extracted(call).removeprefix("$.")]
            taken = exp.column(column, alias)
            call.replace(json.remarked(taken, call, is_result=True))
        place = MEMORY_FIELDS.index(items.name)
        read |= {spelled_item(known[key], place, by_column[items.name], key) for key in keys}
        _read_items(select, table, items.table, place)
    return tuple(sorted(read))


def _list_of(table: exp.Table) -> exp.Column | None:
    """Return the column of a memory that a source unnests, if that is what it is."""
    arguments = table.this.expressions if sql.call_name(table.this) == "json_each" else []
    column = arguments[0] if len(arguments) == 1 else None
    if not isinstance(column, exp.Column) or column.name not in MEMORY_FIELDS:
        return None
    found = sql.source(column)
    return column if found is not None and sql.table_name(found[1]) == "memory" else None


def _joins_before(select: exp.Select, table: exp.Table, memory: str) -> bool:
    """Return whether a select, or an outer one, reads a memory before a list in it."""
    names = list(sql.sources(select))
    return memory not in names or names.index(memory) < names.index(table.alias_or_name)


def _read_items(select: exp.Select, table: exp.Table, memory: str, place: int) -> None:
    """Let a select read the records of a list; after what it reads before, as it was."""
    alias = table.alias_or_name
    join = table.parent
    if isinstance(join, exp.Join):
        join.set("kind", "CROSS")
    table.replace(exp.alias_(exp.to_table("Item"), alias, table=True))
    lists = exp.Mul(
        this=exp.column("id", memory), expression=exp.Literal.number(len(MEMORY_FIELDS))
    )
    this = exp.Paren(this=exp.Add(this=lists, expression=exp.Literal.number(place)))
    first = exp.Mul(this=this, expression=exp.Literal.number(ITEMS))
    last = exp.Add(this=first.copy(), expression=exp.Literal.number(ITEMS - 1))
    sql.restrict(select, exp.Between(this=exp.column("id", alias), low=first, high=last))
