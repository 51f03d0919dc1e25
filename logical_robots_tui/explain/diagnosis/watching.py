"""Sites, the sources of their values, and their queries. In the compile process."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.explain.bodies import Scope, parameters, span_of
from logical_robots_tui.explain.diagnosis.sites import (
    TESTS,
    NamedPlace,
    Probe,
    ProbeColumn,
    Site,
    SitePosition,
)
from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import names_used, reach
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import Atom, Choice, Expression, Node, Proposition, Rule, Tree
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
        expressions, differences: Per column, its expressions, and the difference of both sides.
        passed_site: Index of the site of the part at its end, or -1.
    """

    body: list[Proposition]
    passed_site: int = -1
    columns: list[ProbeColumn] = field(default_factory=list)
    trees: list[Expression | None] = field(default_factory=list)
    expressions: dict[int, Sequence[Expression]] = field(default_factory=dict)
    differences: dict[int, Expression] = field(default_factory=dict)


@dataclass
class Trail:
    """The progress of tracing a body; mutable. `filters` are columns that must be true."""

    segment: Segment
    filters: tuple[int, ...] = ()
    probes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Environment:
    """Where an expression is evaluated.

    Attributes:
        bindings: The query's expressions by variable.
        choice: The condition of an ``if`` that must hold for it, and the index of its rule.
    """

    trail: Trail
    rule: int
    scope: Scope
    bound: frozenset[str]
    bindings: Mapping[str, Expression]
    guard: Guard = ()
    call_stack: tuple[str, ...] = ()
    position: SitePosition = "body"
    choice: tuple[Expression, int] | None = None

    def when(self, column: int, *, holds: bool) -> Environment:
        return replace(self, guard=(*self.guard, (column, holds)))


_FALSE = tree.Boolean("false")


class Watching:
    """Collects the sites of rules and the predicates to be compiled for them.

    Attributes:
        probes: For each generated predicate its rule, and the meaning of its rows.
        skipped_probes: The number of probes beyond the limits.
        copies: For each predicate copied by ``:=``, the original and the copy.
        missed_rules: Rules that are also evaluated where no probe watches them.
    """

    def __init__(
        self, source: Prepared, expanded: Expanded, functions: frozenset[str], rules: Sequence[Rule]
    ) -> None:
        self.sites: list[Site] = []
        self.probes: dict[str, tuple[Rule, Probe]] = {}
        self.reads: dict[tuple[str, int], NamedPlace] = {}
        self.reads_all = False
        self.skipped_probes = 0
        functor_copies = {name: (base, name) for name, base in expanded.bases.items()}
        self.copies = {**expanded.origins, **functor_copies}
        self.missed_rules: set[int] = set()
        self._missed_sites: set[int] = set()
        self._within = self._owner = ""
        self._source = source
        self._predicates, self._functions, self._rules = expanded.rules, functions, rules
        self._numbers = {id(rule): number for number, rule in enumerate(rules)}
        # A copied predicate may be a copy itself; it comes first.
        for copy, (original, _) in {**functor_copies, **expanded.origins}.items():
            # A predicate with the rows of a recursive one has a single rule.
            for rule, first in zip(
                self._predicates[copy], self._predicates[original], strict=False
            ):
                self._numbers[id(rule)] = self._numbers[id(first)]
        self._sources = Sources(source, expanded.rules)
        predicates = expanded.rules
        self._decisive = {
            c for rule in predicates.get(MAIN, ()) for c in decisive_columns(rule, predicates)
        }
        self._site_indices: dict[tuple[Any, ...], int] = {}
        self._memories: set[str] = set()
        self._leaves: set[str] = set()
        self._fresh_count = 0

    def missed_sites(self) -> set[int]:
        """Return the sites that are also evaluated where no probe watches them."""
        in_rules = {n for n, site in enumerate(self.sites) if site.rule in self.missed_rules}
        return self._missed_sites | in_rules

    def miss_probe(self, probe: Probe) -> None:
        """Note that a probe is not evaluated."""
        self._missed_sites |= probe.sites
        if probe.rule >= 0:
            self.missed_rules.add(probe.rule)

    def _miss(self, node: Tree, env: Environment) -> None:
        """Note that a tree, and the rules that it uses, are not watched in an environment."""
        self.missed_rules.add(env.rule)
        for name in reach(node, self._predicates):
            for rule in self._predicates.get(name, ()):
                self.missed_rules |= {self._numbers.get(id(rule), env.rule)}

    def _guarded_body(self, env: Environment) -> list[Proposition]:
        segment = env.trail.segment
        conditions = ((segment.trees[column], holds) for column, holds in env.guard)
        return [*segment.body, *(_as_part(c, holds=holds) for c, holds in conditions if c)]

    def _covers_predicate(self, probe: Probe) -> bool:
        return any(
            site >= 0 and self.sites[site].predicate not in ("", *INPUTS)
            for site in (probe.passed_site, probe.reached_site)
        )

    def _query_variable(self, name: str, env: Environment) -> str:
        value = env.bindings.get(name)
        return name if value is None else tree.variable_of(value)

    def _fresh_name(self, name: str) -> str:
        self._fresh_count += 1
        return f"d{self._fresh_count}_{name}"

    def _span(self, node: Tree) -> SourceSpan:
        return span_of(node, self._source)

    def _site(self, kind: Any, node: Tree, env: Environment, **details: Any) -> int:
        """Return the index of a site; equal places share one."""
        span = self._span(node)
        owner = self._owner if kind == "leaf" else ""
        key = (kind, span.start, span.stop, self._within, owner, details.get("counterpart"))
        if key not in self._site_indices:
            self._site_indices[key] = len(self.sites)
            rule = self._rules[env.rule]
            places = self._sources.of(node, rule) if kind in _EXPLAINED else ()
            if kind == "leaf" and env.choice is not None:
                condition, number = env.choice
                origins = self._sources.of(condition, self._rules[number])
                places = _alternate(places, (self._span(condition), *origins), span.line)
            attributes = {"within": self._within, "places": places, "position": env.position}
            details = attributes | details
            self.sites.append(Site(kind, span, env.rule, owner=owner, **details))
        return self._site_indices[key]

    def _add(
        self,
        env: Environment,
        site: int,
        expressions: Sequence[Expression],
        kind: Any,
        condition: Expression | None = None,
    ) -> int:
        """Add a column to the query of an environment; return -1 if there are too many."""
        segment = env.trail.segment
        number = len(segment.columns)
        width = 2 + 2 * len(segment.differences) + sum(map(len, segment.expressions.values()))
        if width + 4 > _MOST_COLUMNS:
            self.skipped_probes += 1
            self._missed_sites.add(site)
            return -1
        segment.columns.append(ProbeColumn(site, env.guard, kind))
        segment.trees.append(condition)
        if expressions:
            segment.expressions[number] = expressions
        return number

    def _emit(
        self,
        trail: Trail,
        reached_site: int = -1,
        rule: int = -1,
        robot: Expression | None = None,
        *,
        is_robot: bool = False,
    ) -> None:
        segment = trail.segment
        if not segment.body and not segment.columns and rule < 0:
            return
        values = {
            n for n, column in enumerate(segment.columns) if self.sites[column.site].kind == "value"
        }
        for closer in (False, True) if values else (False,):
            name = f"{PROBE}{self._fresh_count}"
            self._fresh_count += 1
            omitted = frozenset[int]() if closer else values
            columns = {
                f"{'cd'[place]}{number}": expression
                for number, expressions in segment.expressions.items()
                for place, expression in enumerate(expressions)
                if number not in omitted
            }
            if robot is not None:
                columns["who"] = robot
            probe = Probe(
                name,
                tuple(
                    replace(c, kind="skip") if n in omitted else c
                    for n, c in enumerate(segment.columns)
                ),
                segment.passed_site,
                reached_site,
                trail.filters,
                rule,
                has_robot=is_robot,
                closeness=("closer" if closer else "wider") if values else "both",
            )
            count_rule = _count_rule(name, columns, segment.differences, segment.body)
            self.probes[name] = (count_rule, probe)
            trail.probes.append(name)


_MOST = 6  # places
_DEEPEST = 4


class Sources:
    def __init__(self, source: Prepared, predicates: Mapping[str, Sequence[Rule]]) -> None:
        self._source, self._predicates = source, predicates

    def of(self, node: Tree, rule: Rule) -> tuple[SourceSpan, ...]:
        """Return where an expression's values come from, recursively.

        The nearest places come first, and those that only copy a value last.
        """
        places: dict[int, SourceSpan] = {}
        copies: dict[int, SourceSpan] = {}
        visited: set[tuple[int, str]] = set()
        queue: deque[tuple[Tree, Rule, int]] = deque([(node, rule, 0)])
        own_line = span_of(node, self._source).line
        while queue and len(places) < _MOST:
            node, rule, depth = queue.popleft()
            for place, inner, inner_rule in self._direct_places(node, rule, visited):
                span = span_of(place, self._source)
                if span.text and span.line != own_line:
                    (copies if self._copies(place) else places).setdefault(span.line, span)
                if depth + 1 < _DEEPEST:
                    queue.append((inner, inner_rule, depth + 1))
        return tuple((places | {n: s for n, s in copies.items() if n not in places}).values())[
            :_MOST
        ]

    def _copies(self, place: Node) -> bool:
        """Return whether a place is a call of a sensor or of a predicate with rules."""
        return isinstance(place, Atom) and (
            place.name == "Sensor"
            or any(rule.body for rule in self._predicates.get(place.name, ()))
        )

    def _direct_places(
        self, node: Tree, rule: Rule, visited: set[tuple[int, str]]
    ) -> Iterator[tuple[Node, Tree, Rule]]:
        for name in dict.fromkeys(names_used(node)):
            yield from self._rules(name, visited)
        for variable in sorted(tree.variables(node, inside=True)):
            if (id(rule), variable) in visited:
                continue
            visited.add((id(rule), variable))
            for part, value in _bindings(variable, rule):
                if isinstance(part, Atom) and value is None:
                    yield part, (), rule
                    yield from self._rules(part.name, visited)
                elif value is not None:
                    yield from ((place, value, rule) for place in _places(part, value))

    def _rules(self, name: str, visited: set[tuple[int, str]]) -> Iterator[tuple[Node, Tree, Rule]]:
        """Yield the rules of a predicate except facts."""
        if (0, name) in visited:
            return
        visited.add((0, name))
        for rule in self._predicates.get(name, ()):
            is_function = rule.value is not None and parameters(rule) is not None
            if rule.body or is_function:
                copies = all(
                    isinstance(column.value, tree.Variable) for column in rule.head.columns
                )
                yield (copies and rule.body) or rule, rule.value or rule, rule
            for part in tree.conjuncts(rule.body):
                if isinstance(part, Atom) and part.name in tree.CONDITIONS:
                    yield part, part, rule


def _bindings(variable: str, rule: Rule) -> Iterator[tuple[Node, Expression | None]]:
    """Yield equations of a variable with its value, and calls that mention it with None."""
    for part in tree.walk(rule):
        if (pair := tree.equation_sides(part)) is not None:
            for side, value in (pair, pair[::-1]):
                if tree.variable_of(side) == variable:
                    yield part, value
        elif isinstance(part, Atom) and variable in tree.variables(part):
            yield part, None


def _places(part: Node, value: Tree) -> Sequence[Node]:
    """Return the places of an equation: of an ``if``, those of its values."""
    if not isinstance(value, Choice):
        return (part,)
    values = (*(branch.value for branch in value.branches), value.otherwise)
    return [place for place in values if not isinstance(place, tree.Literal)] or (part,)


def _alternate(
    left: Sequence[SourceSpan], right: Sequence[SourceSpan], own_line: int
) -> tuple[SourceSpan, ...]:
    """Return places of both sequences in turn, one for each line except `own_line`."""
    places = (place for pair in zip_longest(left, right) for place in pair if place is not None)
    places_by_line: dict[int, SourceSpan] = {}
    for place in places:
        if place.line != own_line:
            places_by_line.setdefault(place.line, place)
    return tuple(places_by_line.values())[:_MOST]


def decisive_columns(rule: Rule, predicates: Mapping[str, Sequence[Rule]]) -> set[tuple[str, str]]:
    """Return the predicates and columns from which the desire of a rule of `Robot` is copied."""
    columns = {(MAIN, "desire")}
    queue = [(rule, value) for value in _values(rule, "desire")]
    visited: set[tuple[int, int]] = set()

    def add(name: str, column: str) -> None:
        if name in predicates and (name, column) not in columns:
            columns.add((name, column))
            queue.extend(
                (source_rule, value)
                for source_rule in predicates[name]
                for value in _values(source_rule, column)
            )

    while queue:
        rule, value = queue.pop()
        if (id(rule), id(value)) in visited:
            continue
        visited.add((id(rule), id(value)))
        match value:
            case Choice():
                queue += [(rule, branch.value) for branch in value.branches]
                queue.append((rule, value.otherwise))
            case tree.Aggregate():
                queue.append((rule, value.argument))
            case tree.Call(name="Coalesce"):
                queue += [(rule, operand) for operand in tree.operands(value.arguments)]
            case tree.Call():
                add(value.name, VALUE)
            case tree.Variable():
                for part, bound_value in _bindings(value.name, rule):
                    if bound_value is not None:
                        queue.append((rule, bound_value))
                    elif isinstance(part, Atom):
                        for argument in part.arguments:
                            if argument.expression == value:
                                add(part.name, argument.column)
    return columns


def _values(rule: Rule, column: str) -> Iterator[Expression]:
    """Yield the values of a column in a rule's head."""
    for argument in rule.head.columns:
        if argument.column == column:
            value = argument.value
            yield value.argument if isinstance(value, tree.Aggregation) else value


def _as_part(condition: Expression, *, holds: bool) -> Proposition:
    """Return a part that holds where an expression is true, or where it is false or null."""
    truth = tree.call("Coalesce", condition, _FALSE)
    if holds:
        return Atom("!=", tree.arguments({"left": truth, "right": _FALSE}))
    return tree.Equation(truth, _FALSE)


def _count_rule(
    name: str,
    columns: Mapping[str, Expression],
    differences: Mapping[int, Expression],
    body: Sequence[Proposition],
) -> Rule:
    """Make a rule that counts the derivations of a body, grouped by columns.

    Of the differences, which are numbers, it has the minimum and the maximum.
    """
    aggregated = [
        tree.Argument(f"{letter}{place}", tree.Aggregation(operator, value))
        for place, value in differences.items()
        for letter, operator in (("l", "Min"), ("h", "Max"))
    ]
    number = tree.Argument("n", tree.Aggregation("+", tree.Number("1")))
    head = tree.Head(name, (*tree.arguments(columns), *aggregated, number))
    return Rule(head, tree.Conjunction(tuple(body)) if body else None, is_distinct=True)
