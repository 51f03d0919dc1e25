"""Parts of a program that are written out before it is compiled: functors, casts, whole rows.

SQLite has no row values, and no list of the columns that a call leaves out. So ``P(..r)`` becomes
``P(a: r_a, b: r_b), r = {a: r_a, b: r_b}`` where the columns of ``P`` are known.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeAlias, TypeVar

from logical_robots_tui.language import tree
from logical_robots_tui.language.adapter import types_on_duckdb
from logical_robots_tui.language.definitions import Model, prelude, reach, rules_of
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import Prepared, diagnostic_at
from logical_robots_tui.language.tree import Span
from logical_robots_tui.schema import INPUTS, VALUE

N = TypeVar("N", bound=tree.Node)


@dataclass(frozen=True, slots=True)
class Expanded:
    """The rules of a program with every ``:=`` expanded.

    Attributes:
        rules: The rules of each predicate, including copies made by ``:=``.
        names: The name of the copy, by predicate and the made predicate that it belongs to.
        origins: The reverse of `names`.
        bases: For each made predicate, the one that it is ultimately made from.
    """

    rules: dict[str, list[tree.Rule]]
    annotations: list[tree.Annotation]
    names: dict[tuple[str, str], str] = field(default_factory=dict)
    origins: dict[str, tuple[str, str]] = field(default_factory=dict)
    bases: dict[str, str] = field(default_factory=dict)

    def name_of(self, predicate: str, within: str) -> str:
        return self.names.get((predicate, within), predicate)

    def reach(self, name: str) -> set[str]:
        return reach(self.rules.get(name, ()), self.rules)


def expand(model: Model) -> Expanded:
    functors: dict[str, tree.Functor] = {}
    rules: dict[str, list[tree.Rule]] = {}
    for name, statements in model.definitions.items():
        if isinstance(statements[0], tree.Functor):
            functors[name] = statements[0]
        else:
            rules[name] = rules_of(statements)
    expanded = Expanded(rules, model.annotations)
    while functors:
        ready = []
        for name, functor in functors.items():
            values = (argument.value for argument in functor.arguments)
            callees = {functor.base, *(v.name for v in values if isinstance(v, tree.PredicateName))}
            if not callees.union(*map(expanded.reach, callees)) & functors.keys():
                ready.append(name)
        for name in ready or list(functors):
            _make(functors.pop(name), expanded)
    return expanded


def expand_functors(program: list[tree.Statement]) -> list[tree.Statement]:
    """Expand every ``:=`` if the package can't: one copies a recursion, or there are whole rows."""
    if not any(isinstance(statement, tree.Functor) for statement in program):
        return program
    expanded = expand(Model(program))
    bases = {**expanded.bases, **{copy: first for copy, (first, _) in expanded.origins.items()}}
    recursive = {name for name in expanded.rules if name in expanded.reach(name)}
    if not tree.has_rows(program) and not recursive & {*bases, *bases.values()}:
        return program
    copies = [
        rename(annotation, {original: name})
        for name, original in bases.items()
        for annotation in expanded.annotations
        if annotation.subject == original and (annotation.name != "@Recursive" or name in recursive)
    ]
    rules = (rule for group in expanded.rules.values() for rule in group)
    return [*expanded.annotations, *copies, *rules]


def _make(functor: tree.Functor, expanded: Expanded) -> None:
    name, base = functor.name, functor.base
    names = {}
    for number, argument in enumerate(functor.arguments):
        if isinstance(argument.value, tree.PredicateName):
            names[str(argument.field)] = argument.value.name
        else:
            constant = f"{name}_given{number}"
            names[str(argument.field)] = constant
            columns = (tree.Argument(VALUE, argument.value),)
            expanded.rules[constant] = [tree.Rule(tree.Head(constant, columns))]
    expanded.bases[name] = expanded.bases.get(base, base)
    if not names and base in expanded.reach(base) and expanded.rules.get(base):
        fields = [column.field for column in expanded.rules[base][0].head.columns]
        values = tree.arguments({c: tree.Variable(f"c{n}") for n, c in enumerate(fields)})
        expanded.rules[name] = [tree.Rule(tree.Head(name, values), tree.Atom(base, values))]
        return
    reachable = {base, *expanded.reach(base)}
    affected = {p for p in reachable - names.keys() if expanded.reach(p) & names.keys()} | {base}
    copies = {p: f"{p}_in_{name}" for p in affected if p in expanded.rules} | {base: name}
    renaming = {f"{old}": f"{new}" for old, new in {**copies, **names}.items()}
    for original, copy in copies.items():
        expanded.rules[copy] = [
            replace(renamed, head=replace(renamed.head, name=f"{copy}"))
            for renamed in (rename(rule, renaming) for rule in expanded.rules.get(original, ()))
        ]
        if copy != name:
            first = expanded.origins.get(original, (original, ""))[0]
            expanded.names[first, name] = copy
            expanded.origins[copy] = first, name


def rename(node: N, names: Mapping[str, str]) -> N:
    """Return a node that calls other predicates."""

    def change(inner: tree.Node) -> tree.Node:
        inner = tree.rebuild(inner, change)
        if isinstance(inner, tree.Call | tree.Atom | tree.PredicateName) and inner.name in names:
            return replace(inner, name=names[inner.name])
        if isinstance(inner, tree.Aggregate | tree.Aggregation) and inner.operator in names:
            return replace(inner, operator=names[inner.operator])
        return inner

    return change(node)  # type: ignore[return-value]  # a kind for its kind


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

_UNKNOWN = ("Any", "Singular", "Sequential")
"""Types of the package's inference that say nothing of a value."""

OPEN_LIST = "The empty list in this example could hold anything"
OPEN_LIST_HINT = 'Give it an element, such as [""], or a type: e = {seen: []}, e ~ {seen: [Str]}.'
CAST_HINT = 'Write TryCast(memory, {count: 0, seen: [""]}), or types: {count: Num, seen: [Str]}.'


def spell_out(program: Sequence[tree.Statement], source: Prepared) -> list[tree.Statement]:
    """Replace the type in a cast by its text, and `ToString` of a boolean.

    Raises:
        ProgramError: A cast does not have two arguments, or the type of an empty list in its
            example can't be told.
    """
    examples = _Examples(program, source)

    def change(node: tree.Node) -> tree.Node:
        node = tree.rebuild(node, change)
        if isinstance(node, tree.Call) and node.name == "ToString" and len(node.arguments) == 1:
            value = node.arguments[0].value
            is_call = isinstance(value, tree.Call) and value.name in tree.TRUTHS
            is_truth = is_call or isinstance(value, tree.Boolean)
            return replace(node, name="TruthToString") if is_truth else node
        if isinstance(node, tree.Call) and node.name in ("Cast", "TryCast"):
            if len(node.arguments) != 2:
                message = f"{node.name} needs a value and an example of the result"
                start: int = getattr(node.name, "start", 0)
                length = len(node.name)
                problem = diagnostic_at(source.original, start, length, message, CAST_HINT)
                raise ProgramError((problem,))
            return _with_type_as_text(node, examples)
        return node

    return [tree.rebuild(statement, change) for statement in program]


def _with_type_as_text(cast: tree.Call, examples: _Examples) -> tree.Call:
    """Pass the type of a cast as text; in an example, a type becomes a value of that type."""
    value, example = cast.arguments
    assert example.expression is not None
    try:
        kind = written_type(example.expression)
    except KeyError:
        kind = examples.kind(example.expression)
    if kind is None:
        return replace(
            cast, name="TryCast", arguments=(value, tree.rebuild(example, _with_samples))
        )
    type_text = tree.Text(json.dumps(kind, separators=(",", ":"), ensure_ascii=False))
    record = tree.Record((replace(value, field="v"), tree.Argument("t", type_text)))
    return replace(
        cast,
        name="SqlExpr",
        arguments=tree.arguments({0: tree.Text("try_cast({v}, {t})"), 1: record}),
    )


class _Examples:
    """The types of examples, from all that a program does with them, as DuckDB knows them."""

    def __init__(self, program: Sequence[tree.Statement], source: Prepared) -> None:
        self._program = program
        self._source = source

    def kind(self, example: tree.Expression) -> Any:
        """Return the type of an example, or None if its value shows it.

        Raises:
            ProgramError: It has a list of unknown elements.
        """
        if example.span is None or _is_typed(example):
            return None
        text, (start, stop) = self._source.original, example.span
        open_list = diagnostic_at(text, start, stop - start, OPEN_LIST, OPEN_LIST_HINT)
        try:
            return _cast_type(self._kinds.get(example.span), open_list)
        except KeyError:
            return None

    @cached_property
    def _kinds(self) -> dict[Span, Any]:
        """Types by place, None where they differ, as between rules that functors copy."""
        rules = [_name_constants(rule) for rule in rules_of(self._program)]
        kinds: dict[Span, Any] = {}
        for span, kind in types_on_duckdb(rules, self._source):
            kinds[span] = kind if kinds.get(span, kind) == kind else None
        return kinds


def _name_constants(rule: tree.Rule) -> tree.Rule:
    """Replace all calls of ``E()`` in a rule by one variable, so that they have one type."""
    constants: dict[str, tree.Call] = {}

    def change(node: tree.Node) -> tree.Node:
        if isinstance(node, tree.Call) and not node.arguments:
            constants[node.name] = node
            return tree.Variable(f"{node.name}()", span=node.span)
        return tree.rebuild(node, change)

    rewritten = tree.rebuild(rule, change)
    if rewritten.body is None:
        return rule
    equations = (tree.Equation(tree.Variable(f"{name}()"), constants[name]) for name in constants)
    return replace(rewritten, body=tree.Conjunction((rewritten.body, *equations)))


def _cast_type(kind: Any, open_list: Diagnostic) -> Any:
    """Return a type of the package's inference as `try_cast` reads it.

    Raises:
        ProgramError: It has a list of unknown elements.
        KeyError: It is unknown.
    """
    if isinstance(kind, list):
        (element,) = kind
        if element in _UNKNOWN:
            raise ProgramError((open_list,))
        return [_cast_type(element, open_list)]
    if isinstance(kind, dict):
        return {name: _cast_type(kind[name], open_list) for name in sorted(kind)}
    return TYPES[str(kind).upper()]


def _is_typed(example: tree.Expression) -> bool:
    if isinstance(example, tree.Record):
        return all(a.expression is None or _is_typed(a.expression) for a in example.arguments)
    if isinstance(example, tree.List):
        return bool(example.elements) and _is_typed(example.elements[0])
    return isinstance(example, tree.Boolean | tree.Number | tree.PredicateName | tree.Text)


_SAMPLES: dict[str, tree.Expression] = {
    "Num": tree.Number("0"),
    "Int": tree.Number("0"),
    "Str": tree.Text(""),
    "Bool": tree.Boolean("true"),
}


def _with_samples(node: tree.Node) -> tree.Node:
    if isinstance(node, tree.PredicateName) and (kind := TYPES.get(node.name.upper())):
        return replace(_SAMPLES[kind], span=node.span)
    return tree.rebuild(node, _with_samples)


def written_type(node: tree.Expression) -> Any:
    """Return a type: ``{a: Num}``, ``[Str]``, ``Bool``, ``"BIGINT"``; else raise KeyError."""
    if isinstance(node, tree.Record):
        return {str(a.field): written_type(a.expression) for a in node.arguments if a.expression}
    if isinstance(node, tree.List) and len(node.elements) == 1:
        return [written_type(node.elements[0])]
    if isinstance(node, tree.PredicateName):
        return TYPES[node.name.upper()]
    if isinstance(node, tree.Text):
        return _sql_type(node.value)
    raise KeyError(type(node).__name__)


def _sql_type(text: str) -> Any:
    text = text.strip()
    if text.endswith("[]"):
        return [_sql_type(text[:-2])]
    if match := re.fullmatch(r"(?is)struct\s*\((.*)\)", text):
        fields = (part.strip().split(None, 1) for part in _parts(match.group(1)))
        return {field[0].strip('"'): _sql_type(field[1]) for field in fields if len(field) == 2}
    return TYPES[text.upper()]


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


def expand_rows(program: list[tree.Statement]) -> list[tree.Statement]:
    """Expand whole rows, where their columns are known."""
    if not tree.has_rows(program):
        return program
    columns = _columns(program)
    return [
        _RowExpander(statement, columns).rule() if isinstance(statement, tree.Rule) else statement
        for statement in program
    ]


def _columns(program: Sequence[tree.Statement]) -> dict[str, list[Field]]:
    model = Model(program)
    tables: dict[str, list[Field]] = {name: [*columns] for name, columns in INPUTS.items()}
    predicates = {**prelude().definitions, **model.definitions}
    for _ in range(_ROUNDS):
        size = len(tables)
        for name, statements in predicates.items():
            candidates = [_columns_of(statement, tables) for statement in statements]
            first = candidates[0]
            is_new = name not in tables and name not in model.substituted
            if is_new and first is not None and all(columns == first for columns in candidates):
                tables[name] = first
        if len(tables) == size:
            break
    return tables


def _columns_of(
    rule: tree.Rule | tree.Functor, tables: Mapping[str, list[Field]]
) -> list[Field] | None:
    if not isinstance(rule, tree.Rule):
        return None
    columns: list[Field] = []
    rows = _rows(rule, tables)
    for column in rule.head.columns:
        if column.field == tree.REST:
            row = rows.get(tree.variable_of(column.expression))
            if row is None:
                return None
            columns += [name for name in row if name not in columns]
        else:
            columns.append(column.field)
    return columns


def _rows(rule: tree.Rule, tables: Mapping[str, list[Field]]) -> dict[str, list[Field]]:
    return {
        row: _remaining_columns(node, tables)
        for node in tree.walk(rule)
        if isinstance(node, tree.Atom) and (row := _row_of(node, tables))
    }


def _row_of(atom: tree.Atom, tables: Mapping[str, list[Field]]) -> str:
    """Return the variable of ``..r`` in a call of a predicate with known columns, or ""."""
    if atom.name not in tables:
        return ""
    return next(
        (tree.variable_of(a.expression) for a in atom.arguments if a.field == tree.REST), ""
    )


def _remaining_columns(atom: tree.Atom, tables: Mapping[str, list[Field]]) -> list[Field]:
    names = {argument.field for argument in atom.arguments}
    return [name for name in tables[atom.name] if name not in names]


class _RowExpander:
    """Expands the whole rows of a rule."""

    def __init__(self, rule: tree.Rule, tables: Mapping[str, list[Field]]) -> None:
        self._rule, self._tables = rule, tables
        self._rows = _rows(rule, tables)
        self._mark = "_of_row"
        while any(name.endswith(self._mark) for name in tree.variables(rule, inside=True)):
            self._mark += "_"

    def rule(self) -> tree.Rule:
        rule = tree.rebuild(self._rule, self._change)
        columns = rule.head.columns
        names = {column.field for column in columns}
        for row_column in [column for column in columns if column.field == tree.REST]:
            row = tree.variable_of(row_column.expression)
            if row in self._rows:
                remaining = [name for name in self._rows[row] if name not in names]
                columns = _replace_row(columns, row_column, self._variables(row, remaining))
        return replace(rule, head=replace(rule.head, columns=columns))

    def _change(self, node: tree.Node) -> tree.Node:
        if isinstance(node, tree.Conjunction | tree.Atom):
            rows: list[tree.Proposition] = []
            members = node.members if isinstance(node, tree.Conjunction) else (node,)
            new_members = [self._member(member, rows) for member in members]
            if isinstance(node, tree.Conjunction) or rows:
                return tree.Conjunction((*new_members, *rows), span=node.span)
            return new_members[0]
        return tree.rebuild(node, self._change)

    def _member(self, member: tree.Proposition, rows: list[tree.Proposition]) -> tree.Proposition:
        """Return a member of a body expanded, and add the equation of its row."""
        if not isinstance(member, tree.Atom):
            return self._change(member)  # type: ignore[return-value]  # a kind for its kind
        if row := _row_of(member, self._tables):
            row_argument = next(a for a in member.arguments if a.field == tree.REST)
            values = self._variables(row, _remaining_columns(member, self._tables))
            arguments = _replace_row(member.arguments, row_argument, values)
            member = replace(member, arguments=arguments)
            rows.append(tree.Equation(tree.Variable(row), tree.Record(tree.arguments(values))))
        return tree.rebuild(member, self._change)

    def _variables(self, row: str, columns: Iterable[Field]) -> dict[Field, tree.Expression]:
        return {column: tree.Variable(f"{row}_{column}{self._mark}") for column in columns}


def _replace_row(
    arguments: tuple[tree.Argument, ...],
    row: tree.Argument,
    values: Mapping[Field, tree.Expression],
) -> tuple[tree.Argument, ...]:
    return (*(a for a in arguments if a is not row), *tree.arguments(values))
