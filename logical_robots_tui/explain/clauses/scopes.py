"""Variables that a part of a rule needs, and those that it binds. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.language.definitions import is_built_in
from logical_robots_tui.language.tree import (
    Aggregate,
    Atom,
    Disjunction,
    Membership,
    Record,
    Variable,
    conjuncts,
    equated,
    is_aggregate,
    operands,
    variables,
    walk,
)

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping

    from logical_robots_tui.language.tree import Expression, Proposition, Tree


class _EveryColumn:
    """Contains every column name."""

    def __contains__(self, column: object) -> bool:
        return True


EVERY_COLUMN = _EveryColumn()
"""The columns of a function whose required columns are unknown."""


class Scope:
    """The variables of a body and its surroundings, and those that nested aggregates use."""

    def __init__(self, functions: Mapping[str, Container[str]], variables: Iterable[str]) -> None:
        self.functions = functions
        self.variables = frozenset(variables)

    def mentioned(self, tree: Tree) -> frozenset[str]:
        """Return the variables of this scope that a tree mentions, at any depth."""
        return variables(tree) | (variables(tree, inside=True) & self.variables)

    def gives(self, part: Proposition, known: frozenset[str]) -> frozenset[str] | None:
        """Return the variables that are bound after a part, or None if it can't be evaluated."""
        if isinstance(part, Disjunction):
            return self._choice(part, known)
        if isinstance(part, Membership):
            if not self.mentioned(part.collection) <= known:
                return None
            return self._matched(part.element, known)
        pair = equated(part)
        if pair is not None:
            return self._equal(*pair, known)
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
            matched = self._matched(value, found)
            if matched is None:
                return None
            found = matched
        return found

    def _matched(self, pattern: Expression, known: frozenset[str]) -> frozenset[str] | None:
        if isinstance(pattern, Variable):
            return known | {str(pattern.name)}
        return known if self.mentioned(pattern) <= known else None

    def _equal(
        self, left: Expression, right: Expression, known: frozenset[str]
    ) -> frozenset[str] | None:
        for pattern, value in ((left, right), (right, left)):
            if self.mentioned(value) <= known:
                patterns: tuple[Expression, ...] = (pattern,)
                if isinstance(pattern, Record) and pattern.arguments:
                    patterns = operands(pattern.arguments)
                found: frozenset[str] | None = known
                for each in patterns:
                    found = None if found is None else self._matched(each, found)
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
        for place, part in enumerate(waiting):
            found = scope.gives(part, known)
            if found is not None:
                del waiting[place]
                ordered.append((part, found))
                known = found
                break
        else:
            break
    return ordered, waiting


def outer_aggregates(tree: Tree) -> Iterator[Aggregate]:
    """Yield the outermost aggregates in a tree."""
    return (node for node in walk(tree, is_aggregate) if isinstance(node, Aggregate))
