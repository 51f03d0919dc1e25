"""Bodies of rules: their parts, in the order in which they can be evaluated, and their places."""

from __future__ import annotations

import typing
from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

from logical_robots_tui.explain.why.probing import PredicateCall, SourceSpan
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import is_built_in
from logical_robots_tui.language.source_text import Prepared, with_whole_brackets
from logical_robots_tui.language.tree import Atom, Expression, Head, Node, Proposition, Rule, Tree
from logical_robots_tui.schema import INPUTS, VALUE

N = TypeVar("N", bound=Node)

PartKind: TypeAlias = typing.Literal["call", "condition", "value", "element", "denial"]
"""The kinds of a body's parts: a condition only tests, a value is an equation."""

AUXILIARY = "why_"
"""The prefix of variables that hold the values of calls."""

_BRACKETS = {"(": ")", "[": "]", "{": "}"}


def make_rule(
    name: str,
    columns: Mapping[str, Expression] | Mapping[int | str, Expression],
    body: Sequence[Proposition],
) -> Rule:
    return Rule(
        Head(name, tree.arguments(columns)), tree.Conjunction(tuple(body)) if body else None
    )


def span_of(node: Tree, source: Prepared) -> SourceSpan:
    """Return the place of a tree's text."""
    start, stop = tree.span_of(node) or (0, 0)
    return span_of_text(*with_whole_brackets(source.skeleton, start, stop), source.original)


def span_of_text(start: int, stop: int, text: str) -> SourceSpan:
    while start < stop and text[start].isspace():
        start += 1
    words = ""
    for line in text[start:stop].split("\n"):
        addition = " ".join((line.split("#")[0] if '"' not in line else line).split())
        is_close = words[-1:] in _BRACKETS or addition[:1] in _BRACKETS.values()
        words += addition if is_close or not (words and addition) else f" {addition}"
    return SourceSpan(start, stop, text.count("\n", 0, start) + 1, words)


def parameters(rule: Rule) -> list[tuple[str, str]] | None:
    """Return the columns of a function's head with their variables; None if one has none."""
    pairs = []
    for column in rule.head.columns:
        if column.field == VALUE:
            continue
        variable = tree.variable_of(column.expression)
        if not variable or column.field == tree.REST:
            return None
        pairs.append((column.column, variable))
    return pairs


def part_kind(part: Proposition, predicates: Container[str]) -> PartKind:
    """Return the kind of a part of a body; `predicates` are the program's."""
    if isinstance(part, tree.Membership):
        return "element"
    if tree.equation_sides(part) is not None:
        return "value"
    name = part.name if isinstance(part, Atom) else ""
    if name == "IsNull" and any(aggregate.is_denial for aggregate in outer_aggregates(part)):
        return "denial"
    return "call" if name in INPUTS or name in predicates else "condition"


class Scope:
    """The variables of a body and its surroundings, and those that nested aggregates use."""

    def __init__(self, functions: Mapping[str, Container[str]], names: Iterable[str]) -> None:
        self.functions = functions
        self.variables = frozenset(names)

    def variables_in(self, node: Tree) -> frozenset[str]:
        """Return the variables of this scope that a tree mentions, at any depth."""
        return tree.variables(node) | (tree.variables(node, inside=True) & self.variables)

    def bound_after(
        self, part: Proposition, bound: frozenset[str], *, binds_calls: bool = False
    ) -> frozenset[str] | None:
        """Return the variables that are bound after a part, or None if it can't be evaluated.

        The value of a call is bound by the call, by other parts only if `binds_calls`.
        """
        if isinstance(part, tree.Disjunction):
            branch_bounds = []
            for branch in part.alternatives:
                ordered, unordered = order_parts(tree.conjuncts(branch), self, bound)
                if unordered:
                    return None
                branch_bounds.append(ordered[-1][1] if ordered else bound)
            return frozenset.intersection(*branch_bounds)
        if isinstance(part, tree.Membership):
            if not self.variables_in(part.collection) <= bound:
                return None
            return self._pattern(part.element, bound, binds_calls)
        pair = tree.equation_sides(part)
        if pair is not None:
            return self._equation(*pair, bound, binds_calls)
        name = part.name if isinstance(part, Atom) else ""
        if name not in self.functions and (is_built_in(name) or not name[:1].isalpha()):
            return bound if self.variables_in(part) <= bound else None
        assert isinstance(part, Atom)
        required = self.functions.get(name, ())
        new_bound = bound
        for argument in part.arguments:
            assert argument.expression is not None
            value = argument.expression
            if argument.column in required and not self.variables_in(value) <= bound:
                return None
            extended = self._pattern(value, new_bound, binds_calls or argument.column == VALUE)
            if extended is None:
                return None
            new_bound = extended
        return new_bound

    def _pattern(
        self, pattern: Expression, bound: frozenset[str], binds_calls: bool
    ) -> frozenset[str] | None:
        if isinstance(pattern, tree.Variable) and (
            binds_calls or not pattern.name.startswith(AUXILIARY)
        ):
            return bound | {str(pattern.name)}
        return bound if self.variables_in(pattern) <= bound else None

    def _equation(
        self, left: Expression, right: Expression, bound: frozenset[str], binds_calls: bool
    ) -> frozenset[str] | None:
        for pattern, value in ((left, right), (right, left)):
            if self.variables_in(value) <= bound:
                patterns: tuple[Expression, ...] = (pattern,)
                if isinstance(pattern, tree.Record) and pattern.arguments:
                    patterns = tree.operands(pattern.arguments)
                new_bound: frozenset[str] | None = bound
                for element in patterns:
                    if new_bound is not None:
                        new_bound = self._pattern(element, new_bound, binds_calls)
                if new_bound is not None:
                    return new_bound
        return None


def order_parts(
    parts: Iterable[Proposition], scope: Scope, bound: frozenset[str]
) -> tuple[list[tuple[Proposition, frozenset[str]]], list[Proposition]]:
    """Order parts so that each can be evaluated, in text order where possible.

    Returns:
        The parts, each with the variables bound after it; and those that can't be evaluated.
    """
    remaining = list(parts)
    ordered: list[tuple[Proposition, frozenset[str]]] = []
    while remaining:
        choices = ((n, binds_calls) for binds_calls in (False, True) for n in range(len(remaining)))
        for index, binds_calls in choices:
            new_bound = scope.bound_after(remaining[index], bound, binds_calls=binds_calls)
            if new_bound is not None:
                ordered.append((remaining.pop(index), new_bound))
                bound = new_bound
                break
        else:
            break
    return ordered, remaining


def without_equations(node: N) -> tuple[N, list[Atom]]:
    """Return a node with the right side of each equation in its expressions, and the equations.

    ``short = distance < 60`` becomes ``distance < 60`` with ``short = distance``.
    """
    equations: list[Atom] = []

    def change(inner: Node) -> Node:
        if tree.is_aggregate(inner):
            return inner
        inner = tree.rebuild(inner, change)
        if not isinstance(inner, tree.Call) or inner.name != "=":
            return inner
        equations.append(Atom("=", inner.arguments, span=inner.span))
        return replace(tree.operands(inner.arguments)[-1], span=inner.span)

    return change(node), equations  # type: ignore[return-value]  # a kind for its kind


def outer_aggregates(node: Tree) -> Iterator[tree.Aggregate]:
    """Yield the outermost aggregates in a tree."""
    return (n for n in tree.walk(node, tree.is_aggregate) if isinstance(n, tree.Aggregate))


@dataclass(frozen=True)
class CallablePredicates:
    """The predicates that rules may call.

    Attributes:
        functions: The required columns of each predicate that needs arguments.
        origins: For each copy, its original and the predicate made with ``:=``.
    """

    functions: Mapping[str, Collection[str]]
    tables: Mapping[str, str]
    origins: Mapping[str, tuple[str, str]]

    def __contains__(self, name: object) -> bool:
        return name in self.functions or name in self.tables

    def call(self, name: str, columns: Mapping[str, str]) -> PredicateCall:
        return PredicateCall(*self.origins.get(name, (name, "")), columns)


def head_of(rule: Rule) -> tuple[dict[str, Expression], dict[str, tree.Aggregation]]:
    plain: dict[str, Expression] = {}
    aggregations: dict[str, tree.Aggregation] = {}
    for column in rule.head.columns:
        if isinstance(column.value, tree.Aggregation):
            aggregations[column.column] = column.value
        elif column.field != tree.REST:
            plain[column.column] = column.value
    return plain, aggregations
