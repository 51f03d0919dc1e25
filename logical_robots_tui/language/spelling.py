"""Rewrites of the tree that SQL templates can't express: types, truths as text, whole rows.

SQLite has no row values, and no list of the columns that a call leaves out. So ``P(..r)`` becomes
``P(a: r_a, b: r_b), r = {a: r_a, b: r_b}`` where the columns of ``P`` are known.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from logical_robots_tui.language.definitions import definitions, prelude, substitutions
from logical_robots_tui.language.diagnostics import ProgramError
from logical_robots_tui.language.source_text import diagnostic_for
from logical_robots_tui.language.tree import (
    REST,
    TRUTHS,
    Argument,
    Atom,
    Boolean,
    Call,
    Conjunction,
    Equation,
    Expression,
    Functor,
    List,
    Node,
    Number,
    PredicateName,
    Proposition,
    Record,
    Rule,
    Statement,
    Text,
    Variable,
    arguments,
    has_rows,
    rebuild,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.schema import INPUTS

Field: TypeAlias = "int | str"
"""A column by place or name."""

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
    "REAL": "Num",
    "STR": "Str",
    "STRING": "Str",
    "TEXT": "Str",
    "VARCHAR": "Str",
}
"""Accepted names of types, in upper case, and their name here."""

CAST_HINT = 'Such as TryCast(memory, {count: 0, seen: [""]}), or types: {count: Num, seen: [Str]}.'


def spell_out(program: Iterable[Statement], text: str) -> list[Statement]:
    """Replace the type in a cast by its text, and `ToString` of a boolean.

    Raises:
        ProgramError: A cast does not have two arguments.
    """

    def change(node: Node) -> Node:
        node = rebuild(node, change)
        if isinstance(node, Call) and node.name == "ToString" and len(node.arguments) == 1:
            return replace(node, name="TruthToString") if _is_truth(node.arguments[0]) else node
        if isinstance(node, Call) and node.name in ("Cast", "TryCast"):
            if len(node.arguments) != 2:
                message = f"{node.name} needs a value and an example of the result"
                raise ProgramError((diagnostic_for(text, node.name, message, CAST_HINT),))
            return _with_type_as_text(node)
        return node

    return [rebuild(statement, change) for statement in program]


def _with_type_as_text(cast: Call) -> Call:
    """Pass the type of a cast as text; in an example, a type becomes a value of that type."""
    value, example = cast.arguments
    assert example.expression is not None
    try:
        wanted = Text(
            json.dumps(written_type(example.expression), separators=(",", ":"), ensure_ascii=False)
        )
    except KeyError:
        sample = replace(example, value=_with_samples(example.expression))
        return replace(cast, name="TryCast", arguments=(value, sample))
    given = Record((replace(value, field="v"), Argument("t", wanted)))
    return replace(
        cast, name="SqlExpr", arguments=arguments({0: Text("try_cast({v}, {t})"), 1: given})
    )


_SAMPLES: dict[str, Expression] = {
    "Num": Number("0"),
    "Int": Number("0"),
    "Str": Text(""),
    "Bool": Boolean("true"),
}


def _with_samples(node: Expression) -> Expression:
    def change(inner: Node) -> Node:
        if isinstance(inner, PredicateName):
            sample = _SAMPLES.get(TYPES.get(inner.name.upper(), ""))
            return inner if sample is None else replace(sample, span=inner.span)
        return rebuild(inner, change)

    return change(node)  # type: ignore[return-value]  # an expression for an expression


def _is_truth(argument: Argument) -> bool:
    value = argument.value
    return isinstance(value, Boolean) or (isinstance(value, Call) and value.name in TRUTHS)


def written_type(node: Expression) -> Any:
    """Return a type: ``{a: Num}``, ``[Str]``, ``Bool``, ``"BIGINT"``; else raise KeyError."""
    if isinstance(node, Record):
        return {str(a.field): written_type(a.expression) for a in node.arguments if a.expression}
    if isinstance(node, List) and len(node.elements) == 1:
        return [written_type(node.elements[0])]
    if isinstance(node, PredicateName):
        return TYPES[node.name.upper()]
    if isinstance(node, Text):
        return _sql_type(node.value)
    raise KeyError(type(node).__name__)


def _sql_type(spelled: str) -> Any:
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


_ROUNDS = 10  # how far columns are traced from predicate to predicate


def expand_rows(program: list[Statement]) -> list[Statement]:
    """Expand whole rows, where their columns are known."""
    if not has_rows(program):
        return program
    columns = _columns(program)
    return [_Rows(each, columns).rule() if isinstance(each, Rule) else each for each in program]


def _columns(program: Sequence[Statement]) -> dict[str, list[Field]]:
    open_ = {name for each in program for name in substitutions(each)}
    known: dict[str, list[Field]] = {name: [*columns] for name, columns in INPUTS.items()}
    own = {**definitions(prelude()), **definitions(program)}
    for _ in range(_ROUNDS):
        before = len(known)
        for name, mine in own.items():
            found = [_columns_of(each, known) for each in mine]
            first = found[0]
            is_new = name not in known and name not in open_
            if is_new and first is not None and all(columns == first for columns in found):
                known[name] = first
        if len(known) == before:
            break
    return known


def _columns_of(rule: Rule | Functor, known: Mapping[str, list[Field]]) -> list[Field] | None:
    if not isinstance(rule, Rule):
        return None
    columns: list[Field] = []
    rows = _rows(rule, known)
    for each in rule.head.columns:
        if each.field == REST:
            rest = rows.get(variable_of(each.expression))
            if rest is None:
                return None
            columns += [name for name in rest if name not in columns]
        else:
            columns.append(each.field)
    return columns


def _rows(rule: Rule, known: Mapping[str, list[Field]]) -> dict[str, list[Field]]:
    return {
        row: _left(node, known)
        for node in walk(rule)
        if isinstance(node, Atom) and (row := _row_of(node, known))
    }


def _row_of(atom: Atom, known: Mapping[str, list[Field]]) -> str:
    """Return the variable of ``..r`` in a call of a predicate with known columns, or ""."""
    if atom.name not in known:
        return ""
    return next((variable_of(a.expression) for a in atom.arguments if a.field == REST), "")


def _left(atom: Atom, known: Mapping[str, list[Field]]) -> list[Field]:
    named = {each.field for each in atom.arguments}
    return [name for name in known[atom.name] if name not in named]


class _Rows:
    """Expands the whole rows of a rule."""

    def __init__(self, rule: Rule, known: Mapping[str, list[Field]]) -> None:
        self._rule, self._known = rule, known
        self._rows = _rows(rule, known)
        self._mark = "_of_row"
        while any(name.endswith(self._mark) for name in variables(rule, inside=True)):
            self._mark += "_"

    def rule(self) -> Rule:
        rule = rebuild(self._rule, self._change)
        columns = rule.head.columns
        named = {each.field for each in columns}
        for rest in [each for each in columns if each.field == REST]:
            row = variable_of(rest.expression)
            if row in self._rows:
                left = [name for name in self._rows[row] if name not in named]
                columns = _without(columns, rest, self._variables(row, left))
        return replace(rule, head=replace(rule.head, columns=columns))

    def _change(self, node: Node) -> Node:
        if isinstance(node, Conjunction | Atom):
            rows: list[Proposition] = []
            members = node.members if isinstance(node, Conjunction) else (node,)
            changed = [self._member(member, rows) for member in members]
            if isinstance(node, Conjunction) or rows:
                return Conjunction((*changed, *rows), span=node.span)
            return changed[0]
        return rebuild(node, self._change)

    def _member(self, member: Proposition, rows: list[Proposition]) -> Proposition:
        """Return a member of a body expanded, and add the equation of its row."""
        if not isinstance(member, Atom):
            return self._change(member)  # type: ignore[return-value]  # a kind for its kind
        if row := _row_of(member, self._known):
            rest = next(each for each in member.arguments if each.field == REST)
            named = self._variables(row, _left(member, self._known))
            member = replace(member, arguments=_without(member.arguments, rest, named))
            rows.append(Equation(Variable(row), Record(arguments(named))))
        return rebuild(member, self._change)

    def _variables(self, row: str, columns: Iterable[Field]) -> dict[Field, Expression]:
        return {column: Variable(f"{row}_{column}{self._mark}") for column in columns}


def _without(
    given: tuple[Argument, ...], rest: Argument, named: Mapping[Field, Expression]
) -> tuple[Argument, ...]:
    return (*(each for each in given if each is not rest), *arguments(named))
