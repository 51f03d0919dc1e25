"""Sites, where their values come from, and what queries them. In the compile process."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.explain.bodies import Scope, parameters, span_of
from logical_robots_tui.explain.diagnosis.sites import TESTS, Column, Field, Probe, Site, Stands
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.definitions import names_used, reach
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import (
    CONDITIONS,
    Aggregate,
    Aggregation,
    Argument,
    Atom,
    Boolean,
    Call,
    Choice,
    Conjunction,
    Equation,
    Expression,
    Head,
    Literal,
    Node,
    Number,
    Proposition,
    Rule,
    Tree,
    Variable,
    arguments,
    call,
    conjuncts,
    equation_sides,
    operands,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.schema import INPUTS, MAIN, VALUE

if TYPE_CHECKING:
    from logical_robots_tui.language.expansion import Expanded

PROBE = "DiagnosisProbe"
"""The prefix of the generated predicates."""

_MOST_COLUMNS = 90  # of a probe; SQLite allows 100

_EXPLAINED = (*TESTS, "leaf", "value")
"""Kinds of sites that record where their values come from."""

Guard: TypeAlias = tuple[tuple[int, bool], ...]


@dataclass
class Segment:
    """A body up to a part with rows, and the tests there: the content of one query.

    Attributes:
        asked, differences: Per column, its expression, and the difference of compared sides.
        after: Index of the site of the part at its end, or -1.
    """

    body: list[Proposition]
    after: int = -1
    columns: list[Column] = field(default_factory=list)
    trees: list[Expression | None] = field(default_factory=list)
    asked: dict[int, Sequence[Expression]] = field(default_factory=dict)
    differences: dict[int, Expression] = field(default_factory=dict)


@dataclass
class Trail:
    """The progress of tracing a body; mutable. `filters` are columns that must be true."""

    segment: Segment
    filters: tuple[int, ...] = ()
    probes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class At:
    """Where an expression is computed.

    Attributes:
        given: The query's expressions by variable.
        chosen: The condition of an ``if`` that must hold for it, and the index of its rule.
    """

    trail: Trail
    rule: int
    scope: Scope
    known: frozenset[str]
    given: Mapping[str, Expression]
    guard: Guard = ()
    inside: tuple[str, ...] = ()
    stands: Stands = "body"
    chosen: tuple[Expression, int] | None = None

    def when(self, column: int, *, holds: bool) -> At:
        return replace(self, guard=(*self.guard, (column, holds)))


_FALSE = Boolean("false")


class Watching:
    """Collects the sites of rules and the predicates to be compiled for them.

    Attributes:
        probes: For each generated predicate its rule, and the meaning of its rows.
        left_out: The number of probes beyond the limits.
        copies: For each predicate copied by ``:=``, the original and the made predicate.
        missed_rules: Rules that are also evaluated where no probe watches them.
    """

    def __init__(
        self, source: Prepared, expanded: Expanded, functions: frozenset[str], rules: Sequence[Rule]
    ) -> None:
        self.sites: list[Site] = []
        self.probes: dict[str, tuple[Rule, Probe]] = {}
        self.reads: dict[tuple[str, int], Field] = {}
        self.reads_all = False
        self.left_out = 0
        made = {name: (base, name) for name, base in expanded.bases.items()}
        self.copies = {**expanded.origins, **made}
        self.missed_rules: set[int] = set()
        self._missed_sites: set[int] = set()
        self._within = self._owner = ""
        self._source = source
        self._own, self._functions, self._rules = expanded.rules, functions, rules
        self._numbers = {id(rule): number for number, rule in enumerate(rules)}
        # A copy may be of a predicate that is made itself, which comes first.
        for copy, (original, _) in {**made, **expanded.origins}.items():
            # A predicate with the rows of a recursive one has a single rule.
            for rule, first in zip(self._own[copy], self._own[original], strict=False):
                self._numbers[id(rule)] = self._numbers[id(first)]
        self._sources = Sources(source, expanded.rules)
        own = expanded.rules
        self._decisive = {c for rule in own.get(MAIN, ()) for c in decisive_columns(rule, own)}
        self._known_sites: dict[tuple[Any, ...], int] = {}
        self._memories: set[str] = set()
        self._leaves: set[str] = set()
        self._fresh = 0

    def missed_sites(self) -> set[int]:
        """Return the sites that are also evaluated where no probe watches them."""
        in_rules = {n for n, site in enumerate(self.sites) if site.rule in self.missed_rules}
        return self._missed_sites | in_rules

    def miss_probe(self, probe: Probe) -> None:
        """Note that a probe is not asked."""
        self._missed_sites |= probe.sites
        if probe.gives >= 0:
            self.missed_rules.add(probe.gives)

    def _miss(self, tree: Tree, at: At) -> None:
        """Note that a tree, and the rules that it uses, are not watched at a place."""
        self.missed_rules.add(at.rule)
        for name in reach(tree, self._own):
            for rule in self._own.get(name, ()):
                self.missed_rules |= {self._numbers.get(id(rule), at.rule)}

    def _all_of(self, at: At) -> list[Proposition]:
        segment = at.trail.segment
        conditions = ((segment.trees[column], holds) for column, holds in at.guard)
        return [*segment.body, *(_as_part(c, holds=holds) for c, holds in conditions if c)]

    def _tells(self, probe: Probe) -> bool:
        return any(
            at >= 0 and self.sites[at].predicate not in ("", *INPUTS)
            for at in (probe.after, probe.before)
        )

    def _called(self, name: str, at: At) -> str:
        value = at.given.get(name)
        return name if value is None else variable_of(value)

    def _new(self, name: str) -> str:
        self._fresh += 1
        return f"d{self._fresh}_{name}"

    def _span(self, tree: Tree) -> Span:
        return span_of(tree, self._source)

    def _site(self, kind: Any, node: Tree, at: At, **details: Any) -> int:
        """Return the index of a site; equal places share one."""
        span = self._span(node)
        owner = self._owner if kind == "leaf" else ""
        key = (kind, span.start, span.stop, self._within, owner, details.get("other"))
        if key not in self._known_sites:
            self._known_sites[key] = len(self.sites)
            rule = self._rules[at.rule]
            places = self._sources.of(node, rule) if kind in _EXPLAINED else ()
            if kind == "leaf" and at.chosen is not None:
                condition, number = at.chosen
                why = self._sources.of_condition(condition, self._rules[number])
                places = _alternate(places, why, span.line)
            known = {"within": self._within, "places": places, "stands": at.stands, "owner": owner}
            self.sites.append(Site(kind, span, at.rule, **(known | details)))
        return self._known_sites[key]

    def _add(
        self,
        at: At,
        site: int,
        asked: Sequence[Expression],
        kind: Any,
        condition: Expression | None = None,
    ) -> int:
        """Add a column to the query at a place; return -1 if there are too many."""
        segment = at.trail.segment
        number = len(segment.columns)
        width = 2 + 2 * len(segment.differences) + sum(map(len, segment.asked.values()))
        if width + 4 > _MOST_COLUMNS:
            self.left_out += 1
            self._missed_sites.add(site)
            return -1
        segment.columns.append(Column(site, at.guard, kind))
        segment.trees.append(condition)
        if asked:
            segment.asked[number] = asked
        return number

    def _emit(
        self,
        trail: Trail,
        before: int = -1,
        gives: int = -1,
        who: Expression | None = None,
        *,
        is_robot: bool = False,
    ) -> None:
        segment = trail.segment
        if not segment.body and not segment.columns and gives < 0:
            return
        every = tuple(segment.columns)
        values = {n for n, column in enumerate(every) if self.sites[column.site].kind == "value"}
        for closer in (False, True) if values else (False,):
            name = f"{PROBE}{self._fresh}"
            self._fresh += 1
            left_out = frozenset[int]() if closer else values
            columns = {
                f"{'cd'[place]}{number}": tree
                for number, asked in segment.asked.items()
                for place, tree in enumerate(asked)
                if number not in left_out
            }
            if who is not None:
                columns["who"] = who
            probe = Probe(
                name,
                tuple(replace(c, kind="skip") if n in left_out else c for n, c in enumerate(every)),
                segment.after,
                before,
                trail.filters,
                gives,
                robot=is_robot,
                closeness=("closer" if closer else "wider") if values else "both",
            )
            rule = _count_rule(name, columns, segment.differences, segment.body)
            self.probes[name] = (rule, probe)
            trail.probes.append(name)


_MOST = 6  # places
_DEEPEST = 4


class Sources:
    def __init__(self, source: Prepared, own: Mapping[str, Sequence[Rule]]) -> None:
        self._source, self._own = source, own

    def of(self, node: Tree, rule: Rule) -> tuple[Span, ...]:
        """Return where an expression's values come from, recursively.

        The nearest places come first, and those that only copy a value last.
        """
        found: dict[int, Span] = {}
        copies: dict[int, Span] = {}
        seen: set[tuple[int, str]] = set()
        waiting: deque[tuple[Tree, Rule, int]] = deque([(node, rule, 0)])
        own_line = span_of(node, self._source).line
        while waiting and len(found) < _MOST:
            node, rule, depth = waiting.popleft()
            for place, inner, where in self._next(node, rule, seen):
                span = span_of(place, self._source)
                if span.text and span.line != own_line:
                    (copies if self._copies(place) else found).setdefault(span.line, span)
                if depth + 1 < _DEEPEST:
                    waiting.append((inner, where, depth + 1))
        return tuple((found | {n: s for n, s in copies.items() if n not in found}).values())[:_MOST]

    def _copies(self, place: Node) -> bool:
        """Return whether a place is a call of a sensor or of what other rules give."""
        return isinstance(place, Atom) and (
            place.name == "Sensor" or any(rule.body for rule in self._own.get(place.name, ()))
        )

    def of_condition(self, node: Tree, rule: Rule) -> tuple[Span, ...]:
        """Return the place of a condition, and where its values come from."""
        return span_of(node, self._source), *self.of(node, rule)

    def _next(
        self, node: Tree, rule: Rule, seen: set[tuple[int, str]]
    ) -> Iterator[tuple[Node, Tree, Rule]]:
        for name in dict.fromkeys(names_used(node)):
            yield from self._rules(name, seen)
        for variable in sorted(variables(node, inside=True)):
            if (id(rule), variable) in seen:
                continue
            seen.add((id(rule), variable))
            for part, value in _bindings(variable, rule):
                if isinstance(part, Atom) and value is None:
                    yield part, (), rule
                    yield from self._rules(part.name, seen)
                elif value is not None:
                    yield from ((place, value, rule) for place in _places(part, value))

    def _rules(self, name: str, seen: set[tuple[int, str]]) -> Iterator[tuple[Node, Tree, Rule]]:
        """Yield the rules of a predicate except facts."""
        if (0, name) in seen:
            return
        seen.add((0, name))
        for rule in self._own.get(name, ()):
            is_function = rule.value is not None and parameters(rule) is not None
            if rule.body or is_function:
                copies = all(isinstance(each.value, Variable) for each in rule.head.columns)
                yield (copies and rule.body) or rule, rule.value or rule, rule
            for part in conjuncts(rule.body):
                if isinstance(part, Atom) and part.name in CONDITIONS:
                    yield part, part, rule


def _bindings(variable: str, rule: Rule) -> Iterator[tuple[Node, Expression | None]]:
    """Yield equations of a variable with its value, and calls that mention it with None."""
    for part in walk(rule):
        if (pair := equation_sides(part)) is not None:
            for side, value in (pair, pair[::-1]):
                if variable_of(side) == variable:
                    yield part, value
        elif isinstance(part, Atom) and variable in variables(part):
            yield part, None


def _places(part: Node, value: Tree) -> Sequence[Node]:
    """Return the places of an equation: of an ``if``, those of its values."""
    if not isinstance(value, Choice):
        return (part,)
    each = (*(branch.value for branch in value.branches), value.otherwise)
    return [place for place in each if not isinstance(place, Literal)] or (part,)


def _alternate(some: Sequence[Span], others: Sequence[Span], own_line: int) -> tuple[Span, ...]:
    """Return places of both sorts in turn, one for each line except one."""
    each = (place for pair in zip_longest(some, others) for place in pair if place is not None)
    found: dict[int, Span] = {}
    for place in each:
        if place.line != own_line:
            found.setdefault(place.line, place)
    return tuple(found.values())[:_MOST]


def decisive_columns(rule: Rule, own: Mapping[str, Sequence[Rule]]) -> set[tuple[str, str]]:
    """Return the predicates and columns from which the desire of a rule of `Robot` is copied."""
    found = {(MAIN, "desire")}
    waiting = [(rule, value) for value in _values(rule, "desire")]
    seen: set[tuple[int, int]] = set()

    def add(name: str, column: str) -> None:
        if name in own and (name, column) not in found:
            found.add((name, column))
            waiting.extend((each, value) for each in own[name] for value in _values(each, column))

    while waiting:
        rule, value = waiting.pop()
        if (id(rule), id(value)) in seen:
            continue
        seen.add((id(rule), id(value)))
        match value:
            case Choice():
                waiting += [(rule, each.value) for each in value.branches]
                waiting.append((rule, value.otherwise))
            case Aggregate():
                waiting.append((rule, value.argument))
            case Call(name="Coalesce"):
                waiting += [(rule, each) for each in operands(value.arguments)]
            case Call():
                add(value.name, VALUE)
            case Variable():
                for part, other in _bindings(value.name, rule):
                    if other is not None:
                        waiting.append((rule, other))
                    elif isinstance(part, Atom):
                        for argument in part.arguments:
                            if argument.expression == value:
                                add(part.name, argument.column)
    return found


def _values(rule: Rule, column: str) -> Iterator[Expression]:
    """Yield what a rule's head has for a column."""
    for each in rule.head.columns:
        if each.column == column:
            value = each.value
            yield value.argument if isinstance(value, Aggregation) else value


def _as_part(condition: Expression, *, holds: bool) -> Proposition:
    """Return a part that holds where an expression is true, or where it is false or null."""
    known = call("Coalesce", condition, _FALSE)
    if holds:
        return Atom("!=", arguments({"left": known, "right": _FALSE}))
    return Equation(known, _FALSE)


def _count_rule(
    name: str,
    columns: Mapping[str, Expression],
    differences: Mapping[int, Expression],
    body: Sequence[Proposition],
) -> Rule:
    """Make a rule that counts the ways in which a body holds, grouped by columns.

    Of the differences, which are numbers, it gives the least and the greatest.
    """
    aggregated = [
        Argument(f"{letter}{place}", Aggregation(operator, value))
        for place, value in differences.items()
        for letter, operator in (("l", "Min"), ("h", "Max"))
    ]
    number = Argument("n", Aggregation("+", Number("1")))
    head = Head(name, (*arguments(columns), *aggregated, number))
    return Rule(head, Conjunction(tuple(body)) if body else None, is_distinct=True)
