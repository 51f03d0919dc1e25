"""Variables that a part of a rule needs, and those that it binds. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.compiler import rule_translate

from logical_robots_tui.mind.checking import builtins
from logical_robots_tui.mind.compiling.rules import equated, is_aggregate, nodes, variable_of

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule


class _EveryColumn:
    """Contains every column name."""

    def __contains__(self, column: object) -> bool:
        return True


EVERY_COLUMN = _EveryColumn()
"""The columns of a function whose required columns are unknown."""


def column_name(field: str | int) -> str:
    """Return the column of a field in a head or call; positional ones are col0, col1 ..."""
    return f"col{field}" if isinstance(field, int) else str(field)


def names(tree: Any, *, inside: bool = False) -> frozenset[str]:
    """Return the names of the variables in a syntax tree.

    Args:
        tree: The tree.
        inside: Whether to include aggregates and negations.
    """
    return frozenset(map(str, rule_translate.AllMentionedVariables(tree, inside)))


def flat(body: Rule | None) -> list[Rule]:
    """Yield the parts of a body without nesting."""
    if body is None:
        return []
    if "conjunction" not in body:
        return [body]
    return [part for conjunct in body["conjunction"]["conjunct"] for part in flat(conjunct)]


class Scope:
    """The variables of a body and of its surroundings.

    Args:
        functions: For each predicate that needs arguments, the columns that must be given.
        variables: Variables that aggregates inside refer to.
    """

    def __init__(self, functions: Mapping[str, Container[str]], variables: Iterable[str]) -> None:
        self.functions = functions
        self.variables = frozenset(variables)

    def mentioned(self, tree: Any) -> frozenset[str]:
        """Return the variables of this scope that a syntax tree mentions, at any depth."""
        return names(tree) | (names(tree, inside=True) & self.variables)

    def gives(self, part: Rule, known: frozenset[str]) -> frozenset[str] | None:
        """Return the variables that are bound after a part, or None if it can't be evaluated."""
        if "disjunction" in part:
            return self._choice(part, known)
        if "inclusion" in part:
            element, of = part["inclusion"]["element"], part["inclusion"]["list"]
            return self._matched(element, known) if self.mentioned(of) <= known else None
        pair = equated(part)
        if pair is not None:
            return self._equal(*pair, known)
        call = part.get("predicate", {})
        name = str(call.get("predicate_name", ""))
        if name not in self.functions and (builtins.is_built_in(name) or not name[:1].isalpha()):
            return known if self.mentioned(part) <= known else None
        needed = self.functions.get(name, ())
        found = known
        for argument in call["record"]["field_value"]:
            value = argument["value"]["expression"]
            if column_name(argument["field"]) in needed and not self.mentioned(value) <= known:
                return None
            matched = self._matched(value, found)
            if matched is None:
                return None
            found = matched
        return found

    def _matched(self, pattern: Rule, known: frozenset[str]) -> frozenset[str] | None:
        """Return the variables bound after matching a value with a pattern."""
        if "variable" in pattern:
            return known | {variable_of(pattern)}
        return known if self.mentioned(pattern) <= known else None

    def _equal(self, left: Rule, right: Rule, known: frozenset[str]) -> frozenset[str] | None:
        for pattern, value in ((left, right), (right, left)):
            if self.mentioned(value) <= known:
                fields = pattern.get("record", {}).get("field_value", ())
                patterns = [f["value"].get("expression", {}) for f in fields] or [pattern]
                found: frozenset[str] | None = known
                for each in patterns:
                    found = None if found is None else self._matched(each, found)
                if found is not None:
                    return found
        return None

    def _choice(self, part: Rule, known: frozenset[str]) -> frozenset[str] | None:
        found = []
        for branch in part["disjunction"]["disjunct"]:
            ordered, left = in_order(flat(branch), self, known)
            if left:
                return None
            found.append(ordered[-1][1] if ordered else known)
        return frozenset.intersection(*found)


def in_order(
    parts: Iterable[Rule], scope: Scope, known: frozenset[str]
) -> tuple[list[tuple[Rule, frozenset[str]]], list[Rule]]:
    """Order parts so that each can be evaluated, in text order where possible.

    Returns:
        The parts, each with the variables bound after it; and the parts whose variables are never
        bound.
    """
    waiting = list(parts)
    ordered: list[tuple[Rule, frozenset[str]]] = []
    while waiting:
        for part in waiting:
            found = scope.gives(part, known)
            if found is not None:
                waiting.remove(part)
                ordered.append((part, found))
                known = found
                break
        else:
            break
    return ordered, waiting


def combines(tree: Any) -> Iterator[Rule]:
    """Yield the outermost aggregates in a syntax tree."""
    return (node["combine"] for node in nodes(tree, is_aggregate) if is_aggregate(node))
