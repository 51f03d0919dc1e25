"""Why a rule has no row: the first of its steps that no derivation gets past."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from logical_robots_tui.explain.why.derivations import Derivations
from logical_robots_tui.explain.why.deriving import (
    NodeBuilder,
    ask_of,
    group_alternatives,
    negation,
    number_of,
    value_of,
)
from logical_robots_tui.explain.why.explanation import Ask, ProofNode, spell_call, type_difference
from logical_robots_tui.explain.why.probing import (
    Clause,
    Misread,
    PredicateCall,
    Probing,
    RuleParts,
    SourceSpan,
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
_MOST_COMPARED = 20_000  # pairs of a query's arguments and rows
_SHOWN_CALLS = 10


@dataclass(frozen=True, slots=True)
class FailedStep:
    """A step that nothing gets past, and the matches that reach it, up to a limit."""

    clause: Clause
    step: Step
    matches: Sequence[Way]


class _ClauseProgress(NamedTuple):
    """How far matches get: steps that hold, their query, conditions on its columns, a count."""

    steps: int
    query: str
    conditions: list[tuple[str, Value]]
    match_count: int


class Refuter:
    """Explains why bodies have no derivation; `targets` are the values of head columns."""

    def __init__(
        self,
        derivations: Derivations,
        probing: Probing,
        arguments: Sequence[Scalar],
        targets: Mapping[str, Value],
    ) -> None:
        self._relations, self._arguments, self._targets = derivations.relations, arguments, targets
        self._probing, self._queries = probing, probing.queries

        def refute(clauses: Sequence[Clause], arguments: Sequence[Scalar]) -> tuple[ProofNode, ...]:
            return Refuter(derivations, probing, arguments, {}).refute(clauses)

        self.builder = NodeBuilder(
            self._relations, probing.queries, refute, derivations.robot, probing.predicate
        )

    def rule(self, rule: RuleParts) -> tuple[bool, ProofNode | None, tuple[ProofNode, ...]]:
        """Return whether the rule is unrelated, the node that stops it, and all nodes."""
        if differences := self._differing_constants(rule):
            shared = self._targets.keys() - differences.keys() - {"robot_name"}
            head = rule.clauses[0].terms
            is_near = any(head[column].kind == "literal" for column in shared if column in head)
            is_computed = all(head[column].kind != "literal" for column in differences)
            is_unrelated = "robot_name" in differences or not (
                self._probing.parameters or is_near or is_computed
            )
            remark, holds = ("", None) if is_unrelated else ("actual value", False)
            nodes = tuple(
                ProofNode(
                    "column",
                    self._label(c),
                    type_difference(self._targets[c], v) or remark,
                    holds,
                    (v,),
                )
                for c, v in differences.items()
            )
            return is_unrelated, None if is_unrelated else nodes[0], nodes
        ends = [self._clause(clause) for clause in rule.clauses]
        return False, max(ends, key=lambda end: end.steps).stop, _join(ends)

    def stop(self, rule: RuleParts) -> FailedStep | None:
        """Return the step that stops the clause that gets furthest; None if no step does."""
        if self._differing_constants(rule):
            return None
        candidates = [(clause, self._progress(clause)) for clause in rule.clauses]
        clause, progress = max(candidates, key=lambda pair: pair[1].steps)
        sql = self._queries.get(progress.query)
        if sql is None or any(p.steps == len(c.steps) for c, p in candidates):
            return None
        matches = self._relations.ways(
            sql, self._arguments, progress.conditions, max_rows=_MOST_WAYS
        )
        return FailedStep(clause, clause.steps[progress.steps], matches)

    def refute(self, clauses: Sequence[Clause]) -> tuple[ProofNode, ...]:
        """Return why no clause has a derivation, or the derivation of one that has."""
        for clause in clauses:
            match = self._first_match(clause.query)
            if match is not None:
                return self.builder.derivation(clause, match)
        return _join([self._clause(clause) for clause in clauses])

    def _label(self, column: str) -> str:
        return self._relations.label(self._probing.predicate, column)

    def _differing_constants(self, rule: RuleParts) -> dict[str, Value]:
        """Return the constants of a head that differ from the targets."""
        clause = rule.clauses[0]
        match = self._first_match(clause.start_query) or {}
        return {
            column: value_of(match, place)
            for column, place in clause.head.items()
            if column in self._targets and place in match
            # Other values are known only together with the body.
            if not clause.steps or clause.terms[column].kind == "literal"
            if not same(value_of(match, place), self._targets[column])
        }

    def _places(self, clause: Clause, query: str, *, joined: bool) -> list[tuple[str, Value]]:
        """Return the targets of a query's columns that are bound by calls, or computed."""
        sql = self._queries[query]
        return [
            (place, self._targets[column])
            for column, place in clause.head.items()
            if column in self._targets
            and joined == _is_joined(clause, column)
            and re.search(rf"\bAS {place}\b", sql)
        ]

    def _differing_column(self, clause: Clause, match: Way) -> ProofNode | None:
        """Return the first computed column that differs from its target wherever steps hold."""
        sql = self._queries[clause.query]
        conditions = self._places(clause, clause.query, joined=True)
        for column, place in clause.head.items():
            if column not in self._targets or _is_joined(clause, column):
                continue
            extended = [*conditions, (place, self._targets[column])]
            if self._relations.count(sql, self._arguments, extended):
                conditions = extended
                continue
            selection = f"DISTINCT {place}"
            matches = self._relations.ways(sql, self._arguments, conditions, selection, _MOST_WAYS)
            values = tuple(from_sql(row[place]) for row in matches)
            term = clause.terms[column]
            examples, excess = values[:_EXAMPLES], max(0, len(values) - _EXAMPLES)
            node = ProofNode("column", self._label(column), "actual value", False, examples, excess)
            if term.kind in ("literal", "variable"):
                return node
            text = f"{node.text}: {term.span.text}"
            if term.kind == "call" and term.call is not None:
                (call_node,) = self.builder.term(term, match) or (node,)
                query, children = call_node.query, call_node.children
            else:
                query, children = None, tuple(self.builder.reason(term, match))
            children = children if len(values) == 1 else ()
            return replace(node, text=text, span=term.span, query=query, children=children)
        return None

    def _progress(self, clause: Clause) -> _ClauseProgress:
        progress = _ClauseProgress(0, clause.start_query, [], 1)
        for number, step in enumerate(clause.steps, 1):
            sql = self._queries.get(step.query)
            if sql is None:
                continue  # the next step answers for this one, too
            conditions = self._places(clause, step.query, joined=True)
            match_count = self._relations.count(sql, self._arguments, conditions, _MOST_WAYS)
            if not match_count:
                return progress._replace(steps=number - 1)
            progress = _ClauseProgress(number, step.query, conditions, match_count)
        return progress._replace(steps=len(clause.steps))

    def _clause(self, clause: Clause) -> _Refutation:
        progress = self._progress(clause)
        match = self._first_match(progress.query, progress.conditions)
        prefix = self.builder.derivation(clause, match or {}, progress.steps)
        if progress.match_count > 1 and prefix:
            matches = number_of(
                progress.match_count, "match", is_all=progress.match_count < _MOST_WAYS
            )
            prefix = (*prefix[:-1], replace(prefix[-1], remark=f"1 of {matches}"))
        if progress.steps < len(clause.steps):
            step = clause.steps[progress.steps]
            return _Refutation(
                clause, progress.steps, prefix, self._failed_node(clause, step, progress, match)
            )
        stop = self._differing_column(clause, match or {}) if self._targets else None
        return _Refutation(clause, progress.steps, prefix, stop)

    def _failed_node(
        self, clause: Clause, step: Step, progress: _ClauseProgress, match: Way | None
    ) -> ProofNode:
        text, remark = step.span.text, self._matches_elsewhere(step)
        children: tuple[ProofNode, ...] = ()
        query: Ask | None = None
        if match is not None and step.denial is not None:
            children = self.builder.refutation(step.denial, match)
            text, default = negation(text, holds=False)
            remark = remark or default
        elif match is not None and step.call is not None and step.call.predicate not in INPUTS:
            query, children = self._call_queries(step.call, progress, self._bound_values(clause))
            remark = self._row_difference(query) or remark
        terms = [term for term in step.terms if term.kind != "literal"]
        if match is not None and progress.match_count == 1:
            inner = tuple(node for term in terms for node in self.builder.term(term, match))
            if len(step.terms) == 2:
                left, right = (value_of(match, term.column) for term in step.terms)
                remark = type_difference(left, right) or remark
        else:
            inner = tuple(self._examples(terms, progress))
        if step.misread is not None:
            remark = _misread(step.misread, match if progress.match_count == 1 else None)
        return ProofNode(
            "call" if step.kind == "function" else step.kind,
            text,
            remark or "no match",
            False,
            span=step.span,
            query=query,
            children=(*inner, *children),
        )

    def _matches_elsewhere(self, step: Step) -> str:
        count = 0
        if self._targets:
            sql = self._queries[step.query]
            count = self._relations.count(sql, self._arguments, (), _MOST_WAYS)
        if not count:
            return ""
        matches = number_of(count, "match", is_all=count < _MOST_WAYS)
        if self._targets.keys() == {"robot_name"}:
            return f"not here, but {matches} elsewhere"
        return f"not for these values, but {matches} for others"

    def _call_queries(
        self, call: PredicateCall, progress: _ClauseProgress, bindings: Way
    ) -> tuple[Ask, tuple[ProofNode, ...]]:
        """Return the queries of a call, those nearest to an existing row first."""
        sql = self._queries[progress.query]
        places = [p for p in call.arguments.values() if re.search(rf"\bAS {p}\b", sql)]
        selection = f"DISTINCT {', '.join(dict.fromkeys(places))}" if places else "1"
        matches = self._relations.ways(
            sql, self._arguments, progress.conditions, selection, _MOST_WAYS if places else 1
        )
        queries = [ask_of(call, match | bindings) for match in matches]
        if len(queries) > 1:
            queries = self._nearest_first(queries)
            instances = [
                ProofNode("instance", spell_call(q), query=q) for q in queries[:_SHOWN_CALLS]
            ]
            if excess := len(queries) - len(instances):
                instances.append(ProofNode("note", f"and {excess:,} more"))
            return queries[0], tuple(instances)
        labels = (
            (self._relations.label(call.predicate, c), v) for c, v in queries[0].given.items()
        )
        return queries[0], tuple(
            ProofNode("value", label, values=(value,)) for label, value in labels
        )

    def _rows(self, query: Ask) -> Sequence[Mapping[str, Value]]:
        name, probing = query.predicate, self._probing
        if query.within or name not in probing.tables:
            return ()
        return self._relations.rows(name, probing.sources)

    def _row_difference(self, query: Ask) -> str:
        """Return how a row differs from the query, if only in types; else ""."""
        for row in self._rows(query)[:_MOST_WAYS]:
            differences = [(v, row[c]) for c, v in query.given.items() if not same(v, row[c])]
            remarks = [type_difference(*pair) for pair in differences]
            if remarks and all(remarks):
                return remarks[0]
        return ""

    def _nearest_first(self, queries: list[Ask]) -> list[Ask]:
        rows = self._rows(queries[0])[: _MOST_COMPARED // len(queries)]

        def gap(query: Ask) -> float:
            gaps = (sum(_unlikeness(v, row.get(c)) for c, v in query.given.items()) for row in rows)
            return min(gaps, default=0.0)

        return sorted(queries, key=gap)

    def _examples(self, terms: Sequence[Term], progress: _ClauseProgress) -> Iterator[ProofNode]:
        sql = self._queries.get(progress.query)
        for term in _flat(terms):
            if sql is None or not term.column or term.kind == "literal":
                continue
            selection = f"DISTINCT {term.column}"
            try:
                matches = self._relations.ways(
                    sql, self._arguments, progress.conditions, selection, _MOST_WAYS
                )
            except FailureError:
                continue
            values = tuple(from_sql(match[term.column]) for match in matches)
            yield ProofNode(
                "value",
                term.span.text,
                values=values[:_EXAMPLES],
                excess=max(0, len(values) - _EXAMPLES),
                span=term.span,
            )

    def _bound_values(self, clause: Clause) -> Way:
        return {
            place: to_sql(self._targets[column])
            for column, place in clause.head.items()
            if column in self._targets and _is_joined(clause, column)
        }

    def _first_match(self, query: str, conditions: Sequence[tuple[str, Value]] = ()) -> Way | None:
        sql = self._queries.get(query)
        if sql is None:
            return None
        return next(iter(self._relations.ways(sql, self._arguments, conditions)), None)


def _misread(misread: Misread, match: Way | None) -> str:
    """Describe the sides of an operator, one of which is an equation."""
    sides = []
    for term in misread.sides:
        text = term.span.text if term.kind == "literal" else f"`{term.span.text}`"
        if match is not None and term.kind != "literal" and term.column in match:
            text += f" ({spell(value_of(match, term.column))})"
        sides.append(text)
    verb = "joins" if misread.operator in ("&&", "||") else "compares"
    return f"{verb} {' with '.join(sides)}"


class _Refutation(NamedTuple):
    """How a clause fails: the nodes of the steps that hold, and of the one that stops it."""

    clause: Clause
    steps: int
    prefix: tuple[ProofNode, ...]
    stop: ProofNode | None

    @property
    def nodes(self) -> tuple[ProofNode, ...]:
        return (*self.prefix, *((self.stop,) if self.stop is not None else ()))

    @property
    def alternatives(self) -> tuple[SourceSpan, ...]:
        """The alternatives that were evaluated, at least in part."""
        steps = self.clause.steps[: self.steps + 1]
        return tuple(
            span
            for span in self.clause.alternatives
            if any(span.holds(step.span) for step in steps)
        )

    @property
    def failure(self) -> SourceSpan | None:
        """The innermost alternative that it fails in, or None if it gets past all of them."""
        steps = self.clause.steps[self.steps : self.steps + 1]
        return next(
            (s for s in self.alternatives[::-1] if any(s.holds(t.span) for t in steps)), None
        )


def _join(refutations: Sequence[_Refutation]) -> tuple[ProofNode, ...]:
    """Return the nodes of a body with alternatives: those that fail, and what stops the rest."""
    if len(refutations) == 1:
        return refutations[0].nodes
    distinct = {(end.alternatives, repr(end.nodes)): end for end in refutations}
    ends = [*distinct.values()]
    if len(ends) == 1:
        return tuple(group_alternatives(ends[0].nodes, ends[0].alternatives))
    common = 0
    while (
        all(len(end.nodes) > common for end in ends)
        and len({repr(end.nodes[common]) for end in ends}) == 1
    ):
        common += 1
    failing = [_alternative(end, common) for end in ends if end.failure is not None]
    passed = [end for end in ends if end.failure is None]
    if len(passed) == 1:
        remainder: Sequence[ProofNode] = group_alternatives(
            passed[0].nodes[common:], passed[0].alternatives
        )
    else:
        remainder = [_alternative(end, common) for end in passed]
    return (*ends[0].nodes[:common], *failing, *remainder)


def _alternative(end: _Refutation, common: int) -> ProofNode:
    nodes, span = end.nodes[common:], end.failure
    if span is not None:
        alternatives = [a for a in end.alternatives if not a.holds(span)]
        remark = "this alternative does not hold"
        children = tuple(group_alternatives(nodes, alternatives))
        return ProofNode("alternative", span.text, remark, False, span=span, children=children)
    text = " and ".join(a.text for a in end.alternatives)
    remark = "this alternative holds, but not what comes after it"
    span = end.alternatives[-1] if end.alternatives else None
    return ProofNode("alternative", text, remark, span=span, children=nodes)


def _is_joined(clause: Clause, column: str) -> bool:
    """Return whether a column of the head is a variable that no equation or list binds."""
    place = clause.head[column]
    return clause.terms[column].kind in ("variable", "literal") and not any(
        place in step.bindings.values()
        for step in clause.steps
        if step.kind in ("value", "element")
    )


def _unlikeness(left: Value, right: Value) -> float:
    """Return the dissimilarity of two values, at most 1."""
    if same(left, right):
        return 0.0
    if isinstance(left, int | float) and isinstance(right, int | float):
        return 0.5 * (size := abs(left - right)) / (size + 1)
    if isinstance(left, str) and isinstance(right, str):
        return min(1.0, distance(left, right) / max(1, len(left), len(right)))
    return 1.0


def _flat(terms: Sequence[Term]) -> Iterator[Term]:
    for term in terms:
        yield term
        if term.kind in ("truth", "if"):
            yield from _flat(term.parts)
