"""Whole rows, as in ``Sensor(..r), r.sensor``: each of their columns becomes a variable.

SQLite has no row values, and no list of the columns that a call leaves out. ``P(..r)`` becomes
``P(a: r_a, b: r_b), r = {a: r_a, b: r_b}`` where the columns of ``P`` are known.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.checking.parameters import filled_in
from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.compiling.rules import (
    VALUE,
    fields,
    head_name,
    heads,
    nodes,
    prelude_rules,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.program import INPUTS

if TYPE_CHECKING:
    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["written_out"]

_REST = "*"
_ROUNDS = 10  # how far columns are traced from predicate to predicate


def written_out(rules: list[Rule]) -> None:
    """Expand whole rows in place, where their columns are known."""
    if not any(_REST in fields(node) for node in nodes(rules) if "field_value" in node):
        return
    columns = _columns(rules)
    for rule in rules:
        if not head_name(rule).startswith("@"):
            _in_rule(rule, columns)


def _columns(rules: list[Rule]) -> dict[str, list[str]]:
    """Return the columns of predicates that have the same named columns in all rules."""
    open_ = {name for rule in rules for name in filled_in(rule)}
    known = {name: list(columns) for name, columns in INPUTS.items()}
    own = {**heads(list(prelude_rules())), **heads(rules)}
    for _ in range(_ROUNDS):
        before = len(known)
        for name, mine in own.items():
            found = [_columns_of(rule, known) for rule in mine]
            first = found[0]
            is_new = name not in known and name not in open_
            if is_new and first is not None and all(columns == first for columns in found):
                known[name] = first
        if len(known) == before:
            break
    return known


def _columns_of(rule: Rule, known: dict[str, list[str]]) -> list[str] | None:
    """Return the columns in the head of a rule, or None if some have no names."""
    columns: list[str] = []
    for fv in rule["head"]["record"]["field_value"]:
        if fv["field"] == _REST:
            rest = _row(fv, _rows(rule, known))
            if rest is None:
                return None
            columns += [name for name in rest if name not in columns]
        elif isinstance(fv["field"], int) or fv["field"] == VALUE:
            return None
        else:
            columns.append(fv["field"])
    return None if head_name(rule).startswith("@") else columns


def _rows(rule: Rule, known: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return the variables for whole rows in a body, with their columns."""
    return {
        str((value_of(fv) or {})["variable"]["var_name"]): _left(node["predicate"], known)
        for node in nodes(rule)
        if (fv := _rest_of(node.get("predicate"), known)) is not None
    }


def _rest_of(call: Any, known: dict[str, list[str]]) -> Rule | None:
    """Return the ``..r`` of a call of a predicate with known columns."""
    if not isinstance(call, dict) or call["predicate_name"] not in known:
        return None
    rest = [fv for fv in call["record"]["field_value"] if fv["field"] == _REST]
    return rest[0] if rest and "variable" in (value_of(rest[0]) or {}) else None


def _left(call: Rule, known: dict[str, list[str]]) -> list[str]:
    """Return the columns that a call does not name."""
    named = fields(call["record"])
    return [name for name in known[call["predicate_name"]] if name not in named]


def _row(fv: Rule, rows: dict[str, list[str]]) -> list[str] | None:
    return rows.get(variable_of(value_of(fv) or {}))


def _in_rule(rule: Rule, known: dict[str, list[str]]) -> None:
    rows = _rows(rule, known)
    taken = {n["variable"]["var_name"] for n in nodes(rule) if "variable" in n}

    def variables(row: str, columns: list[str]) -> dict[str, str]:
        mark = "_of_row"
        while any(name.endswith(mark) for name in taken):
            mark += "_"
        return {column: f"{row}_{column}{mark}" for column in columns}

    head = rule["head"]["record"]
    for fv in [fv for fv in head["field_value"] if fv["field"] == _REST]:
        if (columns := _row(fv, rows)) is not None:
            row = (value_of(fv) or {})["variable"]["var_name"]
            left = [column for column in columns if column not in fields(head)]
            _replace_rest(head, fv, variables(row, left))
    for conjuncts in [node["conjunct"] for node in nodes(rule) if "conjunct" in node]:
        for conjunct in list(conjuncts):
            rest = _rest_of(conjunct.get("predicate"), known)
            if rest is not None:
                row = (value_of(rest) or {})["variable"]["var_name"]
                names = variables(row, _left(conjunct["predicate"], known))
                _replace_rest(conjunct["predicate"]["record"], rest, names)
                conjuncts.append(_is_record(row, names))


def _replace_rest(record: Rule, rest: Rule, names: dict[str, str]) -> None:
    record["field_value"].remove(rest)
    record["field_value"] += trees.fields(_variables(names))


def _variables(names: dict[str, str]) -> dict[str, Rule]:
    return {column: _variable(name) for column, name in names.items()}


def _variable(name: str) -> Rule:
    return {**trees.variable(name), "expression_heritage": name}


def _is_record(row: str, names: dict[str, str]) -> Rule:
    """Return the condition that a row is the record of its columns."""
    record = {**trees.record(_variables(names)), "expression_heritage": row}
    return trees.equal(_variable(row), record)
