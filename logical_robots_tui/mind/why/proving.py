"""Why a predicate has a row, or none: one derivation of the row, or where each rule ends.

A row is fixed first; then a derivation of just this row is looked for, and all that is told of it
is read off that one derivation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.mind.diagnostics import QueryError
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.sqlite.stored import to_sql
from logical_robots_tui.mind.why.deriving import MOST_ELEMENTS, Telling, counted, shown, value_of
from logical_robots_tui.mind.why.explanation import Explanation, Node, RuleFound
from logical_robots_tui.mind.why.refuting import Refuting
from logical_robots_tui.mind.why.relations import ALIKE, same
from logical_robots_tui.mind.why.staging import Stages

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Scalar
    from logical_robots_tui.mind.why.probing import (
        Body,
        Clause,
        Collected,
        Probing,
        RuleParts,
        Span,
    )
    from logical_robots_tui.mind.why.relations import Relations, Way
    from logical_robots_tui.values import Value

__all__ = ["MOST_ROWS", "Derived", "Prover"]

MOST_ROWS = 1_000
"""Where counting rows ends."""

Row: TypeAlias = "Mapping[str, Value]"


@dataclass(frozen=True, slots=True)
class Derived:
    """A row and its derivations.

    Attributes:
        probing: The predicate.
        row: The row.
        ways: For each derivation its rule, its clause, and its row of the clause's query. There is
            one, or where the head aggregates all that contribute.
    """

    probing: Probing
    row: Row
    ways: tuple[tuple[Span, Clause, Way], ...]


class Prover:
    """Explains rows of predicates for one robot at one moment.

    Args:
        relations: The rows of predicates then.
        robot: In whose reasoning.
        take_apart: Gives a predicate, by its name and the made predicate in whose copy it stands,
            taken apart.

    Attributes:
        robot: In whose reasoning.
    """

    def __init__(
        self,
        relations: Relations,
        robot: str,
        take_apart: Callable[[str, str], Probing],
    ) -> None:
        self._relations, self.robot, self._take_apart = relations, robot, take_apart
        self._stages: dict[tuple[str, ...], Stages] = {}

    def explain(self, predicate: str, given: Row, within: str = "") -> Explanation:
        """Why a predicate has the rows with given values, or none.

        Args:
            predicate: One of the program's own.
            given: Values of some of its columns.
            within: The predicate made with ``:=`` in whose copy of the rules it is asked, or "".

        Raises:
            QueryError: It has no such column, lacks an argument, or its rows can't be computed.
            Stopped: The work was stopped.
        """
        probing = self._take_apart(predicate, within)
        given = _checked(given, probing)
        try:
            rows = self.rows(probing, given)
            self.prepare(probing)
        except FailureError as failure:
            raise QueryError(f"{predicate} failed: {failure}.") from None
        row = self._stage(probing).first(probing, rows) if rows else None
        rules = tuple(self._rule(rule, probing, given, rows, row) for rule in probing.rules)
        if row is not None and all(found.row is None for found in rules):
            if _is_over_nothing(probing, row):
                rules = (_over_nothing(rules[0], row), *rules[1:])
            else:
                rules = (*rules, _unexplained(rules[0], probing))
        return Explanation(
            predicate,
            self.robot,
            probing.made_from,
            within,
            given,
            min(len(rows), MOST_ROWS),
            row,
            rules,
        )

    def taken_apart(self, predicate: str) -> Probing:
        """A predicate, taken apart.

        Raises:
            QueryError: It can't be.
        """
        return self._take_apart(predicate, "")

    def rows(self, probing: Probing, given: Row) -> Sequence[Row]:
        """The rows of a predicate with given values.

        Raises:
            FailureError: They can't be computed.
        """
        if probing.given:
            self.prepare(probing)
            sql = probing.queries.get(probing.rows)
            if sql is None:
                raise FailureError("it can't be asked for its rows")
            arguments = [to_sql(given[column]) for column in probing.given]
            ways = self._relations.ways(sql, arguments, most=MOST_ROWS + 1)
            found: Sequence[Row] = [
                {c: value_of(way, f"c{i}") for i, c in enumerate(probing.columns)} for way in ways
            ]
        else:
            name = probing.name
            found = self._relations.rows(name, probing.sources.get(name, ""))
        return [row for row in found if all(same(row[c], v) for c, v in given.items())]

    def derivations(self, predicate: str, within: str, given: Row) -> Derived:
        """The first row with given values, and a derivation of it; of aggregates, all of them.

        Raises:
            QueryError: There is none, or how it came about can't be told.
            FailureError: A query failed.
        """
        probing = self._take_apart(predicate, within)
        given = _checked(given, probing)
        self.prepare(probing)
        rows = self.rows(probing, given)
        if not rows:
            raise QueryError(f"{predicate} has no such row.")
        row = self._stage(probing).first(probing, rows)
        arguments = [to_sql(given[column]) for column in probing.given]
        self.prepare(probing, row)
        ways: list[tuple[Span, Clause, Way]] = []
        for rule in probing.rules:
            most = MOST_ELEMENTS if _is_aggregated(rule) else 1
            found = self._ways(rule, probing, row, arguments, most)
            ways += [(rule.span, clause, way) for clause, way in found]
            if ways and not _is_aggregated(rule):
                break
        if not ways:
            raise QueryError(f"How {predicate} has this row can't be told.")
        return Derived(probing, row, tuple(ways))

    def elements(self, probing: Probing, body: Body, way: Way) -> list[tuple[Clause, Way]]:
        """Derivations of what an aggregate goes over, in one derivation.

        Raises:
            FailureError: A query failed.
        """
        self.prepare(probing)
        given = [way.get(place) for place in body.given.values()]
        return [
            (clause, inner)
            for clause in body.clauses
            for inner in self._relations.ways(self._sql(clause, probing), given, most=MOST_ELEMENTS)
        ]

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
        refuting = Refuting(self._relations, probing.queries)
        telling = Telling(self._relations, probing.queries, refuting.bodies)
        refuting.telling = telling
        try:
            number = self._number(rule, probing, given, arguments, rows)
            if row is not None:
                self.prepare(probing, row)
                nodes = self._derived(rule, probing, row, arguments, telling)
                self.prepare(probing)
                if nodes is not None:
                    said = _gives(number, len(rows))
                    return RuleFound(
                        rule.span, number, row, None, _heading(rule, said, True, nodes)
                    )
            if number:
                said = f"gives {_counted(number)}, but not the first"
                return RuleFound(rule.span, number, None, None, _heading(rule, said, True))
            wanted = {c: v for c, v in given.items() if c not in probing.given}
            others, stopped, children = refuting.rule(rule, arguments, wanted)
            if row is None and stopped is None and _is_aggregated(rule):
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
        """What came out of the aggregates, where that is not what was asked for."""
        keys = _keys(rule, given)
        rows = self.rows(probing, keys)
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
        """How many of the rows come from a rule."""
        if not rows:
            return 0
        if probing.recursive or _is_aggregated(rule):
            return sum(
                any(True for _ in self._ways(rule, probing, row, arguments)) for row in rows[:100]
            )
        found: set[str] = set()
        number = 0
        for clause in rule.clauses:
            sql = self._sql(clause, probing)
            places = [(place, given[c]) for c, place in clause.head.items() if c in given]
            if probing.distinct:
                what = f"DISTINCT {', '.join(clause.head.values()) or 'one'}"
                ways = self._relations.ways(sql, arguments, places, what, MOST_ROWS)
                found |= {repr(tuple(way.values())) for way in ways}
            else:
                number += self._relations.count(sql, arguments, places, MOST_ROWS)
        return min(number + len(found), MOST_ROWS)

    def _derived(
        self,
        rule: RuleParts,
        probing: Probing,
        row: Row,
        arguments: Sequence[Scalar],
        telling: Telling,
    ) -> tuple[Node, ...] | None:
        """The nodes of a derivation of a row by a rule, or None if there is none."""
        if not _is_aggregated(rule):
            for clause, way in self._ways(rule, probing, row, arguments):
                return (*telling.row(clause, way, row), *telling.derivation(clause, way))
            return None
        ways = list(self._ways(rule, probing, row, arguments, MOST_ELEMENTS + 1))
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
            said = f"{operator} over {counted(len(found), 'row', is_all=is_all)}"
            if len(probing.rules) > 1:
                said += " of this rule"
            yield Node("aggregate", shown(column), said, values=(row[column],), children=children)

    def _ways(
        self,
        rule: RuleParts,
        probing: Probing,
        row: Row,
        arguments: Sequence[Scalar],
        most: int = 1,
    ) -> Iterator[tuple[Clause, Way]]:
        """Derivations of a row by a rule; of one with aggregates, what contributes to it."""
        for clause in rule.clauses:
            alike = [(place, row[c]) for c, place in clause.head.items() if c in row]
            sql = self._sql(clause, probing)
            found = self._relations.ways(sql, arguments, alike, most=most)
            if not found and any(isinstance(value, dict | list) for _, value in alike):
                found = self._relations.ways(sql, arguments, alike, most=most, compared=ALIKE)
            for way in found:
                yield clause, way

    @staticmethod
    def _sql(clause: Clause, probing: Probing) -> str:
        sql = probing.queries.get(clause.query)
        if sql is None:
            raise FailureError("it is put together from too many parts")
        return sql

    # -- tables ----------------------------------------------------------------------------------

    def prepare(self, probing: Probing, row: Row | None = None) -> None:
        """Fill the tables that the queries of a predicate read.

        Args:
            probing: The predicate.
            row: A row of a recursion, so that only what was there before counts.
        """
        for name, table in probing.tables.items():
            rows: Sequence[Row] = self._relations.rows(name, probing.sources.get(name, ""))
            if name in probing.recursive and row is not None:
                rows = self._stage(probing).before(name, probing, row, rows)
            self._relations.fill(table, name, rows)

    def _stage(self, probing: Probing) -> Stages:
        key = tuple(probing.recursive)
        if key not in self._stages:
            members = {}
            if probing.founded:
                members = {
                    name: self._take_apart(*called) for name, called in probing.recursive.items()
                }
            self._stages[key] = Stages(self._relations, members)
        return self._stages[key]


def _checked(given: Row, probing: Probing) -> Row:
    """The given values, by columns that there are.

    Raises:
        QueryError: One is not there, or an argument is missing.
    """
    if VALUE in probing.columns and "value" in given and "value" not in probing.columns:
        given = {(VALUE if c == "value" else c): v for c, v in given.items()}
    columns = ", ".join(map(shown, probing.columns))
    for column in given:
        if column not in probing.columns:
            raise QueryError(f"{probing.predicate} has no column {column}; it has {columns}.")
    if missing := [name for name in probing.given if name not in given]:
        names = ", ".join(missing)
        raise QueryError(f"{probing.predicate} is a function of {names}: give a value for it.")
    return given


def _is_aggregated(rule: RuleParts) -> bool:
    return any(clause.collected for clause in rule.clauses)


def _keys(rule: RuleParts, row: Row) -> Row:
    """The values of a row in the columns that are not aggregated."""
    return {c: v for c, v in row.items() if any(c in clause.head for clause in rule.clauses)}


def _heading(
    rule: RuleParts, said: str, holds: bool | None, children: tuple[Node, ...] = ()
) -> Node:
    return Node("rule", rule.span.text, said, holds, span=rule.span, children=children)


def _counted(number: int) -> str:
    return counted(number, "row", is_all=number < MOST_ROWS)


def _gives(number: int, of: int) -> str:
    if of <= 1:
        return "gives this row"
    return f"gives {_counted(number)}; this is the first"


def _is_over_nothing(probing: Probing, row: Row) -> bool:
    """Whether a row is what aggregates without a key give where there is nothing."""
    is_keyless = not any(clause.head for rule in probing.rules for clause in rule.clauses)
    return is_keyless and all(value in (None, 0) for value in row.values())


def _over_nothing(found: RuleFound, row: Row) -> RuleFound:
    """A rule whose aggregates go over nothing, and so does every other one of its predicate."""
    columns = tuple(
        Node("column", shown(c), "goes over nothing", None, (v,)) for c, v in row.items()
    )
    children = (*columns, *found.node.children)
    node = replace(found.node, said="gives this row, of nothing", holds=True, children=children)
    return replace(found, rows=1, row=row, node=node)


def _unexplained(like: RuleFound, probing: Probing) -> RuleFound:
    if probing.recursive:
        text = "This row is from a recursion that was cut off, or that goes through a sum."
    else:
        text = "How this row came about could not be told."
    return RuleFound(like.span, None, None, None, Node("note", text))
