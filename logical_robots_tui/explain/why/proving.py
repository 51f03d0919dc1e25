"""Why a predicate has a row, or none: one derivation of the row, or where each rule ends."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

from logical_robots_tui.explain.why.derivations import (
    MOST_ROWS,
    Derivations,
    Row,
    check_given,
    is_aggregated,
)
from logical_robots_tui.explain.why.deriving import MOST_ELEMENTS, Telling, column_label, number_of
from logical_robots_tui.explain.why.explanation import Ask, Explanation, Node, Proof, RuleFound
from logical_robots_tui.explain.why.probing import Clause, Collected, Probing, RuleParts
from logical_robots_tui.explain.why.refuting import Refuting
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.relations import Way, same
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.stored import to_sql


class Prover:
    """Explains rows of predicates for one robot at one moment."""

    def __init__(self, derivations: Derivations) -> None:
        self.derivations = derivations

    def explain(self, asked: Ask) -> Explanation:
        """Explain a predicate's rows, or their absence; raise QueryError or Stopped."""
        probing = self.derivations.decompose(asked.predicate, asked.within)
        given = check_given(asked.given, probing)
        try:
            rows = self.derivations.rows(probing, given)
            self.derivations.prepare(probing)
        except FailureError as failure:
            raise QueryError(f"{asked.predicate} failed: {failure}.") from None
        row = self.derivations.stage(probing).first(probing, rows) if rows else None
        rules = tuple(self._rule(rule, probing, given, rows, row) for rule in probing.rules)
        if row is not None and all(found.row is None for found in rules):
            if _is_over_nothing(probing, row):
                rules = (_over_nothing(rules[0], row), *rules[1:])
            else:
                rules = (*rules, _note_unexplained(rules[0], probing))
        return Explanation(
            asked.predicate,
            self.derivations.robot,
            probing.made_from,
            asked.within,
            given,
            min(len(rows), MOST_ROWS),
            row,
            rules,
        )

    # -- rules -----------------------------------------------------------------------------------

    def _rule(
        self,
        rule: RuleParts,
        probing: Probing,
        given: Row,
        rows: Sequence[Row],
        row: Row | None,
    ) -> RuleFound:
        arguments = [to_sql(given[column]) for column in probing.given]
        wanted = {c: v for c, v in given.items() if c not in probing.given}
        refuting = Refuting(self.derivations.relations, probing.queries, arguments, wanted)
        try:
            number = self._number(rule, probing, given, arguments, rows)
            if row is not None:
                self.derivations.prepare(probing, row)
                nodes = self._derived(rule, probing, row, arguments, refuting.telling)
                self.derivations.prepare(probing)
                if nodes is not None:
                    said = _gives(number, len(rows))
                    return RuleFound(
                        rule.span, number, row, None, _heading(rule, said, True, nodes)
                    )
            if number:
                said = f"gives {_number_of_rows(number)}, but not the first"
                return RuleFound(rule.span, number, None, None, _heading(rule, said, True))
            others, stopped, children = refuting.rule(rule)
            if row is None and stopped is None and is_aggregated(rule):
                unlike = self._unlike(rule, probing, given)
                children, stopped = (*children, *unlike), next(iter(unlike), None)
            said = "is about something else" if others else "gives no row"
            node = _heading(rule, said, None if others else False, children)
            return RuleFound(rule.span, 0, None, stopped, node)
        except FailureError as failure:
            note = Node("note", "This could not be asked", str(failure))
            return RuleFound(
                rule.span, None, None, None, _heading(rule, "could not be asked", None, (note,))
            )

    def _unlike(self, rule: RuleParts, probing: Probing, given: Row) -> tuple[Node, ...]:
        keys = _keys(rule, given)
        rows = self.derivations.rows(probing, keys)
        return tuple(
            Node("column", column, "came out", False, (row[column],))
            for row in rows[:1]
            for column, value in given.items()
            if column not in keys and not same(row[column], value)
        )

    def _number(
        self,
        rule: RuleParts,
        probing: Probing,
        given: Row,
        arguments: Sequence[Scalar],
        rows: Sequence[Row],
    ) -> int:
        if not rows:
            return 0
        if probing.recursive or is_aggregated(rule):
            ways = self.derivations.ways
            return sum(any(True for _ in ways(rule, probing, r, arguments)) for r in rows[:100])
        found: set[str] = set()
        number = 0
        for clause in rule.clauses:
            sql = self.derivations.sql(clause, probing)
            places = [(place, given[c]) for c, place in clause.head.items() if c in given]
            if probing.distinct:
                what = f"DISTINCT {', '.join(clause.head.values()) or 'one'}"
                rest = self.derivations.relations.ways(sql, arguments, places, what, MOST_ROWS)
                found |= {repr(tuple(way.values())) for way in rest}
            else:
                number += self.derivations.relations.count(sql, arguments, places, MOST_ROWS)
        return min(number + len(found), MOST_ROWS)

    def _derived(
        self,
        rule: RuleParts,
        probing: Probing,
        row: Row,
        arguments: Sequence[Scalar],
        telling: Telling,
    ) -> tuple[Node, ...] | None:
        if not is_aggregated(rule):
            for clause, way in self.derivations.ways(rule, probing, row, arguments):
                return (*telling.row(clause, way, row), *telling.derivation(clause, way))
            return None
        ways = list(self.derivations.ways(rule, probing, row, arguments, MOST_ELEMENTS + 1))
        if not ways:
            return None
        return tuple(self._aggregated(probing, ways, row, telling))

    def _aggregated(
        self,
        probing: Probing,
        ways: list[tuple[Clause, Way]],
        row: Row,
        telling: Telling,
    ) -> Iterator[Node]:
        is_all = len(ways) <= MOST_ELEMENTS
        yield from telling.row(*ways[0], row)
        for column in (each.column for each in ways[0][0].collected):
            found: list[tuple[Clause, Collected, Way]] = [
                (clause, next(c for c in clause.collected if c.column == column), way)
                for clause, way in ways[:MOST_ELEMENTS]
            ]
            children = telling.contributors(found, row[column], is_all)
            operator = found[0][1].operator
            said = f"{operator} over {number_of(len(found), 'row', is_all=is_all)}"
            if len(probing.rules) > 1:
                said += " of this rule"
            yield Node(
                "aggregate", column_label(column), said, values=(row[column],), children=children
            )


def _keys(rule: RuleParts, row: Row) -> Row:
    return {c: v for c, v in row.items() if any(c in clause.head for clause in rule.clauses)}


def _heading(
    rule: RuleParts, said: str, holds: bool | None, children: tuple[Node, ...] = ()
) -> Node:
    return Node("rule", rule.span.text, said, holds, span=rule.span, children=children)


def _number_of_rows(number: int) -> str:
    return number_of(number, "row", is_all=number < MOST_ROWS)


def _gives(number: int, of: int) -> str:
    if of <= 1:
        return "gives this row"
    return f"gives {_number_of_rows(number)}; this is the first"


def _is_over_nothing(probing: Probing, row: Row) -> bool:
    is_keyless = not any(clause.head for rule in probing.rules for clause in rule.clauses)
    return is_keyless and all(value in (None, 0) for value in row.values())


def _over_nothing(found: RuleFound, row: Row) -> RuleFound:
    columns = tuple(
        Node("column", column_label(c), "goes over nothing", None, (v,)) for c, v in row.items()
    )
    children = (*columns, *found.node.children)
    node = replace(found.node, said="gives this row, of nothing", holds=True, children=children)
    return replace(found, rows=1, row=row, node=node)


def _note_unexplained(like: RuleFound, probing: Probing) -> RuleFound:
    if probing.recursive:
        text = "This row is from a recursion that was cut off, or that goes through a sum."
    else:
        text = "How this row came about could not be told."
    return RuleFound(like.span, None, None, None, Node("note", text))


def unfold(prover: Prover, asked: Ask, *, depth: int, nodes: int) -> Proof:
    explanation = prover.explain(asked)
    unfolding = _Unfolding(prover, nodes)
    roots = tuple(unfolding.node(node, depth, ()) for node in _proving(explanation))
    return Proof(explanation, roots, unfolding.complete)


class _Unfolding:
    def __init__(self, prover: Prover, most: int) -> None:
        self._prover, self._left = prover, most
        self._known: dict[str, tuple[Node, ...] | str] = {}
        self.complete = True

    def node(self, node: Node, depth: int, above: tuple[str, ...]) -> Node:
        self._left -= 1
        children = tuple(self.node(child, depth, above) for child in node.children)
        if node.asked is not None:
            children = (*children, *self._called(node.asked, depth, above))
        return replace(node, children=children)

    def _called(self, asked: Ask, depth: int, above: tuple[str, ...]) -> tuple[Node, ...]:
        key = json.dumps([asked.predicate, asked.within, asked.given], sort_keys=True)
        if depth <= 1 or self._left <= 0 or key in above:
            self.complete = False
            return ()
        try:
            self._prover.derivations.relations.spend(len(key))
        except FailureError as failure:
            self.complete = False
            return (Node("note", f"The proof ends here: {failure}."),)
        found = self._known.get(key)
        if found is None:
            try:
                found = _proving(self._prover.explain(asked))
            except QueryError as error:
                found = str(error)
            self._known[key] = found
        if isinstance(found, str):
            return (Node("note", found),)
        return tuple(self.node(each, depth - 1, (*above, key)) for each in found)


def _proving(explanation: Explanation) -> tuple[Node, ...]:
    if explanation.row is None:
        return explanation.nodes
    giving = tuple(rule.node for rule in explanation.rules if rule.row is not None)
    if not giving:
        return (explanation.rules[-1].node,)
    # Several rules may contribute to what is aggregated; else one of them is enough.
    is_aggregated = any(child.kind == "aggregate" for child in giving[0].children)
    return giving if is_aggregated else giving[:1]
