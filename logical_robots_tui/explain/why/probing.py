"""A predicate's decomposed rules, as data for the compile process and a mind.

A body has one clause per choice of alternatives. Each row of a clause's query is one
derivation, with the values of all variables and of all shown expressions.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from logical_robots_tui.language.diagnostics import ProgramError, QueryError, closest
from logical_robots_tui.mind.compilation import Task, compile_task
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite.database import Scalar
from logical_robots_tui.mind.sqlite.stored import to_sql
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.mind.program import Program

ROWS = "WhyRows_"
"""The prefix of the tables with the rows of predicates."""

LOWER = "WhyLower_"
"""The prefix of those with the rows of a recursion that come before the explained row."""

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
class SourceSpan:
    """A piece of a program's text: offsets from `start` to before `stop`, `line` from 1."""

    start: int
    stop: int
    line: int
    text: str

    def holds(self, inner: SourceSpan) -> bool:
        return self.start <= inner.start and inner.stop <= self.stop


@dataclass(frozen=True, slots=True)
class PredicateCall:
    """A call of the program's predicate.

    Attributes:
        within: The predicate made with ``:=`` whose copy of the rules is called, or "".
        arguments: The query's column for each argument, by name of the predicate's column.
        terms: Arguments that are more than a variable or a literal.
    """

    predicate: str
    within: str = ""
    arguments: Mapping[str, str] = field(default_factory=dict)
    terms: Mapping[str, Term] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class AggregateInput:
    """An aggregate's input, in one clause.

    Attributes:
        column: The column of the head that holds the result.
        value: The column of the query with an element's value.
        key: The column that an element is chosen by, for ``value -> key``; else "".
    """

    column: str
    operator: str
    value: str
    key: str = ""
    term: Term | None = None


@dataclass(frozen=True, slots=True)
class Body:
    """The body of an aggregate or of a negation.

    `outer_columns` maps columns of the table of given values to columns of the outer query.
    """

    span: SourceSpan
    outer_columns: Mapping[str, str]
    clauses: tuple[Clause, ...]

    def arguments(self, match: Mapping[str, Scalar]) -> list[Scalar]:
        """Return the given values for a row of the outer query."""
        return [match.get(column) for column in self.outer_columns.values()]


@dataclass(frozen=True, slots=True)
class Term:
    """An expression, to trace the origin of its value.

    Attributes:
        kind: ``field`` (read from a record), ``cast``, ``truth`` (of a comparison or a
            junction), ``call`` (of a predicate of the program); the others by name.
        column: The column of the query with its value; "" for a literal.
        parts: Its subterms. For ``if``: condition and value of each branch, then the default.
            For ``field``: the record.
        names: Of ``record`` the names of the parts; of ``field`` the path into the record.
    """

    kind: TermKind
    span: SourceSpan
    column: str = ""
    parts: tuple[Term, ...] = ()
    names: tuple[str, ...] = ()
    call: PredicateCall | None = None
    body: Body | None = None

    def walk(self) -> Iterator[Term]:
        yield self
        for part in self.parts:
            yield from part.walk()


@dataclass(frozen=True, slots=True)
class Misread:
    """An operator with an equation as a side: ``short = distance < 60``.

    Attributes:
        correction: What to put in parentheses, or None.
    """

    operator: str
    sides: tuple[Term, Term]
    correction: SourceSpan | None = None


@dataclass(frozen=True, slots=True)
class Step:
    """One part of a clause.

    Attributes:
        kind: ``value`` binds a variable, ``element`` iterates a list, ``function`` is a call
            inside an expression; the others by name.
        query: Name of the query for the derivations of all steps up to this one.
        bindings: The columns of the variables that it binds, by name.
        terms: The terms that it compares or computes.
        reads: What the clause reads of a call of ``Sensor`` or ``Memory``.
    """

    kind: Literal["call", "condition", "value", "element", "denial", "function"]
    span: SourceSpan
    query: str
    bindings: Mapping[str, str] = field(default_factory=dict)
    terms: tuple[Term, ...] = ()
    call: PredicateCall | None = None
    denial: Body | None = None
    reads: tuple[Term, ...] = ()
    misread: Misread | None = None


@dataclass(frozen=True, slots=True)
class Clause:
    """A body with one choice of `alternatives`, and a query for its derivations.

    Attributes:
        start_query: Name of the query before any step.
        steps: In order of evaluation: text order as far as variables are bound.
        head, terms: The query's column, and the expression, of each column not aggregated.
        parameters: The column of given values for each column of the query that is given.
    """

    alternatives: tuple[SourceSpan, ...]
    start_query: str
    steps: tuple[Step, ...]
    head: Mapping[str, str] = field(default_factory=dict)
    terms: Mapping[str, Term] = field(default_factory=dict)
    aggregates: tuple[AggregateInput, ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)

    @property
    def query(self) -> str:
        return self.steps[-1].query if self.steps else self.start_query

    def all_terms(self) -> Iterator[Term]:
        """Yield all expressions and their subterms, except those in inner bodies."""
        terms = [aggregate.term for aggregate in self.aggregates if aggregate.term is not None]
        terms[:0] = self.terms.values()
        for step in reversed(self.steps):
            terms[:0] = (*step.terms, *step.reads, *(step.call.terms.values() if step.call else ()))
        for term in terms:
            yield from term.walk()


@dataclass(frozen=True, slots=True)
class RuleParts:
    span: SourceSpan
    clauses: tuple[Clause, ...]

    @property
    def is_aggregated(self) -> bool:
        return any(clause.aggregates for clause in self.clauses)


@dataclass(frozen=True, slots=True)
class Probing:
    """All rules of a predicate, decomposed.

    Attributes:
        within: The predicate made with ``:=`` whose copy of the rules is meant, or "".
        name: The name of that copy, or `predicate`.
        made_from: The predicate whose rules ``:=`` copied, or "".
        parameters: The required columns, if it is a function.
        queries: SQL by name, where SQLite can prepare it.
        rows: Name of the query for a function's rows; else "".
        tables: The table that holds the rows of each called predicate.
        sources: SQL for the rows of predicates where the program has none.
        recursive: The predicates that are mutually recursive with this one: their names in the
            program, and the made predicates of their copies.
        is_founded: Whether earlier rows can explain rows of these.
        lazy_groups: Groups of queries; a group is compiled when one of them is needed.
    """

    predicate: str
    within: str
    name: str
    made_from: str
    columns: tuple[str, ...]
    parameters: tuple[str, ...]
    is_distinct: bool
    rules: tuple[RuleParts, ...]
    queries: Mapping[str, str]
    rows: str = ""
    tables: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    recursive: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    is_founded: bool = True
    lazy_groups: tuple[tuple[str, ...], ...] = ()

    def arguments(self, values: Mapping[str, Value]) -> list[Scalar]:
        """Return the values of the required columns, null where none is given."""
        return [to_sql(values.get(column)) for column in self.parameters]


class _Queries(Mapping[str, str]):
    """A predicate's queries; `compile_group` returns those of a lazy group."""

    def __init__(
        self, probing: Probing, compile_group: Callable[[tuple[str, ...]], Mapping[str, str]]
    ) -> None:
        self._queries = dict(probing.queries)
        self._lazy_groups = {query: group for group in probing.lazy_groups for query in group}
        self._compile = compile_group

    def __getitem__(self, query: str) -> str:
        group = self._lazy_groups.get(query)
        if group is not None:
            self._queries |= self._compile(group)
            self._lazy_groups = {
                name: lazy_group
                for name, lazy_group in self._lazy_groups.items()
                if lazy_group is not group
            }
        return self._queries[query]

    def __iter__(self) -> Iterator[str]:
        return iter({**self._queries, **self._lazy_groups})

    def __len__(self) -> int:
        return len({**self._queries, **self._lazy_groups})


@dataclass(frozen=True, slots=True)
class Called:
    """A predicate with values by column, as a player wrote it."""

    predicate: str
    given: dict[str, Any]


class ReadCall(Task, frozen=True):
    """Gives `Called`."""

    parts = ("explain",)
    text: str


class Decompose(Task, frozen=True):
    """Gives `Probing`."""

    parts = ("explain",)
    text: str
    predicate: str
    within: str
    kinds: str


class CompileClauses(Decompose, frozen=True):
    """Gives more queries of a decomposed predicate, by name."""

    queries: tuple[str, ...]


def _no_rules_message(program: Program, predicate: str) -> str:
    if predicate == "Sensor":
        return "Sensor has no rules: its rows are what the robots sense."
    if predicate == "Memory":
        return "Memory has no rules: its rows are what the robots remembered in the tick before."
    if program.predicate(predicate) is not None:
        return f"{predicate} comes with the game; the program has no rules for it."
    close = closest(predicate, (entry.name for entry in program.predicates))
    return f"The program has no rules for {predicate}{f'; did you mean {close}?' if close else '.'}"


def decompose(
    program: Program,
    predicate: str,
    within: str = "",
    *,
    stop: Callable[[], threading.Event | None] = lambda: None,
    limits: Limits | None = None,
) -> Probing:
    """Decompose the rules of a predicate; results are cached. Blocks.

    `stop` returns the event that stops it, or a lazy group's compilation, which blocks, too.

    Raises:
        QueryError: There is no such predicate, or it can't be computed.
        Stopped: `stop` was set.
    """
    entry = program.predicate(predicate)
    if entry is None or entry.kind != "program":
        raise QueryError(_no_rules_message(program, predicate))
    if not (entry.has_rows or entry.is_function or within):
        raise QueryError(entry.reason)
    parts = program.text, predicate, within, program.kinds
    try:
        probing = compile_task(Decompose(*parts), Probing, stop=stop(), limits=limits)
    except ProgramError as error:
        raise QueryError(f"{predicate} can't be explained: {error}") from None

    def compile_group(group: tuple[str, ...]) -> Mapping[str, str]:
        task = CompileClauses(*parts, group)
        try:
            return compile_task(task, dict[str, str], stop=stop(), limits=limits)
        except ProgramError:
            return {}  # a question that needs one of them fails

    return (
        replace(probing, queries=_Queries(probing, compile_group))
        if probing.lazy_groups
        else probing
    )
