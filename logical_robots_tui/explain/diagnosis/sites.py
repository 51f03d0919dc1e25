"""The watched places of a program, as data for the compile process and a mind."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.explain.why.probing import Span  # noqa: TC001 - so it does here
from logical_robots_tui.language.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.compilation import compiled
from logical_robots_tui.mind.program import Program  # noqa: TC001 - `record` reads the hint

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.mind.limits import Limits

TESTS = ("condition", "denial", "branch", "operand")
"""Sites of these kinds are conditions."""

SiteKind = Literal["part", "condition", "branch", "operand", "text", "denial", "leaf", "value"]


@dataclass(frozen=True, slots=True)
class Site:
    """A watched place.

    Attributes:
        kind: ``part`` (of a body, with rows: a call, an element of a list, alternatives),
            ``condition`` (of a body), ``denial`` (of a body), ``branch`` (the condition of an
            ``if``), ``operand`` (of ``&&``, ``||`` or ``!``), ``text`` (passed to a function that
            compares it), ``leaf`` (a value that an ``if`` chooses, or a rule's value) or ``value``
            (a part that may be null; true means that it is).
        span: Its place in the text.
        rule: Number of its rule.
        literal: The text that it is compared with, or None.
        other: The expression that is compared with that text or with a number; or "".
        operator: The comparison, ``&&``, ``||`` or "".
        predicate: The predicate that a call calls, or "".
        within: The predicate made with ``:=`` whose rules it belongs to, or "".
        places: Where its values come from, the nearest places first.
        stands: Whether it is in the ``body`` of a rule, within an ``aggregate``, or
            within something ``denied``.
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
        """Whether the rule has no row if nothing satisfies this."""
        return self.kind in ("part", "condition", "denial") and self.stands == "body"


@dataclass(frozen=True, slots=True)
class RuleSite:
    """A watched rule.

    Attributes:
        predicate: The predicate that it defines.
        span: Its place in the text.
        is_function: Whether it needs arguments.
        is_needed: Whether `Robot` uses it.
        is_fact: Whether it has no body.
        key: Equal for facts that mean the same.
        memory: The place of a robot's memory in it, or None.
        body: The place of its body, or None.
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
        site: Number of its site.
        guard: Columns that must be true, or must not be, for the site to be reached.
        kind: ``truth``, ``text`` (the value compared with the site's text), ``pair`` (the two sides
            of an equation), ``always`` (no column; reaching the site is enough) or ``skip`` (not
            examined here).
    """

    site: int
    guard: tuple[tuple[int, bool], ...]
    kind: Literal["truth", "text", "pair", "always", "skip"] = "truth"


@dataclass(frozen=True, slots=True)
class Probe:
    """A query for the ways in which the beginning of a body holds, grouped by boolean values.

    Its columns are c0, c1 ..., and dN for the right sides of pairs; for comparisons of numbers also
    lN and hN, the least and the greatest difference between the sides; then ``n``, the number of
    ways.

    Attributes:
        name: Its name.
        columns: The meaning of its columns.
        after: Number of the site, a part, that holds in these rows, or -1.
        before: Number of the site, a part, that these rows reach, or -1.
        filters: Columns that must be true for `before` to be reached, or the rule to give a row.
        gives: Number of the rule that has a row then, or -1.
        robot: Whether there is a column ``who`` with the robot.
        closeness: ``closer`` if it includes values, which takes longer; ``wider`` if it is the same
            without values.
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
    """A memory field that is read or written."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Checkup:
    """A program prepared to be watched.

    Attributes:
        rules: Its rules.
        sites: The watched places.
        probes: The queries for a tick.
        program: The compiled program that contains the probes.
        reads: Memory fields that it reads.
        writes: Memory fields that it writes.
        reads_all: Whether it may read others, because it uses a memory as a whole.
        writes_all: Whether it may write others, because its memory is not a plain record.
        texts: Texts in its comparisons and facts.
        left_out: The number of probes that could not be made.
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
    """Prepare a program to be watched; results are cached. Blocks.

    Raises:
        QueryError: The program is too complex.
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
