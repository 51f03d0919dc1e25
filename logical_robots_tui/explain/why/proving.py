"""Why a predicate has a row, or none: one derivation of the row, or where each rule fails."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

from logical_robots_tui.explain.why.derivations import (
    MOST_ROWS,
    Derivations,
    Row,
    check_given,
)
from logical_robots_tui.explain.why.deriving import (
    AGGREGATES_NO_ROWS,
    MOST_ELEMENTS,
    Element,
    number_of,
)
from logical_robots_tui.explain.why.explanation import (
    Ask,
    Explanation,
    Proof,
    ProofNode,
    RuleOutcome,
    spell_call,
)
from logical_robots_tui.explain.why.probing import Clause, Probing, RuleParts
from logical_robots_tui.explain.why.refuting import Refuter
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import Way, same
from logical_robots_tui.schema import MAIN


def explain(derivations: Derivations, query: Ask, *, is_first: bool = True) -> Explanation:
    """Explain a predicate's rows, or their absence; raise QueryError or Stopped.

    `is_first` is False for the questions that follow from another one.
    """
    key = (query.key, is_first)
    if key not in derivations.explained:
        derivations.explained[key] = _explain(derivations, query, is_first=is_first)
    return derivations.explained[key]


def _explain(derivations: Derivations, query: Ask, *, is_first: bool) -> Explanation:
    probing = derivations.decompose(query.predicate, query.within)
    values = check_given(query, probing, derivations.relations.label)
    query = replace(query, given=values)
    try:
        rows = derivations.rows(probing, values)
        derivations.prepare(probing)
    except FailureError as failure:
        raise QueryError(f"{query.predicate} failed: {failure}.") from None
    row = derivations.stage(probing).first_row(probing, rows) if rows else None
    prover = _Prover(derivations, probing, values, rows, row)
    rules = tuple(map(prover.rule, probing.rules))
    if row is not None and all(outcome.row is None for outcome in rules):
        is_keyless = not any(clause.head for rule in probing.rules for clause in rule.clauses)
        if is_keyless and all(value in (None, 0) for value in row.values()):
            rules = (_over_nothing(rules[0], row, prover.label), *rules[1:])
        elif all(outcome.rows is not None for outcome in rules):
            rules = (*rules, _note(rules[0], _unexplained(probing)))
    if row is None and (is_first or probing.recursive):
        for name, steps in derivations.relations.cut_off(query.predicate):
            message = f"The recursion of {name} was cut off after {steps} steps, so later rows are"
            hint = f"@Recursive({name}, {2 * steps}) would allow more"
            rules = (*rules, _note(rules[0], f"{message} missing; {hint}."))
    return Explanation(
        query, derivations.robot, probing.made_from, min(len(rows), MOST_ROWS), row, rules
    )


_MOST_OTHERS = 50  # rows among which another derivation is sought, derivations that are counted
_MOST_DERIVATIONS = 10  # of those, shown
_STEPS_FOR_OTHERS = 1_000_000  # some 15 milliseconds
_DEEPEST = 5  # functions that call functions, in the search for an empty aggregation


class _Prover:
    """Explains the rows of each rule of a predicate; `row` is the first of the `rows`, if any."""

    def __init__(
        self,
        derivations: Derivations,
        probing: Probing,
        values: Row,
        rows: Sequence[Row],
        row: Row | None,
    ) -> None:
        self._derivations, self._probing = derivations, probing
        self._values, self._rows, self._row = values, rows, row
        self._arguments = probing.arguments(values)
        targets = {c: v for c, v in values.items() if c not in probing.parameters}
        self._refuting = Refuter(derivations, probing, self._arguments, targets)
        self._builder = self._refuting.builder
        self._position = "last" if probing.name == MAIN else "first"

    def rule(self, rule: RuleParts) -> RuleOutcome:
        row = self._row
        try:
            derivation_count = 0
            nodes: tuple[ProofNode, ...] = ()
            if row is not None:
                self._derivations.prepare(self._probing, row)
                derivation_count, nodes = self._derivation_nodes(rule, row)
                self._derivations.prepare(self._probing)
            count = 1 if derivation_count and len(self._rows) == 1 else self._row_count(rule)
            if row is not None and derivation_count:
                remark = "gives this row"
                if len(self._rows) > 1:
                    remark = f"gives {_number_of_rows(count)}; this is the {self._position}"
                if derivation_count > 1:
                    is_all = derivation_count < _MOST_OTHERS
                    number = number_of(derivation_count, "derivation", is_all=is_all)
                    remark += f"; first of {number}"
                if self._probing.name == MAIN:
                    nodes = (*nodes, *self._alternative(rule, row, nodes), *self._null_notes(nodes))
                return RuleOutcome(rule.span, count, row, None, _heading(rule, remark, True, nodes))
            if count:
                remark = f"gives {_number_of_rows(count)}, but not the {self._position}"
                nodes = (
                    () if row is None or self._position == "first" else self._other_row_nodes(rule)
                )
                return RuleOutcome(
                    rule.span, count, None, None, _heading(rule, remark, True, nodes)
                )
            is_unrelated, stop, children = self._refuting.rule(rule)
            if row is None and stop is None and rule.is_aggregated:
                differences = self._differences(rule)
                children, stop = (*children, *differences), next(iter(differences), None)
            remark = "does not apply to these values" if is_unrelated else "gives no row"
            if is_omitted := row is None and not (stop or is_unrelated or rule.is_aggregated):
                remark = "gives this row, but it was left out, as by @Limit"
                if self._probing.recursive:
                    remark = "would give this row in a later step"
            node = _heading(rule, remark, None if is_unrelated or is_omitted else False, children)
            return RuleOutcome(rule.span, 0, None, stop, node)
        except FailureError as failure:
            note = ProofNode("note", "This could not be asked", str(failure))
            heading = _heading(rule, "could not be asked", None, (note,))
            return RuleOutcome(rule.span, None, None, None, heading)

    def _differences(self, rule: RuleParts) -> tuple[ProofNode, ...]:
        values = self._values
        keys = {c: v for c, v in values.items() if any(c in clause.head for clause in rule.clauses)}
        return tuple(
            ProofNode("column", self.label(column), "actual value", False, (row[column],))
            for row in self._derivations.rows(self._probing, keys)[:1]
            for column, value in values.items()
            if column not in keys and not same(row[column], value)
        )

    def label(self, column: str) -> str:
        return self._derivations.relations.label(self._probing.predicate, column)

    def _row_count(self, rule: RuleParts) -> int:
        if not self._rows:
            return 0
        probing, relations = self._probing, self._derivations.relations
        if probing.recursive or rule.is_aggregated:
            return sum(any(True for _ in self._matches(rule, row)) for row in self._rows[:100])
        distinct_rows: set[str] = set()
        count = 0
        for clause in rule.clauses:
            sql = self._derivations.sql(clause, probing)
            places = [
                (place, self._values[c]) for c, place in clause.head.items() if c in self._values
            ]
            if probing.is_distinct:
                selection = f"DISTINCT {', '.join(clause.head.values()) or 'one'}"
                matches = relations.ways(sql, self._arguments, places, selection, MOST_ROWS)
                distinct_rows |= {repr(tuple(match.values())) for match in matches}
            else:
                count += relations.count(sql, self._arguments, places, MOST_ROWS)
        return min(count + len(distinct_rows), MOST_ROWS)

    def _matches(self, rule: RuleParts, row: Row, limit: int = 1) -> Iterator[tuple[Clause, Way]]:
        return self._derivations.matches(rule, self._probing, row, self._arguments, limit)

    def _derivation_nodes(self, rule: RuleParts, row: Row) -> tuple[int, tuple[ProofNode, ...]]:
        """Return how many derivations a row has, and the first, with some others below it."""
        if rule.is_aggregated:
            matches = list(self._matches(rule, row, MOST_ELEMENTS + 1))
            return (1, tuple(self._aggregate_nodes(matches, row))) if matches else (0, ())
        matches = self._matches_of(rule, row)
        derivations = [
            (*self._builder.row(*match, row), *self._builder.derivation(*match))
            for match in matches[:_MOST_DERIVATIONS]
        ]
        others = (
            ProofNode("derivation", f"Derivation {number}", children=nodes)
            for number, nodes in enumerate(derivations[1:], 2)
        )
        return len(matches), (*(derivations[0] if derivations else ()), *others)

    def _matches_of(self, rule: RuleParts, row: Row) -> list[tuple[Clause, Way]]:
        """Return derivations of a row: of `Robot` one, of others several if they take few steps."""
        if self._probing.is_distinct or (len(self._rows) > 1 and self._probing.name != MAIN):
            budget = self._derivations.relations.budget
            with suppress(FailureError), budget.bound_steps(_STEPS_FOR_OTHERS):
                return list(self._matches(rule, row, _MOST_OTHERS))
        return list(islice(self._matches(rule, row), 1))

    def _other_row_nodes(self, rule: RuleParts) -> tuple[ProofNode, ...]:
        """Return the derivation of a row that this rule gives and that does not count."""
        if self._probing.recursive:
            return ()
        candidates = (self._derivation_nodes(rule, row)[1] for row in self._rows[:_MOST_OTHERS])
        return next(filter(None, candidates), ())

    def _alternative(
        self, rule: RuleParts, row: Row, nodes: tuple[ProofNode, ...]
    ) -> Iterator[ProofNode]:
        """Yield the differences in another derivation of this rule, if there is one."""
        if self._probing.recursive or rule.is_aggregated:
            return
        rows = [row, *(r for r in self._rows[:_MOST_OTHERS] if r != row)]
        matches = ((r, *match) for r in rows for match in self._matches(rule, r, 2))
        for other_row, clause, match in islice(matches, 1, 2):
            alternative = (
                *self._builder.row(clause, match, other_row),
                *self._builder.derivation(clause, match),
            )
            differences = tuple(node for node in alternative if node not in nodes)
            advice = "a condition, or distinct with an aggregation, would leave one row"
            yield ProofNode(
                "note", "Another row of this rule comes from", advice, children=differences
            )

    def _null_notes(self, nodes: Sequence[ProofNode]) -> Iterator[ProofNode]:
        """Yield which aggregations over nothing made values of the row null."""
        pairs: dict[tuple[str, str], None] = {}
        for top in nodes:
            for _, node in top.walk():
                if node.kind != "note" and node.values == (None,):
                    name = node.span.text if node.span else node.text
                    pairs |= {
                        (name, aggregation): None
                        for aggregation in self._empty_aggregations(node, _DEEPEST)
                    }
        for name, empty in pairs:
            subject = "It" if name == empty else f"`{empty}`"
            remark = f"{subject} aggregates no rows; Coalesce({name}, 0) would be 0 then"
            yield ProofNode("note", f"`{name}` is null", remark)

    def _empty_aggregations(self, node: ProofNode, depth: int) -> Iterator[str]:
        if any(child.text == AGGREGATES_NO_ROWS for child in node.children):
            yield node.span.text if node.span else node.text
        elif node.query is not None and depth:
            explanation = explain(self._derivations, node.query, is_first=False)
            for top in explanation.nodes:
                for _, inner_node in top.walk():
                    if inner_node.values == (None,):
                        yield from self._empty_aggregations(inner_node, depth - 1)

    def _aggregate_nodes(self, matches: list[tuple[Clause, Way]], row: Row) -> Iterator[ProofNode]:
        is_all = len(matches) <= MOST_ELEMENTS
        yield from self._builder.row(*matches[0], row)
        for column in (aggregate.column for aggregate in matches[0][0].aggregates):
            elements: list[Element] = [
                (clause, next(c for c in clause.aggregates if c.column == column), match)
                for clause, match in matches[:MOST_ELEMENTS]
            ]
            children = self._builder.contributors(elements, row[column], is_all)
            name = elements[0][1].operator
            remark = f"{name} over {number_of(len(elements), 'row', is_all=is_all)}"
            if len(self._probing.rules) > 1:
                remark += " of this rule"
            yield ProofNode(
                "aggregate", self.label(column), remark, values=(row[column],), children=children
            )


def _heading(
    rule: RuleParts, remark: str, holds: bool | None, children: tuple[ProofNode, ...] = ()
) -> ProofNode:
    return ProofNode("rule", rule.span.text, remark, holds, span=rule.span, children=children)


def _number_of_rows(number: int) -> str:
    return number_of(number, "row", is_all=number < MOST_ROWS)


def _over_nothing(outcome: RuleOutcome, row: Row, label: Callable[[str], str]) -> RuleOutcome:
    remark = AGGREGATES_NO_ROWS
    columns = (ProofNode("column", label(c), remark, None, (v,)) for c, v in row.items())
    children = (*columns, *outcome.node.children)
    node = replace(outcome.node, remark="gives this row, of nothing", holds=True, children=children)
    return replace(outcome, rows=1, row=row, node=node)


def _note(outcome: RuleOutcome, text: str) -> RuleOutcome:
    return RuleOutcome(outcome.span, None, None, None, ProofNode("note", text))


def _unexplained(probing: Probing) -> str:
    if not probing.recursive:
        return "The origin of this row can't be determined."
    if not probing.is_founded:
        return "This row is from a recursion that goes through a sum or a negation."
    return "This row is from a recursion that was cut off."


def prove(derivations: Derivations, query: Ask, *, depth: int, nodes: int) -> Proof:
    """Prove a row, or its absence, up to `depth` predicates and `nodes` nodes."""
    explanation = explain(derivations, query)
    unfolder = _Unfolder(derivations, nodes)
    path = (explanation.query.key,)
    premises = _premises(explanation)
    roots = tuple(unfolder.node(node, depth, path) for node in premises)
    spans = {premise.span for premise in premises}
    alternatives = tuple(node for node in explanation.nodes if node.span not in spans)
    return Proof(explanation, roots, alternatives, unfolder.complete, unfolder.is_cut)


class _Unfolder:
    """Unfolds calls into their proofs; `is_cut` if the depth has cut some off."""

    def __init__(self, derivations: Derivations, limit: int) -> None:
        self._derivations, self._limit, self._budget = derivations, limit, limit
        self.complete, self.is_cut = True, False

    def node(
        self, node: ProofNode, depth: int, path: tuple[str, ...], *, is_expanded: bool = True
    ) -> ProofNode:
        """Return a node with proofs below, of instances and derivations only in the first."""
        self._budget -= 1
        if node.kind == "derivation":
            return node
        if not node.children and (node.query is None or not is_expanded):
            return node
        instance = next((child for child in node.children if child.kind == "instance"), None)
        children = tuple(
            self.node(child, depth, path, is_expanded=child is instance or child.kind != "instance")
            for child in node.children
        )
        if node.query is not None and is_expanded and instance is None:
            children = (*children, *self._call_proof(node.query, depth, path))
        elif all(map(operator.is_, children, node.children)):
            return node
        return replace(node, children=children)

    def _call_proof(self, query: Ask, depth: int, path: tuple[str, ...]) -> tuple[ProofNode, ...]:
        key = query.key
        if key in path:
            text = f"{spell_call(query)} is asked above; no row follows from itself."
            return (ProofNode("note", text),)
        if depth <= 1:
            self.complete, self.is_cut = False, True
            return ()
        try:
            if self._budget <= 0:
                raise FailureError(f"it has {self._limit:,} lines")
            self._derivations.relations.spend(len(key))
        except FailureError as failure:
            self.complete = False
            return (ProofNode("note", f"The proof ends here: {failure}."),)
        try:
            explanation = explain(self._derivations, query, is_first=False)
        except QueryError as error:
            return (ProofNode("note", str(error)),)
        return tuple(
            self.node(premise, depth - 1, (*path, key)) for premise in _premises(explanation)
        )


def _premises(explanation: Explanation) -> tuple[ProofNode, ...]:
    if explanation.row is None:
        return explanation.nodes
    giving = tuple(rule.node for rule in explanation.rules if rule.row is not None)
    if not giving:
        return next((rule.node,) for rule in explanation.rules if rule.rows is None)
    # Several rules may contribute to an aggregate; otherwise one of them is enough.
    if any(child.kind == "aggregate" for child in giving[0].children):
        return giving
    derivations = (
        replace(node, kind="derivation", remark=f"also {node.remark}") for node in giving[1:]
    )
    return (giving[0], *derivations)
