"""Fields of memories as columns, and records in their lists as rows: none is parsed again."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.filling import spelled_item
from logical_robots_tui.mind.sqlite.layouts import ITEM_FIELDS, ITEMS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import json, sql

if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping, Sequence


@dataclass(frozen=True, slots=True)
class MemoryColumns:
    """Which columns hold what of memories, for all queries of a program; added to.

    Attributes:
        fields: By name of a field of memories its column of ``Memory``.
        items: By name of a field of records in their lists its column of ``Item``.
    """

    fields: dict[str, str] = field(default_factory=dict)
    items: dict[str, str] = field(default_factory=dict)

    @classmethod
    def closed(cls, read: Mapping[str, Sequence[str]]) -> MemoryColumns:
        """Return what the columns are that are read already, with no room for more."""
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


def memory_fields_as_columns(tree: exp.Expr, known: MutableMapping[str, str]) -> None:
    """Take fields of memories from columns of their own."""
    for column in list(tree.find_all(exp.Column)):
        guarded = _field_of_memory(column)
        if guarded is None:
            continue
        case, field = guarded
        if field not in known:
            if len(known) == len(MEMORY_FIELDS):
                continue
            known[field] = MEMORY_FIELDS[len(known)]
        taken = exp.column(known[field], column.table)
        case.replace(json.remarked(taken, case, is_result=True))


def named_fields(names: tuple[str, ...], fields: Mapping[str, str]) -> tuple[str, ...]:
    """Return names of columns of ``Memory``, those of fields with the field."""
    by_column = {column: field for field, column in fields.items()}
    return tuple(f"{n}={by_column[n]}" if n in by_column else n for n in names)


def _field_of_memory(column: exp.Column) -> tuple[exp.Case, str] | None:
    """Return the expression that reads a field of a memory if it is a record, and the field."""
    if column.name.lower() != "memory":
        return None
    found = sql.source(column)
    if found is None or sql.table_name(found[1]) != "memory":
        return None
    return guarded_field(column)


def guarded_field(column: exp.Column) -> tuple[exp.Case, str] | None:
    """Return the expression that takes a field out of a column if that is a record, and the field.

    It is ``CASE WHEN JSON_VALID(column) THEN JSON_EXTRACT(column, '$.field') END``; of its two
    mentions of the column only the second has one.
    """
    call = column.parent
    branch = call.parent if sql.call_name(call) == "json_extract" and call else None
    case = branch.parent if isinstance(branch, exp.If) else None
    if not isinstance(case, exp.Case) or branch is None or call is None:
        return None
    test = branch.this
    path = call.expressions[1] if len(call.expressions) == 2 else None
    if (
        case.this is not None
        or case.args.get("default") is not None
        or len(case.args["ifs"]) != 1
        or branch.args.get("true") is not call
        or sql.call_name(test) != "json_valid"
        or test.expressions != [column]
        or not isinstance(path, exp.Literal)
        or not path.is_string
    ):
        return None
    name = path.this.removeprefix("$.")
    return (case, name) if path.this == f"$.{name}" and name.isidentifier() else None


def items_as_rows(
    tree: exp.Expr, fields: Mapping[str, str], known: MutableMapping[str, str]
) -> tuple[str, ...]:
    """Read records in lists of memories from a table of such records.

    Returns:
        The columns that the query reads, as `fillings` wants them.
    """
    by_column = {column: name for name, column in fields.items()}
    read: set[str] = set()
    for table in list(tree.find_all(exp.Table)):
        select, items = table.find_ancestor(exp.Select), _list_of(table)
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
