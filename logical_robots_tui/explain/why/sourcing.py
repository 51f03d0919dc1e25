"""The source of a value at one moment: the expression that made it, and what it was made from.

A value is traced through one derivation back to computations, to facts, and to what was read
from sensors and memories. What only passes a value on is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.explain.why.deriving import Element, ask_of, value_of, winner
from logical_robots_tui.explain.why.explanation import (
    Ask,
    Condition,
    Path,
    Read,
    Subject,
    ValueSource,
    part_of,
)
from logical_robots_tui.explain.why.probing import (
    DECIDED_BY_ONE,
    Body,
    Clause,
    PredicateCall,
    Probing,
    SourceSpan,
    Step,
    Term,
)
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import Way, alike
from logical_robots_tui.schema import INPUTS, VALUE
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.derivations import Derivations, DerivedRow

_MOST_ROWS = 200  # to derive
_DEEPEST = 40  # rows within rows
_MOST_ELEMENTS = 10  # of an aggregate that are traced
_RADAR = ("radar",)


@dataclass(frozen=True, slots=True, eq=False)
class _ClauseFrame:
    probing: Probing
    rule: SourceSpan
    clause: Clause
    match: Way
    outer_values: dict[str, tuple[_ClauseFrame, str, Term | None]] = field(default_factory=dict)


def source_of(derivations: Derivations, subject: Subject) -> ValueSource:
    """Return the source of a value; raise QueryError."""
    try:
        return _SourceTracer(derivations).subject(subject)
    except FailureError as failure:
        raise QueryError(f"{subject.query.predicate} failed: {failure}.") from None


class _SourceTracer:
    def __init__(self, derivations: Derivations) -> None:
        self._derivations = derivations
        self._rows: dict[str, DerivedRow] = {}
        self._variable_sources: dict[tuple[_ClauseFrame, str, Path], ValueSource] = {}
        self._open: set[tuple[_ClauseFrame, str, Path]] = set()
        self._depth = 0

    def subject(self, subject: Subject) -> ValueSource:
        if not subject.span and not subject.variable:
            return self._in_row(subject.query, self._column(subject), subject.path)
        derived = self._derived_row(subject.query)
        frames = [_frame(derived.probing, *match, None) for match in derived.matches]
        for frame in frames:
            if (source := self._expression_source(frame, subject)) is not None:
                return source
        raise QueryError("The origin of this value can't be determined.")

    def _column(self, subject: Subject) -> str:
        derived, name = self._derived_row(subject.query), subject.query.predicate
        labels = {self._derivations.relations.label(name, column): column for column in derived.row}
        column = labels.get(subject.column, subject.column)
        free = [column for column in derived.row if column not in derived.probing.parameters]
        free = [column for column in free if column != "robot_name"] or free
        if not column and len(free) == 1:
            column = free[0]
        if column not in derived.row:
            wrong = f"has no column {column}; it has" if column else "has more than one column:"
            raise QueryError(f"{name} {wrong} {', '.join(labels)}.")
        return column

    def _expression_source(self, frame: _ClauseFrame, subject: Subject) -> ValueSource | None:
        """Return the source of an expression or variable of a clause, also inside aggregates."""
        clause, match = frame.clause, frame.match
        for step in clause.steps:
            place = step.bindings.get(subject.variable, "")
            if step.span == subject.span and len(step.bindings) == 1:
                (place,) = step.bindings.values()
            if place and alike(value_of(match, place), subject.value):
                return self._variable(frame, place, subject.path)
        for term in clause.all_terms():
            if term.span == subject.span and alike(value_of(match, term.column), subject.value):
                return self._term(frame, term, subject.path)
        for term in clause.all_terms():
            elements = (
                self._derivations.elements(frame.probing, term.body, match) if term.body else ()
            )
            for inner in elements:
                assert term.body is not None
                source = self._expression_source(_inner(frame, term.body, *inner), subject)
                if source is not None:
                    return source
        return None

    def _derived_row(self, query: Ask) -> DerivedRow:
        if query.key not in self._rows:
            if len(self._rows) >= _MOST_ROWS:
                raise QueryError("This goes through too many rows to be traced.")
            self._rows[query.key] = self._derivations.first_row(query)
        return self._rows[query.key]

    def _in_row(
        self,
        query: Ask,
        column: str,
        path: Path,
        caller: tuple[_ClauseFrame, PredicateCall] | None = None,
    ) -> ValueSource:
        self._depth += 1
        try:
            if self._depth > _DEEPEST:
                raise QueryError("This goes through too many predicates to be traced.")
            derived = self._derived_row(query)
            value = part_of(derived.row[column], path) if caller is None else derived.row[column]
            label = self._derivations.relations.label(query.predicate, column)
            name = f"{query.predicate}.{label}"
            frames = [_frame(derived.probing, *match, caller) for match in derived.matches]
            term = derived.matches[0][1].terms.get(column)
            if all(aggregate.column != column for aggregate in derived.matches[0][1].aggregates):
                rule = frames[0].rule
                source = (
                    ValueSource(name, value, rule, rule, is_constant=True)
                    if term is None
                    else self._term(frames[0], term, path)
                )
            else:
                elements = [
                    (clause, next(c for c in clause.aggregates if c.column == column), match)
                    for _, clause, match in derived.matches
                ]
                aggregate, span = elements[0][1], frames[0].rule
                if aggregate.term is not None:
                    text = f"{aggregate.operator}= {aggregate.term.span.text}"
                    span = replace(aggregate.term.span, text=text)
                source = self._aggregate(elements, frames, derived.row[column], path, span)
            return replace(source, name=name, value=value) if caller is None else source
        finally:
            self._depth -= 1

    def _term(self, frame: _ClauseFrame, term: Term, path: Path) -> ValueSource:
        if term.kind == "variable":
            return self._variable(frame, term.column, path)
        if term.kind in ("field", "cast"):
            return self._term(frame, term.parts[0], (*term.names, *path))
        if term.kind == "record" and path:
            parts = dict(zip(term.names, term.parts, strict=True))
            if path[0] in parts:
                return self._term(frame, parts[str(path[0])], path[1:])
            return ValueSource(term.span.text, None, term.span, frame.rule)
        if term.kind == "if":
            return self._branch(frame, term, path)
        if term.kind == "coalesce":
            for part in term.parts:
                if value_of(frame.match, part.column) is not None:
                    return self._term(frame, part, path)
        if term.kind == "call" and term.call is not None:
            return self._call_source(frame, term.call, VALUE, path)
        if term.kind == "aggregate" and term.body is not None:
            matches = self._derivations.elements(frame.probing, term.body, frame.match)
            elements = [
                (clause, clause.aggregates[0], match)
                for clause, match in matches
                if clause.aggregates
            ]
            frames = [_inner(frame, term.body, clause, match) for clause, _, match in elements]
            value = value_of(frame.match, term.column)
            source = self._aggregate(elements, frames, value, path, term.span)
            return source if frames else replace(source, rule=frame.rule)
        return self._computed(frame, term, path)

    def _computed(self, frame: _ClauseFrame, term: Term, path: Path) -> ValueSource:
        value = _part(value_of(frame.match, term.column), path)
        if term.kind == "truth" and value is not None:
            value = bool(value)
        if term.kind == "record":
            fields = zip(term.names, term.parts, strict=True)
            inputs = [replace(self._term(frame, part, ()), name=name) for name, part in fields]
        else:
            inputs = [self._named_source(frame, part) for part in _operands(term)]
        return ValueSource(
            *(term.span.text, value, term.span, frame.rule),
            inputs=_unique(inputs),
            is_constant=not term.parts and term.kind in ("literal", "value", "record"),
        )

    def _named_source(self, frame: _ClauseFrame, term: Term) -> ValueSource:
        return replace(self._term(frame, term, ()), name=term.span.text)

    def _branch(self, frame: _ClauseFrame, term: Term, path: Path) -> ValueSource:
        *branches, value_term = term.parts
        condition, holds = branches[-2], False
        for candidate, value in zip(branches[::2], branches[1::2], strict=True):
            if value_of(frame.match, candidate.column):
                condition, value_term, holds = candidate, value, True
                break
        source = self._term(frame, value_term, path)
        conditions = (Condition(condition.span, holds), *source.conditions)
        if source.is_constant:
            is_compared = condition.kind == "truth"
            parts = [*_operands(condition)] if is_compared else [condition]
            decided_by = [self._named_source(frame, part) for part in parts]
            source = replace(source, decided_by=_unique([*decided_by, *source.decided_by]))
        return replace(source, conditions=conditions)

    def _variable(self, frame: _ClauseFrame, place: str, path: Path) -> ValueSource:
        """Return the source of a variable; a memory that a join makes equal to it comes first."""
        key = frame, place, path
        if key in self._open:
            raise QueryError("This value is only compared with itself.")
        if key not in self._variable_sources:
            self._open.add(key)
            try:
                self._variable_sources[key] = min(self._candidates(frame, place, path), key=_rank)
            finally:
                self._open.remove(key)
        return self._variable_sources[key]

    def _candidates(self, frame: _ClauseFrame, place: str, path: Path) -> Sequence[ValueSource]:
        sources: list[ValueSource] = []
        last_error: QueryError | None = None
        for step in _binding(frame.clause, place):
            try:
                sources.append(self._step(frame, step, place, path))
            except QueryError as error:
                last_error = error
        if sources:
            return sources
        if place in frame.outer_values:
            outer, outer_place, term = frame.outer_values[place]
            if term is not None:
                return (self._term(outer, term, path),)
            return (self._variable(outer, outer_place, path),)
        if last_error is not None:
            raise last_error
        value = _part(value_of(frame.match, place), path)
        span = None if place in frame.clause.parameters else frame.rule  # None: the query has it
        return (ValueSource("", value, span, span, is_constant=True),)

    def _step(self, frame: _ClauseFrame, step: Step, place: str, path: Path) -> ValueSource:
        if step.call is not None:
            column = [c for c, p in step.call.arguments.items() if p == place][-1]
            source = self._call_source(frame, step.call, column, path)
            return self._fact_source(frame, step, source) if source.is_constant else source
        if step.kind == "element":
            items = value_of(frame.match, step.terms[0].column)
            value = value_of(frame.match, place)
            numbered = enumerate(items if isinstance(items, list) else ())
            number = next((number for number, item in numbered if alike(item, value)), 0)
            return self._term(frame, step.terms[0], (number, *path))
        terms = [term for term in step.terms if term.column != place]
        if len(terms) == 1:
            return self._term(frame, terms[0], path)
        value = _part(value_of(frame.match, place), path)
        return ValueSource(step.span.text, value, step.span, frame.rule)

    def _fact_source(self, frame: _ClauseFrame, step: Step, source: ValueSource) -> ValueSource:
        """Return a constant from a fact with the keys of the join that chose the fact."""
        assert step.call is not None
        keys = [
            self._step(frame, binder, place, ())
            for place in dict.fromkeys(step.call.arguments.values())
            for binder in _binding(frame.clause, place)
            if binder is not step and binder.kind == "value"
        ]
        keys = [key for key in keys if not key.is_constant]
        return replace(source, inputs=_unique([*source.inputs, *keys]))

    def _call_source(
        self, frame: _ClauseFrame, call: PredicateCall, column: str, path: Path
    ) -> ValueSource:
        query = ask_of(call, frame.match)
        if call.predicate not in INPUTS:
            return self._in_row(query, column, path, (frame, call))
        whole = query.given[column]
        if column == "robot_name":
            return ValueSource(column, whole, frame.rule, frame.rule, is_constant=True)
        kind: Literal["sensor", "memory"] = "sensor" if column == "sensor" else "memory"
        own_robot, robot = self._derivations.robot, query.given.get("robot_name")
        if not robot:  # it is the robot's that thinks, by preference
            names = self._derivations.relations.owners(kind, whole)
            robot = own_robot if own_robot in names or not names else names[0]
        if kind == "sensor" and path[:1] == _RADAR:
            path = path[:2]
        read = Read(kind, str(robot), path, _part(whole, path))
        return ValueSource("", read.value, None, frame.rule, read)

    def _aggregate(
        self,
        elements: Sequence[Element],
        frames: Sequence[_ClauseFrame],
        value: Value,
        path: Path,
        span: SourceSpan,
    ) -> ValueSource:
        if not elements:
            return ValueSource(span.text, _part(value, path), span)
        index = None
        if elements[0][1].operator in DECIDED_BY_ONE:
            queries = frames[0].probing.queries
            best = winner(self._derivations.relations, queries, elements, value)
            index = next((n for n, element in enumerate(elements) if element is best), None)
        elif path and isinstance(value, list) and isinstance(path[0], int):
            target = part_of(value, path[:1])
            values = [value_of(match, aggregate.value) for _, aggregate, match in elements]
            index = next((n for n, v in enumerate(values) if alike(v, target)), None)
            path = path[1:]
        if index is not None and (term := elements[index][1].term) is not None:
            return self._term(frames[index], term, path)
        inputs: list[ValueSource] = []
        for (_, aggregate, _), frame in zip(elements[:_MOST_ELEMENTS], frames, strict=False):
            if aggregate.term is not None:
                source = self._term(frame, aggregate.term, ())
                is_own = source.span is not None and span.holds(source.span)
                inputs += (
                    source.inputs if is_own else (replace(source, name=aggregate.term.span.text),)
                )
        excess = max(0, len(elements) - _MOST_ELEMENTS) if inputs else 0
        rule = frames[0].rule
        return ValueSource(span.text, value, span, rule, inputs=_unique(inputs), excess=excess)


def _binding(clause: Clause, place: str) -> Iterator[Step]:
    """Yield the steps that give a variable its value, or make it equal to another."""
    for step in clause.steps:
        if step.call is not None:
            columns = [c for c, p in step.call.arguments.items() if p == place]
            if step.kind == "function":
                columns = [column for column in columns if column == VALUE]
            if columns and (place in step.bindings.values() or columns != ["robot_name"]):
                yield step
        elif step.kind == "element" or len(step.bindings) > 1:
            if place in step.bindings.values():
                yield step
        elif step.kind == "value" and place in (term.column for term in step.terms):
            terms = [term for term in step.terms if term.column != place]
            if place in step.bindings.values() or any(term.kind != "literal" for term in terms):
                yield step


def _operands(term: Term) -> Iterator[Term]:
    """Yield the operands of a term, of conditions within a condition as well."""
    for part in term.parts:
        if part.kind == "truth" and term.kind == "truth":
            yield from _operands(part)
        elif part.kind != "literal":
            yield part


def _rank(source: ValueSource) -> int:
    """Return the rank of a source: memories first, then sensors, computations and constants."""
    if source.read is not None:
        return 0 if source.read.kind == "memory" else 1
    return 3 if source.is_constant else 2


def _unique(sources: Iterable[ValueSource]) -> tuple[ValueSource, ...]:
    return tuple({repr(s.read or (s.name, s.value)): s for s in sources}.values())


def _part(value: Value, path: Path) -> Value:
    try:
        return part_of(value, path)
    except QueryError:
        return None


def _frame(
    probing: Probing,
    rule: SourceSpan,
    clause: Clause,
    match: Way,
    caller: tuple[_ClauseFrame, PredicateCall] | None,
) -> _ClauseFrame:
    frame = _ClauseFrame(probing, rule, clause, match)
    if caller is not None:
        outer, call = caller
        columns = {f"g{number}": column for number, column in enumerate(probing.parameters)}
        for place, name in clause.parameters.items():
            column = columns[name]
            if column in call.arguments:
                frame.outer_values[place] = outer, call.arguments[column], call.terms.get(column)
    return frame


def _inner(outer: _ClauseFrame, body: Body, clause: Clause, match: Way) -> _ClauseFrame:
    frame = _ClauseFrame(outer.probing, outer.rule, clause, match)
    for place, name in clause.parameters.items():
        frame.outer_values[place] = outer, body.outer_columns[name], None
    return frame
