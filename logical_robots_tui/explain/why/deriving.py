"""Derivations, rows of a clause's query, as nodes of a proof.

An example: why ``Far(x:) :- Target(x:), x > 3;`` has the row ``x = 7``.

1. Its clause has two steps: the call ``Target(x:)``, which binds x, in column c0 of the query; and
   the condition ``x > 3``, whose terms are the variable in c0 and the literal in c1.
2. The query of the last step reads the rows of ``Target`` from a table:
   ``SELECT 1 AS one, WhyRows_Target.x AS c0, 3 AS c1 FROM WhyRows_Target
   WHERE (WhyRows_Target.x > 3)``.
3. One of its rows is the derivation ``{"one": 1, "c0": 7, "c1": 3}``: column x of the head is c0.
4. `NodeBuilder.derivation` makes a node of each step: ``Target(x:)``, with the question
   ``Target(x: 7)``, which leads one step deeper; and ``x > 3``. Both have a node for ``x = 7``
   below; a literal needs none. `NodeBuilder.row` makes the node of the column, ``x = 7``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TypeAlias

from logical_robots_tui.explain.why.explanation import Ask, ProofNode
from logical_robots_tui.explain.why.probing import (
    DECIDED_BY_ONE,
    AggregateInput,
    Body,
    Clause,
    PredicateCall,
    SourceSpan,
    Step,
    Term,
)
from logical_robots_tui.mind.relations import Relations, Way, alike, same
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.stored import from_sql
from logical_robots_tui.schema import INPUTS
from logical_robots_tui.values import Value, read_value, spell

AGGREGATES_NO_ROWS = "aggregates no rows"
MOST_ELEMENTS = 1_000
_SHOWN_ELEMENTS = 100
_TOLD_ELEMENTS = 40  # with their derivations

Element: TypeAlias = tuple[Clause, AggregateInput, Way]
"""A match of an aggregate's body."""


class NodeBuilder:
    """Describes derivations as nodes."""

    def __init__(
        self,
        relations: Relations,
        queries: Mapping[str, str],
        refute: Callable[[Sequence[Clause], Sequence[Scalar]], tuple[ProofNode, ...]],
        robot: str,
        predicate: str,
    ) -> None:
        self._relations, self._queries, self._refute = relations, queries, refute
        self._robot, self._predicate = robot, predicate

    def derivation(
        self, clause: Clause, match: Way, until: int | None = None
    ) -> tuple[ProofNode, ...]:
        """Return the nodes of a derivation, up to but excluding the step `until`."""
        nodes = [node for step in clause.steps[:until] for node in self.step(step, match)]
        return tuple(group_alternatives(nodes, clause.alternatives if until is None else ()))

    def row(self, clause: Clause, match: Way, row: Mapping[str, Value]) -> tuple[ProofNode, ...]:
        columns = [column for column in clause.head if column in row]
        return tuple(self._column(c, clause.terms[c], match, row[c]) for c in columns)

    def step(self, step: Step, match: Way) -> Iterator[ProofNode]:
        """Yield the node of a step that holds; none for a call that its expression explains."""
        span, text = step.span, step.span.text
        value_nodes = tuple(
            ProofNode("value", name, values=(value_of(match, place),))
            for name, place in step.bindings.items()
            if place in match
        )
        if step.kind == "call" and step.call is not None:
            reads = tuple(
                ProofNode(
                    "read", term.span.text, values=(value_of(match, term.column),), span=term.span
                )
                for term in step.reads
                if term.column in match
            )
            robot = value_of(match, step.call.arguments.get("robot_name", ""))
            is_input = step.call.predicate in INPUTS
            is_foreign = is_input and isinstance(robot, str) and robot not in ("", self._robot)
            yield ProofNode(
                "call",
                text,
                f"{robot}'s {step.call.predicate.lower()}" if is_foreign else "",
                holds=True,
                span=span,
                robot=robot if isinstance(robot, str) else "",
                query=None if is_input else ask_of(step.call, match),
                children=reads if is_input else value_nodes,
            )
        elif step.kind == "element":
            tests = tuple(node for term in step.terms[1:] for node in self.term(term, match))
            yield ProofNode("element", text, holds=True, span=span, children=(*value_nodes, *tests))
        elif step.kind == "value":
            columns, terms = step.bindings.values(), [t for t in step.terms if t.kind != "literal"]
            terms = [t for t in terms if t.kind != "variable" or t.column not in columns]
            values = tuple(
                value_of(match, place) for place in step.bindings.values() if place in match
            )
            children = tuple(node for term in terms for node in self.reason(term, match))
            if len(step.bindings) != 1:
                children = (*value_nodes, *children)
                values = ()
            yield ProofNode("value", text, holds=True, values=values, span=span, children=children)
        elif step.kind == "condition":
            children = tuple(node for term in step.terms for node in self.term(term, match))
            yield ProofNode("condition", text, holds=True, span=span, children=children)
        elif step.kind == "denial":
            inner = self.refutation(step.denial, match) if step.denial is not None else ()
            text, remark = negation(text, holds=True)
            yield ProofNode("denial", text, remark, True, span=span, children=inner)

    def refutation(self, body: Body, match: Way) -> tuple[ProofNode, ...]:
        return self._refute(body.clauses, body.arguments(match))

    def term(self, term: Term, match: Way) -> Iterator[ProofNode]:
        if term.kind == "literal" or term.column not in match:
            return
        value = value_of(match, term.column)
        span, text = term.span, term.span.text
        if term.kind == "call" and term.call is not None:
            query = ask_of(term.call, match)
            inner = tuple(node for part in term.parts for node in self.term(part, match))
            yield ProofNode("call", text, values=(value,), span=span, query=query, children=inner)
            return
        is_truth = term.kind == "truth"
        children = tuple(self.reason(term, match))
        if not (is_truth or children) and is_written(value, text):
            return
        yield ProofNode(
            term.kind if term.kind in ("if", "coalesce", "aggregate") else "value",
            text,
            holds=bool(value) if is_truth else None,
            values=() if is_truth and value is not None else (value,),
            span=span,
            children=children,
        )

    def reason(self, term: Term, match: Way) -> Iterator[ProofNode]:
        if term.kind in ("if", "coalesce") and any(part.column not in match for part in term.parts):
            return  # the chosen part is unknown: a query has only so many columns
        if term.kind == "if":
            yield from self._branch(term, match)
        elif term.kind == "coalesce":
            for part in term.parts:
                value = value_of(match, part.column)
                if value is not None:
                    remark = "is the first that is not null"
                    span, inner = part.span, tuple(self.reason(part, match))
                    yield ProofNode(
                        "value", span.text, remark, None, (value,), span=span, children=inner
                    )
                    break
                yield from self.term(part, match)
        elif term.kind == "aggregate" and term.body is not None:
            yield from self._aggregate(term.body, value_of(match, term.column), match)
        elif term.kind == "call":
            yield from self.term(term, match)
        elif term.kind == "record":
            for name, part in zip(term.names, term.parts, strict=True):
                for node in self.term(part, match):
                    is_named = part.kind == "variable" and part.span.text == name
                    yield node if is_named else replace(node, text=f"{name}: {node.text}")
        elif term.kind != "field" or term.parts[0].kind != "variable":
            for part in term.parts:
                yield from self.term(part, match)

    def contributors(
        self, elements: Sequence[Element], result: Value, is_all: bool
    ) -> tuple[ProofNode, ...]:
        if not elements:
            return (ProofNode("note", AGGREGATES_NO_ROWS),)
        name = elements[0][1].operator
        number = number_of(len(elements), "row", is_all=is_all)
        if name in DECIDED_BY_ONE:
            decisive = winner(self._relations, self._queries, elements, result, is_all=is_all)
            if decisive is not None:
                clause, aggregate, match = decisive
                children = self.derivation(clause, match)
                remark = f"chosen from {number}" if len(elements) > 1 else "is the only one"
                if owners := self._owners(clause, match) if self._has_foreign([decisive]) else "":
                    remark = f"{owners}; {remark}"
                return (replace(self._contributor(aggregate, match, remark), children=children),)
        is_foreign = self._has_foreign(elements[:_SHOWN_ELEMENTS])
        nodes = tuple(
            replace(
                self._contributor(
                    aggregate, match, self._owners(clause, match) if is_foreign else ""
                ),
                children=self.derivation(clause, match) if index < _TOLD_ELEMENTS else (),
            )
            for index, (clause, aggregate, match) in enumerate(elements[:_SHOWN_ELEMENTS])
        )
        excess = len(elements) - len(nodes)
        note = (ProofNode("note", f"and {excess:,} more"),) if excess else ()
        return (ProofNode("note", f"aggregates {number}", children=(*nodes, *note)),)

    def _column(self, name: str, term: Term, match: Way, value: Value) -> ProofNode:
        title = self._relations.label(self._predicate, name)
        if term.kind in ("literal", "variable"):
            return ProofNode("column", title, values=(value,))
        if term.kind == "call":
            (node,) = self.term(term, match)
            return replace(node, kind="column", text=f"{title}: {node.text}", values=(value,))
        children = tuple(self.reason(term, match))
        is_value = is_written(value, term.span.text)
        text = title if is_value else f"{title}: {term.span.text}"
        return ProofNode("column", text, values=(value,), span=term.span, children=children)

    def _branch(self, term: Term, match: Way) -> Iterator[ProofNode]:
        *branches, otherwise = term.parts
        for condition, value in zip(branches[::2], branches[1::2], strict=True):
            holds = bool(value_of(match, condition.column))
            for node in self.term(condition, match):
                yield replace(node, holds=holds)
            if holds:
                yield self._branch_node(value, match)
                return
        yield self._branch_node(otherwise, match)

    def _branch_node(self, term: Term, match: Way) -> ProofNode:
        remark = "this branch is taken"
        if term.kind == "call":
            return replace(next(self.term(term, match)), remark=remark)
        text, value = term.span.text or "null", value_of(match, term.column)
        values = () if is_written(value, text) else (value,)
        children = tuple(self.reason(term, match))
        return ProofNode("value", text, remark, values=values, span=term.span, children=children)

    def _aggregate(self, body: Body, result: Value, match: Way) -> Iterator[ProofNode]:
        elements: list[Element] = []
        arguments, limit = body.arguments(match), MOST_ELEMENTS + 1
        for clause in body.clauses:
            sql = self._queries.get(clause.query)
            if sql is None or not clause.aggregates:
                yield ProofNode("note", "its rows could not be queried")
                return
            matches = self._relations.ways(sql, arguments, max_rows=limit - len(elements))
            elements += [(clause, clause.aggregates[0], inner) for inner in matches]
        is_all = len(elements) < limit
        if not elements:
            yield ProofNode("note", AGGREGATES_NO_ROWS, children=self.refutation(body, match))
            return
        yield from self.contributors(elements[:MOST_ELEMENTS], result, is_all)

    def _robots(self, clause: Clause, match: Way) -> dict[str, dict[str, None]]:
        """Return the predicates that an element was read from, by robot."""
        readings: dict[str, dict[str, None]] = {}
        steps = [s for s in clause.steps if s.call and "robot_name" in s.call.arguments]
        reading = [s for s in steps if s.reads or (s.call and s.call.predicate not in INPUTS)]
        for call in (step.call for step in reading or steps):
            robot = value_of(match, call.arguments["robot_name"]) if call else None
            if call and isinstance(robot, str):
                name = call.predicate
                readings.setdefault(robot, {})[name.lower() if name in INPUTS else name] = None
        return readings

    def _has_foreign(self, elements: Sequence[Element]) -> bool:
        return any(
            self._robots(clause, match).keys() - {self._robot} for clause, _, match in elements
        )

    def _owners(self, clause: Clause, match: Way) -> str:
        """Name the predicates that an element was read from: ``Bo's memory``."""
        robots = self._robots(clause, match)
        foreign = {robot: names for robot, names in robots.items() if robot != self._robot}
        return " and ".join(
            f"{r}'s {' and '.join(names)}" for r, names in (foreign or robots).items()
        )

    def _contributor(self, aggregate: AggregateInput, match: Way, remark: str) -> ProofNode:
        value = value_of(match, aggregate.value)
        key = (
            f" -> {spell(value_of(match, aggregate.key), is_rounded=True)}" if aggregate.key else ""
        )
        span = aggregate.term.span if aggregate.term is not None else None
        text = span.text if span is not None else aggregate.operator
        return ProofNode("contributor", f"{text}{key}", remark, True, (value,), span=span)


def group_alternatives(
    nodes: Sequence[ProofNode], alternatives: Sequence[SourceSpan]
) -> list[ProofNode]:
    """Put the nodes of each alternative that holds under a node of its own."""
    result = [*nodes]
    for span in reversed(alternatives):
        inner = [n for n in result if n.span is not None and span.holds(n.span)]
        if inner:
            first = result.index(inner[0])
            result = [node for node in result if node not in inner]
            alternative = ProofNode(
                "alternative", span.text, "this alternative holds", True, span=span
            )
            result.insert(first, replace(alternative, children=tuple(inner)))
    return result


def winner(
    relations: Relations,
    queries: Mapping[str, str],
    elements: Sequence[Element],
    result: Value,
    *,
    is_all: bool = True,
) -> Element | None:
    """Return the element that determines an aggregate's result; raise FailureError."""
    for are_equal in (operator.eq, same, alike):
        equal = [e for e in elements if are_equal(value_of(e[2], e[1].value), result)]
        if equal:
            break
    else:
        return None
    if not equal[0][1].key:
        return equal[0] if result is not None else None
    if not is_all:
        return None  # another one may have the better key
    aggregate = "arg_min" if equal[0][1].operator == "ArgMin" else "arg_max"
    columns = {(queries.get(clause.query, ""), aggregate.key) for clause, aggregate, _ in equal}
    keys = [match.get(aggregate.key) for _, aggregate, match in equal]
    best = relations.chosen_key(aggregate, columns, keys)
    return None if best is None else equal[best]


def value_of(match: Way, place: str) -> Value:
    return from_sql(match.get(place))


def ask_of(call: PredicateCall, match: Way) -> Ask:
    """Return the question which rows a call matches in a derivation."""
    places = {column: place for column, place in call.arguments.items() if place in match}
    values = {column: value_of(match, place) for column, place in places.items()}
    return Ask(call.predicate, values, call.within)


def is_written(value: Value, text: str) -> bool:
    """Return whether a text is nothing but a value as it is written."""
    with suppress(ValueError):
        return read_value(text) == value
    return False


def negation(text: str, *, holds: bool) -> tuple[str, str]:
    """Return a denial as written, and the remark on it; ``a => b`` denies ``a`` without ``b``."""
    if text.startswith("~"):
        return text, "no match" if holds else "there is a match"
    if "=>" in text:
        return text, "there is no counterexample" if holds else "there is a counterexample"
    return f"not: {text}", ""


def number_of(number: int, noun: str, *, is_all: bool) -> str:
    suffix = "" if is_all else " or more"
    ending = "" if number == 1 else "es" if noun.endswith("ch") else "s"
    return f"{number:,}{suffix} {noun}{ending}"
