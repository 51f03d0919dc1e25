"""Why a rule gives nothing: the first of its steps that no way gets past."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from logical_robots_tui.explain.why.derivations import Derivations
from logical_robots_tui.explain.why.deriving import (
    Telling,
    ask_of,
    grouped,
    negation,
    number_of,
    value_of,
)
from logical_robots_tui.explain.why.explanation import Ask, Node, spell_call, unlike_types
from logical_robots_tui.explain.why.probing import (
    Call,
    Clause,
    Misread,
    Probing,
    RuleParts,
    Span,
    Step,
    Term,
)
from logical_robots_tui.language.diagnostics import distance
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import Way, same
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.stored import from_sql, to_sql
from logical_robots_tui.schema import INPUTS
from logical_robots_tui.values import Value, spell

_MOST_WAYS = 1_000
_EXAMPLES = 100
_MOST_COMPARED = 20_000  # pairs of asked arguments and rows
_SHOWN_CALLS = 10


@dataclass(frozen=True, slots=True)
class Stop:
    """A step that nothing gets past, and the ways to reach it, up to a limit."""

    clause: Clause
    step: Step
    ways: Sequence[Way]


class _Reached(NamedTuple):
    """How far ways get: steps that hold, their query, the wanted values there, number of ways."""

    steps: int
    query: str
    wanted: list[tuple[str, Value]]
    ways: int


class Refuting:
    """Explains why bodies have no derivation; `wanted` are the values of head columns."""

    def __init__(
        self,
        derivations: Derivations,
        probing: Probing,
        given: Sequence[Scalar],
        wanted: Mapping[str, Value],
    ) -> None:
        self._relations, self._given, self._wanted = derivations.relations, given, wanted
        self._probing, self._queries = probing, probing.queries

        def refuted(clauses: Sequence[Clause], given: Sequence[Scalar]) -> tuple[Node, ...]:
            return Refuting(derivations, probing, given, {}).of(clauses)

        self.telling = Telling(
            self._relations, probing.queries, refuted, derivations.robot, probing.predicate
        )

    def rule(self, rule: RuleParts) -> tuple[bool, Node | None, tuple[Node, ...]]:
        """Return whether it is about something else, the stopping node, and all nodes."""
        if others := self._others(rule):
            is_else = self._is_about_else(rule, others)
            said, holds = ("", None) if is_else else ("actual value", False)
            nodes = tuple(
                Node(
                    "column", self._label(c), unlike_types(self._wanted[c], v) or said, holds, (v,)
                )
                for c, v in others.items()
            )
            return is_else, None if is_else else nodes[0], nodes
        found = [self._clause(clause) for clause in rule.clauses]
        return False, max(found, key=lambda each: each.steps).stop, _join(found)

    def stop(self, rule: RuleParts) -> Stop | None:
        """Return what stops the clause that gets furthest, or None if nothing stops it."""
        if self._others(rule):
            return None
        reached = [(clause, self._reached(clause)) for clause in rule.clauses]
        clause, found = max(reached, key=lambda each: each[1].steps)
        sql = self._queries.get(found.query)
        if sql is None or any(each.steps == len(of.steps) for of, each in reached):
            return None
        ways = self._relations.ways(sql, self._given, found.wanted, max_rows=_MOST_WAYS)
        return Stop(clause, clause.steps[found.steps], ways)

    def of(self, clauses: Sequence[Clause]) -> tuple[Node, ...]:
        """Return why none of some clauses has a derivation, or the derivation of one that has."""
        for clause in clauses:
            way = self._first(clause.query)
            if way is not None:
                return self.telling.derivation(clause, way)
        return _join([self._clause(clause) for clause in clauses])

    def _label(self, column: str) -> str:
        return self._relations.label(self._probing.predicate, column)

    def _others(self, rule: RuleParts) -> dict[str, Value]:
        """Return the constants of a head that are unlike what is wanted."""
        clause = rule.clauses[0]
        way = self._first(clause.before) or {}
        return {
            column: value_of(way, place)
            for column, place in clause.head.items()
            if column in self._wanted and place in way
            # Others are known only together with the body.
            if not clause.steps or clause.terms[column].kind == "literal"
            if not same(value_of(way, place), self._wanted[column])
        }

    def _is_about_else(self, rule: RuleParts, others: Mapping[str, Value]) -> bool:
        """Return whether a rule's constants share nothing with what is wanted."""
        alike = self._wanted.keys() - others.keys() - {"robot_name"}
        head = rule.clauses[0].terms
        is_near = any(head[column].kind == "literal" for column in alike if column in head)
        is_computed = all(head[column].kind != "literal" for column in others)
        return "robot_name" in others or not (self._probing.given or is_near or is_computed)

    def _places(self, clause: Clause, query: str, *, joined: bool) -> list[tuple[str, Value]]:
        """Return the wanted values of a query's columns that are bound by calls, or computed."""
        sql = self._queries[query]
        return [
            (place, self._wanted[column])
            for column, place in clause.head.items()
            if column in self._wanted
            and joined == _is_joined(clause, column)
            and re.search(rf"\bAS {place}\b", sql)
        ]

    def _came_out(self, clause: Clause, way: Way) -> Node | None:
        """Return the first computed column that differs from what is wanted wherever steps hold."""
        sql = self._queries[clause.query]
        wanted = self._places(clause, clause.query, joined=True)
        for column, place in clause.head.items():
            if column not in self._wanted or _is_joined(clause, column):
                continue
            further = [*wanted, (place, self._wanted[column])]
            if self._relations.count(sql, self._given, further):
                wanted = further
                continue
            what = f"DISTINCT {place}"
            ways = self._relations.ways(sql, self._given, wanted, what, _MOST_WAYS)
            values = tuple(from_sql(each[place]) for each in ways)
            return self._computed(column, clause.terms[column], way, values)
        return None

    def _computed(self, column: str, term: Term, way: Way, values: tuple[Value, ...]) -> Node:
        shown, more = values[:_EXAMPLES], max(0, len(values) - _EXAMPLES)
        found = Node("column", self._label(column), "actual value", False, shown, more)
        if term.kind in ("literal", "variable"):
            return found
        text = f"{found.text}: {term.span.text}"
        if term.kind == "call" and term.call is not None:
            (called,) = self.telling.term(term, way) or (found,)
            asked, inside = called.asked, called.children
        else:
            asked, inside = None, tuple(self.telling.reason(term, way))
        inside = inside if len(values) == 1 else ()
        return replace(found, text=text, span=term.span, asked=asked, children=inside)

    def _reached(self, clause: Clause) -> _Reached:
        reached = _Reached(0, clause.before, [], 1)
        for number, step in enumerate(clause.steps, 1):
            sql = self._queries.get(step.query)
            if sql is None:
                continue  # the next step answers for this one, too
            wanted = self._places(clause, step.query, joined=True)
            found = self._relations.count(sql, self._given, wanted, _MOST_WAYS)
            if not found:
                return reached._replace(steps=number - 1)
            reached = _Reached(number, step.query, wanted, found)
        return reached._replace(steps=len(clause.steps))

    def _clause(self, clause: Clause) -> _Refuted:
        reached = self._reached(clause)
        way = self._first(reached.query, reached.wanted)
        held = self._held(clause, reached, way)
        if reached.steps < len(clause.steps):
            step = clause.steps[reached.steps]
            return _Refuted(clause, reached.steps, held, self._failed(clause, step, reached, way))
        failed = self._came_out(clause, way or {}) if self._wanted else None
        return _Refuted(clause, reached.steps, held, failed)

    def _held(self, clause: Clause, reached: _Reached, way: Way | None) -> tuple[Node, ...]:
        nodes = self.telling.derivation(clause, way or {}, reached.steps)
        if reached.ways > 1 and nodes:
            matches = number_of(reached.ways, "match", is_all=reached.ways < _MOST_WAYS)
            nodes = (*nodes[:-1], replace(nodes[-1], said=f"1 of {matches}"))
        return nodes

    def _failed(self, clause: Clause, step: Step, reached: _Reached, way: Way | None) -> Node:
        text, said = step.span.text, self._elsewhere(step)
        children: tuple[Node, ...] = ()
        asked: Ask | None = None
        if way is not None and step.denied is not None:
            children = self.telling.refuted(step.denied, way)
            text, found = negation(text, holds=False)
            said = said or found
        elif way is not None and step.call is not None and step.call.predicate not in INPUTS:
            asked, children = self._call(step.call, reached, self._known(clause))
            said = self._unlike_row(asked) or said
        terms = [term for term in step.terms if term.kind != "literal"]
        if way is not None and reached.ways == 1:
            inside = tuple(node for term in terms for node in self.telling.term(term, way))
            if len(step.terms) == 2:
                one, other = (value_of(way, term.column) for term in step.terms)
                said = unlike_types(one, other) or said
        else:
            inside = tuple(self._examples(terms, reached))
        if step.misread is not None:
            said = _misread(step.misread, way if reached.ways == 1 else None)
        return Node(
            "call" if step.kind == "function" else step.kind,
            text,
            said or "no match",
            False,
            span=step.span,
            asked=asked,
            children=(*inside, *children),
        )

    def _elsewhere(self, step: Step) -> str:
        number = 0
        if self._wanted:
            sql = self._queries[step.query]
            number = self._relations.count(sql, self._given, (), _MOST_WAYS)
        if not number:
            return ""
        matches = number_of(number, "match", is_all=number < _MOST_WAYS)
        if self._wanted.keys() == {"robot_name"}:
            return f"not here, but {matches} elsewhere"
        return f"not for these values, but {matches} for others"

    def _call(self, call: Call, reached: _Reached, known: Way) -> tuple[Ask, tuple[Node, ...]]:
        """Return what a call was asked for, nearest to a row that is there first."""
        sql = self._queries[reached.query]
        places = [p for p in call.arguments.values() if re.search(rf"\bAS {p}\b", sql)]
        what = f"DISTINCT {', '.join(dict.fromkeys(places))}" if places else "1"
        ways = self._relations.ways(
            sql, self._given, reached.wanted, what, _MOST_WAYS if places else 1
        )
        asks = [ask_of(call, way | known) for way in ways]
        if len(asks) > 1:
            asks = self._nearest_first(asks)
            shown = [Node("instance", spell_call(ask), asked=ask) for ask in asks[:_SHOWN_CALLS]]
            if more := len(asks) - len(shown):
                shown.append(Node("note", f"and {more:,} more"))
            return asks[0], tuple(shown)
        labels = ((self._relations.label(call.predicate, c), v) for c, v in asks[0].given.items())
        return asks[0], tuple(Node("value", label, values=(value,)) for label, value in labels)

    def _rows(self, asked: Ask) -> Sequence[Mapping[str, Value]]:
        name, probing = asked.predicate, self._probing
        if asked.within or name not in probing.tables:
            return ()
        return self._relations.rows(name, probing.sources.get(name, ""))

    def _unlike_row(self, asked: Ask) -> str:
        """Return how a row differs from what was asked for, if in nothing but types, or ""."""
        for row in self._rows(asked)[:_MOST_WAYS]:
            others = [(v, row[c]) for c, v in asked.given.items() if not same(v, row[c])]
            said = [unlike_types(*each) for each in others]
            if said and all(said):
                return said[0]
        return ""

    def _nearest_first(self, asks: list[Ask]) -> list[Ask]:
        rows = self._rows(asks[0])[: _MOST_COMPARED // len(asks)]

        def gap(ask: Ask) -> float:
            gaps = (sum(_unlikeness(v, row.get(c)) for c, v in ask.given.items()) for row in rows)
            return min(gaps, default=0.0)

        return sorted(asks, key=gap)

    def _examples(self, terms: Sequence[Term], reached: _Reached) -> Iterator[Node]:
        sql = self._queries.get(reached.query)
        for term in _flat(terms):
            if sql is None or not term.column or term.kind == "literal":
                continue
            what = f"DISTINCT {term.column}"
            try:
                found = self._relations.ways(sql, self._given, reached.wanted, what, _MOST_WAYS)
            except FailureError:
                continue
            values = tuple(from_sql(way[term.column]) for way in found)
            yield Node(
                "value",
                term.span.text,
                values=values[:_EXAMPLES],
                more=max(0, len(values) - _EXAMPLES),
                span=term.span,
            )

    def _known(self, clause: Clause) -> Way:
        return {
            place: to_sql(self._wanted[column])
            for column, place in clause.head.items()
            if column in self._wanted and _is_joined(clause, column)
        }

    def _first(self, query: str, wanted: Sequence[tuple[str, Value]] = ()) -> Way | None:
        sql = self._queries.get(query)
        if sql is None:
            return None
        return next(iter(self._relations.ways(sql, self._given, wanted)), None)


def _misread(found: Misread, way: Way | None) -> str:
    """Return what an operator has on its sides, of which one is an equation."""
    shown = []
    for term in found.sides:
        text = term.span.text if term.kind == "literal" else f"`{term.span.text}`"
        if way is not None and term.kind != "literal" and term.column in way:
            text += f" ({spell(value_of(way, term.column))})"
        shown.append(text)
    verb = "joins" if found.operator in ("&&", "||") else "compares"
    return f"{verb} {' with '.join(shown)}"


class _Refuted(NamedTuple):
    """How a clause ends: steps that hold, as nodes, and what stops it."""

    clause: Clause
    steps: int
    held: tuple[Node, ...]
    stop: Node | None

    @property
    def nodes(self) -> tuple[Node, ...]:
        return (*self.held, *((self.stop,) if self.stop is not None else ()))

    @property
    def met(self) -> tuple[Span, ...]:
        """The alternatives that were evaluated, at least in part."""
        reached = self.clause.steps[: self.steps + 1]
        return tuple(
            span for span in self.clause.taken if any(span.holds(step.span) for step in reached)
        )

    @property
    def failing(self) -> Span | None:
        """The innermost alternative that it ends in, or None if it gets past all of them."""
        ends = self.clause.steps[self.steps : self.steps + 1]
        return next((s for s in self.met[::-1] if any(s.holds(step.span) for step in ends)), None)


def _join(found: Sequence[_Refuted]) -> tuple[Node, ...]:
    """Return the nodes of a body with alternatives: each that fails, and what stops the others."""
    if len(found) == 1:
        return found[0].nodes
    different = {(each.met, repr(each.nodes)): each for each in found}
    ends = [*different.values()]
    if len(ends) == 1:
        return tuple(grouped(ends[0].nodes, ends[0].met))
    common = 0
    while (
        all(len(each.nodes) > common for each in ends)
        and len({repr(each.nodes[common]) for each in ends}) == 1
    ):
        common += 1
    failing = [_alternative(each, common) for each in ends if each.failing is not None]
    passed = [each for each in ends if each.failing is None]
    if len(passed) == 1:
        rest: Sequence[Node] = grouped(passed[0].nodes[common:], passed[0].met)
    else:
        rest = [_alternative(each, common) for each in passed]
    return (*ends[0].nodes[:common], *failing, *rest)


def _alternative(end: _Refuted, common: int) -> Node:
    nodes, span = end.nodes[common:], end.failing
    if span is not None:
        held = [each for each in end.met if not each.holds(span)]
        said, children = "this alternative does not hold", tuple(grouped(nodes, held))
        return Node("alternative", span.text, said, False, span=span, children=children)
    text = " and ".join(each.text for each in end.met)
    said = "this alternative holds, but not what comes after it"
    span = end.met[-1] if end.met else None
    return Node("alternative", text, said, span=span, children=nodes)


def _is_joined(clause: Clause, column: str) -> bool:
    """Return whether a column of the head is a variable that no equation or list gives."""
    place = clause.head[column]
    return clause.terms[column].kind in ("variable", "literal") and not any(
        place in step.gives.values() for step in clause.steps if step.kind in ("value", "element")
    )


def _unlikeness(one: Value, other: Value) -> float:
    """Return the dissimilarity of two values, at most 1."""
    if same(one, other):
        return 0.0
    if isinstance(one, int | float) and isinstance(other, int | float):
        return 0.5 * (size := abs(one - other)) / (size + 1)
    if isinstance(one, str) and isinstance(other, str):
        return min(1.0, distance(one, other) / max(1, len(one), len(other)))
    return 1.0


def _flat(terms: Sequence[Term]) -> Iterator[Term]:
    for term in terms:
        yield term
        if term.kind in ("truth", "if"):
            yield from _flat(term.parts)
