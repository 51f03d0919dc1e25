"""Where the values of a program come from. In the compile process."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest

from logical_robots_tui.explain.clauses.bodies import parameters, span_of
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.definitions import names_used
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import (
    CONDITIONS,
    Aggregate,
    Aggregation,
    Atom,
    Call,
    Choice,
    Expression,
    Literal,
    Node,
    Rule,
    Tree,
    Variable,
    conjuncts,
    equation_sides,
    operands,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.schema import MAIN, VALUE

_MOST = 6  # places
_DEEPEST = 4


class Sources:
    def __init__(self, source: Prepared, own: Mapping[str, Sequence[Rule]]) -> None:
        self._source, self._own = source, own

    def of(self, node: Tree, rule: Rule) -> tuple[Span, ...]:
        """Return where an expression's values come from, recursively.

        The nearest places come first, and those that only copy a value last.
        """
        found: dict[int, Span] = {}
        copies: dict[int, Span] = {}
        seen: set[tuple[int, str]] = set()
        waiting: deque[tuple[Tree, Rule, int]] = deque([(node, rule, 0)])
        own_line = span_of(node, self._source).line
        while waiting and len(found) < _MOST:
            node, rule, depth = waiting.popleft()
            for place, inner, where in self._next(node, rule, seen):
                span = span_of(place, self._source)
                if span.text and span.line != own_line:
                    (copies if self._copies(place) else found).setdefault(span.line, span)
                if depth + 1 < _DEEPEST:
                    waiting.append((inner, where, depth + 1))
        return tuple((found | {n: s for n, s in copies.items() if n not in found}).values())[:_MOST]

    def _copies(self, place: Node) -> bool:
        """Return whether a place is a call of a sensor or of what other rules give."""
        return isinstance(place, Atom) and (
            place.name == "Sensor" or any(rule.body for rule in self._own.get(place.name, ()))
        )

    def of_condition(self, node: Tree, rule: Rule) -> tuple[Span, ...]:
        """Return the place of a condition, and where its values come from."""
        return span_of(node, self._source), *self.of(node, rule)

    def _next(
        self, node: Tree, rule: Rule, seen: set[tuple[int, str]]
    ) -> Iterator[tuple[Node, Tree, Rule]]:
        for name in dict.fromkeys(names_used(node)):
            yield from self._rules(name, seen)
        for variable in sorted(variables(node, inside=True)):
            if (id(rule), variable) in seen:
                continue
            seen.add((id(rule), variable))
            for part, value in _bindings(variable, rule):
                if isinstance(part, Atom) and value is None:
                    yield part, (), rule
                    yield from self._rules(part.name, seen)
                elif value is not None:
                    yield from ((place, value, rule) for place in _places(part, value))

    def _rules(self, name: str, seen: set[tuple[int, str]]) -> Iterator[tuple[Node, Tree, Rule]]:
        """Yield the rules of a predicate except facts."""
        if (0, name) in seen:
            return
        seen.add((0, name))
        for rule in self._own.get(name, ()):
            is_function = rule.value is not None and parameters(rule) is not None
            if rule.body or is_function:
                copies = all(isinstance(each.value, Variable) for each in rule.head.columns)
                yield (copies and rule.body) or rule, rule.value or rule, rule
            for part in conjuncts(rule.body):
                if isinstance(part, Atom) and part.name in CONDITIONS:
                    yield part, part, rule


def _bindings(variable: str, rule: Rule) -> Iterator[tuple[Node, Expression | None]]:
    """Yield equations of a variable with its value, and calls that mention it with None."""
    for part in walk(rule):
        if (pair := equation_sides(part)) is not None:
            for side, value in (pair, pair[::-1]):
                if variable_of(side) == variable:
                    yield part, value
        elif isinstance(part, Atom) and variable in variables(part):
            yield part, None


def _places(part: Node, value: Tree) -> Sequence[Node]:
    """Return the places of an equation: of an ``if``, those of its values."""
    if not isinstance(value, Choice):
        return (part,)
    each = (*(branch.value for branch in value.branches), value.otherwise)
    return [place for place in each if not isinstance(place, Literal)] or (part,)


def alternate(some: Sequence[Span], others: Sequence[Span], own_line: int) -> tuple[Span, ...]:
    """Return places of both sorts in turn, one for each line except one."""
    each = (place for pair in zip_longest(some, others) for place in pair if place is not None)
    found: dict[int, Span] = {}
    for place in each:
        if place.line != own_line:
            found.setdefault(place.line, place)
    return tuple(found.values())[:_MOST]


def decisive_columns(rule: Rule, own: Mapping[str, Sequence[Rule]]) -> set[tuple[str, str]]:
    """Return the predicates and columns from which the desire of a rule of `Robot` is copied."""
    found = {(MAIN, "desire")}
    waiting = [(rule, value) for value in _values(rule, "desire")]
    seen: set[tuple[int, int]] = set()

    def add(name: str, column: str) -> None:
        if name in own and (name, column) not in found:
            found.add((name, column))
            waiting.extend((each, value) for each in own[name] for value in _values(each, column))

    while waiting:
        rule, value = waiting.pop()
        if (id(rule), id(value)) in seen:
            continue
        seen.add((id(rule), id(value)))
        match value:
            case Choice():
                waiting += [(rule, each.value) for each in value.branches]
                waiting.append((rule, value.otherwise))
            case Aggregate():
                waiting.append((rule, value.argument))
            case Call(name="Coalesce"):
                waiting += [(rule, each) for each in operands(value.arguments)]
            case Call():
                add(value.name, VALUE)
            case Variable():
                for part, other in _bindings(value.name, rule):
                    if other is not None:
                        waiting.append((rule, other))
                    elif isinstance(part, Atom):
                        for argument in part.arguments:
                            if argument.expression == value:
                                add(part.name, argument.column)
    return found


def _values(rule: Rule, column: str) -> Iterator[Expression]:
    """Yield what a rule's head has for a column."""
    for each in rule.head.columns:
        if each.column == column:
            value = each.value
            yield value.argument if isinstance(value, Aggregation) else value
