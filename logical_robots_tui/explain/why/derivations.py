"""The rows of predicates, and derivations of a row, for one robot at one moment.

Rows of a recursion are derived from earlier rows, so that no row proves itself.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from logical_robots_tui.explain.why.deriving import MOST_ELEMENTS, value_of
from logical_robots_tui.explain.why.explanation import Ask, Explanation
from logical_robots_tui.explain.why.probing import Body, Clause, Probing, RuleParts, Span
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
class Derived:
    """A row and its derivations: one, or, if the head aggregates, all that contribute."""

    probing: Probing
    row: Row
    ways: tuple[tuple[Span, Clause, Way], ...]


class Derivations:
    """Finds rows of predicates and derivations of them, in a robot's reasoning."""

    def __init__(
        self, relations: Relations, robot: str, decompose: Callable[[str, str], Probing]
    ) -> None:
        self.relations, self.robot, self.decompose = relations, robot, decompose
        self._stages: dict[tuple[str, ...], Stages] = {}
        self.explained: dict[tuple[str, bool], Explanation] = {}

    def rows(self, probing: Probing, given: Row) -> Sequence[Row]:
        """Return a predicate's rows with given values; raise FailureError."""
        if probing.given:
            self.prepare(probing)
            sql = probing.queries.get(probing.rows)
            if sql is None:
                raise FailureError("it can't be asked for its rows")
            ways = self.relations.ways(sql, probing.arguments(given), max_rows=MOST_ROWS + 1)
            found: Sequence[Row] = [
                {c: value_of(way, f"c{i}") for i, c in enumerate(probing.columns)} for way in ways
            ]
        else:
            name = probing.name
            found = self.relations.rows(name, probing.sources.get(name, ""))
        return [row for row in found if all(same(row[c], v) for c, v in given.items())]

    def first(self, asked: Ask) -> Derived:
        """Return the first such row and one derivation, or all of an aggregate.

        Raises QueryError if there is none, and FailureError if a query failed.
        """
        probing = self.decompose(asked.predicate, asked.within)
        given = check_given(asked, probing, self.relations.label)
        self.prepare(probing)
        rows = self.rows(probing, given)
        if not rows:
            raise QueryError(f"{asked.predicate} has no such row.")
        row = self.stage(probing).first(probing, rows)
        self.prepare(probing, row)
        ways: list[tuple[Span, Clause, Way]] = []
        for rule in probing.rules:
            most = MOST_ELEMENTS if is_aggregated(rule) else 1
            found = self.ways(rule, probing, row, probing.arguments(given), most)
            ways += [(rule.span, clause, way) for clause, way in found]
            if ways and not is_aggregated(rule):
                break
        if not ways:
            raise QueryError(f"The rule that gives {asked.predicate} this row can't be determined.")
        return Derived(probing, row, tuple(ways))

    def elements(self, probing: Probing, body: Body, way: Way) -> list[tuple[Clause, Way]]:
        self.prepare(probing)
        given, ways = body.arguments(way), self.relations.ways
        return [
            (clause, inner)
            for clause in body.clauses
            for inner in ways(self.sql(clause, probing), given, max_rows=MOST_ELEMENTS)
        ]

    def ways(
        self,
        rule: RuleParts,
        probing: Probing,
        row: Row,
        arguments: Sequence[Scalar],
        most: int = 1,
    ) -> Iterator[tuple[Clause, Way]]:
        for clause in rule.clauses:
            alike = [(place, row[c]) for c, place in clause.head.items() if c in row]
            sql = self.sql(clause, probing)
            found = self.relations.ways(sql, arguments, alike, max_rows=most)
            if not found and any(isinstance(value, dict | list) for _, value in alike):
                found = self.relations.ways(sql, arguments, alike, max_rows=most, comparison=ALIKE)
            for way in found:
                yield clause, way

    @staticmethod
    def sql(clause: Clause, probing: Probing) -> str:
        sql = probing.queries.get(clause.query)
        if sql is None:
            raise FailureError("it is put together from too many parts")
        return sql

    def prepare(self, probing: Probing, row: Row | None = None) -> None:
        """Fill the tables that queries read; for a recursion's `row`, only with earlier rows."""
        for name, table in probing.tables.items():
            rows: Sequence[Row] = self.relations.rows(name, probing.sources.get(name, ""))
            if name in probing.recursive and row is not None:
                rows = self.stage(probing).before(name, probing, row, rows)
            self.relations.fill(table, name, rows)

    def stage(self, probing: Probing) -> Stages:
        key = tuple(probing.recursive)
        if key not in self._stages:
            members = probing.recursive.items() if probing.founded else ()
            decomposed = {name: self.decompose(*called) for name, called in members}
            self._stages[key] = Stages(self.relations, decomposed)
        return self._stages[key]


def check_given(asked: Ask, probing: Probing, label: Callable[[str, str], str]) -> Row:
    """Return the given values; QueryError for an unknown column or a missing argument."""
    name = asked.predicate
    labels = {label(name, column): column for column in probing.columns}
    given = {labels.get(column, column): value for column, value in asked.given.items()}
    if len(given) < len(asked.given):
        raise QueryError(f"A column of {name} is given twice.")
    for column in given:
        if column not in probing.columns and re.fullmatch(r"col\d+", column):
            number = sum(each.startswith("col") for each in probing.columns)
            takes = f"takes {count_of(number, 'value')}" if number else "takes no values"
            raise QueryError(f"{name} {takes} by place; its columns are {', '.join(labels)}.")
        if column not in probing.columns:
            raise QueryError(f"{name} has no column {column}; it has {', '.join(labels)}.")
    if missing := [label(name, column) for column in probing.given if column not in given]:
        raise QueryError(f"{name} is a function of {', '.join(missing)}: give a value for it.")
    return given


def is_aggregated(rule: RuleParts) -> bool:
    return any(clause.collected for clause in rule.clauses)


_MOST_STAGES = 250
_MOST_ROWS = 20_000
_NEVER = 10**9


class Stages:
    """The stages at which rows of mutually recursive predicates first arose.

    A row is of stage n if rows of stages below n suffice for it. No `members`: no recursion.
    """

    def __init__(self, relations: Relations, members: Mapping[str, Probing]) -> None:
        self._relations, self._members = relations, members
        self._stages: dict[tuple[str, str], int] | None = None

    def first(self, probing: Probing, rows: Sequence[Row]) -> Row:
        """Return the row to explain; of several of `Robot`, the last one counts."""
        if not self._members:
            return rows[-1 if probing.name == MAIN else 0]
        return min(rows, key=lambda row: self._stage(probing.name, row))

    def before(self, name: str, probing: Probing, row: Row, rows: Sequence[Row]) -> Sequence[Row]:
        if not self._members:
            return rows
        stage = self._stage(probing.name, row)
        return [each for each in rows if self._stage(name, each) < stage]

    def _stage(self, name: str, row: Row) -> int:
        if self._stages is None:
            self._stages = self._found()
        return self._stages.get((name, _key(row)), _NEVER)

    def _found(self) -> dict[tuple[str, str], int]:
        rows = {
            name: {_key(row): row for row in self._rows(name, probing)}
            for name, probing in self._members.items()
        }
        stages: dict[tuple[str, str], int] = {}
        for stage in range(1, _MOST_STAGES):
            for probing in self._members.values():
                for name, table in probing.tables.items():
                    if name in self._members:
                        known = [row for key, row in rows[name].items() if (name, key) in stages]
                        self._relations.fill(table, name, known)
                    else:
                        self._relations.fill(table, name, self._rows(name, probing))
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

    def _rows(self, name: str, probing: Probing) -> Sequence[Row]:
        return self._relations.rows(name, probing.sources.get(name, ""))

    def _derivable(self, probing: Probing, rows: Mapping[str, Row]) -> Iterator[str]:
        aggregated = {c.column for r in probing.rules for k in r.clauses for c in k.collected}
        if not aggregated:
            found = {
                _key({c: value_of(way, place) for c, place in clause.head.items()})
                for clause, way in self._ways(probing)
            }
            yield from (key for key in rows if key in found)
            return
        elements = {
            (
                _key({c: value_of(way, place) for c, place in clause.head.items()}),
                collected.column,
                _key({"": value_of(way, collected.value)}),
            )
            for clause, way in self._ways(probing)
            for collected in clause.collected
        }
        for key, row in rows.items():
            group = _key({c: v for c, v in row.items() if c not in aggregated})
            if all((group, c, _key({"": row[c]})) in elements for c in aggregated):
                yield key

    def _ways(self, probing: Probing) -> Iterator[tuple[Clause, dict[str, Any]]]:
        for rule in probing.rules:
            for clause in rule.clauses:
                sql = probing.queries.get(clause.query)
                if sql is not None:
                    for way in self._relations.ways(sql, (), max_rows=_MOST_ROWS):
                        yield clause, way


def _key(row: Row) -> str:
    """Return a key that is equal for rows that differ only in last digits of numbers."""
    return json.dumps(_round(dict(row)), sort_keys=True)


def _round(value: Value) -> Value:
    if isinstance(value, dict):
        return {name: _round(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_round(each) for each in value]
    if isinstance(value, bool | int | float):
        return f"{float(value):.11g}"
    return value
