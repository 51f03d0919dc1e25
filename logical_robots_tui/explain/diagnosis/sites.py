"""The watched places of a program, and counts of what they did over the ticks of a run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Literal, TypeAlias

from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.compilation import Task, compile_task
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import Program
from logical_robots_tui.schema import INPUTS
from logical_robots_tui.values import Value

TESTS = ("condition", "denial", "branch", "operand")
"""Sites of these kinds are conditions."""

Stands: TypeAlias = Literal["body", "aggregate", "denied"]

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
            ``Coalesce`` takes `other` then).
        rule: Index of its rule.
        literal: The text that `other` is compared with, or None.
        other: The expression compared with that text or with a number; or "".
        operator: The comparison, ``&&``, ``||``, ``!`` or "".
        within: The predicate made with ``:=`` whose rules it belongs to, or "".
        places: Where its values come from, the nearest first.
        owner: Of a leaf, the predicate that has its value, or calls the function that has it.
    """

    kind: SiteKind
    span: Span
    rule: int
    literal: str | None = None
    other: str = ""
    operator: str = ""
    predicate: str = ""
    within: str = ""
    places: tuple[Span, ...] = ()
    stands: Stands = "body"
    owner: str = ""

    @property
    def is_step(self) -> bool:
        """Whether the rule has no row if nothing satisfies this."""
        return self.kind in ("part", "condition", "denial") and self.stands == "body"


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
    span: Span
    is_function: bool
    is_needed: bool
    is_fact: bool
    key: str
    memory: Span | None = None
    body: Span | None = None
    sources: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Column:
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
    """A query for the ways in which the beginning of a body holds, grouped by boolean values.

    Its columns are c0, c1 ...; dN for right sides of pairs; lN and hN for the least and
    greatest difference of compared numbers; then ``n``, the number of ways.

    Attributes:
        after, before: Indices of the parts that these rows passed and reach; or -1.
        filters: Columns that must be true to reach `before`, or for the rule to give a row.
        gives: Index of the rule that has a row then, or -1.
        robot: Whether there is a column ``who`` with the robot.
        closeness: ``closer`` includes values, which takes longer; ``wider`` does not.
    """

    name: str
    columns: tuple[Column, ...]
    after: int = -1
    before: int = -1
    filters: tuple[int, ...] = ()
    gives: int = -1
    robot: bool = False
    closeness: Literal["closer", "wider", "both"] = "both"

    @property
    def sites(self) -> frozenset[int]:
        """The indices of all sites about which it tells something."""
        return frozenset({self.after, self.before, *(c.site for c in self.columns)}) - {-1}


@dataclass(frozen=True, slots=True)
class Field:
    """A name in a program; for a written memory field also where its value comes from."""

    name: str
    span: Span
    places: tuple[Span, ...] = ()


@dataclass(frozen=True, slots=True)
class Checkup:
    """A program prepared to be watched.

    Attributes:
        program: The compiled program that contains the probes.
        reads, writes: Memory fields that it reads and writes.
        reads_all: Whether it may read others, because it uses a memory as a whole.
        writes_all: Whether it may write others, because its memory is not a plain record.
        texts: Texts in its comparisons and facts.
        left_out: The number of probes that could not be made.
        missed_sites, missed_rules: Indices of those that are reached in other ways as well, so
            that nothing can be said never to happen there.
        unused: Predicates that nothing uses.
        same: Predicates that are made of the same as others, with these.
    """

    rules: tuple[RuleSite, ...]
    sites: tuple[Site, ...]
    probes: tuple[Probe, ...]
    program: Program
    reads: tuple[Field, ...] = ()
    writes: tuple[Field, ...] = ()
    reads_all: bool = False
    writes_all: bool = False
    texts: tuple[Field, ...] = ()
    left_out: int = 0
    missed_sites: tuple[int, ...] = ()
    missed_rules: tuple[int, ...] = ()
    unused: tuple[Field, ...] = ()
    same: tuple[tuple[Field, Field], ...] = ()


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
"""Compared values that are kept for a place."""


@dataclass(slots=True)
class Count:
    """Statistics of a site.

    Attributes:
        reached, true, false, null: The first examined tick in which it was so, or None; a part
            is true if it gave rows.
        ways, ticks: In how many ways, and in which ticks, it was reached.
        passed: The number of ways in which a part was passed.
        left, right: Values of the sides of an equation, with their first ticks.
        least, greatest: The extreme differences between the sides of a comparison, or None.
    """

    reached: int | None = None
    ways: int = 0
    passed: int = 0
    ticks: set[int] = field(default_factory=set)
    true: int | None = None
    false: int | None = None
    null: int | None = None
    left: dict[Value, int] = field(default_factory=dict)
    right: dict[Value, int] = field(default_factory=dict)
    least: float | None = None
    greatest: float | None = None

    def reach(self, tick: int, ways: int) -> None:
        self.reached = _first(self.reached, tick)
        self.ways += ways
        self.ticks.add(tick)


@dataclass(slots=True)
class RuleCount:
    """A rule's examinations, and the first ticks in which it was examined and gave a row."""

    asked: int | None = None
    gave: int | None = None


class Tally:
    """Statistics of everything that a checkup watches, by index of the site or rule.

    Attributes:
        given_up: Indices of probes that failed once, so that they can't prove a "never".
        robots: By robot and tick, how many rows each rule of `Robot` had for it.

    Args:
        checkup: What is watched.
        robot: The only robot whose rows count, where rows tell whose they are; "" for all.
    """

    def __init__(self, checkup: Checkup, robot: str = "") -> None:
        self.checkup = checkup
        self._robot = robot
        self.sites = [Count() for _ in checkup.sites]
        self.rules = [RuleCount() for _ in checkup.rules]
        self.ticks: set[int] = set()
        self.given_up: set[int] = set()
        # Parts that are reached only if the parts before them hold.
        self._waited_for = {probe.before for probe in checkup.probes}
        self.robots: dict[tuple[str, int], dict[int, int]] = {}
        self._settle(checkup.missed_sites, checkup.missed_rules)

    def add(self, tick: int, number: int, views: Sequence[Rows]) -> None:
        """Add the rows of a probe at a tick, in each view of it."""
        self.ticks.add(tick)
        probe = self.checkup.probes[number]
        passed = before = gave = 0
        for row in chain.from_iterable(views):
            ways = row["n"]
            who = row.get("who")
            if not isinstance(ways, int):
                continue  # a sum of nothing
            if self._robot and isinstance(who, str) and who != self._robot:
                continue
            truths: list[bool | None] = []
            for place, column in enumerate(probe.columns):
                truth = self._truth(column, place, row)
                truths.append(truth)
                count = self.sites[column.site]
                is_settled = count.true is not None and count.false is not None
                if is_settled or column.kind == "skip":
                    continue
                if all((truths[c] is True) is holds for c, holds in column.guard):
                    self._see(tick, column, place, row, truth, ways)
            passed += ways
            if all(truths[c] is True for c in probe.filters):
                before += ways
                gave += ways
                if probe.robot and isinstance(who, str):
                    given = self.robots.setdefault((who, tick), {})
                    given[probe.gives] = given.get(probe.gives, 0) + ways
        self._note_parts(tick, probe, passed, before, len(views))
        if probe.gives >= 0:
            rule = self.rules[probe.gives]
            rule.asked = _first(rule.asked, tick)
            if gave:
                rule.gave = _first(rule.gave, tick)

    def give_up(self, number: int) -> None:
        """Mark a probe as failed; nothing that depends on it is reported."""
        probe = self.checkup.probes[number]
        self.given_up.add(number)
        self._settle(probe.sites, {probe.gives} - {-1})

    def doubtful_probes(self) -> list[int]:
        """Return the probes that may still change what is told."""
        sites = {n for n in range(len(self.sites)) if self._is_doubtful(n)}
        found = []
        for number, probe in enumerate(self.checkup.probes):
            if probe.closeness == "closer" or number in self.given_up:
                continue
            if probe.sites & sites or (probe.gives >= 0 and self.rules[probe.gives].gave is None):
                found.append(number)
        return found

    def stopped(self, rule: int) -> int | None:
        found = None
        for number, (site, count) in enumerate(zip(self.checkup.sites, self.sites, strict=True)):
            is_stuck = count.reached is not None and count.true is None
            if site.rule == rule and site.is_step and is_stuck:
                found = number
        return found

    def _is_doubtful(self, number: int) -> bool:
        site, count = self.checkup.sites[number], self.sites[number]
        if site.kind in ("leaf", "value"):
            return False
        if count.reached is None or count.true is None:
            return is_telling(site) or self.rules[site.rule].gave is None
        return is_always_true(site, count)

    def _settle(self, sites: Iterable[int], rules: Iterable[int]) -> None:
        """Let nothing be said never to happen at some sites and in some rules."""
        for place in sites:
            count = self.sites[place]
            if self.checkup.sites[place].kind not in ("leaf", "value"):
                count.reached = _first(count.reached, 0)
                count.true = _first(count.true, 0)
                count.false = _first(count.false, 0)
        for rule in rules:
            self.rules[rule].gave = _first(self.rules[rule].gave, 0)

    def _note_parts(self, tick: int, probe: Probe, passed: int, before: int, views: int) -> None:
        if probe.after >= 0 and passed:
            site = self.sites[probe.after]
            site.true = _first(site.true, tick)
            site.passed += passed
        if probe.after >= 0 and probe.after not in self._waited_for:
            self.sites[probe.after].reach(tick, views)
        if probe.before >= 0 and before:
            self.sites[probe.before].reach(tick, before)

    def _truth(self, column: Column, place: int, row: Mapping[str, Value]) -> bool | None:
        if column.kind in ("always", "skip"):
            return True
        value = row[f"c{place}"]
        if column.kind == "truth":
            is_number = isinstance(value, int | float)
            return None if value is None else is_number and bool(value)
        is_pair = column.kind == "pair"
        other = row[f"d{place}"] if is_pair else self.checkup.sites[column.site].literal
        return None if value is None or other is None else value == other

    def _see(
        self,
        tick: int,
        column: Column,
        place: int,
        row: Mapping[str, Value],
        truth: bool | None,
        ways: int,
    ) -> None:
        site = self.sites[column.site]
        site.reach(tick, ways)
        if truth:
            site.true = _first(site.true, tick)
        elif truth is None:
            site.null = _first(site.null, tick)
        else:
            site.false = _first(site.false, tick)
        if column.kind in ("text", "pair"):
            _keep(site.left, row[f"c{place}"], tick)
        if column.kind == "pair":
            _keep(site.right, row[f"d{place}"], tick)
        site.least = _extreme(min, site.least, row.get(f"l{place}"))
        site.greatest = _extreme(max, site.greatest, row.get(f"h{place}"))


def is_telling(site: Site) -> bool:
    """Return whether it is told of a site by itself that nothing held there."""
    # What is negated is told of where it is negated, or instead of its negation by `!`.
    if site.operator == "!":
        return False
    return site.kind != "part" or not (site.predicate in ("", *INPUTS) or site.stands == "denied")


def is_always_true(site: Site, count: Count) -> bool:
    seen = count.true is not None and count.false is None and count.null is None
    return site.kind in TESTS and site.operator != "!" and seen


def _extreme(
    choose: Callable[[float, float], float], known: float | None, new: Value
) -> float | None:
    if not isinstance(new, int | float):
        return known
    return float(new) if known is None else choose(known, float(new))


def _first(known: int | None, tick: int) -> int:
    return tick if known is None else min(known, tick)


def _keep(values: dict[Any, int], value: Value, tick: int) -> None:
    if isinstance(value, str | int | float) and len(values) < MOST_VALUES:
        values.setdefault(value, tick)
