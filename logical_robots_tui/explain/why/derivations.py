"""The rows of predicates, and derivations of a row, for one robot at one moment.

Rows of a recursion are derived from earlier rows, so that no row proves itself.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from logical_robots_tui.explain.why.deriving import MOST_ELEMENTS, value_of
from logical_robots_tui.explain.why.explanation import Ask, Explanation
from logical_robots_tui.explain.why.probing import Body, Clause, Probing, RuleParts, SourceSpan
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.relations import ALIKE, Relations, Way, same
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.schema import MAIN
from logical_robots_tui.values import Value
from logical_robots_tui.wording import count_of

MOST_ROWS = 1_000
"""Where counting rows ends."""

Row: TypeAlias = "Mapping[str, Value]"


@dataclass(frozen=True, slots=True)
class DerivedRow:
    """A row and its derivations: one, or, if the head aggregates, all that contribute."""

    probing: Probing
    row: Row
    matches: tuple[tuple[SourceSpan, Clause, Way], ...]


class Derivations:
    """Finds rows of predicates and derivations of them, in a robot's reasoning."""

    def __init__(
        self, relations: Relations, robot: str, decompose: Callable[[str, str], Probing]
    ) -> None:
        self.relations, self.robot, self.decompose = relations, robot, decompose
        self._stages: dict[tuple[str, ...], Stages] = {}
        self.explained: dict[tuple[str, bool], Explanation] = {}

    def rows(self, probing: Probing, values: Row) -> Sequence[Row]:
        """Return a predicate's rows with given values; raise FailureError."""
        if probing.parameters:
            self.prepare(probing)
            sql = probing.queries.get(probing.rows)
            if sql is None:
                raise FailureError("it can't be asked for its rows")
            matches = self.relations.ways(sql, probing.arguments(values), max_rows=MOST_ROWS + 1)
            rows: Sequence[Row] = [
                {c: value_of(match, f"c{i}") for i, c in enumerate(probing.columns)}
                for match in matches
            ]
        else:
            rows = self.relations.rows(probing.name, probing.sources)
        return [row for row in rows if all(same(row[c], v) for c, v in values.items())]

    def first_row(self, query: Ask) -> DerivedRow:
        """Return the first such row and one derivation, or all of an aggregate.

        Raises QueryError if there is none, and FailureError if a query failed.
        """
        probing = self.decompose(query.predicate, query.within)
        values = check_given(query, probing, self.relations.label)
        self.prepare(probing)
        rows = self.rows(probing, values)
        if not rows:
            raise QueryError(f"{query.predicate} has no such row.")
        row = self.stage(probing).first_row(probing, rows)
        self.prepare(probing, row)
        matches: list[tuple[SourceSpan, Clause, Way]] = []
        for rule in probing.rules:
            limit = MOST_ELEMENTS if rule.is_aggregated else 1
            rule_matches = self.matches(rule, probing, row, probing.arguments(values), limit)
            matches += [(rule.span, clause, match) for clause, match in rule_matches]
            if matches and not rule.is_aggregated:
                break
        if not matches:
            raise QueryError(f"The rule that gives {query.predicate} this row can't be determined.")
        return DerivedRow(probing, row, tuple(matches))

    def elements(self, probing: Probing, body: Body, match: Way) -> list[tuple[Clause, Way]]:
        self.prepare(probing)
        arguments, find_matches = body.arguments(match), self.relations.ways
        return [
            (clause, inner)
            for clause in body.clauses
            for inner in find_matches(self.sql(clause, probing), arguments, max_rows=MOST_ELEMENTS)
        ]

    def matches(
        self,
        rule: RuleParts,
        probing: Probing,
        row: Row,
        arguments: Sequence[Scalar],
        limit: int = 1,
    ) -> Iterator[tuple[Clause, Way]]:
        for clause in rule.clauses:
            conditions = [(place, row[c]) for c, place in clause.head.items() if c in row]
            sql = self.sql(clause, probing)
            matches = self.relations.ways(sql, arguments, conditions, max_rows=limit)
            if not matches and any(isinstance(value, dict | list) for _, value in conditions):
                matches = self.relations.ways(
                    sql, arguments, conditions, max_rows=limit, comparison=ALIKE
                )
            for match in matches:
                yield clause, match

    @staticmethod
    def sql(clause: Clause, probing: Probing) -> str:
        sql = probing.queries.get(clause.query)
        if sql is None:
            raise FailureError("it is put together from too many parts")
        return sql

    def prepare(self, probing: Probing, row: Row | None = None) -> None:
        """Fill the tables that queries read; for a recursion's `row`, only with earlier rows."""
        for name, table in probing.tables.items():
            rows: Sequence[Row] = self.relations.rows(name, probing.sources)
            if name in probing.recursive and row is not None:
                rows = self.stage(probing).earlier_rows(name, probing, row, rows)
            self.relations.fill(table, name, rows)

    def stage(self, probing: Probing) -> Stages:
        key = tuple(probing.recursive)
        if key not in self._stages:
            members = probing.recursive.items() if probing.is_founded else ()
            decomposed = {name: self.decompose(*names) for name, names in members}
            self._stages[key] = Stages(self.relations, decomposed)
        return self._stages[key]


def check_given(query: Ask, probing: Probing, label: Callable[[str, str], str]) -> Row:
    """Return the given values; QueryError for an unknown column or a missing argument."""
    name = query.predicate
    labels = {label(name, column): column for column in probing.columns}
    values = {labels.get(column, column): value for column, value in query.given.items()}
    if len(values) < len(query.given):
        raise QueryError(f"A column of {name} is given twice.")
    for column in values:
        if column not in probing.columns and re.fullmatch(r"col\d+", column):
            number = sum(column.startswith("col") for column in probing.columns)
            takes = f"takes {count_of(number, 'value')}" if number else "takes no values"
            raise QueryError(f"{name} {takes} by place; its columns are {', '.join(labels)}.")
        if column not in probing.columns:
            raise QueryError(f"{name} has no column {column}; it has {', '.join(labels)}.")
    if missing := [label(name, column) for column in probing.parameters if column not in values]:
        raise QueryError(f"{name} is a function of {', '.join(missing)}: give a value for it.")
    return values


_MOST_STAGES = 250
_MOST_ROWS = 20_000
_NEVER = 10**9


class Stages:
    """The stages at which rows of mutually recursive predicates first arose.

    A row is of stage n if rows of stages below n suffice for it. No `members`: no recursion.
    """

    def __init__(self, relations: Relations, members: Mapping[str, Probing]) -> None:
        self._relations, self._members = relations, members

    def first_row(self, probing: Probing, rows: Sequence[Row]) -> Row:
        """Return the row to explain; of several of `Robot`, the last one counts."""
        if not self._members:
            return rows[-1 if probing.name == MAIN else 0]
        return min(rows, key=lambda row: self._stage(probing.name, row))

    def earlier_rows(
        self, name: str, probing: Probing, row: Row, rows: Sequence[Row]
    ) -> Sequence[Row]:
        if not self._members:
            return rows
        stage = self._stage(probing.name, row)
        return [candidate for candidate in rows if self._stage(name, candidate) < stage]

    def _stage(self, name: str, row: Row) -> int:
        return self._stages.get((name, _key(row)), _NEVER)

    @cached_property
    def _stages(self) -> dict[tuple[str, str], int]:
        rows = {
            name: {_key(row): row for row in self._relations.rows(name, probing.sources)}
            for name, probing in self._members.items()
        }
        stages: dict[tuple[str, str], int] = {}
        for stage in range(1, _MOST_STAGES):
            for probing in self._members.values():
                for name, table in probing.tables.items():
                    if name in self._members:
                        pairs = rows[name].items()
                        table_rows: Sequence[Row] = [r for key, r in pairs if (name, key) in stages]
                    else:
                        table_rows = self._relations.rows(name, probing.sources)
                    self._relations.fill(table, name, table_rows)
            new = {
                (name, key): stage
                for name, probing in self._members.items()
                for key in self._derivable(probing, rows[name])
                if (name, key) not in stages
            }
            if not new:
                break
            stages |= new
        return stages

    def _derivable(self, probing: Probing, rows: Mapping[str, Row]) -> Iterator[str]:
        aggregated = {c.column for r in probing.rules for k in r.clauses for c in k.aggregates}
        if not aggregated:
            keys = {
                _key({c: value_of(match, place) for c, place in clause.head.items()})
                for clause, match in self._matches(probing)
            }
            yield from (key for key in rows if key in keys)
            return
        elements = {
            (
                _key({c: value_of(match, place) for c, place in clause.head.items()}),
                aggregate.column,
                _key({"": value_of(match, aggregate.value)}),
            )
            for clause, match in self._matches(probing)
            for aggregate in clause.aggregates
        }
        for key, row in rows.items():
            group = _key({c: v for c, v in row.items() if c not in aggregated})
            if all((group, c, _key({"": row[c]})) in elements for c in aggregated):
                yield key

    def _matches(self, probing: Probing) -> Iterator[tuple[Clause, dict[str, Any]]]:
        for rule in probing.rules:
            for clause in rule.clauses:
                sql = probing.queries.get(clause.query)
                if sql is not None:
                    for match in self._relations.ways(sql, (), max_rows=_MOST_ROWS):
                        yield clause, match


def _key(row: Row) -> str:
    """Return a key, one for all rows that are the `same`."""
    return json.dumps(_round(dict(row)), sort_keys=True)


def _round(value: Value) -> Value:
    if isinstance(value, dict):
        return {name: _round(part) for name, part in value.items() if part is not None}
    if isinstance(value, list):
        return [_round(part) for part in value]
    if isinstance(value, bool | int | float):
        return f"{float(value):.11g}"
    return value
