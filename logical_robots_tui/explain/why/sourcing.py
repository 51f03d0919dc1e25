"""The source of a value at one moment: the expression that made it, and what it was made from.

A value is traced through one derivation back to computations, to facts, and to what was read
from sensors and memories. What only passes a value on is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.explain.why.deriving import ask_of, value_of, winner
from logical_robots_tui.explain.why.explanation import (
    Ask,
    Condition,
    Path,
    Read,
    Source,
    Subject,
    part_of,
)
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
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import Way, alike
from logical_robots_tui.schema import INPUTS, VALUE
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.derivations import Derivations, Derived

_MOST_ROWS = 200  # that are derived
_DEEPEST = 40  # rows within rows
_MOST_ELEMENTS = 10  # of an aggregate that are traced
_RADAR = ("radar",)


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    probing: Probing
    rule: Span
    clause: Clause
    way: Way
    given: dict[str, tuple[_Frame, str, Term | None]] = field(default_factory=dict)


def source_of(derivations: Derivations, subject: Subject) -> Source:
    """Return the source of a value; raise QueryError."""
    try:
        return _Sourcing(derivations).subject(subject)
    except FailureError as failure:
        raise QueryError(f"{subject.asked.predicate} failed: {failure}.") from None


class _Sourcing:
    def __init__(self, derivations: Derivations) -> None:
        self._derivations = derivations
        self._rows: dict[str, Derived] = {}
        self._known: dict[tuple[_Frame, str, Path], Source] = {}
        self._open: set[tuple[_Frame, str, Path]] = set()
        self._depth = 0

    def subject(self, subject: Subject) -> Source:
        if not subject.span and not subject.variable:
            return self._in_row(subject.asked, self._column(subject), subject.path)
        derived = self._first(subject.asked)
        frames = [_frame(derived.probing, *each, None) for each in derived.ways]
        for frame in frames:
            if (found := self._inside(frame, subject)) is not None:
                return found
        raise QueryError("The origin of this value can't be determined.")

    def _column(self, subject: Subject) -> str:
        derived, name = self._first(subject.asked), subject.asked.predicate
        labels = {self._derivations.relations.label(name, each): each for each in derived.row}
        column = labels.get(subject.column, subject.column)
        free = [each for each in derived.row if each not in derived.probing.given]
        free = [each for each in free if each != "robot_name"] or free
        if not column and len(free) == 1:
            column = free[0]
        if column not in derived.row:
            wrong = f"has no column {column}; it has" if column else "has more than one column:"
            raise QueryError(f"{name} {wrong} {', '.join(labels)}.")
        return column

    def _inside(self, frame: _Frame, subject: Subject) -> Source | None:
        """Return the source of an expression or variable of a clause, also inside aggregates."""
        clause, way = frame.clause, frame.way
        for step in clause.steps:
            place = step.gives.get(subject.variable, "")
            if step.span == subject.span and len(step.gives) == 1:
                (place,) = step.gives.values()
            if place and alike(value_of(way, place), subject.value):
                return self._variable(frame, place, subject.path)
        for term in clause.all_terms():
            if term.span == subject.span and alike(value_of(way, term.column), subject.value):
                return self._term(frame, term, subject.path)
        for term in clause.all_terms():
            ways = self._derivations.elements(frame.probing, term.body, way) if term.body else ()
            for inner in ways:
                assert term.body is not None
                found = self._inside(_inner(frame, term.body, *inner), subject)
                if found is not None:
                    return found
        return None

    def _first(self, asked: Ask) -> Derived:
        if asked.key not in self._rows:
            if len(self._rows) >= _MOST_ROWS:
                raise QueryError("This goes through too many rows to be traced.")
            self._rows[asked.key] = self._derivations.first(asked)
        return self._rows[asked.key]

    def _in_row(
        self, asked: Ask, column: str, path: Path, caller: tuple[_Frame, Call] | None = None
    ) -> Source:
        self._depth += 1
        try:
            if self._depth > _DEEPEST:
                raise QueryError("This goes through too many predicates to be traced.")
            derived = self._first(asked)
            value = part_of(derived.row[column], path) if caller is None else derived.row[column]
            label = self._derivations.relations.label(asked.predicate, column)
            name = f"{asked.predicate}.{label}"
            frames = [_frame(derived.probing, *each, caller) for each in derived.ways]
            term = derived.ways[0][1].terms.get(column)
            if all(each.column != column for each in derived.ways[0][1].collected):
                rule = frames[0].rule
                found = (
                    Source(name, value, rule, rule, is_constant=True)
                    if term is None
                    else self._term(frames[0], term, path)
                )
            else:
                collected = [
                    (clause, next(c for c in clause.collected if c.column == column), way)
                    for _, clause, way in derived.ways
                ]
                one, span = collected[0][1], frames[0].rule
                if one.term is not None:
                    text = f"{one.operator}= {one.term.span.text}"
                    span = replace(one.term.span, text=text)
                found = self._aggregate(collected, frames, derived.row[column], path, span)
            return replace(found, name=name, value=value) if caller is None else found
        finally:
            self._depth -= 1

    def _term(self, frame: _Frame, term: Term, path: Path) -> Source:
        if term.kind == "variable":
            return self._variable(frame, term.column, path)
        if term.kind in ("field", "cast"):
            return self._term(frame, term.parts[0], (*term.names, *path))
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
            ways = self._derivations.elements(frame.probing, term.body, frame.way)
            found = [(clause, clause.collected[0], way) for clause, way in ways if clause.collected]
            frames = [_inner(frame, term.body, clause, way) for clause, _, way in found]
            value = value_of(frame.way, term.column)
            made = self._aggregate(found, frames, value, path, term.span)
            return made if frames else replace(made, rule=frame.rule)
        return self._computed(frame, term, path)

    def _computed(self, frame: _Frame, term: Term, path: Path) -> Source:
        value = _part(value_of(frame.way, term.column), path)
        if term.kind == "truth" and value is not None:
            value = bool(value)
        if term.kind == "record":
            fields = zip(term.names, term.parts, strict=True)
            inputs = [replace(self._term(frame, part, ()), name=name) for name, part in fields]
        else:
            inputs = [self._named(frame, part) for part in _operands(term)]
        return Source(
            *(term.span.text, value, term.span, frame.rule),
            inputs=_distinct(inputs),
            is_constant=not term.parts and term.kind in ("literal", "value", "record"),
        )

    def _named(self, frame: _Frame, term: Term) -> Source:
        return replace(self._term(frame, term, ()), name=term.span.text)

    def _branch(self, frame: _Frame, term: Term, path: Path) -> Source:
        *branches, chosen = term.parts
        condition, holds = branches[-2], False
        for each, value in zip(branches[::2], branches[1::2], strict=True):
            if value_of(frame.way, each.column):
                condition, chosen, holds = each, value, True
                break
        found = self._term(frame, chosen, path)
        conditions = (Condition(condition.span, holds), *found.conditions)
        if found.is_constant:
            is_compared = condition.kind == "truth"
            parts = [*_operands(condition)] if is_compared else [condition]
            decided_by = [self._named(frame, part) for part in parts]
            found = replace(found, decided_by=_distinct([*decided_by, *found.decided_by]))
        return replace(found, conditions=conditions)

    def _variable(self, frame: _Frame, place: str, path: Path) -> Source:
        """Return the source of a variable; of one that a join makes equal to a memory, that."""
        key = frame, place, path
        if key in self._open:
            raise QueryError("This value is only compared with itself.")
        if key not in self._known:
            self._open.add(key)
            try:
                self._known[key] = min(self._candidates(frame, place, path), key=_rank)
            finally:
                self._open.remove(key)
        return self._known[key]

    def _candidates(self, frame: _Frame, place: str, path: Path) -> Sequence[Source]:
        found: list[Source] = []
        trouble: QueryError | None = None
        for step in _binding(frame.clause, place):
            try:
                found.append(self._step(frame, step, place, path))
            except QueryError as error:
                trouble = error
        if found:
            return found
        if place in frame.given:
            outer, outer_place, term = frame.given[place]
            if term is not None:
                return (self._term(outer, term, path),)
            return (self._variable(outer, outer_place, path),)
        if trouble is not None:
            raise trouble
        value = _part(value_of(frame.way, place), path)
        span = None if place in frame.clause.given else frame.rule  # else it was asked for
        return (Source("", value, span, span, is_constant=True),)

    def _step(self, frame: _Frame, step: Step, place: str, path: Path) -> Source:
        if step.call is not None:
            column = [c for c, p in step.call.arguments.items() if p == place][-1]
            found = self._called(frame, step.call, column, path)
            return self._chosen(frame, step, found) if found.is_constant else found
        if step.kind == "element":
            items = value_of(frame.way, step.terms[0].column)
            value = value_of(frame.way, place)
            each = enumerate(items if isinstance(items, list) else ())
            number = next((number for number, item in each if alike(item, value)), 0)
            return self._term(frame, step.terms[0], (number, *path))
        others = [term for term in step.terms if term.column != place]
        if len(others) == 1:
            return self._term(frame, others[0], path)
        value = _part(value_of(frame.way, place), path)
        return Source(step.span.text, value, step.span, frame.rule)

    def _chosen(self, frame: _Frame, step: Step, found: Source) -> Source:
        """Return a constant from a fact with the keys of the join that chose the fact."""
        assert step.call is not None
        keys = [
            self._step(frame, other, place, ())
            for place in dict.fromkeys(step.call.arguments.values())
            for other in _binding(frame.clause, place)
            if other is not step and other.kind == "value"
        ]
        keys = [key for key in keys if not key.is_constant]
        return replace(found, inputs=_distinct([*found.inputs, *keys]))

    def _called(self, frame: _Frame, call: Call, column: str, path: Path) -> Source:
        asked = ask_of(call, frame.way)
        if call.predicate not in INPUTS:
            return self._in_row(asked, column, path, (frame, call))
        whole = asked.given[column]
        if column == "robot_name":
            return Source(column, whole, frame.rule, frame.rule, is_constant=True)
        what: Literal["sensor", "memory"] = "sensor" if column == "sensor" else "memory"
        own, robot = self._derivations.robot, asked.given.get("robot_name")
        if not robot:  # it is the robot's that thinks, by preference
            names = self._derivations.relations.owners(what, whole)
            robot = own if own in names or not names else names[0]
        if what == "sensor" and path[:1] == _RADAR:
            path = path[:2]
        read = Read(what, str(robot), path, _part(whole, path))
        return Source("", read.value, None, frame.rule, read)

    def _aggregate(
        self,
        found: Sequence[tuple[Clause, AggregateInput, Way]],
        frames: Sequence[_Frame],
        value: Value,
        path: Path,
        span: Span,
    ) -> Source:
        if not found:
            return Source(span.text, _part(value, path), span)
        chosen = None
        if found[0][1].operator in DECIDED_BY_ONE:
            queries = frames[0].probing.queries
            best = winner(self._derivations.relations, queries, found, value)
            chosen = next((n for n, each in enumerate(found) if each is best), None)
        elif path and isinstance(value, list) and isinstance(path[0], int):
            wanted = part_of(value, path[:1])
            values = [value_of(way, one.value) for _, one, way in found]
            chosen = next((n for n, each in enumerate(values) if alike(each, wanted)), None)
            path = path[1:]
        if chosen is not None and (term := found[chosen][1].term) is not None:
            return self._term(frames[chosen], term, path)
        inputs: list[Source] = []
        for (_, one, _), frame in zip(found[:_MOST_ELEMENTS], frames, strict=False):
            if one.term is not None:
                made = self._term(frame, one.term, ())
                is_own = made.span is not None and span.holds(made.span)
                inputs += made.inputs if is_own else (replace(made, name=one.term.span.text),)
        more = max(0, len(found) - _MOST_ELEMENTS) if inputs else 0
        rule = frames[0].rule
        return Source(span.text, value, span, rule, inputs=_distinct(inputs), more=more)


def _binding(clause: Clause, place: str) -> Iterator[Step]:
    """Yield the steps that give a variable its value, or make it equal to another."""
    for step in clause.steps:
        if step.call is not None:
            columns = [c for c, p in step.call.arguments.items() if p == place]
            if step.kind == "function":
                columns = [column for column in columns if column == VALUE]
            if columns and (place in step.gives.values() or columns != ["robot_name"]):
                yield step
        elif step.kind == "element" or len(step.gives) > 1:
            if place in step.gives.values():
                yield step
        elif step.kind == "value" and place in (term.column for term in step.terms):
            others = [term for term in step.terms if term.column != place]
            if place in step.gives.values() or any(term.kind != "literal" for term in others):
                yield step


def _operands(term: Term) -> Iterator[Term]:
    """Yield what is computed with or compared, of conditions within a condition as well."""
    for part in term.parts:
        if part.kind == "truth" and term.kind == "truth":
            yield from _operands(part)
        elif part.kind != "literal":
            yield part


def _rank(source: Source) -> int:
    """Return how well a source tells where a value comes from; memories are best."""
    if source.read is not None:
        return 0 if source.read.what == "memory" else 1
    return 3 if source.is_constant else 2


def _distinct(sources: Iterable[Source]) -> tuple[Source, ...]:
    return tuple({repr(each.read or (each.name, each.value)): each for each in sources}.values())


def _part(value: Value, path: Path) -> Value:
    try:
        return part_of(value, path)
    except QueryError:
        return None


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
