"""A predicate's decomposed rules, as data for the compile process and a mind.

A body is decomposed into clauses, one for each choice of alternatives. The rows of a clause's query
are its derivations: each row holds the values of all variables and of all shown expressions, so
everything that is said about a derivation comes from one row.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.language.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.compilation import compiled

if TYPE_CHECKING:
    import threading
    from collections.abc import Mapping

    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.program import Program

ROWS = "WhyRows_"
"""What the name of the table with the rows of a predicate begins with."""

LOWER = "WhyLower_"
"""The same for rows of a recursive predicate that were there before the row in question."""

ORDERING = frozenset({"<", "<=", ">", ">="})
"""Comparisons that can fail by a small margin."""

DECIDED_BY_ONE = frozenset({"AnyValue", "ArgMax", "ArgMin", "Max", "Min"})
"""Aggregates whose result is that of one of their elements."""


TermKind: TypeAlias = Literal[
    "literal",
    "variable",
    "value",
    "field",
    "record",
    "cast",
    "truth",
    "if",
    "coalesce",
    "call",
    "aggregate",
]
"""The kinds of expressions; see `Term`."""


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
class Call:
    """A predicate of the program that is called.

    Attributes:
        predicate: Its name, as written in the program.
        within: The predicate made with ``:=`` in whose copy of the rules it is called, or "".
        arguments: By name of its column the column of the query with the argument.
        terms: The same as expressions, of those that are more than a variable or a literal.
    """

    predicate: str
    within: str = ""
    arguments: Mapping[str, str] = field(default_factory=dict)
    terms: Mapping[str, Term] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Collected:
    """What an aggregate goes over, in one clause.

    Attributes:
        column: The column of the head that holds the result.
        operator: The aggregate's name.
        value: The column of the query with an element's value.
        by: The column with what an element is chosen by, for ``value -> by``; else "".
        term: The expression of the value.
    """

    column: str
    operator: str
    value: str
    by: str = ""
    term: Term | None = None


@dataclass(frozen=True, slots=True)
class Body:
    """The body of an aggregate or of a negation.

    Attributes:
        span: Where it stands.
        given: By name of a column of the table of given values the column of the outer query
            with that value.
        clauses: One for each choice of alternatives.
    """

    span: Span
    given: Mapping[str, str]
    clauses: tuple[Clause, ...]


@dataclass(frozen=True, slots=True)
class Term:
    """An expression, to tell where its value comes from.

    Attributes:
        kind: ``literal``, ``variable``, ``value``, ``field`` (read of a record), ``record``,
            ``cast`` (to a type), ``truth`` (of a comparison or a junction), ``if``, ``coalesce``,
            ``call`` (of a predicate of the program) or ``aggregate``.
        span: Where it stands.
        column: The column of the query with its value; "" for a literal.
        parts: The terms in it. For ``if``: condition and value of each branch, then the value
            without any. For ``field``: what holds the record.
        names: Of ``record`` the names of the parts; of ``field`` the way into the record.
        call: What it calls.
        body: What it aggregates.
    """

    kind: TermKind
    span: Span
    column: str = ""
    parts: tuple[Term, ...] = ()
    names: tuple[str, ...] = ()
    call: Call | None = None
    body: Body | None = None


@dataclass(frozen=True, slots=True)
class Step:
    """One part of a clause.

    Attributes:
        kind: ``call`` (of a predicate), ``condition``, ``value`` (gives a variable its value),
            ``element`` (goes through a list), ``denial`` (of what must not hold) or ``function``
            (a call for its value, which an expression goes on with).
        span: Where it stands.
        query: Name of the query for the ways in which all steps up to this one hold.
        gives: By name the columns of the variables that have a value after it only.
        terms: What it compares, or computes.
        call: The predicate that it calls.
        denied: What must not hold.
        reads: Of a call of ``Sensor`` or ``Memory``: what the clause reads of it.
    """

    kind: Literal["call", "condition", "value", "element", "denial", "function"]
    span: Span
    query: str
    gives: Mapping[str, str] = field(default_factory=dict)
    terms: tuple[Term, ...] = ()
    call: Call | None = None
    denied: Body | None = None
    reads: tuple[Term, ...] = ()


@dataclass(frozen=True, slots=True)
class Clause:
    """A body with one choice of alternatives, and a query for its derivations.

    Attributes:
        taken: The alternatives that were chosen.
        before: Name of the query before any step.
        steps: In the order in which they are asked: that of the text, as far as what a step needs
            is known by then.
        head: By name of a column of the head that is not aggregated its column of the query.
        terms: The expressions of these, by name of the column.
        collected: The aggregated columns of the head.
        given: By column of the query with a variable that is given that of the given values.
    """

    taken: tuple[Span, ...]
    before: str
    steps: tuple[Step, ...]
    head: Mapping[str, str] = field(default_factory=dict)
    terms: Mapping[str, Term] = field(default_factory=dict)
    collected: tuple[Collected, ...] = ()
    given: Mapping[str, str] = field(default_factory=dict)

    @property
    def query(self) -> str:
        """Name of the query whose rows are the derivations."""
        return self.steps[-1].query if self.steps else self.before


@dataclass(frozen=True, slots=True)
class RuleParts:
    """One rule, decomposed."""

    span: Span
    clauses: tuple[Clause, ...]


@dataclass(frozen=True, slots=True)
class Probing:
    """All rules of a predicate, decomposed.

    Attributes:
        predicate: Its name.
        within: The predicate made with ``:=`` in whose copy of the rules it is asked, or "".
        name: The name of that copy, or the same as `predicate`.
        made_from: The predicate whose rules these are, where it was made with ``:=``, or "".
        columns: Names of its columns.
        given: Those without which nothing can be asked of it: it is a function of them.
        distinct: Whether rows that are alike are one.
        rules: In the order of the text.
        queries: SQL by name of the query, of those that SQLite can prepare.
        rows: Name of the query for its rows, if it is a function; else "".
        tables: By name of a predicate that is called the table with its rows.
        sources: By name of such a predicate, or of this one, SQL for its rows, where the program
            has none.
        recursive: By name the predicates that call each other in a circle with this one: what
            each is called in the program, and in whose copy it stands.
        founded: Whether rows of these can be told from rows that were there before.
    """

    predicate: str
    within: str
    name: str
    made_from: str
    columns: tuple[str, ...]
    given: tuple[str, ...]
    distinct: bool
    rules: tuple[RuleParts, ...]
    queries: Mapping[str, str]
    rows: str = ""
    tables: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    recursive: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    founded: bool = True


def decompose(
    program: Program,
    predicate: str,
    within: str = "",
    *,
    stop: threading.Event | None = None,
    limits: Limits | None = None,
) -> Probing:
    """Decompose the rules of a predicate; results are cached. Blocks.

    Raises:
        QueryError: There is no such predicate, or it can't be computed.
        Stopped: `stop` was set.
    """
    known = program.predicate(predicate)
    if known is None or known.kind != "program":
        raise QueryError(f"The program has no rules for {predicate}.")
    if not (known.has_rows or known.is_function or within):
        raise QueryError(known.reason)
    request = {
        "text": program.text,
        "predicate": predicate,
        "within": within,
        "with_rows": [p.name for p in program.predicates if p.kind == "program" and p.has_rows],
    }
    try:
        return compiled(request, Probing, stop=stop, limits=limits)
    except ProgramError as error:
        raise QueryError(f"{predicate} can't be explained: {error}") from None
