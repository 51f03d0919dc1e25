"""What one derivation says: a row of a clause's query as nodes."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from logical_robots_tui.explain.why.explanation import Ask, Node
from logical_robots_tui.explain.why.probing import (
    DECIDED_BY_ONE,
    AggregateInput,
    Body,
    Call,
    Clause,
    Span,
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
_TOLD_ELEMENTS = 40  # with where they come from


class Telling:
    """Describes derivations as nodes."""

    def __init__(
        self,
        relations: Relations,
        queries: Mapping[str, str],
        refute: Callable[[Sequence[Clause], Sequence[Scalar]], tuple[Node, ...]],
        robot: str,
        predicate: str,
    ) -> None:
        self._relations, self._queries, self._refute = relations, queries, refute
        self._robot, self._predicate = robot, predicate

    def derivation(self, clause: Clause, way: Way, until: int | None = None) -> tuple[Node, ...]:
        """Return the nodes of a derivation, up to but excluding the step `until`."""
        nodes = [node for step in clause.steps[:until] for node in self.step(step, way)]
        return tuple(grouped(nodes, clause.taken if until is None else ()))

    def row(self, clause: Clause, way: Way, row: Mapping[str, Value]) -> tuple[Node, ...]:
        shown = [column for column in clause.head if column in row]
        return tuple(self._column(c, clause.terms[c], way, row[c]) for c in shown)

    def step(self, step: Step, way: Way) -> Iterator[Node]:
        """Yield the node of a step that holds; none for a call that its expression explains."""
        span, text = step.span, step.span.text
        given = tuple(
            Node("value", name, values=(value_of(way, place),))
            for name, place in step.gives.items()
            if place in way
        )
        if step.kind == "call" and step.call is not None:
            reads = tuple(
                Node("read", term.span.text, values=(value_of(way, term.column),), span=term.span)
                for term in step.reads
                if term.column in way
            )
            robot = value_of(way, step.call.arguments.get("robot_name", ""))
            is_input = step.call.predicate in INPUTS
            is_others = is_input and isinstance(robot, str) and robot not in ("", self._robot)
            yield Node(
                "call",
                text,
                f"{robot}'s {step.call.predicate.lower()}" if is_others else "",
                holds=True,
                span=span,
                robot=robot if isinstance(robot, str) else "",
                asked=None if is_input else ask_of(step.call, way),
                children=reads if is_input else given,
            )
        elif step.kind == "element":
            tested = tuple(node for term in step.terms[1:] for node in self.term(term, way))
            yield Node("element", text, holds=True, span=span, children=(*given, *tested))
        elif step.kind == "value":
            gives, terms = step.gives.values(), [t for t in step.terms if t.kind != "literal"]
            terms = [t for t in terms if t.kind != "variable" or t.column not in gives]
            values = tuple(value_of(way, place) for place in step.gives.values() if place in way)
            children = tuple(node for term in terms for node in self.reason(term, way))
            if len(step.gives) != 1:
                children = (*given, *children)
                values = ()
            yield Node("value", text, holds=True, values=values, span=span, children=children)
        elif step.kind == "condition":
            children = tuple(node for term in step.terms for node in self.term(term, way))
            yield Node("condition", text, holds=True, span=span, children=children)
        elif step.kind == "denial":
            inside = self.refuted(step.denied, way) if step.denied is not None else ()
            text, said = negation(text, holds=True)
            yield Node("denial", text, said, True, span=span, children=inside)

    def refuted(self, body: Body, way: Way) -> tuple[Node, ...]:
        return self._refute(body.clauses, body.arguments(way))

    def term(self, term: Term, way: Way) -> Iterator[Node]:
        if term.kind == "literal" or term.column not in way:
            return
        value = value_of(way, term.column)
        span, text = term.span, term.span.text
        if term.kind == "call" and term.call is not None:
            asked = ask_of(term.call, way)
            inner = tuple(node for part in term.parts for node in self.term(part, way))
            yield Node("call", text, values=(value,), span=span, asked=asked, children=inner)
            return
        is_truth = term.kind == "truth"
        children = tuple(self.reason(term, way))
        if not (is_truth or children) and is_written(value, text):
            return
        yield Node(
            term.kind if term.kind in ("if", "coalesce", "aggregate") else "value",
            text,
            holds=bool(value) if is_truth else None,
            values=() if is_truth and value is not None else (value,),
            span=span,
            children=children,
        )

    def reason(self, term: Term, way: Way) -> Iterator[Node]:
        if term.kind in ("if", "coalesce") and any(each.column not in way for each in term.parts):
            return  # which is chosen can't be told: a query shows only so many columns
        if term.kind == "if":
            yield from self._branch(term, way)
        elif term.kind == "coalesce":
            for part in term.parts:
                value = value_of(way, part.column)
                if value is not None:
                    said = "is the first that is not null"
                    span, inner = part.span, tuple(self.reason(part, way))
                    yield Node("value", span.text, said, None, (value,), span=span, children=inner)
                    break
                yield from self.term(part, way)
        elif term.kind == "aggregate" and term.body is not None:
            yield from self._aggregate(term.body, value_of(way, term.column), way)
        elif term.kind == "call":
            yield from self.term(term, way)
        elif term.kind == "record":
            for name, part in zip(term.names, term.parts, strict=True):
                for node in self.term(part, way):
                    is_named = part.kind == "variable" and part.span.text == name
                    yield node if is_named else replace(node, text=f"{name}: {node.text}")
        elif term.kind != "field" or term.parts[0].kind != "variable":
            for part in term.parts:
                yield from self.term(part, way)

    def contributors(
        self, found: Sequence[tuple[Clause, AggregateInput, Way]], result: Value, is_all: bool
    ) -> tuple[Node, ...]:
        if not found:
            return (Node("note", AGGREGATES_NO_ROWS),)
        name = found[0][1].operator
        number = number_of(len(found), "row", is_all=is_all)
        if name in DECIDED_BY_ONE:
            best = winner(self._relations, self._queries, found, result, is_all=is_all)
            if best is not None:
                clause, collected, way = best
                children = self.derivation(clause, way)
                said = f"chosen from {number}" if len(found) > 1 else "is the only one"
                if whose := self._whose(clause, way) if self._is_of_others([best]) else "":
                    said = f"{whose}; {said}"
                return (replace(self._element(collected, way, said), children=children),)
        is_of_others = self._is_of_others(found[:_SHOWN_ELEMENTS])
        nodes = tuple(
            replace(
                self._element(one, way, self._whose(clause, way) if is_of_others else ""),
                children=self.derivation(clause, way) if place < _TOLD_ELEMENTS else (),
            )
            for place, (clause, one, way) in enumerate(found[:_SHOWN_ELEMENTS])
        )
        more = len(found) - len(nodes)
        rest = (Node("note", f"and {more:,} more"),) if more else ()
        return (Node("note", f"aggregates {number}", children=(*nodes, *rest)),)

    def _column(self, name: str, term: Term, way: Way, value: Value) -> Node:
        title = self._relations.label(self._predicate, name)
        if term.kind in ("literal", "variable"):
            return Node("column", title, values=(value,))
        if term.kind == "call":
            (node,) = self.term(term, way)
            return replace(node, kind="column", text=f"{title}: {node.text}", values=(value,))
        children = tuple(self.reason(term, way))
        is_value = is_written(value, term.span.text)
        text = title if is_value else f"{title}: {term.span.text}"
        return Node("column", text, values=(value,), span=term.span, children=children)

    def _branch(self, term: Term, way: Way) -> Iterator[Node]:
        *branches, otherwise = term.parts
        for condition, value in zip(branches[::2], branches[1::2], strict=True):
            holds = bool(value_of(way, condition.column))
            for node in self.term(condition, way):
                yield replace(node, holds=holds)
            if holds:
                yield self._taken(value, way)
                return
        yield self._taken(otherwise, way)

    def _taken(self, term: Term, way: Way) -> Node:
        said = "this branch is taken"
        if term.kind == "call":
            return replace(next(self.term(term, way)), said=said)
        text, value = term.span.text or "null", value_of(way, term.column)
        values = () if is_written(value, text) else (value,)
        children = tuple(self.reason(term, way))
        return Node("value", text, said, values=values, span=term.span, children=children)

    def _aggregate(self, body: Body, result: Value, way: Way) -> Iterator[Node]:
        found: list[tuple[Clause, AggregateInput, Way]] = []
        given, most = body.arguments(way), MOST_ELEMENTS + 1
        for clause in body.clauses:
            sql = self._queries.get(clause.query)
            if sql is None or not clause.collected:
                yield Node("note", "its rows could not be queried")
                return
            ways = self._relations.ways(sql, given, max_rows=most - len(found))
            found += [(clause, clause.collected[0], inner) for inner in ways]
        is_all = len(found) < most
        if not found:
            yield Node("note", AGGREGATES_NO_ROWS, children=self.refuted(body, way))
            return
        yield from self.contributors(found[:MOST_ELEMENTS], result, is_all)

    def _robots(self, clause: Clause, way: Way) -> dict[str, dict[str, None]]:
        """Return what an element was read from, by robot."""
        found: dict[str, dict[str, None]] = {}
        steps = [s for s in clause.steps if s.call and "robot_name" in s.call.arguments]
        reading = [s for s in steps if s.reads or (s.call and s.call.predicate not in INPUTS)]
        for call in (step.call for step in reading or steps):
            robot = value_of(way, call.arguments["robot_name"]) if call else None
            if call and isinstance(robot, str):
                name = call.predicate
                found.setdefault(robot, {})[name.lower() if name in INPUTS else name] = None
        return found

    def _is_of_others(self, found: Sequence[tuple[Clause, AggregateInput, Way]]) -> bool:
        return any(self._robots(clause, way).keys() - {self._robot} for clause, _, way in found)

    def _whose(self, clause: Clause, way: Way) -> str:
        """Return what an element was read from: ``Bo's memory``."""
        robots = self._robots(clause, way)
        others = {robot: what for robot, what in robots.items() if robot != self._robot}
        return " and ".join(f"{r}'s {' and '.join(what)}" for r, what in (others or robots).items())

    def _element(self, collected: AggregateInput, way: Way, said: str) -> Node:
        value = value_of(way, collected.value)
        by = f" -> {spell(value_of(way, collected.by), is_rounded=True)}" if collected.by else ""
        span = collected.term.span if collected.term is not None else None
        text = span.text if span is not None else collected.operator
        return Node("contributor", f"{text}{by}", said, True, (value,), span=span)


def grouped(nodes: Sequence[Node], taken: Sequence[Span]) -> list[Node]:
    """Put the nodes of each alternative that holds under a node of its own."""
    found = [*nodes]
    for span in reversed(taken):
        inside = [n for n in found if n.span is not None and span.holds(n.span)]
        if inside:
            first = found.index(inside[0])
            found = [node for node in found if node not in inside]
            chosen = Node("alternative", span.text, "this alternative holds", True, span=span)
            found.insert(first, replace(chosen, children=tuple(inside)))
    return found


def winner(
    relations: Relations,
    queries: Mapping[str, str],
    found: Sequence[tuple[Clause, AggregateInput, Way]],
    result: Value,
    *,
    is_all: bool = True,
) -> tuple[Clause, AggregateInput, Way] | None:
    """Return the element that determines an aggregate's result; raise FailureError."""
    for are_equal in (operator.eq, same, alike):
        equal = [each for each in found if are_equal(value_of(each[2], each[1].value), result)]
        if equal:
            break
    else:
        return None
    if not equal[0][1].by:
        return equal[0] if result is not None else None
    if not is_all:
        return None  # another one may have the better key
    aggregate = "arg_min" if equal[0][1].operator == "ArgMin" else "arg_max"
    columns = {(queries.get(clause.query, ""), one.by) for clause, one, _ in equal}
    keys = [way.get(one.by) for _, one, way in equal]
    best = relations.chosen_key(aggregate, columns, keys)
    return None if best is None else equal[best]


def value_of(way: Way, place: str) -> Value:
    return from_sql(way.get(place))


def ask_of(call: Call, way: Way) -> Ask:
    """Return the question which rows a call matches in one way."""
    places = {column: place for column, place in call.arguments.items() if place in way}
    given = {column: value_of(way, place) for column, place in places.items()}
    return Ask(call.predicate, given, call.within)


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


def number_of(number: int, what: str, *, is_all: bool) -> str:
    more = "" if is_all else " or more"
    ending = "" if number == 1 else "es" if what.endswith("ch") else "s"
    return f"{number:,}{more} {what}{ending}"
