"""Where the values of an expression come from in a program's text. In the compile process."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses.scopes import names
from logical_robots_tui.mind.clauses.trees import span_of
from logical_robots_tui.mind.compiling.rules import (
    VALUE,
    called,
    equated,
    nodes,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.diagnosis.expressions import parameters

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnosis.sites import Span
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["Sources"]

_MOST = 6  # places
_DEEPEST = 4


class Sources:
    """Finds where values come from."""

    def __init__(self, text: str, source: Prepared, own: Mapping[str, list[Rule]]) -> None:
        self._text, self._source, self._own = text, source, own

    def of(self, tree: Any, rule: Rule) -> tuple[Span, ...]:
        """Return where the values in an expression of a rule come from, the nearest places first.

        These are the expressions equal to its variables, and the rules of the predicates that bind
        them or that it calls; then recursively the places for the values in these.
        """
        found: dict[int, Span] = {}
        seen: set[tuple[int, str]] = set()
        waiting: deque[tuple[Any, Rule, int]] = deque([(tree, rule, 0)])
        own_line = span_of(tree, self._text, self._source).line
        while waiting and len(found) < _MOST:
            tree, rule, depth = waiting.popleft()
            for place, inner, where in self._next(tree, rule, seen):
                span = span_of(place, self._text, self._source)
                if span.text and span.line != own_line:
                    found.setdefault(span.line, span)
                if depth + 1 < _DEEPEST:
                    waiting.append((inner, where, depth + 1))
        return tuple(found.values())[:_MOST]

    def _next(
        self, tree: Any, rule: Rule, seen: set[tuple[int, str]]
    ) -> Iterator[tuple[Any, Any, Rule]]:
        """Yield places one step away: what to show, what to continue with, and its rule."""
        for name in dict.fromkeys(map(str, called(tree))):
            yield from self._rules(name, seen)
        for variable in sorted(names(tree, inside=True)):
            if (id(rule), variable) in seen:
                continue
            seen.add((id(rule), variable))
            for part in nodes(rule.get("body", {})):
                pair = equated(part)
                if pair is not None:
                    for side, value in (pair, pair[::-1]):
                        if variable_of(side) == variable:
                            yield part, value, rule
                            break
                elif variable in _given_by(part):
                    yield from self._rules(str(part["predicate"]["predicate_name"]), seen)

    def _rules(self, name: str, seen: set[tuple[int, str]]) -> Iterator[tuple[Any, Any, Rule]]:
        """Return the rules of a predicate except facts."""
        if (0, name) in seen:
            return
        seen.add((0, name))
        for rule in self._own.get(name, ()):
            columns = rule["head"]["record"]["field_value"]
            is_function = any(column["field"] == VALUE for column in columns)
            if "body" in rule or (is_function and parameters(rule) is not None):
                value = [value_of(c) for c in columns if c["field"] == VALUE]
                yield rule, value or [rule["head"], rule.get("body")], rule


def _given_by(part: Rule) -> frozenset[str]:
    """Return the variables that a call in a body may bind."""
    call = part.get("predicate")
    return names(call) if isinstance(call, dict) and "record" in call else frozenset()
