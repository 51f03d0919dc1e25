"""Collecting sites, and the predicates that query them. In the compile process."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from logical_robots_tui.explain.clauses.bodies import (
    Scope,
    as_part,
    count_rule,
    span_of,
)
from logical_robots_tui.explain.diagnosis.sites import TESTS, Column, Field, Probe, Site
from logical_robots_tui.explain.diagnosis.sources import Sources, alternate, decisive_columns
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.definitions import reach
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import (
    Expression,
    Proposition,
    Rule,
    Tree,
    variable_of,
)
from logical_robots_tui.schema import INPUTS, MAIN

if TYPE_CHECKING:
    from logical_robots_tui.language.expansion import Expanded

PROBE = "DiagnosisProbe"
"""The prefix of the generated predicates."""

_MOST_COLUMNS = 90  # of a probe; SQLite allows 100

_EXPLAINED = (*TESTS, "leaf", "value")
"""Kinds of sites that record where their values come from."""

Stands: TypeAlias = Literal["body", "aggregate", "denied"]
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
        self._decisive = {
            column
            for rule in expanded.rules.get(MAIN, ())
            for column in decisive_columns(rule, expanded.rules)
        }
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
        return [*segment.body, *(as_part(c, holds=holds) for c, holds in conditions if c)]

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
                places = alternate(places, why, span.line)
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
        if self._width(segment) + 4 > _MOST_COLUMNS:
            self.left_out += 1
            self._missed_sites.add(site)
            return -1
        segment.columns.append(Column(site, at.guard, kind))
        segment.trees.append(condition)
        if asked:
            segment.asked[number] = asked
        return number

    def _width(self, segment: Segment) -> int:
        return 2 + 2 * len(segment.differences) + sum(map(len, segment.asked.values()))

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
            rule = count_rule(name, columns, segment.differences, segment.body)
            self.probes[name] = (rule, probe)
            trail.probes.append(name)
