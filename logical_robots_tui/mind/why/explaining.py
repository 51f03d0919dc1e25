"""Asking the parts of a rule at a tick: which held, in how many ways, with which values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.sqlite.stored import to_sql
from logical_robots_tui.mind.why.explanation import (
    Ask,
    Explanation,
    InsideFound,
    PartFound,
    RuleFound,
)
from logical_robots_tui.mind.why.probing import with_given

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Scalar
    from logical_robots_tui.mind.why.probing import Part, Probing, Query, RuleParts, Side
    from logical_robots_tui.values import Value

__all__ = ["MOST_WAYS", "Rows", "explain"]

MOST_WAYS = 1_000
"""Where counting the ways ends."""

_EXAMPLES = 3


class Rows(Protocol):
    """Whoever can ask a query at the moment in question."""

    def __call__(self, sql: str, parameters: Sequence[Scalar]) -> Sequence[Mapping[str, Value]]:
        """Rows of a query, by the names of its columns.

        Raises:
            FailureError: It failed.
        """


def explain(probing: Probing, robot: str, given: Mapping[str, Value], rows: Rows) -> Explanation:
    """Why a predicate has the rows that it has, or none.

    Args:
        probing: The predicate, taken apart.
        robot: In whose reasoning.
        given: Values of some of its columns; only rows with these are meant.
        rows: Asks a query at the moment in question.
    """
    asking = _Asking(rows, given, probing)
    found = tuple(_rule(rule, asking) for rule in probing.rules)
    predicate, made_from, within = probing.predicate, probing.made_from, probing.within
    return Explanation(predicate, robot, made_from, within, given, found)


@dataclass(frozen=True, slots=True)
class Way:
    """One way in which the parts up to some place hold.

    Attributes:
        variables: Values of the variables, by their names.
        sides: Values of what the next part compares or asks with.
    """

    variables: Mapping[str, Value]
    sides: tuple[Value, ...]


class _Asking:
    """Asks about the rows with given values."""

    def __init__(self, rows: Rows, given: Mapping[str, Value], probing: Probing) -> None:
        self.within = probing.within
        self._rows = rows
        self._given = given
        # A record is written in more than one way, so only plain values are compared.
        self._fixed = {c: v for c, v in given.items() if not isinstance(v, dict | list)}
        self._arguments = probing.given

    def ways(self, query: Query, *, everywhere: bool = False) -> int:
        """In how many ways a query's parts hold.

        Args:
            query: The query.
            everywhere: Whether other values than the given ones are meant, too.
        """
        found = self._select(query, "1", MOST_WAYS, "SELECT COUNT(*) AS ways FROM ({})", everywhere)
        ways = found[0]["ways"]
        assert isinstance(ways, int)
        return ways

    def examples(self, query: Query) -> tuple[Way, ...]:
        """A few of the ways."""
        first = len(query.variables)
        return tuple(
            Way(
                {name: row[f"c{i}"] for i, name in enumerate(query.variables)},
                tuple(row[f"c{first + i}"] for i in range(len(query.sides))),
            )
            for row in self._select(query, "*", _EXAMPLES)
        )

    def values(self, query: Query, side: int) -> tuple[Value, ...]:
        """A few different values of a side."""
        column = f"c{len(query.variables) + side}"
        return tuple(row[column] for row in self._select(query, f"DISTINCT {column}", _EXAMPLES))

    def unlike(self, query: Query) -> dict[str, Value]:
        """The fixed values of a head that are not those asked for, by the names of columns."""
        places = {c: place for c, place in query.head.items() if c in self._fixed}
        found = self._select(query, "*", 1, everywhere=True) if places else ()
        return {
            column: row[place]
            for row in found
            for column, place in places.items()
            if row[place] != self._fixed[column]
        }

    def _select(
        self, query: Query, what: str, most: int, of: str = "{}", everywhere: bool = False
    ) -> Sequence[Mapping[str, Value]]:
        parameters = [to_sql(self._given.get(name)) for name in self._arguments]
        conditions = []
        for column, place in query.head.items() if not everywhere else ():
            if column in self._fixed and column not in self._arguments:
                conditions.append(f"{place} IS ?")
                parameters.append(to_sql(self._fixed[column]))
        where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
        source = with_given(query.sql, self._arguments)
        inner = f"SELECT {what} FROM ({source}){where} LIMIT {most}"  # noqa: S608 - see `Query`
        return self._rows(of.format(inner), parameters)


def _rule(rule: RuleParts, asking: _Asking) -> RuleFound:
    found: tuple[PartFound, ...] = ()
    try:
        fixed = asking.unlike(rule.start) if rule.start is not None else {}
        if fixed:
            return RuleFound(rule, 0, fixed=fixed)
        found = _parts(rule.start, rule.parts, asking)
        if any(not each.holds for each in found):
            return RuleFound(rule, 0, found=found)
        if rule.last is None:
            return RuleFound(rule, None, found=found)
        rows = tuple(
            dict(zip(rule.columns, way.sides, strict=True)) for way in asking.examples(rule.last)
        )
        return RuleFound(rule, asking.ways(rule.last), rows, found)
    except FailureError as error:
        return RuleFound(rule, None, found=found, problem=str(error))


def _parts(before: Query | None, parts: Sequence[Part], asking: _Asking) -> tuple[PartFound, ...]:
    """What parts gave, up to the first that does not hold."""
    found: list[PartFound] = []
    for part in parts:
        found.append(_part(before, part, asking))
        if not found[-1].holds:
            break
        before = part.query or before
    return tuple(found)


def _part(before: Query | None, part: Part, asking: _Asking) -> PartFound:
    if part.query is None:
        return PartFound(part, None)
    try:
        ways = asking.ways(part.query)
        elsewhere = 0 if ways else asking.ways(part.query, everywhere=True)
        earlier = asking.examples(before)[:1] if before is not None else ()
        sides: list[tuple[Side, tuple[Value, ...]]] = []
        for number, side in enumerate(before.sides if before is not None else ()):
            values = tuple(way.sides[number] for way in earlier)
            if before is not None and not ways:
                values = asking.values(before, number)
            sides.append((side, values))
        known = set(before.variables) if before is not None else set()
        later = asking.examples(part.query)[:1] if ways else ()
        new = {n: v for way in later for n, v in way.variables.items() if n not in known}
        inside = tuple(
            InsideFound(each, _parts(each.start, each.parts, asking)) for each in part.inside
        )
    except FailureError as error:
        return PartFound(part, None, problem=str(error))
    asked = _asked(part, earlier, asking.within)
    return PartFound(part, ways, elsewhere, tuple(sides), new, asked, inside)


def _asked(part: Part, before: Sequence[Way], within: str) -> tuple[Ask, ...]:
    """The predicates that a part asked, with the arguments of the first way."""
    found = []
    for call in part.calls:
        given = {c: way.sides[number] for way in before for c, number in call.arguments.items()}
        found.append(Ask(call.predicate, given, within))
    return tuple(found)
