"""Fields of memories as columns, so that memories are not parsed again and again."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.sqlite.remembered import ITEM_FIELDS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import json, sql

if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping, Sequence

__all__ = ["Known", "guarded_field", "memory_fields_as_columns", "named_fields"]


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
        """Return what the columns are that are read already, with no room for more.

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


def memory_fields_as_columns(tree: exp.Expr, known: MutableMapping[str, str]) -> None:
    """Take fields of memories from columns of their own.

    Args:
        tree: A query; changed in place.
        known: By name of a field its column, for all queries of a program; added to.
    """
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
