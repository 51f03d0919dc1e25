"""Bodies of rules: their parts, in the order in which they can be evaluated, and their places."""

from __future__ import annotations

import typing
from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias, TypeVar

from logical_robots_tui.explain.why.probing import PredicateCall, SourceSpan
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import is_built_in
from logical_robots_tui.language.source_text import Prepared, with_whole_brackets
from logical_robots_tui.language.tree import (
    REST,
    Aggregate,
    Aggregation,
    Atom,
    Call,
    Conjunction,
    Disjunction,
    Expression,
    Head,
    Membership,
    Node,
    Proposition,
    Record,
    Rule,
    Tree,
    Variable,
    arguments,
    conjuncts,
    equation_sides,
    is_aggregate,
    operands,
    rebuild,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.schema import INPUTS, VALUE

N = TypeVar("N", bound=Node)

PartKind: TypeAlias = typing.Literal["call", "condition", "value", "element", "denial"]
"""The kinds of a body's parts: a condition only tests, a value is an equation."""

AUXILIARY = "why_"
"""The prefix of variables that hold the values of calls."""

_OPENS = {"(": ")", "[": "]", "{": "}"}


def make_rule(
    name: str,
    columns: Mapping[str, Expression] | Mapping[int | str, Expression],
    body: Sequence[Proposition],
) -> Rule:
    return Rule(Head(name, arguments(columns)), Conjunction(tuple(body)) if body else None)


def span_of(node: Tree, source: Prepared) -> SourceSpan:
    """Return the place of a tree's text."""
    start, stop = tree.span_of(node) or (0, 0)
    return span_of_text(*with_whole_brackets(source.skeleton, start, stop), source.original)


def span_of_text(start: int, stop: int, text: str) -> SourceSpan:
    while start < stop and text[start].isspace():
        start += 1
    words = ""
    for line in text[start:stop].split("\n"):
        more = " ".join((line.split("#")[0] if '"' not in line else line).split())
        is_close = words[-1:] in _OPENS or more[:1] in _OPENS.values()
        words += more if is_close or not (words and more) else f" {more}"
    return SourceSpan(start, stop, text.count("\n", 0, start) + 1, words)


def parameters(rule: Rule) -> list[tuple[str, str]] | None:
    """Return the columns of a function's head with their variables, or None if it has others."""
    found = []
    for each in rule.head.columns:
        if each.field == VALUE:
            continue
        variable = variable_of(each.expression)
        if not variable or each.field == REST:
            return None
        found.append((each.column, variable))
    return found


def part_kind(part: Proposition, own: Container[str]) -> PartKind:
    """Return what a part of a body does; `own` holds the program's predicates."""
    if isinstance(part, Membership):
        return "element"
    if equation_sides(part) is not None:
        return "value"
    name = part.name if isinstance(part, Atom) else ""
    if name == "IsNull" and any(each.is_denial for each in outer_aggregates(part)):
        return "denial"
    return "call" if name in INPUTS or name in own else "condition"


class Scope:
    """The variables of a body and its surroundings, and those that nested aggregates use."""

    def __init__(self, functions: Mapping[str, Container[str]], variables: Iterable[str]) -> None:
        self.functions = functions
        self.variables = frozenset(variables)

    def mentioned(self, tree: Tree) -> frozenset[str]:
        """Return the variables of this scope that a tree mentions, at any depth."""
        return variables(tree) | (variables(tree, inside=True) & self.variables)

    def gives(
        self, part: Proposition, known: frozenset[str], *, anyhow: bool = False
    ) -> frozenset[str] | None:
        """Return the variables that are bound after a part, or None if it can't be evaluated.

        The value of a call is bound by the call, by other parts only if `anyhow`.
        """
        if isinstance(part, Disjunction):
            return self._choice(part, known)
        if isinstance(part, Membership):
            if not self.mentioned(part.collection) <= known:
                return None
            return self._matched(part.element, known, anyhow)
        pair = equation_sides(part)
        if pair is not None:
            return self._equal(*pair, known, anyhow)
        name = part.name if isinstance(part, Atom) else ""
        if name not in self.functions and (is_built_in(name) or not name[:1].isalpha()):
            return known if self.mentioned(part) <= known else None
        assert isinstance(part, Atom)
        needed = self.functions.get(name, ())
        found = known
        for argument in part.arguments:
            assert argument.expression is not None
            value = argument.expression
            if argument.column in needed and not self.mentioned(value) <= known:
                return None
            matched = self._matched(value, found, anyhow or argument.column == VALUE)
            if matched is None:
                return None
            found = matched
        return found

    def _matched(
        self, pattern: Expression, known: frozenset[str], anyhow: bool
    ) -> frozenset[str] | None:
        if isinstance(pattern, Variable) and (anyhow or not pattern.name.startswith(AUXILIARY)):
            return known | {str(pattern.name)}
        return known if self.mentioned(pattern) <= known else None

    def _equal(
        self, left: Expression, right: Expression, known: frozenset[str], anyhow: bool
    ) -> frozenset[str] | None:
        for pattern, value in ((left, right), (right, left)):
            if self.mentioned(value) <= known:
                patterns: tuple[Expression, ...] = (pattern,)
                if isinstance(pattern, Record) and pattern.arguments:
                    patterns = operands(pattern.arguments)
                found: frozenset[str] | None = known
                for each in patterns:
                    found = None if found is None else self._matched(each, found, anyhow)
                if found is not None:
                    return found
        return None

    def _choice(self, part: Disjunction, known: frozenset[str]) -> frozenset[str] | None:
        found = []
        for branch in part.alternatives:
            ordered, left = in_order(conjuncts(branch), self, known)
            if left:
                return None
            found.append(ordered[-1][1] if ordered else known)
        return frozenset.intersection(*found)


def in_order(
    parts: Iterable[Proposition], scope: Scope, known: frozenset[str]
) -> tuple[list[tuple[Proposition, frozenset[str]]], list[Proposition]]:
    """Order parts so that each can be evaluated, in text order where possible.

    Returns:
        The parts, each with the variables bound after it; and those that can't be evaluated.
    """
    waiting = list(parts)
    ordered: list[tuple[Proposition, frozenset[str]]] = []
    while waiting:
        choices = ((n, anyhow) for anyhow in (False, True) for n in range(len(waiting)))
        for place, anyhow in choices:
            found = scope.gives(waiting[place], known, anyhow=anyhow)
            if found is not None:
                ordered.append((waiting.pop(place), found))
                known = found
                break
        else:
            break
    return ordered, waiting


def without_equations(node: N) -> tuple[N, list[Atom]]:
    """Return a node with the right side of each equation in its expressions, and the equations.

    ``short = distance < 60`` becomes ``distance < 60`` with ``short = distance``.
    """
    found: list[Atom] = []

    def change(inner: Node) -> Node:
        if is_aggregate(inner):
            return inner
        inner = rebuild(inner, change)
        if not isinstance(inner, Call) or inner.name != "=":
            return inner
        found.append(Atom("=", inner.arguments, span=inner.span))
        return replace(operands(inner.arguments)[-1], span=inner.span)

    return change(node), found  # type: ignore[return-value]  # a kind for its kind


def outer_aggregates(tree: Tree) -> Iterator[Aggregate]:
    """Yield the outermost aggregates in a tree."""
    return (node for node in walk(tree, is_aggregate) if isinstance(node, Aggregate))


class Names:
    """The predicates that rules may call.

    Args:
        functions: The required columns of each predicate that needs arguments.
        origins: For each copy, its original and the predicate made with ``:=``.
    """

    def __init__(
        self,
        functions: Mapping[str, Collection[str]],
        tables: Mapping[str, str],
        origins: Mapping[str, tuple[str, str]],
    ) -> None:
        self.functions = functions
        self.tables = tables
        self.origins = origins

    def __contains__(self, name: object) -> bool:
        return name in self.functions or name in self.tables

    def call(self, name: str, arguments: Mapping[str, str]) -> PredicateCall:
        return PredicateCall(*self.origins.get(name, (name, "")), arguments)


def head_of(rule: Rule) -> tuple[dict[str, Expression], dict[str, Aggregation]]:
    plain: dict[str, Expression] = {}
    others: dict[str, Aggregation] = {}
    for each in rule.head.columns:
        if isinstance(each.value, Aggregation):
            others[each.column] = each.value
        elif each.field != REST:
            plain[each.column] = each.value
    return plain, others
