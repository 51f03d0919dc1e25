"""The places of a program that are watched in a run, as data for the compile process and a mind."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.mind.compilation import compiled
from logical_robots_tui.mind.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.program import Program  # noqa: TC001 - `record` reads the hint
from logical_robots_tui.mind.why.probing import Span

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.mind.limits import Limits

__all__ = ["TESTS", "Checkup", "Column", "Field", "Probe", "RuleSite", "Site", "Span", "check_up"]

TESTS = ("condition", "denial", "branch", "operand")
"""Sites of these kinds are conditions."""

SiteKind = Literal["part", "condition", "branch", "operand", "text", "denial", "leaf", "value"]


@dataclass(frozen=True, slots=True)
class Site:
    """A place that is watched.

    Attributes:
        kind: ``part`` (of a body, that gives rows: a call, an element of a list, alternatives),
            ``condition`` (of a body), ``denial`` (of a body), ``branch`` (what stands behind
            ``if``), ``operand`` (of ``&&``, ``||`` or ``!``), ``text`` (given to a function that
            compares it), ``leaf`` (a value that an ``if`` chooses, or a rule has) or ``value``
            (what may be null in one; true means that it is).
        span: Where it stands.
        rule: Number of the rule that it stands in.
        literal: The text that it compares with, or None if it is no equation with a text.
        other: What is compared with that text or, with a number, by ``<`` and the like; or "".
        operator: The comparison, ``&&``, ``||`` or "".
        predicate: What a call calls, or "".
        within: The predicate made with ``:=`` in whose rules it is watched, or "".
        places: Where the values in it come from, the nearest places first.
        stands: Whether it stands in the ``body`` of a rule, in what an ``aggregate`` goes over, or
            in something that is ``denied``.
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

    @property
    def is_step(self) -> bool:
        """Whether the rule gives no row when nothing fulfils it."""
        return self.kind in ("part", "condition", "denial") and self.stands == "body"


@dataclass(frozen=True, slots=True)
class RuleSite:
    """A rule that is watched.

    Attributes:
        predicate: What it is a rule of.
        span: Where it stands.
        is_function: Whether it has rows only for given arguments.
        is_needed: Whether `Robot` leans on it.
        is_fact: Whether it has no body.
        key: What it says, the same for two that say the same.
        memory: Where it says what a robot remembers, or None.
        body: Where its body stands, or None.
    """

    predicate: str
    span: Span
    is_function: bool
    is_needed: bool
    is_fact: bool
    key: str
    memory: Span | None = None
    body: Span | None = None


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a probe's answer.

    Attributes:
        site: Number of the site that it tells of.
        guard: Columns that must be true, or must not be, for the place to be reached.
        kind: ``truth``, ``text`` (what is compared with the site's text), ``pair`` (the two sides
            of an equation) or ``always``: there is no such column, being reached is all that is
            asked; or ``skip``: it is not asked here.
    """

    site: int
    guard: tuple[tuple[int, bool], ...]
    kind: Literal["truth", "text", "pair", "always", "skip"] = "truth"


@dataclass(frozen=True, slots=True)
class Probe:
    """A query for the ways in which the beginning of a body holds, counted by truth values.

    Its columns are c0, c1 ... as far as they are there, and for the right sides of pairs dN; for
    comparisons of numbers also lN and hN, the least and the greatest difference between the two
    sides; then ``n``, the number of ways.

    Attributes:
        name: Its name.
        columns: What its columns tell.
        after: Number of the site, a part, that the rows show to have held, or -1.
        before: Number of the site, a part, that is reached by the rows, or -1.
        filters: Columns that must be true for `before` to be reached, or the rule to give a row.
        gives: Number of the rule that gives a row then, or -1.
        robot: Whether there is a column ``who``, the robot that the row is for.
        closeness: ``closer`` if it also tells of values, which takes longer; ``wider`` if it is
            the same without these.
    """

    name: str
    columns: tuple[Column, ...]
    after: int = -1
    before: int = -1
    filters: tuple[int, ...] = ()
    gives: int = -1
    robot: bool = False
    closeness: Literal["closer", "wider", "both"] = "both"


@dataclass(frozen=True, slots=True)
class Field:
    """A field of memory that is read or written.

    Attributes:
        name: Its name.
        span: Where.
    """

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Checkup:
    """A program made ready to be watched.

    Attributes:
        rules: Its rules.
        sites: What is watched.
        probes: What is asked at a tick.
        program: The same as a program, whose predicates they are.
        reads: Fields of memory that it reads.
        writes: Fields of memory that it writes.
        reads_all: Whether it may read others: it uses a memory as a whole.
        writes_all: Whether it may write others: it is not seen what it writes.
        texts: The texts that it compares or has in its facts.
        left_out: How many probes could not be made.
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


def check_up(
    program: Program, *, stop: threading.Event | None = None, limits: Limits | None = None
) -> Checkup:
    """Make a program ready to be watched; what was made ready before is at hand. Blocks.

    Args:
        program: The program.
        stop: Set it from another thread to give up.
        limits: Bounds on compiling.

    Raises:
        QueryError: It is too entangled for that.
        Stopped: `stop` was set.
    """
    functions = [p.name for p in program.predicates if p.is_function]
    request = {"text": program.text, "checkup": functions}
    try:
        found = compiled(request, Checkup, stop=stop, limits=limits)
    except ProgramError as error:
        raise QueryError(f"The program can't be watched: {error}") from None
    asked = replace(found.program, memory=program.memory, sensor=program.sensor)
    return replace(found, program=asked)
