"""The watched places of a program, and counts of what they did over the ticks of a run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Literal, TypeAlias

from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.language.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.compilation import Task, compile_task
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import Program
from logical_robots_tui.schema import INPUTS
from logical_robots_tui.values import Value

TESTS = ("condition", "denial", "branch", "operand")
"""Sites of these kinds are conditions."""

SitePosition: TypeAlias = Literal["body", "aggregate", "denied"]

SiteKind = Literal[
    "part", "condition", "branch", "operand", "text", "denial", "leaf", "value", "fallback"
]


@dataclass(frozen=True, slots=True)
class Site:
    """A watched place.

    Attributes:
        kind: ``part`` (of a body, with rows: a call, an element of a list, alternatives),
            ``condition`` or ``denial`` (of a body), ``branch`` (the condition of an ``if``),
            ``operand`` (of ``&&``, ``||`` or ``!``), ``text`` (passed to a comparing function),
            ``leaf`` (a value that an ``if`` chooses, or a rule's value), ``value`` (a part
            that may be null; true means that it is) or ``fallback`` (the same, where
            ``Coalesce`` takes `counterpart` then).
        rule: Index of its rule.
        literal: The text that `counterpart` is compared with, or None.
        counterpart: The expression compared with that text or with a number; or "".
        operator: The comparison, ``&&``, ``||``, ``!`` or "".
        within: The predicate made with ``:=`` whose rules it belongs to, or "".
        places: Where its values come from, the nearest first.
        position: Whether it is in a body, or in an aggregate or a negation inside one.
        owner: Of a leaf, the predicate that has its value, or calls the function that has it.
    """

    kind: SiteKind
    span: SourceSpan
    rule: int
    literal: str | None = None
    counterpart: str = ""
    operator: str = ""
    predicate: str = ""
    within: str = ""
    places: tuple[SourceSpan, ...] = ()
    position: SitePosition = "body"
    owner: str = ""

    @property
    def is_step(self) -> bool:
        """Whether the rule has no row if nothing satisfies this."""
        return self.kind in ("part", "condition", "denial") and self.position == "body"


@dataclass(frozen=True, slots=True)
class RuleSite:
    """A watched rule.

    Attributes:
        is_needed: Whether `Robot` uses it.
        key: Equal for facts that mean the same.
        memory: The place of a robot's memory in it, or None.
        sources: Of a rule of `Robot`, the predicates from which its desire may come.
    """

    predicate: str
    span: SourceSpan
    is_function: bool
    is_needed: bool
    is_fact: bool
    key: str
    memory: SourceSpan | None = None
    body: SourceSpan | None = None
    sources: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ProbeColumn:
    """A column of a probe's answer.

    Attributes:
        site: Index of its site.
        guard: Columns that must be true, or must not be, for the site to be reached.
        kind: ``truth``, ``text`` (compared with the site's text), ``pair`` (both sides of an
            equation), ``always`` (no column; reaching the site is enough) or ``skip``.
    """

    site: int
    guard: tuple[tuple[int, bool], ...]
    kind: Literal["truth", "text", "pair", "always", "skip"] = "truth"


@dataclass(frozen=True, slots=True)
class Probe:
    """A query for the derivations of the beginning of a body, grouped by boolean values.

    Its columns are c0, c1 ...; dN for right sides of pairs; lN and hN for the least and
    greatest difference of compared numbers; then ``n``, the number of derivations.

    Attributes:
        passed_site, reached_site: Indices of the parts that these rows passed and reach; or -1.
        filters: Columns that must be true to reach `reached_site`, or for the rule to give a row.
        rule: Index of the rule that has a row then, or -1.
        has_robot: Whether there is a column ``who`` with the robot.
        closeness: ``closer`` includes values, which takes longer; ``wider`` does not.
    """

    name: str
    columns: tuple[ProbeColumn, ...]
    passed_site: int = -1
    reached_site: int = -1
    filters: tuple[int, ...] = ()
    rule: int = -1
    has_robot: bool = False
    closeness: Literal["closer", "wider", "both"] = "both"

    @property
    def sites(self) -> frozenset[int]:
        """The indices of all sites that its rows describe."""
        return frozenset({self.passed_site, self.reached_site, *(c.site for c in self.columns)}) - {
            -1
        }


@dataclass(frozen=True, slots=True)
class NamedPlace:
    """A name in a program; for a written memory field also where its value comes from."""

    name: str
    span: SourceSpan
    places: tuple[SourceSpan, ...] = ()


@dataclass(frozen=True, slots=True)
class Checkup:
    """A program prepared to be watched.

    Attributes:
        program: The compiled program that contains the probes.
        reads, writes: Memory fields that it reads and writes.
        reads_all: Whether it may read others, because it uses a memory as a whole.
        writes_all: Whether it may write others, because its memory is not a plain record.
        texts: Texts in its comparisons and facts.
        missed_sites, missed_rules: Indices of those that are also reached unobserved; of these,
            "never" can't be reported.
        duplicate_copies: Pairs of predicates that ``:=`` makes of the same.
    """

    rules: tuple[RuleSite, ...]
    sites: tuple[Site, ...]
    probes: tuple[Probe, ...]
    program: Program
    reads: tuple[NamedPlace, ...] = ()
    writes: tuple[NamedPlace, ...] = ()
    reads_all: bool = False
    writes_all: bool = False
    texts: tuple[NamedPlace, ...] = ()
    skipped_probes: int = 0
    missed_sites: tuple[int, ...] = ()
    missed_rules: tuple[int, ...] = ()
    unused: tuple[NamedPlace, ...] = ()
    duplicate_copies: tuple[tuple[NamedPlace, NamedPlace], ...] = ()


class PrepareCheckup(Task, frozen=True):
    """Gives the `Checkup` of a program, of whose predicates some are functions."""

    parts = ("explain",)
    text: str
    functions: tuple[str, ...]


def check_up(
    program: Program, *, stop: threading.Event | None = None, limits: Limits | None = None
) -> Checkup:
    """Prepare a program to be watched; cached. Blocks; raises QueryError or Stopped."""
    functions = tuple(p.name for p in program.predicates if p.is_function)
    try:
        task = PrepareCheckup(program.text, functions)
        checkup = compile_task(task, Checkup, stop=stop, limits=limits)
    except ProgramError as error:
        raise QueryError(f"The program can't be watched: {error}") from None
    watched = replace(checkup.program, memory=program.memory, sensor=program.sensor)
    return replace(checkup, program=watched)


Rows: TypeAlias = "Sequence[Mapping[str, Value]]"

MOST_VALUES = 60
"""The most compared values that a site keeps."""


@dataclass(slots=True)
class Count:
    """Statistics of a site.

    Attributes:
        first_reached, first_true, first_false, first_null: The first examined tick in which it
            was so, or None; a part is true if it gave rows.
        cases, ticks: The number of derivations, and the ticks, that reached it.
        passed_cases: The number of derivations that passed a part.
        left, right: Values of the sides of an equation, with their first ticks.
        min_difference, max_difference: Between the sides of a comparison, or None.
    """

    first_reached: int | None = None
    cases: int = 0
    passed_cases: int = 0
    ticks: set[int] = field(default_factory=set)
    first_true: int | None = None
    first_false: int | None = None
    first_null: int | None = None
    left: dict[Value, int] = field(default_factory=dict)
    right: dict[Value, int] = field(default_factory=dict)
    min_difference: float | None = None
    max_difference: float | None = None

    def reach(self, tick: int, cases: int) -> None:
        self.first_reached = _earliest(self.first_reached, tick)
        self.cases += cases
        self.ticks.add(tick)


@dataclass(slots=True)
class RuleCount:
    """The first ticks in which a rule was examined and gave a row."""

    first_examined: int | None = None
    first_row: int | None = None


class ProbeTally:
    """Statistics of everything that a checkup watches, by index of the site or rule.

    Attributes:
        failed_probes: Names of probes that failed once, so that they can't prove a "never".
        robot_rows: By robot and tick, how many rows each rule of `Robot` had for it.

    Args:
        checkup: What is watched.
        robot: The only robot whose rows count, where rows name a robot; "" for all.
    """

    def __init__(self, checkup: Checkup, robot: str = "") -> None:
        self.checkup = checkup
        self._robot = robot
        self.sites = [Count() for _ in checkup.sites]
        self.rules = [RuleCount() for _ in checkup.rules]
        self.ticks: set[int] = set()
        self.failed_probes: set[str] = set()
        self._probes = {probe.name: probe for probe in checkup.probes}
        # Parts that are reached only if the parts before them hold.
        self._dependent_parts = {probe.reached_site for probe in checkup.probes}
        self.robot_rows: dict[tuple[str, int], dict[int, int]] = {}
        self._exclude(checkup.missed_sites, checkup.missed_rules)

    def add(self, tick: int, name: str, views: Sequence[Rows] | None) -> None:
        """Add the rows of a probe at a tick, in each view of it; None if it failed.

        No "never" that depends on a failed probe is reported.
        """
        probe = self._probes[name]
        if views is None:
            self.failed_probes.add(name)
            self._exclude(probe.sites, {probe.rule} - {-1})
            return
        self.ticks.add(tick)
        passed_cases = reached_cases = 0
        for row in chain.from_iterable(views):
            cases = row["n"]
            robot = row.get("who")
            if not isinstance(cases, int):
                continue  # a sum of nothing
            if self._robot and isinstance(robot, str) and robot != self._robot:
                continue
            truths: list[bool | None] = []
            for index, column in enumerate(probe.columns):
                truth = self._truth(column, index, row)
                truths.append(truth)
                count = self.sites[column.site]
                is_settled = count.first_true is not None and count.first_false is not None
                if is_settled or column.kind == "skip":
                    continue
                if all((truths[c] is True) is holds for c, holds in column.guard):
                    self._record(tick, column, index, row, truth, cases)
            passed_cases += cases
            if all(truths[c] is True for c in probe.filters):
                reached_cases += cases
                if probe.has_robot and isinstance(robot, str):
                    rows = self.robot_rows.setdefault((robot, tick), {})
                    rows[probe.rule] = rows.get(probe.rule, 0) + cases
        self._note_parts(tick, probe, passed_cases, reached_cases, len(views))
        if probe.rule >= 0:
            rule = self.rules[probe.rule]
            rule.first_examined = _earliest(rule.first_examined, tick)
            if reached_cases:
                rule.first_row = _earliest(rule.first_row, tick)

    def doubtful_probes(self) -> list[str]:
        """Return the names of the probes that may still change the findings."""
        sites = {n for n in range(len(self.sites)) if self._is_doubtful(n)}
        probes = []
        for name, probe in self._probes.items():
            if probe.closeness == "closer" or name in self.failed_probes:
                continue
            if probe.sites & sites or (
                probe.rule >= 0 and self.rules[probe.rule].first_row is None
            ):
                probes.append(name)
        return probes

    def stopping_site(self, rule: int) -> int | None:
        last_stop = None
        for number, (site, count) in enumerate(zip(self.checkup.sites, self.sites, strict=True)):
            is_stuck = count.first_reached is not None and count.first_true is None
            if site.rule == rule and site.is_step and is_stuck:
                last_stop = number
        return last_stop

    def _is_doubtful(self, number: int) -> bool:
        site, count = self.checkup.sites[number], self.sites[number]
        if site.kind in ("leaf", "value"):
            return False
        if count.first_reached is None or count.first_true is None:
            return is_reportable(site) or self.rules[site.rule].first_row is None
        return is_always_true(site, count)

    def _exclude(self, sites: Iterable[int], rules: Iterable[int]) -> None:
        """Exclude sites and rules from findings that something never happened."""
        for number in sites:
            count = self.sites[number]
            if self.checkup.sites[number].kind not in ("leaf", "value"):
                count.first_reached = _earliest(count.first_reached, 0)
                count.first_true = _earliest(count.first_true, 0)
                count.first_false = _earliest(count.first_false, 0)
        for rule in rules:
            self.rules[rule].first_row = _earliest(self.rules[rule].first_row, 0)

    def _note_parts(
        self, tick: int, probe: Probe, passed_cases: int, reached_cases: int, views: int
    ) -> None:
        if probe.passed_site >= 0 and passed_cases:
            site = self.sites[probe.passed_site]
            site.first_true = _earliest(site.first_true, tick)
            site.passed_cases += passed_cases
        if probe.passed_site >= 0 and probe.passed_site not in self._dependent_parts:
            self.sites[probe.passed_site].reach(tick, views)
        if probe.reached_site >= 0 and reached_cases:
            self.sites[probe.reached_site].reach(tick, reached_cases)

    def _truth(self, column: ProbeColumn, index: int, row: Mapping[str, Value]) -> bool | None:
        if column.kind in ("always", "skip"):
            return True
        value = row[f"c{index}"]
        if column.kind == "truth":
            is_number = isinstance(value, int | float)
            return None if value is None else is_number and bool(value)
        is_pair = column.kind == "pair"
        counterpart = row[f"d{index}"] if is_pair else self.checkup.sites[column.site].literal
        return None if value is None or counterpart is None else value == counterpart

    def _record(
        self,
        tick: int,
        column: ProbeColumn,
        index: int,
        row: Mapping[str, Value],
        truth: bool | None,
        cases: int,
    ) -> None:
        site = self.sites[column.site]
        site.reach(tick, cases)
        if truth:
            site.first_true = _earliest(site.first_true, tick)
        elif truth is None:
            site.first_null = _earliest(site.first_null, tick)
        else:
            site.first_false = _earliest(site.first_false, tick)
        if column.kind in ("text", "pair"):
            _record_value(site.left, row[f"c{index}"], tick)
        if column.kind == "pair":
            _record_value(site.right, row[f"d{index}"], tick)
        site.min_difference = _extreme(min, site.min_difference, row.get(f"l{index}"))
        site.max_difference = _extreme(max, site.max_difference, row.get(f"h{index}"))


def is_reportable(site: Site) -> bool:
    """Return whether a site that never held gets a finding of its own."""
    # What `!` negates gets its own finding, instead of the negation.
    if site.operator == "!":
        return False
    return site.kind != "part" or not (site.predicate in ("", *INPUTS) or site.position == "denied")


def is_always_true(site: Site, count: Count) -> bool:
    was_only_true = (
        count.first_true is not None and count.first_false is None and count.first_null is None
    )
    return site.kind in TESTS and site.operator != "!" and was_only_true


def _extreme(
    choose: Callable[[float, float], float], extreme: float | None, difference: Value
) -> float | None:
    if not isinstance(difference, int | float):
        return extreme
    return float(difference) if extreme is None else choose(extreme, float(difference))


def _earliest(first_tick: int | None, tick: int) -> int:
    return tick if first_tick is None else min(first_tick, tick)


def _record_value(values: dict[Any, int], value: Value, tick: int) -> None:
    if isinstance(value, str | int | float) and len(values) < MOST_VALUES:
        values.setdefault(value, tick)
