"""Decomposing bodies: a clause for each choice of alternatives, with a query for its derivations.

In the compile process. A call of the program's own predicate in an expression becomes a separate
part of the body, as in the compiler, so that its value is computed once however often it is
mentioned.
"""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.clauses.bodies import (
    TooManyError,
    alternatives,
    chain_root,
    chains,
    is_denial,
    kind_of,
    names_of,
    parts_of,
    plain_text,
    values_in,
)
from logical_robots_tui.mind.clauses.scopes import (
    Scope,
    column_name,
    combines,
    flat,
    in_order,
    names,
)
from logical_robots_tui.mind.clauses.trees import span_of
from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.compiling.rules import equated, operands, variable_of
from logical_robots_tui.mind.program import INPUTS, VALUE
from logical_robots_tui.mind.why.probing import GIVEN, Body, Call, Clause, Collected, Step, Term

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.mind.clauses.bodies import Names
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared
    from logical_robots_tui.mind.why.probing import Span

PROBE = "WhyProbe"
"""The prefix of the queries' names."""

_AUXILIARY = "why_"
_DEEPEST = 4  # nesting of bodies
_MOST_COLUMNS = 90  # SQLite's limit is 100


class Builder:
    """Decomposes bodies and collects the queries to be compiled.

    Attributes:
        probes: The rules that define the queries' rows, by name.
    """

    def __init__(self, source: Prepared, known: Names) -> None:
        self.probes: dict[str, Rule] = {}
        self.known = known
        self._source = source

    def clauses(
        self,
        body: Sequence[Rule],
        head: Mapping[str, Rule],
        collected: Mapping[str, Rule],
        given: Mapping[str, Rule],
        depth: int = 0,
    ) -> tuple[Clause, ...]:
        """Return the clauses of a body.

        Args:
            body: Its parts.
            head: The expressions of the columns without aggregation.
            collected: The aggregations of the other columns.
            given: For each column of the table of given values, its variable.
            depth: The nesting within other bodies.
        """
        return tuple(
            _ClauseBuilder(self, parts, head, collected, given, depth).clause(taken)
            for parts, taken in self._choices(body)
        )

    def span(self, tree: Any) -> Span:
        """Return the place of a piece of a syntax tree."""
        return span_of(tree, self._source)

    def _choices(self, body: Sequence[Rule]) -> Iterator[tuple[list[Rule], tuple[Span, ...]]]:
        """Return the body for each choice of alternatives, or unchanged if there are too many."""
        try:
            found = alternatives(body)
        except TooManyError:
            found = [(list(body), [])]
        for parts, taken in found:
            yield parts, tuple(map(self.span, taken))


class _ClauseBuilder:
    def __init__(
        self,
        builder: Builder,
        parts: Sequence[Rule],
        head: Mapping[str, Rule],
        collected: Mapping[str, Rule],
        given: Mapping[str, Rule],
        depth: int,
    ) -> None:
        self._builder, self._depth = builder, depth
        self._names = builder.known
        self._calls: dict[str, Rule] = {}  # by the variable of their value
        self._columns: dict[str, tuple[str, Rule]] = {}
        self._used: set[str] = set()
        self._body: list[Rule] = []
        for part in parts:
            self._body += self._without_calls(part)
        self._head: dict[str, Rule] = {}
        for column, value in head.items():
            *calls, only = self._without_calls(value)
            self._body += calls
            self._head[column] = only
        self._collected: dict[str, tuple[str, Rule]] = {}
        for column, aggregation in collected.items():
            *calls, only = self._without_calls(aggregation["argument"])
            self._body += calls
            self._collected[column] = str(aggregation["operator"]), only
        everything = [*self._body, *self._head.values(), *(a for _, a in self._collected.values())]
        variables = frozenset[str]().union(*map(names, everything))
        self._begin: list[Rule] = []
        self._given = given
        known: frozenset[str] = frozenset()
        if given:
            self._begin = [trees.asked(GIVEN, dict(given))]
            known = frozenset().union(*map(names, given.values()))
        self._scope = Scope(self._names.functions, variables | known)
        self._known = known
        self._all = everything

    def clause(self, taken: tuple[Span, ...]) -> Clause:
        """Return the clause for the chosen alternatives."""
        ordered, left = in_order(self._body, self._scope, self._known)
        if left:
            together = left[0] if len(left) == 1 else {"conjunction": {"conjunct": left}}
            ordered.append((together, self._scope.variables))
        before = [self._known, *(after for _, after in ordered)]
        steps = []
        wanted: list[set[str]] = []  # for each step, the columns to show
        for (part, after), known in zip(ordered, before, strict=False):
            self._used = set()
            steps.append(self._step(part, known, after))
            wanted.append(self._used)
        variables = {self._column(trees.variable(name)) for name in self._scope.variables}
        head = {column: self._column(value) for column, value in self._head.items()}
        terms = {column: self._term(value) for column, value in self._head.items()}
        collected = tuple(self._collection(column, *of) for column, of in self._collected.items())
        always = variables | {*head.values()}
        wanted.append({*map(itemgetter(0), self._columns.values())})
        start = self._query(self._begin, self._known, always | wanted[0])
        body = list(self._begin)
        finished = []
        for step, (part, after), next_wanted in zip(steps, ordered, wanted[1:], strict=True):
            body = [*body, part]
            query = self._query(body, after, always | next_wanted)
            finished.append(replace(step, query=query))
        return Clause(
            taken,
            start,
            tuple(finished),
            {column: place for column, place in head.items() if place},
            terms,
            collected,
            {self._column(variable): name for name, variable in self._given.items()},
        )

    # -- calls -----------------------------------------------------------------------------------

    def _without_calls(self, tree: Rule) -> list[Rule]:
        """Return a part preceded by the calls in its expressions, inner ones first."""
        tree = deep_copy(tree)
        found: list[Rule] = []

        def visit(node: Any) -> None:
            if isinstance(node, list):
                for each in node:
                    visit(each)
            if not isinstance(node, dict) or "combine" in node:
                return
            for value in list(node.values()):
                visit(value)
            call = node.get("call")
            if isinstance(call, dict) and self._names.is_own(str(call["predicate_name"])):
                name = f"{_AUXILIARY}{len(self._calls)}"
                self._calls[name] = dict(node)
                del node["call"]
                node["variable"] = {"var_name": name}
                asked = deep_copy(call)
                value = {"field": VALUE, "value": {"expression": trees.variable(name)}}
                asked["record"]["field_value"].append(value)
                found.append({"predicate": asked})

        visit(tree)
        return [*found, tree]

    def _is_call(self, tree: Rule) -> bool:
        return variable_of(tree) in self._calls

    # -- steps -----------------------------------------------------------------------------------

    def _step(self, part: Rule, known: frozenset[str], after: frozenset[str]) -> Step:
        new = sorted(name for name in after - known if not name.startswith(_AUXILIARY))
        gives = {name: self._column(trees.variable(name)) for name in new}
        kind = self._kind(part)
        call: Call | None = None
        denied: Body | None = None
        reads: tuple[Term, ...] = ()
        terms: tuple[Term, ...] = ()
        span = self._builder.span(part)
        if kind in ("call", "function"):
            call, reads = self._call(part["predicate"]), self._reads(part["predicate"])
            value = next(values_in(part["predicate"], VALUE), None)
            if kind == "function" and value is not None:
                span = self._builder.span(self._calls[variable_of(value)])
        elif kind == "denial":
            (combine,) = combines(part)
            denied = self._inner(combine)
        else:
            terms = tuple(map(self._term, self._shown(part)))
        return Step(kind, span, "", gives, terms, call, denied, reads)

    def _kind(
        self, part: Rule
    ) -> Literal["call", "condition", "value", "element", "denial", "function"]:
        if "inclusion" in part:
            return "element"
        if "unification" in part:
            return "value"
        name = str(part.get("predicate", {}).get("predicate_name", ""))
        if name == "=":
            return "value"
        if name == "IsNull" and any(map(is_denial, combines(part))):
            return "denial"
        if name in INPUTS or self._names.is_own(name):
            value = next(values_in(part["predicate"], VALUE), {})
            return "function" if self._is_call(value) else "call"
        return "condition"

    @staticmethod
    def _shown(part: Rule) -> list[Rule]:
        """Return the expressions of a step that explain why it holds."""
        if "inclusion" in part:
            return [part["inclusion"]["list"]]
        if (pair := equated(part)) is not None:
            return list(pair)
        return operands(part["predicate"]) if "predicate" in part else []

    def _call(self, call: Rule) -> Call:
        name = str(call["predicate_name"])
        arguments = {
            column_name(argument["field"]): self._column(argument["value"]["expression"])
            for argument in call["record"]["field_value"]
            if argument["field"] != "*" and "expression" in argument["value"]
        }
        arguments = {column: place for column, place in arguments.items() if place}
        if name in INPUTS:
            return Call(name, "", arguments)
        terms = {
            column_name(argument["field"]): self._term(argument["value"]["expression"])
            for argument in call["record"]["field_value"]
            if "expression" in argument["value"] and argument["field"] not in ("*", VALUE)
        }
        terms = {c: term for c, term in terms.items() if term.kind not in ("literal", "variable")}
        return replace(self._names.call(name, arguments), terms=terms)

    def _reads(self, call: Rule) -> tuple[Term, ...]:
        """Return everything read from a sensor or a memory in the clause."""
        found: dict[str, Rule] = {}
        columns = INPUTS.get(str(call["predicate_name"]), ())
        for column in (*columns, "*") if columns else ():
            for value in values_in(call, column):
                root = variable_of(value)
                mine = [each for each in chains(self._all) if chain_root(each) == root]
                found |= {self._builder.span(each).text: each for each in mine}
                if column == "memory" and root and not mine:
                    found[root] = value
        return tuple(map(self._term, found.values()))

    # -- expressions -----------------------------------------------------------------------------

    def _term(self, tree: Rule) -> Term:
        kind = kind_of(tree)
        span = self._builder.span(tree)
        if kind == "literal":
            return Term("literal", span, self._column(tree))
        if self._is_call(tree):
            name = variable_of(tree)
            call = next(
                part["predicate"]
                for part in self._body
                if any(
                    variable_of(value) == name
                    for value in values_in(part.get("predicate", {}), VALUE)
                )
            )
            span = self._builder.span(self._calls[name])
            called = self._call(call)
            parts = tuple(each for each in called.terms.values() if each.kind != "field")
            return Term("call", span, self._column(tree), parts, call=called)
        if kind == "aggregate":
            body = self._inner(tree["combine"]) if self._depth < _DEEPEST else None
            return Term("aggregate", span, self._column(tree), body=body)
        found = parts_of(tree, kind)
        if kind == "value":
            found = [*{plain_text(part): part for part in found}.values()]
        parts = tuple(map(self._term, found))
        return Term(kind, span, self._column(tree), parts, names_of(tree, kind))

    def _inner(self, combine: Rule) -> Body | None:
        body = flat(combine.get("body"))
        if not body or self._depth >= _DEEPEST:
            return None
        mentioned = names([combine["head"], *body], inside=True) & self._scope.variables
        outer = {f"g{i}": trees.variable(name) for i, name in enumerate(sorted(mentioned))}
        head = combine["head"]["record"]["field_value"]
        aggregations = {column_name(f["field"]): f["value"].get("aggregation") for f in head}
        collected = {c: a for c, a in aggregations.items() if a and not is_denial(combine)}
        clauses = self._builder.clauses(body, {}, collected, outer, self._depth + 1)
        given = {name: self._column(variable) for name, variable in outer.items()}
        return Body(self._builder.span(combine["full_text"]), given, clauses)

    def _collection(self, column: str, operator: str, argument: Rule) -> Collected:
        call = argument.get("call", {})
        if call.get("predicate_name") == "->":
            sides = {f["field"]: f["value"]["expression"] for f in call["record"]["field_value"]}
            value, by = self._column(sides["left"]), self._column(sides["right"])
            return Collected(column, operator, value, by, self._term(sides["left"]))
        return Collected(column, operator, self._column(argument), "", self._term(argument))

    # -- queries ---------------------------------------------------------------------------------

    def _column(self, tree: Rule) -> str:
        """Return the column with the value of an expression, or "" if there are too many."""
        key = plain_text(tree)
        if key not in self._columns and len(self._columns) >= _MOST_COLUMNS:
            return ""
        place, _ = self._columns.setdefault(key, (f"c{len(self._columns)}", tree))
        self._used.add(place)
        return place

    def _query(self, body: Sequence[Rule], known: frozenset[str], wanted: set[str]) -> str:
        """Return a query for the ways in which a body holds, with the wanted columns."""
        columns: dict[str | int, Rule] = {"one": trees.number("1")}
        columns |= {
            place: tree
            for place, tree in self._columns.values()
            if place in wanted and self._scope.mentioned(tree) <= known
        }
        probes = self._builder.probes
        name = f"{PROBE}{len(probes)}"
        probes[name] = trees.rule(name, columns, body, name)
        return name
