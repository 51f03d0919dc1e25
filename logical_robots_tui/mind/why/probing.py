"""A predicate's rules taken apart, as data that both the compile process and a mind know."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = [
    "GIVEN",
    "Call",
    "Inside",
    "Part",
    "Probing",
    "Query",
    "RuleParts",
    "Side",
    "Span",
    "with_given",
]

GIVEN = "WhyGiven"
"""The table of the arguments that are given, one row."""


@dataclass(frozen=True, slots=True)
class Span:
    """A piece of a program's text.

    Attributes:
        start: Offset of its first character.
        stop: Offset behind its last one.
        line: Line of its first character, from 1.
        text: The piece in one line.
    """

    start: int
    stop: int
    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Side:
    """Something that a part compares, or asks with.

    Attributes:
        text: As written.
        is_truth: Whether it is true or false, and not a value.
    """

    text: str
    is_truth: bool = False


@dataclass(frozen=True, slots=True)
class Query:
    """SQL for the ways in which the parts of a rule up to some place hold together.

    Attributes:
        sql: The query. It reads the table `GIVEN` where arguments have to be given.
        variables: Names of the variables that have a value there; their columns are c0, c1 ...
        sides: What the next part compares or asks with; the columns that follow.
        head: By name of a column of the predicate the column of the query that holds its value,
            for those that are known there already.
    """

    sql: str
    variables: tuple[str, ...] = ()
    sides: tuple[Side, ...] = ()
    head: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Call:
    """A predicate of the program that a part asks.

    Attributes:
        predicate: Its name.
        arguments: By name of its column the number of the side that is given for it.
    """

    predicate: str
    arguments: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Inside:
    """Parts that stand within a part.

    Attributes:
        kind: ``either`` (one alternative of several), ``denied`` (what must not hold) or
            ``collected`` (what an aggregate goes over).
        span: Where they stand.
        start: Asked before any of them.
        parts: The parts in the order in which they are asked.
    """

    kind: Literal["either", "denied", "collected"]
    span: Span
    start: Query | None
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """One part of a rule's body, or a field of its head that may fail to have a value.

    Attributes:
        kind: ``call`` (asks a predicate), ``condition`` (compares), ``value`` (gives a variable
            its value), ``element`` (goes through a list), ``choice`` (of alternatives),
            ``denial`` (of what must not hold) or ``head`` (computes a field of the head).
        span: Where it stands.
        query: For the ways in which all parts up to this one hold; None if it can't be asked
            alone, then the next one answers for both.
        calls: Predicates of the program that it asks.
        inside: Parts within it.
    """

    kind: Literal["call", "condition", "value", "element", "choice", "denial", "head"]
    span: Span
    query: Query | None = None
    calls: tuple[Call, ...] = ()
    inside: tuple[Inside, ...] = ()


@dataclass(frozen=True, slots=True)
class RuleParts:
    """One rule, taken apart.

    Attributes:
        span: The whole rule.
        start: Asked before any part: whether the head's fixed values are those asked for.
        parts: In the order in which they are asked: that of the text, as far as what a part
            needs is known by then.
        columns: Names of the columns of the head; the last query's sides are their values.
    """

    span: Span
    start: Query | None
    parts: tuple[Part, ...]
    columns: tuple[str, ...]

    @property
    def last(self) -> Query | None:
        """The query for the ways in which all parts hold."""
        return self.parts[-1].query if self.parts else self.start


@dataclass(frozen=True, slots=True)
class Probing:
    """All rules of a predicate, taken apart.

    Attributes:
        predicate: Its name.
        made_from: The predicate whose rules these are, where it was made with ``:=``, or "".
        within: The predicate made with ``:=`` whose fillings-in hold here, or "".
        given: Columns without which nothing can be asked of it: it is a function of them.
        rules: In the order of the text.
    """

    predicate: str
    made_from: str
    within: str
    given: tuple[str, ...]
    rules: tuple[RuleParts, ...]


def with_given(sql: str, columns: Sequence[str]) -> str:
    """A query with the table of given arguments, whose values are its first parameters."""
    if not columns:
        return sql
    names = ", ".join(f'"{name}"' for name in columns)
    places = ", ".join("?" * len(columns))
    return f"WITH {GIVEN}({names}) AS (VALUES ({places})) SELECT * FROM ({sql})"  # noqa: S608 - ours
