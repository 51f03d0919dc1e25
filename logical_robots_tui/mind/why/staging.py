"""The order in which rows of a recursion arise, so that no row is proved by itself."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.why.deriving import value_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.mind.why.probing import Clause, Probing
    from logical_robots_tui.mind.why.relations import Relations
    from logical_robots_tui.values import Value

__all__ = ["Stages"]

_MOST_STAGES = 250
_MOST_ROWS = 20_000
_NEVER = 10**9


class Stages:
    """The stage at which each row of predicates that call each other was there first.

    A row is of stage n if rows of stages below n suffice for it.

    Args:
        relations: The rows of predicates.
        members: The decomposed predicates, by name; none if there is no recursion.
    """

    def __init__(self, relations: Relations, members: Mapping[str, Probing]) -> None:
        self._relations, self._members = relations, members
        self._stages: dict[tuple[str, str], int] | None = None

    def first(self, probing: Probing, rows: Sequence[Mapping[str, Value]]) -> Mapping[str, Value]:
        """Return the one of some rows that was there first."""
        if not self._members:
            return rows[0]
        return min(rows, key=lambda row: self._stage(probing.name, row))

    def before(
        self,
        name: str,
        probing: Probing,
        row: Mapping[str, Value],
        rows: Sequence[Mapping[str, Value]],
    ) -> Sequence[Mapping[str, Value]]:
        """Return the rows of a predicate that were there before a row of another one."""
        if not self._members:
            return rows
        stage = self._stage(probing.name, row)
        return [each for each in rows if self._stage(name, each) < stage]

    # -- inside ----------------------------------------------------------------------------------

    def _stage(self, name: str, row: Mapping[str, Value]) -> int:
        if self._stages is None:
            self._stages = self._found()
        return self._stages.get((name, _key(row)), _NEVER)

    def _found(self) -> dict[tuple[str, str], int]:
        rows = {
            name: {
                _key(row): row for row in self._relations.rows(name, probing.sources.get(name, ""))
            }
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
                        others = self._relations.rows(name, probing.sources.get(name, ""))
                        self._relations.fill(table, name, others)
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

    def _derivable(
        self, probing: Probing, rows: Mapping[str, Mapping[str, Value]]
    ) -> Iterator[str]:
        """Yield keys of the rows that follow from what the tables hold now."""
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
                    for way in self._relations.ways(sql, (), most=_MOST_ROWS):
                        yield clause, way


def _key(row: Mapping[str, Value]) -> str:
    """Return a key that is equal for rows that differ at most in last digits of numbers."""
    return json.dumps(_rounded(dict(row)), sort_keys=True)


def _rounded(value: Value) -> Value:
    if isinstance(value, dict):
        return {name: _rounded(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    if isinstance(value, bool | int | float):
        return f"{float(value):.11g}"
    return value
