"""Expressions of DuckDB's SQL, each with the kind of value that it gives.

SQLite asks for the kind of a value when it computes with it; DuckDB wants to know beforehand. So
only such queries are translated whose every value is known to be of one kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["NUMBERS", "Kind", "Term", "UnlikeError", "as_kind", "common", "condition", "number"]

Kind: TypeAlias = Literal["whole", "real", "number", "truth", "text", "nothing"]
"""Kinds of values. A ``number`` is whole or real, which only SQLite can tell; a ``nothing`` is
always null."""

NUMBERS = frozenset({"whole", "real", "number"})

_SQL_TYPES = {
    "whole": "BIGINT",
    "real": "DOUBLE",
    "number": "DOUBLE",
    "truth": "BOOLEAN",
    "text": "VARCHAR",
    "nothing": "BIGINT",
}

_LONGEST = 100_000  # characters of an expression


class UnlikeError(Exception):
    """DuckDB can't be asked for the same; the message ends a sentence that begins with "It"."""


@dataclass(frozen=True, slots=True)
class Term:
    """An expression.

    Attributes:
        sql: Its text, fit to be part of any other expression.
        kind: What it gives, unless that is null.
    """

    sql: str
    kind: Kind

    def __post_init__(self) -> None:
        if len(self.sql) > _LONGEST:
            raise UnlikeError("is too long")


def as_kind(term: Term, kind: Kind) -> Term:
    """A term as one of a wider kind, as `common` gives it."""
    if _SQL_TYPES[term.kind] == _SQL_TYPES[kind] and term.kind != "nothing":
        return Term(term.sql, kind)
    return Term(f"CAST({term.sql} AS {_SQL_TYPES[kind]})", kind)


def number(term: Term) -> Term:
    """A term as a number: SQLite's truth values are 1 and 0.

    Raises:
        UnlikeError: It is a text.
    """
    if term.kind == "text":
        raise UnlikeError("computes with a text as if it were a number")
    return as_kind(term, "whole") if term.kind in ("truth", "nothing") else term


def condition(term: Term) -> str:
    """A term as a condition: a number holds when it is not 0.

    Raises:
        UnlikeError: It is a text.
    """
    if term.kind == "truth":
        return term.sql
    return f"({number(term).sql} <> 0)"


def common(kinds: Iterable[Kind]) -> Kind:
    """The narrowest kind that has room for values of all these kinds.

    Raises:
        UnlikeError: There are texts and numbers among them.
    """
    found = set(kinds) - {"nothing"}
    if len(found) <= 1:
        return found.pop() if found else "nothing"
    if "text" in found:
        raise UnlikeError("has a value that is sometimes a text and sometimes a number")
    return "whole" if found == {"whole", "truth"} else "number"
