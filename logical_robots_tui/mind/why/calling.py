"""The calls of a function that a robot's reasoning makes at a moment, with their results."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.sqlite.stored import to_sql
from logical_robots_tui.mind.why.deriving import value_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Scalar
    from logical_robots_tui.mind.why.derivations import Derivations
    from logical_robots_tui.mind.why.probing import Body, Call, Clause, Probing, Term
    from logical_robots_tui.mind.why.relations import Way
    from logical_robots_tui.values import Value

__all__ = ["calls_of"]

_MOST_WAYS = 1_000
_DEEPEST = 20  # functions that call functions


def calls_of(
    name: str,
    callers: Mapping[str, Sequence[str]],
    derivations: Derivations,
    most: int,
) -> tuple[tuple[str, ...], list[tuple[Value, ...]]]:
    """Return the different calls of a function: columns, and a row for each call and result.

    Args:
        name: The function.
        callers: By name of a predicate those of the program that mention it.
        derivations: Finds rows.
        most: Most calls.

    Raises:
        QueryError: A predicate can't be decomposed.
        FailureError: It takes too long.
    """
    search = _Search(callers, derivations, most)
    found = search.arguments(name, 0)
    probing = derivations.decompose(name, "")
    rows: list[tuple[Value, ...]] = []
    for given in found:
        arguments = {column: given.get(column) for column in probing.given}
        rows += [tuple(row.values()) for row in derivations.rows(probing, arguments)]
        if len(rows) >= most:
            break
    return probing.columns, rows[:most]


class _Search:
    """Looks for calls in all clauses that hold."""

    def __init__(
        self,
        callers: Mapping[str, Sequence[str]],
        derivations: Derivations,
        most: int,
    ) -> None:
        self._callers, self._derivations = callers, derivations
        self._most = most
        self._known: dict[str, list[Mapping[str, Value]]] = {}

    def arguments(self, name: str, depth: int) -> list[Mapping[str, Value]]:
        """Return the different arguments that a function is called with."""
        if name in self._known or depth > _DEEPEST:
            return self._known.get(name, [])
        self._known[name] = []
        needed = self._derivations.decompose(name, "").given
        found: dict[str, Mapping[str, Value]] = {}
        for caller in self._callers.get(name, ()):
            probing = self._derivations.decompose(caller, "")
            contexts: Iterable[Mapping[str, Value]] = ({},)
            if probing.given:
                contexts = self.arguments(caller, depth + 1)
            for context in contexts:
                given = [to_sql(context.get(column)) for column in probing.given]
                self._derivations.prepare(probing)
                for call, way in self._calls(probing, given, name):
                    values = {c: value_of(way, p) for c, p in call.arguments.items() if p in way}
                    values = {c: v for c, v in values.items() if c in needed}
                    found.setdefault(json.dumps(values, sort_keys=True), values)
                if len(found) >= self._most:
                    break
        self._known[name] = list(found.values())
        return self._known[name]

    def _calls(
        self, probing: Probing, given: Sequence[Scalar], name: str
    ) -> Iterator[tuple[Call, Way]]:
        for rule in probing.rules:
            yield from self._in_clauses(rule.clauses, probing, given, name)

    def _in_clauses(
        self, clauses: Sequence[Clause], probing: Probing, given: Sequence[Scalar], name: str
    ) -> Iterator[tuple[Call, Way]]:
        for clause in clauses:
            calls = [s.call for s in clause.steps if s.call and s.call.predicate == name]
            bodies = [*_bodies(clause)]
            sql = probing.queries.get(clause.query)
            if sql is None or not (calls or bodies):
                continue
            try:
                ways = self._derivations.relations.ways(sql, given, most=_MOST_WAYS)
            except FailureError as failure:
                if failure.slow:
                    raise
                continue
            for way in ways:
                yield from ((call, way) for call in calls)
                for body in bodies:
                    inner = [way.get(place) for place in body.given.values()]
                    yield from self._in_clauses(body.clauses, probing, inner, name)


def _bodies(clause: Clause) -> Iterator[Body]:
    """Yield the aggregates and denials of a clause."""
    for step in clause.steps:
        if step.denied is not None:
            yield step.denied
        yield from _in_terms(step.terms)
    yield from _in_terms(clause.terms.values())


def _in_terms(terms: Iterable[Term]) -> Iterator[Body]:
    for term in terms:
        if term.body is not None:
            yield term.body
        yield from _in_terms(term.parts)
