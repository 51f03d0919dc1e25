"""Decompose a body into a clause per choice of alternatives, with a query for derivations.

As in the compiler, a call of the program's own predicate in an expression becomes a
separate part of the body, so that its value is computed once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from logical_robots_tui.explain.bodies import (
    AUXILIARY,
    Names,
    Scope,
    in_order,
    make_rule,
    outer_aggregates,
    part_kind,
    span_of,
    span_of_text,
    without_equations,
)
from logical_robots_tui.explain.why.probing import (
    AggregateInput,
    Body,
    Clause,
    Misread,
    PredicateCall,
    SourceSpan,
    Step,
    Term,
    TermKind,
)
from logical_robots_tui.language.source_text import Prepared, with_whole_brackets
from logical_robots_tui.language.tree import (
    COMPARISONS,
    JUNCTIONS,
    REST,
    Aggregate,
    Aggregation,
    Argument,
    Atom,
    Call,
    Choice,
    Conjunction,
    Expression,
    FieldAccess,
    Literal,
    Membership,
    Node,
    Number,
    PredicateName,
    Proposition,
    Record,
    Rule,
    Span,
    Tree,
    Variable,
    alternatives,
    arguments,
    children,
    conjuncts,
    equation_sides,
    infix_of,
    is_aggregate,
    operands,
    rebuild,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.mind.relations import GIVEN
from logical_robots_tui.schema import INPUTS, VALUE

N = TypeVar("N", bound="Node")

PROBE = "WhyProbe"
"""The prefix of the queries' names."""

_DEEPEST = 4  # nesting of bodies
_MOST_CLAUSES = 32  # of one body
_MOST_COLUMNS = 90  # SQLite's limit is 100


class Builder:
    """Decomposes bodies; `probes` collects the rules to compile, by name."""

    def __init__(self, source: Prepared, known: Names) -> None:
        self.probes: dict[str, Rule] = {}
        self.known = known
        self._source = source

    def clauses(
        self,
        body: Sequence[Proposition],
        head: Mapping[str, Expression],
        collected: Mapping[str, Aggregation],
        given: Mapping[str, Expression],
        depth: int = 0,
    ) -> tuple[Clause, ...]:
        """Return a body's clauses; `collected` holds the aggregations, `head` the other columns."""
        return tuple(
            _ClauseBuilder(self, parts, head, collected, given, depth).clause(chosen)
            for parts, chosen in alternatives(body, _MOST_CLAUSES)
        )

    def span(self, tree: Tree) -> SourceSpan:
        return span_of(tree, self._source)

    def meant(self, part: Proposition, equation: Span, value: Span) -> SourceSpan | None:
        """Return all from the value of an equation that begins a part to the end of that part."""
        if part.span is None or part.span.start != equation.start:
            return None
        start, stop = with_whole_brackets(self._source.skeleton, value.start, part.span.stop)
        is_behind = "=" in self._source.skeleton[equation.start : start]
        return span_of_text(start, stop, self._source.original) if is_behind else None


class _ClauseBuilder:
    def __init__(
        self,
        builder: Builder,
        parts: Sequence[Proposition],
        head: Mapping[str, Expression],
        collected: Mapping[str, Aggregation],
        given: Mapping[str, Expression],
        depth: int,
    ) -> None:
        self._builder, self._depth = builder, depth
        self._names = builder.known
        self._calls: dict[str, Call] = {}  # by the variable of their value
        self._equations: dict[Span, Span] = {}  # with the places of their values
        self._columns: dict[Expression, str] = {}
        self._used: set[str] = set()
        self._body: list[Proposition] = []
        for part in parts:
            self._body.append(self._without_calls(part))
        self._head = {column: self._without_calls(value) for column, value in head.items()}
        self._collected = {
            column: (str(aggregation.operator), self._without_calls(aggregation.argument))
            for column, aggregation in collected.items()
        }
        collected_values = (argument for _, argument in self._collected.values())
        everything: list[Node] = [*self._body, *self._head.values(), *collected_values]
        mentioned = variables(everything)
        self._begin: list[Proposition] = []
        self._given = given
        known: frozenset[str] = frozenset()
        if given:
            self._begin = [Atom(GIVEN, arguments(given))]
            known = variables(given.values())
        self._scope = Scope(self._names.functions, mentioned | known)
        self._known = known
        self._all = everything

    def clause(self, taken: Sequence[Proposition]) -> Clause:
        ordered, left = in_order(self._body, self._scope, self._known)
        if left:
            together = left[0] if len(left) == 1 else Conjunction(tuple(left))
            ordered.append((together, self._scope.variables))
        before = [self._known, *(after for _, after in ordered)]
        steps = []
        wanted: list[set[str]] = []  # for each step, the columns to show of it and those before
        for (part, after), known in zip(ordered, before, strict=False):
            self._used = set()
            steps.append(self._step(part, known, after))
            wanted.append(self._used.union(*wanted[-1:]))
        everywhere = {self._column(Variable(name)) for name in sorted(self._scope.variables)}
        head = {column: self._column(value) for column, value in self._head.items()}
        terms = {column: self._term(value) for column, value in self._head.items()}
        collected = tuple(self._collection(column, *of) for column, of in self._collected.items())
        always = everywhere | {*head.values()}
        wanted.append({*self._columns.values()})
        start = self._query(self._begin, self._known, always | wanted[0])
        body = list(self._begin)
        finished = []
        for step, (part, after), next_wanted in zip(steps, ordered, wanted[1:], strict=True):
            body = [*body, part]
            query = self._query(body, after, always | next_wanted)
            finished.append(replace(step, query=query))
        return Clause(
            tuple(map(self._builder.span, taken)),
            start,
            tuple(finished),
            {column: place for column, place in head.items() if place},
            terms,
            collected,
            {self._column(variable): name for name, variable in self._given.items()},
        )

    def _without_calls(self, node: N) -> N:
        """Return a part without the calls and equations in it, which become parts before it."""

        def change(inner: Node) -> Node:
            if is_aggregate(inner):
                return inner
            inner = rebuild(inner, change)
            if not isinstance(inner, Call) or inner.name not in self._names:
                return inner
            name = f"{AUXILIARY}{len(self._calls)}"
            self._calls[name] = inner
            value = Argument(VALUE, Variable(name))
            self._body.append(Atom(inner.name, (*inner.arguments, value), span=inner.span))
            return Variable(name, span=inner.span)

        node, equations = without_equations(node)
        for each in equations:
            _, value = operands(each.arguments)
            if each.span is not None and value.span is not None:
                self._equations[each.span] = value.span
            self._body.append(change(each))  # type: ignore[arg-type]  # a kind for its kind
        return change(node)  # type: ignore[return-value]  # a kind for its kind

    def _step(self, part: Proposition, known: frozenset[str], after: frozenset[str]) -> Step:
        new = sorted(name for name in after - known if not name.startswith(AUXILIARY))
        gives = {name: self._column(Variable(name)) for name in new}
        kind = part_kind(part, self._names)
        span = self._builder.span(part)
        if isinstance(part, Atom) and kind == "call":
            called, reads = self._call(part), self._reads(part)
            function = self._calls.get(variable_of(next(_values_in(part, VALUE), None)))
            if function is not None:
                return Step("function", self._builder.span(function), "", gives, call=called)
            return Step(kind, span, "", gives, call=called, reads=reads)
        if kind == "denial":
            (denied,) = outer_aggregates(part)
            return Step(kind, span, "", gives, denial=self._inner(denied))
        shown = self._shown(part, is_test=after == known)
        return Step(
            kind, span, "", gives, tuple(map(self._term, shown)), misread=self._misread(part)
        )

    def _misread(self, part: Proposition) -> Misread | None:
        for node in walk(part, is_aggregate):
            infix = infix_of(node)
            equation = (
                next((s.span for s in infix.sides if s.span in self._equations), None)
                if infix
                else None
            )
            if infix is None or equation is None:
                continue
            sides = self._term(infix.left), self._term(infix.right)
            return Misread(
                infix.operator,
                sides,
                self._builder.meant(part, equation, self._equations[equation]),
            )
        return None

    @staticmethod
    def _shown(part: Proposition, *, is_test: bool) -> Sequence[Expression]:
        if isinstance(part, Membership):
            return [part.collection, part.element] if is_test else [part.collection]
        if (pair := equation_sides(part)) is not None:
            return pair
        return operands(part.arguments) if isinstance(part, Atom) else ()

    def _call(self, atom: Atom) -> PredicateCall:
        given = {
            each.column: each.expression
            for each in atom.arguments
            if each.expression and each.field != REST
        }
        columns = {name: self._column(value) for name, value in given.items()}
        columns = {name: column for name, column in columns.items() if column}
        if atom.name in INPUTS:
            return PredicateCall(str(atom.name), "", columns)
        terms = {name: self._term(value) for name, value in given.items() if name != VALUE}
        terms = {c: term for c, term in terms.items() if term.kind not in ("literal", "variable")}
        return replace(self._names.call(atom.name, columns), terms=terms)

    def _reads(self, atom: Atom) -> tuple[Term, ...]:
        found: dict[Expression, Expression] = {}
        columns = INPUTS.get(atom.name, ())
        for column in (*columns, REST) if columns else ():
            for value in _values_in(atom, column):
                root = variable_of(value)
                mine = [each for each in _chains(self._all) if _chain_root(each) == root]
                for chain in mine:
                    found.setdefault(chain, chain)
                if column == "memory" and root and not mine:
                    found[value] = value
        return tuple(map(self._term, found.values()))

    def _term(self, node: Expression) -> Term:
        kind = _kind_of(node)
        span = self._builder.span(node)
        if kind == "literal":
            return Term("literal", span, self._column(node))
        if variable_of(node) in self._calls:
            return self._called_term(variable_of(node), self._column(node))
        if isinstance(node, Aggregate):
            body = self._inner(node) if self._depth < _DEEPEST else None
            return Term("aggregate", span, self._column(node), body=body)
        parts = tuple(map(self._term, _parts_of(node)))
        return Term(kind, span, self._column(node), parts, _names_of(node))

    def _called_term(self, name: str, column: str) -> Term:
        """Return the term of a call whose value is a variable."""
        atom = next(
            part
            for part in self._body
            if isinstance(part, Atom) and name in map(variable_of, _values_in(part, VALUE))
        )
        called = self._call(atom)
        parts = tuple(each for each in called.terms.values() if each.kind != "field")
        return Term("call", self._builder.span(self._calls[name]), column, parts, call=called)

    def _inner(self, aggregate: Aggregate) -> Body | None:
        body = conjuncts(aggregate.body)
        if not body or self._depth >= _DEEPEST:
            return None
        mentioned = variables([aggregate.argument, *body], inside=True) & self._scope.variables
        outer = {f"g{i}": Variable(name) for i, name in enumerate(sorted(mentioned))}
        aggregation = Aggregation(aggregate.operator, aggregate.argument)
        collected = {} if aggregate.is_denial else {VALUE: aggregation}
        clauses = self._builder.clauses(body, {}, collected, outer, self._depth + 1)
        given = {name: self._column(variable) for name, variable in outer.items()}
        return Body(self._builder.span(aggregate), given, clauses)

    def _collection(self, column: str, operator: str, argument: Expression) -> AggregateInput:
        if isinstance(argument, Call) and argument.name == "->":
            left, right = operands(argument.arguments)
            value, by = self._column(left), self._column(right)
            return AggregateInput(column, operator, value, by, self._term(left))
        return AggregateInput(column, operator, self._column(argument), "", self._term(argument))

    def _column(self, node: Expression) -> str:
        if node not in self._columns and len(self._columns) >= _MOST_COLUMNS:
            return ""
        column = self._columns.setdefault(node, f"c{len(self._columns)}")
        self._used.add(column)
        return column

    def _query(self, body: Sequence[Proposition], known: frozenset[str], wanted: set[str]) -> str:
        columns: dict[str, Expression] = {"one": Number("1")}
        there = ((column, node) for node, column in self._columns.items() if column in wanted)
        columns |= {c: node for c, node in there if self._scope.mentioned(node) <= known}
        probes = self._builder.probes
        name = f"{PROBE}{len(probes)}"
        probes[name] = make_rule(name, columns, body)
        return name


def _values_in(node: Node, column: str) -> Iterator[Expression]:
    """Yield the expressions that a call has for a column."""
    for argument in node.arguments if isinstance(node, Atom | Call) else ():
        if argument.column == column and argument.expression:
            yield argument.expression


def _kind_of(node: Node) -> TermKind:
    match node:
        case Literal() | PredicateName():
            return "literal"
        case Variable():
            return "variable"
        case Aggregate():
            return "aggregate"
        case Choice():
            return "if"
        case FieldAccess():
            return "field"
        case Record() if all(isinstance(each.field, str) for each in node.arguments):
            return "record"
        case Call(name="Coalesce"):
            return "coalesce"
        case Call(name="TryCast"):
            return "cast"
        case Call(name=name) if name in COMPARISONS | JUNCTIONS | {"!"}:
            return "truth"
    return "value"


def _parts_of(node: Expression) -> list[Expression]:
    match _kind_of(node), node:
        case "if", Choice():
            pairs = [part for each in node.branches for part in (each.condition, each.value)]
            return [*pairs, node.otherwise]
        case (("coalesce" | "truth"), Call()):
            return [*operands(node.arguments)]
        case "cast", Call():
            return [*operands(node.arguments)[:1]]
        case "field", _:
            while isinstance(node, FieldAccess):
                node = node.record
            return [node]
        case "record", Record():
            return [*operands(node.arguments)]
        case "value", _:
            inner = filter(_needs_explanation, walk(children(node), _needs_explanation))
            last = {each: each for each in inner if isinstance(each, Expression)}
            return [*last.values()]
    return []


def _names_of(node: Expression) -> tuple[str, ...]:
    """Return the field names of a record, or the path that is read from one."""
    if isinstance(node, Record) and _kind_of(node) == "record":
        return tuple(str(each.field) for each in node.arguments)
    names: list[str] = []
    while isinstance(node, FieldAccess):
        names.append(str(node.field))
        node = node.record
    return tuple(reversed(names))


def _chains(tree: Tree) -> Iterator[FieldAccess]:
    """Yield the field accesses in a tree: ``sensor.radar``, ``memory.plan.at``."""
    found = walk(tree, _chain_root)
    return (node for node in found if isinstance(node, FieldAccess) and _chain_root(node))


def _chain_root(node: Node) -> str:
    if not isinstance(node, FieldAccess):
        return ""
    while isinstance(node, FieldAccess):
        node = node.record
    return variable_of(node)


def _needs_explanation(node: Node) -> bool:
    """Return whether a part of a calculation or list needs its own explanation."""
    if isinstance(node, Choice | Aggregate | Variable | FieldAccess):
        return True
    return isinstance(node, Call) and _kind_of(node) in ("coalesce", "cast", "truth")
