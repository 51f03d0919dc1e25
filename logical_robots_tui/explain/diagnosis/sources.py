"""Where the values of a program come from. In the compile process."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence

from logical_robots_tui.explain.clauses.bodies import parameters, span_of
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.definitions import MAIN, names_used
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import (
    Aggregation,
    Atom,
    Call,
    Expression,
    Membership,
    Node,
    Rule,
    Tree,
    equation_sides,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.schema import VALUE

_MOST = 6  # places
_DEEPEST = 4


class Sources:
    def __init__(self, source: Prepared, own: Mapping[str, list[Rule]]) -> None:
        self._source, self._own = source, own

    def of(self, node: Tree, rule: Rule) -> tuple[Span, ...]:
        """Return where an expression's values come from, recursively, the nearest places first."""
        found: dict[int, Span] = {}
        seen: set[tuple[int, str]] = set()
        waiting: deque[tuple[Tree, Rule, int]] = deque([(node, rule, 0)])
        own_line = span_of(node, self._source).line
        while waiting and len(found) < _MOST:
            node, rule, depth = waiting.popleft()
            for place, inner, where in self._next(node, rule, seen):
                span = span_of(place, self._source)
                if span.text and span.line != own_line:
                    found.setdefault(span.line, span)
                if depth + 1 < _DEEPEST:
                    waiting.append((inner, where, depth + 1))
        return tuple(found.values())[:_MOST]

    def _next(
        self, node: Tree, rule: Rule, seen: set[tuple[int, str]]
    ) -> Iterator[tuple[Node, Tree, Rule]]:
        for name in dict.fromkeys(names_used(node)):
            yield from self._rules(name, seen)
        for variable in sorted(variables(node, inside=True)):
            if (id(rule), variable) in seen:
                continue
            seen.add((id(rule), variable))
            for part in walk(rule.body) if rule.body else ():
                pair = equation_sides(part)
                if pair is not None:
                    for side, value in (pair, pair[::-1]):
                        if variable_of(side) == variable:
                            yield part, value, rule
                            break
                elif isinstance(part, Atom) and variable in variables(part):
                    yield from self._rules(part.name, seen)

    def _rules(self, name: str, seen: set[tuple[int, str]]) -> Iterator[tuple[Node, Tree, Rule]]:
        """Yield the rules of a predicate except facts."""
        if (0, name) in seen:
            return
        seen.add((0, name))
        for rule in self._own.get(name, ()):
            is_function = rule.value is not None and parameters(rule) is not None
            if rule.body or is_function:
                yield rule, rule.value or rule, rule


def decisive_columns(rule: Rule, own: Mapping[str, Sequence[Rule]]) -> set[tuple[str, str]]:
    """Return the predicates and columns from which the desire of a rule of `Robot` may come."""
    found = {(MAIN, "desire")}
    waiting: list[tuple[Rule, Tree]] = []

    def add(name: str, column: str) -> None:
        if name in own and (name, column) not in found:
            found.add((name, column))
            waiting.extend((each, value) for each in own[name] for value in _values(each, column))

    waiting += [(rule, value) for value in _values(rule, "desire")]
    seen: set[tuple[int, int]] = set()
    while waiting:
        where, value = waiting.pop()
        if (id(where), id(value)) in seen:
            continue
        seen.add((id(where), id(value)))
        for node in walk(value):
            if isinstance(node, Call):
                add(node.name, VALUE)
        for part in walk(where.body) if where.body else ():
            pair = equation_sides(part)
            names = variables(value, inside=True)
            if pair is not None:
                for side, other in (pair, pair[::-1]):
                    if variables(side) & names:
                        waiting.append((where, other))
            elif isinstance(part, Membership) and variables(part.element) & names:
                waiting.append((where, part.collection))
            elif isinstance(part, Atom):
                for argument in part.arguments:
                    if argument.expression and variables(argument.expression) & names:
                        add(part.name, argument.column)
    return found


def _values(rule: Rule, column: str) -> Iterator[Expression]:
    """Yield what a rule's head has for a column."""
    for each in rule.head.columns:
        if each.column == column:
            value = each.value
            yield value.argument if isinstance(value, Aggregation) else value
