"""The watched places of a program, as data for the compile process and a mind."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from typing import Literal

from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.compilation import compile_request
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import Program

TESTS = ("condition", "denial", "branch", "operand")
"""Sites of these kinds are conditions."""

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
    stands: Literal["body", "aggregate", "denied"] = "body"
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


def check_up(
    program: Program, *, stop: threading.Event | None = None, limits: Limits | None = None
) -> Checkup:
    """Prepare a program to be watched; cached. Blocks; raises QueryError or Stopped."""
    functions = [p.name for p in program.predicates if p.is_function]
    request = {"text": program.text, "checkup": functions}
    try:
        found = compile_request(request, Checkup, stop=stop, limits=limits)
    except ProgramError as error:
        raise QueryError(f"The program can't be watched: {error}") from None
    asked = replace(found.program, memory=program.memory, sensor=program.sensor)
    return replace(found, program=asked)
