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
    CallablePredicates,
    Scope,
    make_rule,
    order_parts,
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
from logical_robots_tui.language import tree
from logical_robots_tui.language.source_text import Prepared, with_whole_brackets
from logical_robots_tui.language.tree import Atom, Call, Expression, FieldAccess, Node, Proposition
from logical_robots_tui.mind.relations import GIVEN
from logical_robots_tui.schema import INPUTS, VALUE

N = TypeVar("N", bound=Node)

PROBE = "WhyProbe"
"""The prefix of the queries' names."""

_DEEPEST = 4  # nesting of bodies
_MOST_CLAUSES = 32  # of one body
_MOST_COLUMNS = 90  # SQLite's limit is 100


class Builder:
    """Decomposes bodies; `probes` collects the rules to compile, by name."""

    def __init__(self, source: Prepared, predicates: CallablePredicates) -> None:
        self.probes: dict[str, tree.Rule] = {}
        self.predicates = predicates
        self._source = source

    def clauses(
        self,
        body: Sequence[Proposition],
        head: Mapping[str, Expression],
        aggregations: Mapping[str, tree.Aggregation],
        parameters: Mapping[str, Expression],
        depth: int = 0,
    ) -> tuple[Clause, ...]:
        """Return a body's clauses; `head` holds the columns that are not aggregated."""
        return tuple(
            _ClauseBuilder(self, parts, head, aggregations, parameters, depth).clause(choice)
            for parts, choice in tree.alternatives(body, _MOST_CLAUSES)
        )

    def span(self, node: tree.Tree) -> SourceSpan:
        return span_of(node, self._source)

    def correction(
        self, part: Proposition, equation: tree.Span, value: tree.Span
    ) -> SourceSpan | None:
        """Return the span from the value of an equation that begins a part to the part's end."""
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
        aggregations: Mapping[str, tree.Aggregation],
        parameters: Mapping[str, Expression],
        depth: int,
    ) -> None:
        self._builder, self._depth = builder, depth
        self._names = builder.predicates
        self._calls: dict[str, Call] = {}  # by the variable of their value
        self._equations: dict[tree.Span, tree.Span] = {}  # with the places of their values
        self._columns: dict[Expression, str] = {}
        self._used_columns: set[str] = set()
        self._body: list[Proposition] = []
        for part in parts:
            self._body.append(self._without_calls(part))
        self._head = {column: self._without_calls(value) for column, value in head.items()}
        self._aggregations = {
            column: (str(aggregation.operator), self._without_calls(aggregation.argument))
            for column, aggregation in aggregations.items()
        }
        aggregated_values = (argument for _, argument in self._aggregations.values())
        nodes: list[Node] = [*self._body, *self._head.values(), *aggregated_values]
        names = tree.variables(nodes)
        self._start: list[Proposition] = []
        self._parameters = parameters
        bound: frozenset[str] = frozenset()
        if parameters:
            self._start = [Atom(GIVEN, tree.arguments(parameters))]
            bound = tree.variables(parameters.values())
        self._scope = Scope(self._names.functions, names | bound)
        self._bound = bound
        self._nodes = nodes

    def clause(self, choice: Sequence[Proposition]) -> Clause:
        ordered, unordered = order_parts(self._body, self._scope, self._bound)
        if unordered:
            remainder = unordered[0] if len(unordered) == 1 else tree.Conjunction(tuple(unordered))
            ordered.append((remainder, self._scope.variables))
        bounds = [self._bound, *(new_bound for _, new_bound in ordered)]
        steps = []
        selections: list[set[str]] = []  # for each step, the columns of it and those before it
        for (part, new_bound), bound in zip(ordered, bounds, strict=False):
            self._used_columns = set()
            steps.append(self._step(part, bound, new_bound))
            selections.append(self._used_columns.union(*selections[-1:]))
        variable_columns = {
            self._column(tree.Variable(name)) for name in sorted(self._scope.variables)
        }
        head = {column: self._column(value) for column, value in self._head.items()}
        terms = {column: self._term(value) for column, value in self._head.items()}
        aggregates = tuple(
            self._aggregate_input(column, *aggregation)
            for column, aggregation in self._aggregations.items()
        )
        fixed = variable_columns | {*head.values()}
        selections.append({*self._columns.values()})
        start = self._query(self._start, self._bound, fixed | selections[0])
        body = list(self._start)
        complete_steps = []
        for step, (part, new_bound), selection in zip(steps, ordered, selections[1:], strict=True):
            body = [*body, part]
            query = self._query(body, new_bound, fixed | selection)
            complete_steps.append(replace(step, query=query))
        return Clause(
            tuple(map(self._builder.span, choice)),
            start,
            tuple(complete_steps),
            {column: place for column, place in head.items() if place},
            terms,
            aggregates,
            {self._column(variable): name for name, variable in self._parameters.items()},
        )

    def _without_calls(self, node: N) -> N:
        """Return a part without its calls and equations, which become parts before it."""

        def change(inner: Node) -> Node:
            if tree.is_aggregate(inner):
                return inner
            inner = tree.rebuild(inner, change)
            if not isinstance(inner, Call) or inner.name not in self._names:
                return inner
            name = f"{AUXILIARY}{len(self._calls)}"
            self._calls[name] = inner
            value = tree.Argument(VALUE, tree.Variable(name))
            self._body.append(Atom(inner.name, (*inner.arguments, value), span=inner.span))
            return tree.Variable(name, span=inner.span)

        node, equations = without_equations(node)
        for equation in equations:
            _, value = tree.operands(equation.arguments)
            if equation.span is not None and value.span is not None:
                self._equations[equation.span] = value.span
            self._body.append(change(equation))  # type: ignore[arg-type]  # a kind for its kind
        return change(node)  # type: ignore[return-value]  # a kind for its kind

    def _step(self, part: Proposition, bound: frozenset[str], new_bound: frozenset[str]) -> Step:
        new_names = sorted(name for name in new_bound - bound if not name.startswith(AUXILIARY))
        bindings = {name: self._column(tree.Variable(name)) for name in new_names}
        kind = part_kind(part, self._names)
        span = self._builder.span(part)
        if isinstance(part, Atom) and kind == "call":
            call, reads = self._call(part), self._reads(part)
            function = self._calls.get(tree.variable_of(next(_values_in(part, VALUE), None)))
            if function is not None:
                return Step("function", self._builder.span(function), "", bindings, call=call)
            return Step(kind, span, "", bindings, call=call, reads=reads)
        if kind == "denial":
            (aggregate,) = outer_aggregates(part)
            return Step(kind, span, "", bindings, denial=self._inner(aggregate))
        expressions = self._expressions(part, is_test=new_bound == bound)
        return Step(
            kind,
            span,
            "",
            bindings,
            tuple(map(self._term, expressions)),
            misread=self._misread(part),
        )

    def _misread(self, part: Proposition) -> Misread | None:
        for node in tree.walk(part, tree.is_aggregate):
            infix = tree.infix_of(node)
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
                self._builder.correction(part, equation, self._equations[equation]),
            )
        return None

    @staticmethod
    def _expressions(part: Proposition, *, is_test: bool) -> Sequence[Expression]:
        if isinstance(part, tree.Membership):
            return [part.collection, part.element] if is_test else [part.collection]
        if (pair := tree.equation_sides(part)) is not None:
            return pair
        return tree.operands(part.arguments) if isinstance(part, Atom) else ()

    def _call(self, atom: Atom) -> PredicateCall:
        expressions = {
            argument.column: argument.expression
            for argument in atom.arguments
            if argument.expression and argument.field != tree.REST
        }
        columns = {name: self._column(value) for name, value in expressions.items()}
        columns = {name: column for name, column in columns.items() if column}
        if atom.name in INPUTS:
            return PredicateCall(str(atom.name), "", columns)
        terms = {name: self._term(value) for name, value in expressions.items() if name != VALUE}
        terms = {c: term for c, term in terms.items() if term.kind not in ("literal", "variable")}
        return replace(self._names.call(atom.name, columns), terms=terms)

    def _reads(self, atom: Atom) -> tuple[Term, ...]:
        reads: dict[Expression, Expression] = {}
        columns = INPUTS.get(atom.name, ())
        for column in (*columns, tree.REST) if columns else ():
            for value in _values_in(atom, column):
                root = tree.variable_of(value)
                chains = [chain for chain in _chains(self._nodes) if _chain_root(chain) == root]
                for chain in chains:
                    reads.setdefault(chain, chain)
                if column == "memory" and root and not chains:
                    reads[value] = value
        return tuple(map(self._term, reads.values()))

    def _term(self, node: Expression) -> Term:
        kind = _kind_of(node)
        span = self._builder.span(node)
        if kind == "literal":
            return Term("literal", span, self._column(node))
        if (name := tree.variable_of(node)) in self._calls:
            column = self._column(node)
            atom = next(
                part
                for part in self._body
                if isinstance(part, Atom) and name in map(tree.variable_of, _values_in(part, VALUE))
            )
            call = self._call(atom)
            parts = tuple(term for term in call.terms.values() if term.kind != "field")
            return Term("call", self._builder.span(self._calls[name]), column, parts, call=call)
        if isinstance(node, tree.Aggregate):
            body = self._inner(node) if self._depth < _DEEPEST else None
            return Term("aggregate", span, self._column(node), body=body)
        parts = tuple(map(self._term, _parts_of(node)))
        return Term(kind, span, self._column(node), parts, _names_of(node))

    def _inner(self, aggregate: tree.Aggregate) -> Body | None:
        body = tree.conjuncts(aggregate.body)
        if not body or self._depth >= _DEEPEST:
            return None
        names = tree.variables([aggregate.argument, *body], inside=True) & self._scope.variables
        outer = {f"g{i}": tree.Variable(name) for i, name in enumerate(sorted(names))}
        aggregation = tree.Aggregation(aggregate.operator, aggregate.argument)
        aggregations = {} if aggregate.is_denial else {VALUE: aggregation}
        clauses = self._builder.clauses(body, {}, aggregations, outer, self._depth + 1)
        outer_columns = {name: self._column(variable) for name, variable in outer.items()}
        return Body(self._builder.span(aggregate), outer_columns, clauses)

    def _aggregate_input(self, column: str, operator: str, argument: Expression) -> AggregateInput:
        if isinstance(argument, Call) and argument.name == "->":
            left, right = tree.operands(argument.arguments)
            value, key = self._column(left), self._column(right)
            return AggregateInput(column, operator, value, key, self._term(left))
        return AggregateInput(column, operator, self._column(argument), "", self._term(argument))

    def _column(self, node: Expression) -> str:
        if node not in self._columns and len(self._columns) >= _MOST_COLUMNS:
            return ""
        column = self._columns.setdefault(node, f"c{len(self._columns)}")
        self._used_columns.add(column)
        return column

    def _query(
        self, body: Sequence[Proposition], bound: frozenset[str], selection: set[str]
    ) -> str:
        columns: dict[str, Expression] = {"one": tree.Number("1")}
        pairs = ((column, node) for node, column in self._columns.items() if column in selection)
        columns |= {c: node for c, node in pairs if self._scope.variables_in(node) <= bound}
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
        case tree.Literal() | tree.PredicateName():
            return "literal"
        case tree.Variable():
            return "variable"
        case tree.Aggregate():
            return "aggregate"
        case tree.Choice():
            return "if"
        case FieldAccess():
            return "field"
        case tree.Record() if all(isinstance(argument.field, str) for argument in node.arguments):
            return "record"
        case Call(name="Coalesce"):
            return "coalesce"
        case Call(name="TryCast"):
            return "cast"
        case Call(name=name) if name in tree.COMPARISONS | tree.JUNCTIONS | {"!"}:
            return "truth"
    return "value"


def _parts_of(node: Expression) -> list[Expression]:
    match _kind_of(node), node:
        case "if", tree.Choice():
            pairs = [part for branch in node.branches for part in (branch.condition, branch.value)]
            return [*pairs, node.otherwise]
        case (("coalesce" | "truth"), Call()):
            return [*tree.operands(node.arguments)]
        case "cast", Call():
            return [*tree.operands(node.arguments)[:1]]
        case "field", _:
            while isinstance(node, FieldAccess):
                node = node.record
            return [node]
        case "record", tree.Record():
            return [*tree.operands(node.arguments)]
        case "value", _:
            inner = filter(_needs_explanation, tree.walk(tree.children(node), _needs_explanation))
            last = {part: part for part in inner if isinstance(part, Expression)}
            return [*last.values()]
    return []


def _names_of(node: Expression) -> tuple[str, ...]:
    """Return the field names of a record, or the path that is read from one."""
    if isinstance(node, tree.Record) and _kind_of(node) == "record":
        return tuple(str(argument.field) for argument in node.arguments)
    names: list[str] = []
    while isinstance(node, FieldAccess):
        names.append(str(node.field))
        node = node.record
    return tuple(reversed(names))


def _chains(node: tree.Tree) -> Iterator[FieldAccess]:
    """Yield the field accesses in a tree: ``sensor.radar``, ``memory.plan.at``."""
    nodes = tree.walk(node, _chain_root)
    return (node for node in nodes if isinstance(node, FieldAccess) and _chain_root(node))


def _chain_root(node: Node) -> str:
    if not isinstance(node, FieldAccess):
        return ""
    while isinstance(node, FieldAccess):
        node = node.record
    return tree.variable_of(node)


def _needs_explanation(node: Node) -> bool:
    """Return whether a part of a calculation or list needs its own explanation."""
    if isinstance(node, tree.Choice | tree.Aggregate | tree.Variable | FieldAccess):
        return True
    return isinstance(node, Call) and _kind_of(node) in ("coalesce", "cast", "truth")
