"""Why a predicate has a row, or none: one derivation of the row, or where each rule ends."""

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
    is_aggregated,
)
from logical_robots_tui.explain.why.deriving import AGGREGATES_NO_ROWS, MOST_ELEMENTS, number_of
from logical_robots_tui.explain.why.explanation import (
    Ask,
    Explanation,
    Node,
    Proof,
    RuleFound,
    spell_call,
)
from logical_robots_tui.explain.why.probing import AggregateInput, Clause, Probing, RuleParts
from logical_robots_tui.explain.why.refuting import Refuting
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import Way, same
from logical_robots_tui.schema import MAIN


def explain(derivations: Derivations, asked: Ask, *, is_first: bool = True) -> Explanation:
    """Explain a predicate's rows, or their absence; raise QueryError or Stopped.

    `is_first` is False for the questions that follow from another one.
    """
    key = (asked.key, is_first)
    if key not in derivations.explained:
        derivations.explained[key] = _explain(derivations, asked, is_first=is_first)
    return derivations.explained[key]


def _explain(derivations: Derivations, asked: Ask, *, is_first: bool) -> Explanation:
    probing = derivations.decompose(asked.predicate, asked.within)
    given = check_given(asked, probing, derivations.relations.label)
    asked = replace(asked, given=given)
    try:
        rows = derivations.rows(probing, given)
        derivations.prepare(probing)
    except FailureError as failure:
        raise QueryError(f"{asked.predicate} failed: {failure}.") from None
    row = derivations.stage(probing).first(probing, rows) if rows else None
    proving = _Proving(derivations, probing, given, rows, row)
    rules = tuple(map(proving.rule, probing.rules))
    if row is not None and all(found.row is None for found in rules):
        is_keyless = not any(clause.head for rule in probing.rules for clause in rule.clauses)
        if is_keyless and all(value in (None, 0) for value in row.values()):
            rules = (_over_nothing(rules[0], row, proving.label), *rules[1:])
        elif all(found.rows is not None for found in rules):
            rules = (*rules, _note(rules[0], _unexplained(probing)))
    if row is None and (is_first or probing.recursive):
        for name, steps in derivations.relations.cut_off(asked.predicate):
            said = f"The recursion of {name} was cut off after {steps} steps, so later rows are"
            more = f"@Recursive({name}, {2 * steps}) would allow more"
            rules = (*rules, _note(rules[0], f"{said} missing; {more}."))
    return Explanation(
        asked, derivations.robot, probing.made_from, min(len(rows), MOST_ROWS), row, rules
    )


_MOST_OTHERS = 50  # rows among which another derivation is sought, derivations that are counted
_STEPS_FOR_OTHERS = 1_000_000  # some 15 milliseconds
_DEEPEST = 5  # functions that call functions, in the search for an empty aggregation


class _Proving:
    """Explains what each rule of a predicate gives; `row` is the first of the `rows`, if any."""

    def __init__(
        self,
        derivations: Derivations,
        probing: Probing,
        given: Row,
        rows: Sequence[Row],
        row: Row | None,
    ) -> None:
        self._derivations, self._probing = derivations, probing
        self._given, self._rows, self._row = given, rows, row
        self._arguments = probing.arguments(given)
        wanted = {c: v for c, v in given.items() if c not in probing.given}
        self._refuting = Refuting(derivations, probing, self._arguments, wanted)
        self._telling = self._refuting.telling
        self._which = "last" if probing.name == MAIN else "first"

    def rule(self, rule: RuleParts) -> RuleFound:
        row = self._row
        try:
            nodes = None
            if row is not None:
                self._derivations.prepare(self._probing, row)
                nodes = self._derived(rule, row)
                self._derivations.prepare(self._probing)
            number = 1 if nodes is not None and len(self._rows) == 1 else self._number(rule)
            if nodes is not None:
                said = "gives this row"
                if len(self._rows) > 1:
                    said = f"gives {_number_of_rows(number)}; this is the {self._which}"
                if row is not None and self._probing.name == MAIN:
                    nodes = (*nodes, *self._another(rule, row, nodes), *self._nulls(nodes))
                return RuleFound(rule.span, number, row, None, _heading(rule, said, True, nodes))
            if number:
                said = f"gives {_number_of_rows(number)}, but not the {self._which}"
                nodes = () if row is None or self._which == "first" else self._of_other_row(rule)
                return RuleFound(rule.span, number, None, None, _heading(rule, said, True, nodes))
            is_else, stopped, children = self._refuting.rule(rule)
            if row is None and stopped is None and is_aggregated(rule):
                unlike = self._unlike(rule)
                children, stopped = (*children, *unlike), next(iter(unlike), None)
            said = "does not apply to these values" if is_else else "gives no row"
            if is_left_out := row is None and not (stopped or is_else or is_aggregated(rule)):
                said = "gives this row, but it was left out, as by @Limit"
                if self._probing.recursive:
                    said = "would give this row in a later step"
            node = _heading(rule, said, None if is_else or is_left_out else False, children)
            return RuleFound(rule.span, 0, None, stopped, node)
        except FailureError as failure:
            note = Node("note", "This could not be asked", str(failure))
            heading = _heading(rule, "could not be asked", None, (note,))
            return RuleFound(rule.span, None, None, None, heading)

    def _unlike(self, rule: RuleParts) -> tuple[Node, ...]:
        given = self._given
        keys = {c: v for c, v in given.items() if any(c in each.head for each in rule.clauses)}
        return tuple(
            Node("column", self.label(column), "actual value", False, (row[column],))
            for row in self._derivations.rows(self._probing, keys)[:1]
            for column, value in given.items()
            if column not in keys and not same(row[column], value)
        )

    def label(self, column: str) -> str:
        return self._derivations.relations.label(self._probing.predicate, column)

    def _number(self, rule: RuleParts) -> int:
        if not self._rows:
            return 0
        probing, relations = self._probing, self._derivations.relations
        if probing.recursive or is_aggregated(rule):
            return sum(any(True for _ in self._ways(rule, row)) for row in self._rows[:100])
        found: set[str] = set()
        number = 0
        for clause in rule.clauses:
            sql = self._derivations.sql(clause, probing)
            places = [
                (place, self._given[c]) for c, place in clause.head.items() if c in self._given
            ]
            if probing.distinct:
                what = f"DISTINCT {', '.join(clause.head.values()) or 'one'}"
                rest = relations.ways(sql, self._arguments, places, what, MOST_ROWS)
                found |= {repr(tuple(way.values())) for way in rest}
            else:
                number += relations.count(sql, self._arguments, places, MOST_ROWS)
        return min(number + len(found), MOST_ROWS)

    def _ways(self, rule: RuleParts, row: Row, most: int = 1) -> Iterator[tuple[Clause, Way]]:
        return self._derivations.ways(rule, self._probing, row, self._arguments, most)

    def _derived(self, rule: RuleParts, row: Row) -> tuple[Node, ...] | None:
        if is_aggregated(rule):
            ways = list(self._ways(rule, row, MOST_ELEMENTS + 1))
            return tuple(self._aggregated(ways, row)) if ways else None
        ways = self._derivations_of(rule, row)
        if not ways:
            return None
        nodes = (*self._telling.row(*ways[0], row), *self._telling.derivation(*ways[0]))
        if number := len(ways) - 1:
            others = number_of(number, "other derivation", is_all=len(ways) < _MOST_OTHERS)
            nodes = (*nodes, Node("note", f"This row has {others} by this rule"))
        return nodes

    def _derivations_of(self, rule: RuleParts, row: Row) -> list[tuple[Clause, Way]]:
        """Return derivations of a row: of a distinct one those that are found in a few steps."""
        if self._probing.distinct:
            budget = self._derivations.relations.budget
            with suppress(FailureError), budget.bound_steps(_STEPS_FOR_OTHERS):
                return list(self._ways(rule, row, _MOST_OTHERS))
        return list(islice(self._ways(rule, row), 1))

    def _of_other_row(self, rule: RuleParts) -> tuple[Node, ...]:
        """Return the derivation of a row that this rule gives and that does not count."""
        if self._probing.recursive:
            return ()
        found = (self._derived(rule, each) for each in self._rows[:_MOST_OTHERS])
        return next(filter(None, found), ())

    def _another(self, rule: RuleParts, row: Row, nodes: tuple[Node, ...]) -> Iterator[Node]:
        """Yield what is different in another derivation of this rule, if there is one."""
        if self._probing.recursive or is_aggregated(rule):
            return
        others = [row, *(each for each in self._rows[:_MOST_OTHERS] if each != row)]
        ways = ((each, *way) for each in others for way in self._ways(rule, each, 2))
        for other, clause, way in islice(ways, 1, 2):
            found = (*self._telling.row(clause, way, other), *self._telling.derivation(clause, way))
            unlike = tuple(node for node in found if node not in nodes)
            said = "a condition, or distinct with an aggregation, would leave one row"
            yield Node("note", "Another row of this rule comes from", said, children=unlike)

    def _nulls(self, nodes: Sequence[Node]) -> Iterator[Node]:
        """Yield which aggregations over nothing made values of the row null."""
        found: dict[tuple[str, str], None] = {}
        for top in nodes:
            for _, node in top.walk():
                if node.kind != "note" and node.values == (None,):
                    name = node.span.text if node.span else node.text
                    found |= {(name, each): None for each in self._empty(node, _DEEPEST)}
        for name, empty in found:
            because = "It" if name == empty else f"`{empty}`"
            said = f"{because} aggregates no rows; Coalesce({name}, 0) would be 0 then"
            yield Node("note", f"`{name}` is null", said)

    def _empty(self, node: Node, depth: int) -> Iterator[str]:
        if any(child.text == AGGREGATES_NO_ROWS for child in node.children):
            yield node.span.text if node.span else node.text
        elif node.asked is not None and depth:
            inner = explain(self._derivations, node.asked, is_first=False)
            for top in inner.nodes:
                for _, each in top.walk():
                    if each.values == (None,):
                        yield from self._empty(each, depth - 1)

    def _aggregated(self, ways: list[tuple[Clause, Way]], row: Row) -> Iterator[Node]:
        is_all = len(ways) <= MOST_ELEMENTS
        yield from self._telling.row(*ways[0], row)
        for column in (each.column for each in ways[0][0].collected):
            found: list[tuple[Clause, AggregateInput, Way]] = [
                (clause, next(c for c in clause.collected if c.column == column), way)
                for clause, way in ways[:MOST_ELEMENTS]
            ]
            children = self._telling.contributors(found, row[column], is_all)
            operator = found[0][1].operator
            said = f"{operator} over {number_of(len(found), 'row', is_all=is_all)}"
            if len(self._probing.rules) > 1:
                said += " of this rule"
            yield Node(
                "aggregate", self.label(column), said, values=(row[column],), children=children
            )


def _heading(
    rule: RuleParts, said: str, holds: bool | None, children: tuple[Node, ...] = ()
) -> Node:
    return Node("rule", rule.span.text, said, holds, span=rule.span, children=children)


def _number_of_rows(number: int) -> str:
    return number_of(number, "row", is_all=number < MOST_ROWS)


def _over_nothing(found: RuleFound, row: Row, label: Callable[[str], str]) -> RuleFound:
    said = AGGREGATES_NO_ROWS
    columns = (Node("column", label(c), said, None, (v,)) for c, v in row.items())
    children = (*columns, *found.node.children)
    node = replace(found.node, said="gives this row, of nothing", holds=True, children=children)
    return replace(found, rows=1, row=row, node=node)


def _note(like: RuleFound, text: str) -> RuleFound:
    return RuleFound(like.span, None, None, None, Node("note", text))


def _unexplained(probing: Probing) -> str:
    if not probing.recursive:
        return "The origin of this row can't be determined."
    if not probing.founded:
        return "This row is from a recursion that goes through a sum or a negation."
    return "This row is from a recursion that was cut off."


def prove(derivations: Derivations, asked: Ask, *, depth: int, nodes: int) -> Proof:
    """Prove a row, or its absence, up to `depth` predicates and `nodes` nodes."""
    explanation = explain(derivations, asked)
    unfolding = _Unfolding(derivations, nodes)
    above = (explanation.asked.key,)
    roots = tuple(unfolding.node(node, depth, above) for node in _premises(explanation))
    return Proof(explanation, roots, unfolding.complete, unfolding.is_cut)


class _Unfolding:
    """Unfolds calls into their proofs; `is_cut` if the depth has cut some off."""

    def __init__(self, derivations: Derivations, most: int) -> None:
        self._derivations, self._most, self._left = derivations, most, most
        self.complete, self.is_cut = True, False

    def node(
        self, node: Node, depth: int, above: tuple[str, ...], *, is_tried: bool = True
    ) -> Node:
        """Return a node with proofs below; of the calls in `instance` nodes, only of the first."""
        self._left -= 1
        if not node.children and (node.asked is None or not is_tried):
            return node
        tried = next((child for child in node.children if child.kind == "instance"), None)
        children = tuple(
            self.node(child, depth, above, is_tried=child is tried or child.kind != "instance")
            for child in node.children
        )
        if node.asked is not None and is_tried and tried is None:
            children = (*children, *self._called(node.asked, depth, above))
        elif all(map(operator.is_, children, node.children)):
            return node
        return replace(node, children=children)

    def _called(self, asked: Ask, depth: int, above: tuple[str, ...]) -> tuple[Node, ...]:
        key = asked.key
        if key in above:
            text = f"{spell_call(asked)} is asked above; no row follows from itself."
            return (Node("note", text),)
        if depth <= 1:
            self.complete, self.is_cut = False, True
            return ()
        try:
            if self._left <= 0:
                raise FailureError(f"it has {self._most:,} lines")
            self._derivations.relations.spend(len(key))
        except FailureError as failure:
            self.complete = False
            return (Node("note", f"The proof ends here: {failure}."),)
        try:
            found = explain(self._derivations, asked, is_first=False)
        except QueryError as error:
            return (Node("note", str(error)),)
        return tuple(self.node(each, depth - 1, (*above, key)) for each in _premises(found))


def _premises(explanation: Explanation) -> tuple[Node, ...]:
    if explanation.row is None:
        return explanation.nodes
    giving = tuple(rule.node for rule in explanation.rules if rule.row is not None)
    if not giving:
        return next((rule.node,) for rule in explanation.rules if rule.rows is None)
    # Several rules may contribute to what is aggregated; else one of them is enough.
    is_aggregated = any(child.kind == "aggregate" for child in giving[0].children)
    return giving if is_aggregated else giving[:1]
