"""Columns of predicates, and whether all rules and calls agree about them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import (
    Model,
    arity,
    calls,
    is_built_in,
    prelude,
    rules_of,
)
from logical_robots_tui.language.diagnostics import Diagnostic, Proposal, closest
from logical_robots_tui.language.source_text import distinct_after_head
from logical_robots_tui.schema import INPUTS, MAIN, VALUE

Runs = Callable[[str], bool]
"""Whether a built-in function works in SQLite."""


@dataclass(frozen=True, slots=True)
class Signature:
    """A predicate's columns; `required`: the positional ones that its value depends on."""

    count: int
    named: frozenset[str]
    has_value: bool
    required: frozenset[int] = frozenset()

    def __str__(self) -> str:
        positional = [f"argument {i + 1}" for i in range(self.count)]
        columns = ", ".join([*positional, *(f"{name}:" for name in sorted(self.named))])
        return f"({columns})" + (" = value" if self.has_value else "")


def signatures(model: Model) -> dict[str, Signature]:
    catalog = {name: Signature(0, frozenset(columns), False) for name, columns in INPUTS.items()}
    for name, statements in {**prelude().definitions, **model.definitions}.items():
        candidates = {_signature(statement) for statement in statements}
        signature = candidates.pop()
        if signature and not candidates:
            catalog[name] = signature
    return catalog


_ALL_DISTINCT = "Write distinct in all of its heads, or in none."
_GIVEN = (tree.PredicateName, tree.Literal)


def wrong_copies(model: Model) -> Iterator[Diagnostic]:
    """Report arguments of functors that are neither predicates' names nor constants."""
    for functor in model.functors:
        for argument in functor.arguments:
            value = argument.value
            if value.span is not None and not isinstance(value, _GIVEN):
                message = "A copy takes a predicate by its name, or a constant"
                hint = "Define a predicate with this value, and write its name here."
                yield model.diagnostic(value.span, message, hint)


def collisions(model: Model) -> Iterator[Diagnostic]:
    for name, (first, *statements) in model.definitions.items():
        is_function = isinstance(first, tree.Rule) and first.head.column(VALUE)
        if name.isidentifier() and is_built_in(name):
            uses = (isinstance(call, tree.Call) and call.name == name for call in model.calls)
            if is_function or any(uses):
                message = f"{name} is built in; this definition would be ignored"
                yield model.diagnostic(name, message, "Give your predicate another name.")
        for statement in statements:
            line = model.text.count("\n", 0, max(0, getattr(name, "start", 0))) + 1
            if difference := _difference(first, statement, line):
                message, hint = difference
                problem = model.diagnostic(statement.name, f"{name} {message}", hint)
                for rule in rules_of([first, statement]) if hint == _ALL_DISTINCT else ():
                    if rule.span and not rule.is_distinct:
                        fix = distinct_after_head(model.source, *rule.span)
                        problem = replace(problem, fix=fix)
                yield replace(problem, related=(line,))
                break


def wrong_calls(model: Model, catalog: Mapping[str, Signature], runs: Runs) -> Iterator[Diagnostic]:
    predicates = model.definitions
    reachable = {MAIN, *model.reach(MAIN)} if MAIN in predicates else {*predicates}
    for rule in model.rules:
        for call in calls(rule):
            name, for_value = call.name, isinstance(call, tree.Call)
            if name in catalog and not (for_value and is_built_in(name)):
                is_parameter = name in model.substituted
                yield from _wrong_call(call, catalog[name], model, is_parameter=is_parameter)
                if for_value and catalog[name].has_value and rule.name in reachable:
                    yield from _missing_arguments(call, catalog[name], model)
            elif (
                for_value
                and name not in predicates
                and name[:1].isupper()  # not an operator
                and is_built_in(name)
                and runs(name)
            ):
                yield from _wrong_built_in(call, model)


def duplicates(model: Model) -> Iterator[Diagnostic]:
    for node in tree.walk(model.statements):
        names = set()
        for child in tree.children(node):
            name = child.field if isinstance(child, tree.Argument) else 0
            if isinstance(name, str) and name in names and name != tree.REST:
                hint = "Remove one, or join the conditions with ','."
                yield model.diagnostic(name, f"{name} is given twice here", hint)
            names.add(name)


def _signature(rule: tree.Rule | tree.Functor) -> Signature | None:
    if isinstance(rule, tree.Functor):
        return None
    columns = [column.field for column in rule.head.columns]
    if tree.REST in columns:
        return None
    positional = sum(isinstance(c, int) for c in columns)
    while f"col{positional}" in columns:  # an aggregated one needs a name
        columns.remove(f"col{positional}")
        positional += 1
    named = frozenset(str(c) for c in columns if isinstance(c, str))
    value = None if rule.body else rule.head.column(VALUE)
    names = tree.variables(value, inside=True) if value else ()
    required = frozenset(
        column.field
        for column in rule.head.columns
        if isinstance(column.field, int) and tree.variable_of(column.expression) in names
    )
    return Signature(positional, named - {VALUE}, VALUE in named, required)


def _difference(
    first: tree.Rule | tree.Functor, rule: tree.Rule | tree.Functor, line: int
) -> tuple[str, str] | None:
    if isinstance(first, tree.Functor) or isinstance(rule, tree.Functor):
        return f"is already defined in line {line}", "Give one of them another name."
    left, right = _signature(first), _signature(rule)
    if left is None or right is None:
        return None
    if left.has_value != right.has_value:
        noun = "a function" if left.has_value else "without a value"
        return f"is {noun} in line {line}, but not here", "Give one of them another name."
    if (left.count, left.named) != (right.count, right.named):
        hint = f"All rules of a predicate have the same columns; there it has {left}."
        if len(hint) > 120:
            hint = "All rules of a predicate have the same columns."
        return f"has different columns in line {line}", hint
    if first.is_distinct != rule.is_distinct:
        place = f"in line {line}, but not here" if first.is_distinct else "here only"
        return f"is distinct {place}", _ALL_DISTINCT
    return None


def _wrong_call(
    call: tree.Call | tree.Atom, signature: Signature, model: Model, *, is_parameter: bool
) -> Iterator[Diagnostic]:
    name = call.name
    fields = [argument.field for argument in call.arguments]
    positional = sum(isinstance(field, int) for field in fields)
    allowed = {*signature.named, tree.REST, VALUE, *(f"col{i}" for i in range(signature.count))}
    if positional > signature.count:
        hint = "Compare with the rule that defines it." if signature.count else _shape(signature)
        message = f"{name} takes {_arguments(signature.count)}; {_count_text(positional)}"
        if not signature.count and signature.named:
            message = f"The columns of {name} have names"
        yield model.diagnostic(name, message, hint)
    for field in fields:
        if isinstance(field, str) and field not in allowed:
            close = closest(field, signature.named, 0.6)
            hint = Proposal(close) if close else _shape(signature)
            yield model.diagnostic(field, f"{name} has no column {field}", hint)
    if isinstance(call, tree.Call) and not signature.has_value and not is_parameter:
        hint = f"Use {name}(...) as a condition, or give it a value: {name}(...) = ...;"
        message = f"{name} is not a function; it has no value"
        yield model.diagnostic(name, message, hint if len(hint) <= 120 else "")


def _missing_arguments(
    call: tree.Call | tree.Atom, signature: Signature, model: Model
) -> Iterator[Diagnostic]:
    """Report a call without arguments that the value needs; leaving out others is allowed."""
    fields = {argument.field for argument in call.arguments}
    missing = any(not {place, f"col{place}"} & fields for place in signature.required)
    if missing and tree.REST not in fields:
        count = sum(isinstance(field, int) for field in fields)
        message = f"{call.name} takes {_arguments(signature.count)}; {_count_text(count)}"
        yield model.diagnostic(call.name, message, "Add the missing arguments.")


def _shape(signature: Signature) -> str:
    named = sorted(signature.named)
    if named and not signature.count:
        hint = f"Name the columns that you need: ({', '.join(f'{n}:' for n in named)})."
    elif named:
        hint = f"Its named columns are {', '.join(named)}."
    else:
        hint = "Its columns are positional; they have no names." if signature.count else ""
    return hint if len(hint) <= 120 else ""


def _wrong_built_in(call: tree.Call | tree.Atom, model: Model) -> Iterator[Diagnostic]:
    name = call.name
    fields = [argument.field for argument in call.arguments]
    lower, upper = arity(name)
    named = [field for field in fields if isinstance(field, str)]
    if named:
        hint = f"Write {name}(...) with plain values in order."
        yield model.diagnostic(named[0], f"The arguments of {name} have no names", hint)
    elif not lower <= len(fields) <= upper:
        takes = _arguments(lower)
        if upper == math.inf:
            takes = f"at least {takes}"
        elif upper > lower:
            takes = f"{lower} to {upper:.0f} arguments"
        message = f"{name} takes {takes}; {_count_text(len(fields))}"
        yield model.diagnostic(name, message, "See `logical-robots help " + name + "`.")


def _arguments(count: float) -> str:
    return "no arguments" if not count else f"{count:.0f} argument{'s' if count != 1 else ''}"


def _count_text(count: int) -> str:
    return f"{count or 'none'} {'are' if count > 1 else 'is'} given"
