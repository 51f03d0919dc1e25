"""Why a rule gives nothing: the first of its steps that no way gets past."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from logical_robots_tui.explain.why.deriving import Telling, ask_of, negation, number_of, value_of
from logical_robots_tui.explain.why.explanation import Node
from logical_robots_tui.explain.why.probing import Clause, RuleParts, Step, Term
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.relations import Relations, Way, same
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.stored import from_sql, to_sql
from logical_robots_tui.schema import INPUTS, VALUE
from logical_robots_tui.values import Value

_MOST_WAYS = 1_000
_EXAMPLES = 100


@dataclass(frozen=True, slots=True)
class Stop:
    """A step that nothing gets past, and the ways to reach it, up to a limit."""

    clause: Clause
    step: Step
    ways: Sequence[Way]


class Refuting:
    """Explains why bodies have no derivation; `alike` are the wanted values of head columns."""

    def __init__(
        self,
        relations: Relations,
        queries: Mapping[str, str],
        given: Sequence[Scalar],
        alike: Mapping[str, Value],
    ) -> None:
        self._relations, self._queries = relations, queries
        self._given, self._alike = given, alike

        def refuted(clauses: Sequence[Clause], given: Sequence[Scalar]) -> tuple[Node, ...]:
            return Refuting(relations, queries, given, {}).of(clauses)

        self.telling = Telling(relations, queries, refuted)

    def rule(self, rule: RuleParts) -> tuple[dict[str, Value], Node | None, tuple[Node, ...]]:
        """Return head values unlike those asked for, the stopping node, and all nodes."""
        others = self._others(rule)
        if others:
            return others, None, tuple(Node("column", c, values=(v,)) for c, v in others.items())
        found = [self._clause(clause) for clause in rule.clauses]
        nodes = _join(rule.clauses, [nodes for _, nodes in found])
        return {}, _last_step(found), nodes

    def stop(self, rule: RuleParts) -> Stop | None:
        """Return what stops the clause that gets furthest, or None if nothing stops it."""
        if self._others(rule):
            return None
        reached = [(clause, *self._reached(clause)) for clause in rule.clauses]
        clause, number, query, now, _ = max(reached, key=lambda each: each[1])
        sql = self._queries.get(query)
        if number == len(clause.steps) or sql is None:
            return None
        ways = self._relations.ways(sql, self._given, now, most=_MOST_WAYS)
        return Stop(clause, clause.steps[number], ways)

    def of(self, clauses: Sequence[Clause]) -> tuple[Node, ...]:
        """Return why none of some clauses has a derivation, or the derivation of one that has."""
        for clause in clauses:
            way = self._first(clause.query)
            if way is not None:
                return self.telling.derivation(clause, way)
        return _join(clauses, [self._clause(clause)[1] for clause in clauses])

    # -- inside ----------------------------------------------------------------------------------

    def _others(self, rule: RuleParts) -> dict[str, Value]:
        clause = rule.clauses[0]
        way = self._first(clause.before)
        return {
            column: value_of(way, place)
            for column, place in clause.head.items()
            if way is not None and column in self._alike and place in way and column != VALUE
            if not same(value_of(way, place), self._alike[column])
        }

    def _reached(self, clause: Clause) -> tuple[int, str, list[tuple[str, Value]], int]:
        """Return how many steps hold, their query, its conditions, and the number of ways."""
        reached: tuple[str, list[tuple[str, Value]], int] = (clause.before, [], 1)
        for number, step in enumerate(clause.steps):
            sql = self._queries.get(step.query)
            if sql is None:
                continue  # the next step answers for this one, too
            now = self._conditions(clause, step.query)
            found = self._relations.count(sql, self._given, now, _MOST_WAYS)
            if not found:
                return number, *reached
            reached = step.query, now, found
        return len(clause.steps), *reached

    def _clause(self, clause: Clause) -> tuple[int, tuple[Node, ...]]:
        number, query, now, ways = self._reached(clause)
        before = self._first(query, now)
        held = self._held(clause, number, before, ways)
        if number == len(clause.steps):
            return number, (*held, *self._unlike(clause, query))
        return number, (*held, self._failed(clause, clause.steps[number], query, before, ways))

    def _held(self, clause: Clause, until: int, way: Way | None, ways: int) -> tuple[Node, ...]:
        nodes = self.telling.derivation(clause, way or {}, until)
        if ways > 1 and nodes:
            said = f"one of {number_of(ways, 'way', is_all=ways < _MOST_WAYS)}"
            nodes = (*nodes[:-1], replace(nodes[-1], said=said))
        return nodes

    def _failed(self, clause: Clause, step: Step, before: str, way: Way | None, ways: int) -> Node:
        span, text = step.span, step.span.text
        sql = self._queries[step.query]
        elsewhere = self._relations.count(sql, self._given, (), _MOST_WAYS) if self._alike else 0
        said = "in no way"
        if elsewhere:
            number = number_of(elsewhere, "way", is_all=elsewhere < _MOST_WAYS)
            said = f"not here, but in {number} elsewhere"
        children: tuple[Node, ...] = ()
        asked = None
        is_one = ways == 1
        if way is not None and step.denied is not None:
            children = self.telling.refuted(step.denied, way)
            text, found = negation(text, holds=False)
            said = said if elsewhere else found
        elif way is not None and step.call is not None and step.call.predicate not in INPUTS:
            asked = ask_of(step.call, way | self._known(clause))
        terms = [term for term in step.terms if term.kind != "literal"]
        if way is not None and is_one:
            children = (*children, *(n for term in terms for n in self.telling.term(term, way)))
        elif before:
            columns = self._conditions(clause, before)
            children = (*children, *self._examples(terms, before, columns))
        if asked is not None:
            arguments = (Node("value", c, values=(v,)) for c, v in asked.given.items())
            children = (*children, *arguments)
        return Node(
            "call" if step.kind == "function" else step.kind,
            text,
            said,
            False,
            span=span,
            asked=asked,
            children=children,
        )

    def _examples(
        self, terms: Sequence[Term], query: str, alike: Sequence[tuple[str, Value]]
    ) -> Iterator[Node]:
        for term in _flat(terms):
            sql = self._queries.get(query)
            if sql is None or not term.column or term.kind == "literal":
                continue
            try:
                found = self._relations.ways(
                    sql, self._given, alike, f"DISTINCT {term.column}", _MOST_WAYS
                )
            except FailureError:
                continue
            values = tuple(from_sql(way[term.column]) for way in found)
            yield Node(
                "value",
                term.span.text,
                values=values[:_EXAMPLES],
                more=max(0, len(values) - _EXAMPLES),
                is_truth=term.kind == "truth",
                span=term.span,
            )

    def _unlike(self, clause: Clause, query: str) -> Iterator[Node]:
        way = self._first(query, self._conditions(clause, query))
        for column, place in clause.head.items() if way is not None else ():
            if column in self._alike and not same(value_of(way or {}, place), self._alike[column]):
                value = value_of(way or {}, place)
                yield Node("column", column, "is another", False, (value,))

    def _known(self, clause: Clause) -> Way:
        head, alike = clause.head, self._alike
        return {place: to_sql(alike[c]) for c, place in head.items() if c in alike}

    def _first(self, query: str, alike: Sequence[tuple[str, Value]] = ()) -> Way | None:
        sql = self._queries.get(query)
        if sql is None:
            return None
        return next(iter(self._relations.ways(sql, self._given, alike)), None)

    def _conditions(self, clause: Clause, query: str) -> list[tuple[str, Value]]:
        sql = self._queries[query]
        return [
            (place, self._alike[column])
            for column, place in clause.head.items()
            if column in self._alike and column != VALUE and re.search(rf"\bAS {place}\b", sql)
        ]


def _flat(terms: Sequence[Term]) -> Iterator[Term]:
    for term in terms:
        yield term
        if term.kind in ("truth", "if"):
            yield from _flat(term.parts)


def _join(clauses: Sequence[Clause], found: Sequence[tuple[Node, ...]]) -> tuple[Node, ...]:
    if len(clauses) == 1:
        return found[0]
    common = 0
    while (
        all(len(nodes) > common for nodes in found)
        and len({repr(nodes[common]) for nodes in found}) == 1
    ):
        common += 1
    branches = tuple(
        Node(
            "alternative",
            " and ".join(span.text for span in clause.taken),
            "this alternative does not hold",
            False,
            span=clause.taken[-1] if clause.taken else None,
            children=nodes[common:],
        )
        for clause, nodes in zip(clauses, found, strict=True)
        if nodes[common:]
    )
    return (*found[0][:common], *branches)


def _last_step(found: Sequence[tuple[int, tuple[Node, ...]]]) -> Node | None:
    _, nodes = max(found, key=lambda each: each[0])
    return nodes[-1] if nodes and nodes[-1].holds is False else None
