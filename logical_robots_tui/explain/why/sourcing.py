"""The origin of a value: the expression that made it, and the reads that it depends on.

A value is traced through one derivation back to a computation or to a sensor or memory.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.explain.why.deriving import ask_of, value_of, winner
from logical_robots_tui.explain.why.explanation import Ask
from logical_robots_tui.explain.why.probing import (
    DECIDED_BY_ONE,
    AggregateInput,
    Body,
    Call,
    Clause,
    Probing,
    Span,
    Step,
    Term,
)
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.relations import Way, alike
from logical_robots_tui.schema import INPUTS, VALUE
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.derivations import Derivations

Path: TypeAlias = "tuple[str | int, ...]"
"""The way to a part of a value: names of fields and places in lists."""

_DEEPEST = 60
_MOST_ELEMENTS = 50


@dataclass(frozen=True, slots=True)
class Read:
    """Something that was read from a robot's sensor or memory."""

    what: Literal["sensor", "memory"]
    robot: str
    path: Path
    value: Value


@dataclass(frozen=True, slots=True)
class Provenance:
    """The origin of a value at one moment.

    Attributes:
        span: The expression that made it; None if it was only passed on.
        reads: The distinct reads it depends on; one if it was only passed on.
    """

    span: Span | None
    rule: Span | None
    reads: tuple[Read, ...]
    value: Value = None


@dataclass(frozen=True, slots=True)
class _Frame:
    probing: Probing
    rule: Span
    clause: Clause
    way: Way
    given: dict[str, tuple[_Frame, str, Term | None]] = field(default_factory=dict)


def source_of(derivations: Derivations, path: Path) -> Provenance:
    """Return the origin of a part of the robot's new memory; raise QueryError."""
    asked = Ask(given={"robot_name": derivations.robot})
    try:
        whole, found = _Sourcing(derivations).in_row(asked, "memory", path, None)
    except FailureError as failure:
        raise QueryError(f"Robot failed: {failure}.") from None
    reads = tuple({repr(read): read for read in found.reads}.values())
    return replace(found, reads=reads, value=part_of(whole, path))


def part_of(value: Value, path: Path) -> Value:
    """Return a part of a value, or raise QueryError."""
    for place, name in enumerate(path):
        if isinstance(value, dict) and name in value:
            value = value[str(name)]
        elif isinstance(value, list) and isinstance(name, int) and -len(value) <= name < len(value):
            value = value[name]
        else:
            here = ".".join(map(str, path[:place])) or "this value"
            raise QueryError(f"{here} has no part {name}{_parts_of(value)}.")
    return value


def _parts_of(value: Value) -> str:
    if isinstance(value, Mapping):
        return f"; it has {', '.join(value)}" if value else "; it is empty"
    if isinstance(value, list):
        return f"; it is a list of {len(value)}"
    return f"; it is {spell(value)}"


class _Sourcing:
    def __init__(self, derivations: Derivations) -> None:
        self._derivations = derivations
        self._depth = 0

    def in_row(
        self, asked: Ask, column: str, path: Path, caller: tuple[_Frame, Call] | None
    ) -> tuple[Value, Provenance]:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise QueryError("This goes through too many predicates to be followed.")
        derived = self._derivations.first(asked)
        value = derived.row[column]
        clause = derived.ways[0][1]
        collected = next((c for c in clause.collected if c.column == column), None)
        if collected is None:
            frame = _frame(derived.probing, *derived.ways[0], caller)
            return value, self._head(frame, column, path)
        found = [
            (clause, next(c for c in clause.collected if c.column == column), way)
            for _, clause, way in derived.ways
        ]
        frames = [_frame(derived.probing, *each, caller) for each in derived.ways]
        return value, self._aggregate(found, frames, value, path, derived.ways[0][0])

    def _head(self, frame: _Frame, column: str, path: Path) -> Provenance:
        term = frame.clause.terms.get(column)
        if term is None:
            return Provenance(frame.rule, frame.rule, ())
        return self._term(frame, term, path)

    def _term(self, frame: _Frame, term: Term, path: Path) -> Provenance:
        if term.kind == "variable":
            return self._variable(frame, term.column, path)
        if term.kind == "field":
            return self._term(frame, term.parts[0], (*term.names, *path))
        if term.kind == "cast":
            return self._term(frame, term.parts[0], path)
        if term.kind == "record" and path:
            parts = dict(zip(term.names, term.parts, strict=True))
            if path[0] in parts:
                return self._term(frame, parts[str(path[0])], path[1:])
        if term.kind == "if":
            return self._branch(frame, term, path)
        if term.kind == "coalesce":
            for part in term.parts:
                if value_of(frame.way, part.column) is not None:
                    return self._term(frame, part, path)
        if term.kind == "call" and term.call is not None:
            return self._called(frame, term.call, VALUE, path)
        if term.kind == "aggregate" and term.body is not None:
            return self._collected(frame, term, term.body, path)
        return self._computed(frame, term)

    def _computed(self, frame: _Frame, term: Term) -> Provenance:
        reads = [read for part in term.parts for read in self._term(frame, part, ()).reads]
        return Provenance(term.span, frame.rule, tuple(reads))

    def _branch(self, frame: _Frame, term: Term, path: Path) -> Provenance:
        *branches, otherwise = term.parts
        for condition, value in zip(branches[::2], branches[1::2], strict=True):
            if value_of(frame.way, condition.column):
                return self._term(frame, value, path)
        return self._term(frame, otherwise, path)

    def _variable(self, frame: _Frame, place: str, path: Path) -> Provenance:
        for step in frame.clause.steps:
            if step.kind in ("call", "function") and step.call is not None:
                columns = [c for c, p in step.call.arguments.items() if p == place]
                if columns and (step.kind == "function" or place in step.gives.values()):
                    return self._called(frame, step.call, columns[-1], path)
            elif place in step.gives.values() and step.terms:
                return self._step(frame, step, place, path)
        if place in frame.given:
            outer, outer_place, term = frame.given[place]
            if term is not None:
                return self._term(outer, term, path)
            return self._variable(outer, outer_place, path)
        return Provenance(frame.rule, frame.rule, ())

    def _step(self, frame: _Frame, step: Step, place: str, path: Path) -> Provenance:
        if step.kind == "element":
            items = value_of(frame.way, step.terms[0].column)
            number = _index(items, value_of(frame.way, place))
            return self._term(frame, step.terms[0], (number, *path))
        terms = [term for term in step.terms if term.kind != "literal"]
        others = [term for term in terms if term.column != place]
        if len(others) == 1 and len(step.gives) == 1:
            return self._term(frame, others[0], path)
        return Provenance(step.span, frame.rule, ())

    def _called(self, frame: _Frame, call: Call, column: str, path: Path) -> Provenance:
        asked = ask_of(call, frame.way)
        given = asked.given
        if call.predicate in INPUTS:
            robot = str(given.get("robot_name", self._derivations.robot))
            if column == "robot_name":
                return Provenance(None, frame.rule, ())
            what: Literal["sensor", "memory"] = "sensor" if call.predicate == "Sensor" else "memory"
            try:
                value = part_of(given[column], path)
            except QueryError:
                value = None
            return Provenance(None, frame.rule, (Read(what, robot, path, value),))
        _, found = self.in_row(asked, column, path, (frame, call))
        return found

    def _collected(self, frame: _Frame, term: Term, body: Body, path: Path) -> Provenance:
        ways = self._derivations.elements(frame.probing, body, frame.way)
        found = [(clause, clause.collected[0], way) for clause, way in ways if clause.collected]
        frames = [_inner(frame, body, clause, way) for clause, _, way in found]
        value = value_of(frame.way, term.column)
        return self._aggregate(found, frames, value, path, term.span)

    def _aggregate(
        self,
        found: Sequence[tuple[Clause, AggregateInput, Way]],
        frames: Sequence[_Frame],
        value: Value,
        path: Path,
        span: Span,
    ) -> Provenance:
        rule = frames[0].rule if frames else None
        if not found:
            return Provenance(span, rule, ())
        operator = found[0][1].operator
        chosen = None
        if operator in DECIDED_BY_ONE:
            queries = frames[0].probing.queries
            best = winner(self._derivations.relations, queries, found, value)
            chosen = next((n for n, each in enumerate(found) if each is best), None)
        elif path and isinstance(value, list) and isinstance(path[0], int):
            wanted = part_of(value, path[:1])
            values = [value_of(way, one.value) for _, one, way in found]
            chosen = next((n for n, each in enumerate(values) if alike(each, wanted)), None)
            path = path[1:]
        if chosen is not None:
            term = found[chosen][1].term
            if term is not None:
                return self._term(frames[chosen], term, path)
        reads = [
            read
            for (_, one, _), frame in zip(found[:_MOST_ELEMENTS], frames, strict=False)
            if one.term is not None
            for read in self._term(frame, one.term, ()).reads
        ]
        return Provenance(span, rule, tuple(reads))


def _frame(
    probing: Probing, rule: Span, clause: Clause, way: Way, caller: tuple[_Frame, Call] | None
) -> _Frame:
    frame = _Frame(probing, rule, clause, way)
    if caller is not None:
        outer, call = caller
        columns = {f"g{number}": column for number, column in enumerate(probing.given)}
        for place, name in clause.given.items():
            column = columns[name]
            if column in call.arguments:
                frame.given[place] = outer, call.arguments[column], call.terms.get(column)
    return frame


def _inner(outer: _Frame, body: Body, clause: Clause, way: Way) -> _Frame:
    frame = _Frame(outer.probing, outer.rule, clause, way)
    for place, name in clause.given.items():
        frame.given[place] = outer, body.given[name], None
    return frame


def _index(items: Value, value: Value) -> int:
    places = enumerate(items if isinstance(items, list) else ())
    return next((number for number, item in places if alike(item, value)), 0)
