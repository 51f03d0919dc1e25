"""Rewrites of the syntax tree that SQL templates can't express: types, truths as text, whole rows.

SQLite has no row values, and no list of the columns that a call leaves out. So ``P(..r)`` becomes
``P(a: r_a, b: r_b), r = {a: r_a, b: r_b}`` where the columns of ``P`` are known.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.compiling.rules import (
    TRUTHS,
    fields,
    filled_in,
    head_name,
    heads,
    nodes,
    predicate_of,
    prelude_rules,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.diagnostics import ProgramError
from logical_robots_tui.mind.program import INPUTS, VALUE
from logical_robots_tui.mind.source_text import diagnostic_for
from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from logical_robots_tui.mind.compiling.rules import Rule

TYPES = {
    "BIGINT": "Int",
    "BOOL": "Bool",
    "BOOLEAN": "Bool",
    "DOUBLE": "Num",
    "FLOAT": "Num",
    "FLOAT64": "Num",
    "INT": "Int",
    "INT64": "Int",
    "INTEGER": "Int",
    "NUM": "Num",
    "NUMERIC": "Num",
    "STR": "Str",
    "STRING": "Str",
    "TEXT": "Str",
    "VARCHAR": "Str",
}
"""Accepted names of types, in upper case, and their name here."""


_CAST_HINT = 'Such as TryCast(memory, {count: 0, seen: [""]}), or types: {count: Num, seen: [Str]}.'


def spell_out(rules: list[Rule], text: str) -> None:
    """Replace, in place, the type in `TryCast` by its text, and `ToString` of a boolean.

    Raises:
        ProgramError: A `TryCast` does not have two arguments.
    """
    found = (node["call"] for node in nodes(rules) if "call" in node)
    for call in reversed([*found]):  # inner ones first
        values = call["record"]["field_value"]
        if call["predicate_name"] == "ToString" and len(values) == 1:
            if _is_truth(values[0]["value"].get("expression", {})):
                call["predicate_name"] = "TruthToString"
        elif call["predicate_name"] == "TryCast":
            if len(values) != 2:
                message = "TryCast needs a value and an example of the result"
                name = call["predicate_name"]
                raise ProgramError((diagnostic_for(text, name, message, _CAST_HINT),))
            _name_type(call, values[1]["value"])


def _name_type(call: dict[str, Any], second: dict[str, Any]) -> None:
    """Pass the type of a `TryCast` as text; in an example, a type becomes a value of that type."""
    try:
        wanted = to_json(_type(second["expression"]))
    except KeyError:
        second["expression"] = _with_samples(second["expression"])
        return
    first = call["record"]["field_value"][0]
    given = trees.record({"t": trees.text(wanted)})
    given["record"]["field_value"].insert(0, {**first, "field": "v"})
    call["predicate_name"] = "SqlExpr"
    template = trees.text("try_cast({v}, {t})")
    call["record"]["field_value"] = trees.fields({0: template, 1: given})


_SAMPLES = {
    "Num": {"the_number": {"number": "0"}},
    "Int": {"the_number": {"number": "0"}},
    "Str": {"the_string": {"the_string": ""}},
    "Bool": {"the_bool": {"the_bool": "true"}},
}


def _with_samples(tree: Any) -> Any:
    if isinstance(tree, list):
        return [_with_samples(branch) for branch in tree]
    if not isinstance(tree, dict):
        return tree
    if sample := _SAMPLES.get(TYPES.get(predicate_of(tree).upper(), "")):
        return {**tree, "literal": sample}
    return {key: _with_samples(branch) for key, branch in tree.items()}


def _is_truth(expression: dict[str, Any]) -> bool:
    if "literal" in expression:
        return "the_bool" in expression["literal"]
    return expression.get("call", {}).get("predicate_name") in TRUTHS


def _type(expression: dict[str, Any]) -> Any:
    """Return the type that an expression names: ``{a: Num}``, ``[Str]``, ``Bool``, ``"BIGINT"``.

    Raises:
        KeyError: It is not a type but an example.
    """
    if "record" in expression:
        fields = expression["record"]["field_value"]
        if any("expression" not in field["value"] for field in fields):
            raise KeyError("expression")
        return {f["field"]: _type(f["value"]["expression"]) for f in fields}
    literal = expression["literal"]
    if "the_list" in literal:
        elements = literal["the_list"]["element"]
        return [_type(elements[0] if len(elements) == 1 else {})]
    if "the_predicate" in literal:
        return TYPES[str(predicate_of(expression)).upper()]
    return _sql_type(str(literal["the_string"]["the_string"]))


def _sql_type(spelled: str) -> Any:
    """Return the type that an SQL text describes, such as ``STRUCT(a BIGINT, b VARCHAR[])``."""
    spelled = spelled.strip()
    if spelled.endswith("[]"):
        return [_sql_type(spelled[:-2])]
    if found := re.fullmatch(r"(?is)struct\s*\((.*)\)", spelled):
        fields = (part.strip().split(None, 1) for part in _parts(found.group(1)))
        return {field[0].strip('"'): _sql_type(field[1]) for field in fields if len(field) == 2}
    return TYPES[spelled.upper()]


def _parts(text: str) -> list[str]:
    parts, depth = [""], 0
    for character in text:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and not depth:
            parts.append("")
        else:
            parts[-1] += character
    return parts


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
