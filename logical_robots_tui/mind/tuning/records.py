"""Records of a result as columns, so that numbers are not written as text and parsed again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlglot import exp

from logical_robots_tui.mind.program import TRUTH_MARK
from logical_robots_tui.mind.tuning import json, sql

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["records_as_columns"]

_MOST_COLUMNS = 60
_WIDEST_CHOICE = 3  # records that a CASE chooses from, before writing it out for each field is dear


def records_as_columns(tree: exp.Query) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Let a query give the fields of its records one by one.

    Args:
        tree: The query; changed in place.

    Returns:
        Names of the columns that the query had, each with the names of the fields that stand in
        its place, those of truths marked, or with () if it is as it was; () if no column is
        changed.
    """
    if not isinstance(tree, exp.Select):
        return ()
    result: list[tuple[str, tuple[str, ...]]] = []
    columns: list[exp.Expr] = []
    for item in tree.expressions:
        fields = _fields(item.this) if isinstance(item, exp.Alias) else None
        if fields is None or len(columns) + len(fields) > _MOST_COLUMNS:
            result.append((item.alias, ()))
            columns.append(item)
        else:
            result.append((item.alias, tuple(map(_marked, fields, fields.values()))))
            columns += [
                exp.alias_(json.taken_out(value), f"{item.alias}_{number}")
                for number, value in enumerate(fields.values())
            ]
    if not all(name for name, _ in result) or not any(fields for _, fields in result):
        return ()
    tree.set("expressions", columns)
    return tuple(result)


def _marked(name: str, value: exp.Expr) -> str:
    return f"{name}{TRUTH_MARK}" if json.truth_in(value) is not None else name


def _fields(value: exp.Expr) -> dict[str, exp.Expr] | None:
    """Return expressions by field of a record that is written out, or None."""
    if isinstance(value, exp.Paren):
        return _fields(value.this)
    if isinstance(value, exp.Case):
        return _chosen_fields(value)
    if sql.call_name(value) != "json_object":
        return None
    names, values = value.expressions[::2], value.expressions[1::2]
    if not all(isinstance(name, exp.Literal) and name.is_string for name in names):
        return None
    fields = {name.this: field for name, field in zip(names, values, strict=True)}
    return fields if len(fields) == len(names) and fields else None


def _chosen_fields(case: exp.Case) -> dict[str, exp.Expr] | None:
    """Return the same for a choice between a few records of the same fields, never null."""
    default = case.args.get("default")
    branches = case.args["ifs"]
    if case.this is not None or default is None or len(branches) >= _WIDEST_CHOICE:
        return None
    records = [_fields(value) for value in (*(b.args["true"] for b in branches), default)]
    first = records[0]
    if first is None or any(r is None or list(r) != list(first) for r in records):
        return None
    *chosen, otherwise = [record for record in records if record is not None]
    chosen_of = {
        field: _choice(branches, [record[field] for record in chosen], otherwise[field])
        for field in first
    }
    fields = {field: case for field, case in chosen_of.items() if case is not None}
    return fields if len(fields) == len(first) else None


def _choice(
    branches: Sequence[exp.If], values: Sequence[exp.Expr], otherwise: exp.Expr
) -> exp.Expr | None:
    """Return a choice between what stands in JSON, or None if some but not all of it are truths."""
    given = [*values, otherwise]
    truths = [truth for truth in map(json.truth_in, given) if truth is not None]
    if truths and len(truths) < len(given):
        return None
    *arms, default = map(json.taken_out, given)
    ifs = [
        exp.If(this=branch.this.copy(), true=arm)
        for branch, arm in zip(branches, arms, strict=True)
    ]
    case = exp.Case(ifs=ifs, default=default)
    return json.truth(case) if truths else case
