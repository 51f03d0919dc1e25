"""Programs: Logica text, compiled."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError, QueryError

if TYPE_CHECKING:
    import threading
    from collections.abc import Mapping

    from logical_robots_tui.mind.compilation import Report
    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.why.probing import Probing

__all__ = [
    "INPUTS",
    "STEPS",
    "TRUTH_MARK",
    "VALUE",
    "Predicate",
    "Program",
    "Question",
    "Tuned",
]

INPUTS: Mapping[str, tuple[str, ...]] = {
    "Sensor": ("robot_name", "sensor"),
    "Memory": ("robot_name", "memory"),
}
"""The predicates that the game supplies, with their columns."""

STEPS = "t_0_steps_of_"
"""What the name of a named query begins with that has the steps of a recursion."""

TRUTH_MARK = "?"
"""What the name of a field ends with, in the result of a tuned query, that is a truth."""


VALUE = "logica_value"
"""The column in which a function keeps its value."""


@dataclass(frozen=True, slots=True)
class Predicate:
    """A predicate that an inspector can name.

    Attributes:
        name: As written in the program.
        kind: ``input`` (Sensor, Memory), ``program`` (defined in the text) or ``prelude``.
        line: Line of its first rule in the program's text, from 1, or None.
        has_rows: False for a function of its arguments, which has no rows of its own.
        reason: Why it has no rows, one sentence, or "".
        is_function: Whether it has rows only for given arguments.
    """

    name: str
    kind: Literal["input", "program", "prelude"]
    line: int | None
    has_rows: bool
    reason: str = ""
    is_function: bool = False


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked of a program at one tick, compiled.

    Attributes:
        text: As it was typed.
        sql: The query.
        gives: What its rows are: those of a predicate or of conditions; the ``value`` of an
            expression, one; or whether conditions without variables hold, "true" or "false".
        tuned: The same query for quicker tables, if it could be rewritten.
    """

    text: str
    sql: str
    gives: Literal["rows", "value", "truth"] = "rows"
    tuned: Tuned | None = None


@dataclass(frozen=True, slots=True)
class Tuned:
    """A query rewritten for tables that hold all robots' rows, with fields in columns.

    Attributes:
        sql: The query. Its parameters are the numbers of the first and the last visible row of
            ``Sensor``, then of ``Memory``.
        bounds: How many of these parameters it has.
        columns: By name of a table the columns of it that are read, beside ``id``.
        result: Names of the columns of the answer, each with the fields of its record where the
            query gives these as columns of their own, those of truths with `TRUTH_MARK`; () if it
            gives the answer as it is.
        together: The query for all viewers at once, where each sees its own sensor only, or "".
            It has one more column, the viewer's number, and as last parameter how much further
            the visible rows of ``Memory`` begin from one viewer to the next.
        together_alike: The same where all viewers see the same memories, without that parameter.
        crowd: The first query and the two together as they are for many robots, where those for
            few are not the same; else ().
    """

    sql: str
    bounds: int
    columns: Mapping[str, tuple[str, ...]]
    result: tuple[tuple[str, tuple[str, ...]], ...]
    together: str = ""
    together_alike: str = ""
    crowd: tuple[str, ...] = ()

    def for_crowd(self) -> Tuned:
        """The same for many robots."""
        if not self.crowd:
            return self
        one, together, alike = self.crowd
        return replace(self, sql=one, together=together, together_alike=alike, crowd=())

    def for_all(self, *, alike: bool) -> tuple[str, int]:
        """The query for all viewers, or "", and how many parameters it has.

        Args:
            alike: Whether all viewers see the same memories.
        """
        memories = 2 if alike else 3
        bounds = 2 + memories if "Memory" in self.columns else 2
        return self.together_alike if alike else self.together, bounds


@dataclass(frozen=True, slots=True)
class Program:
    """A compiled program; make one with `Program.compile`.

    Attributes:
        text: The Logica text.
        predicates: Inputs first, then the program's own in the order of the text, then the prelude.
        statements: One SQL query by predicate name, for those that have rows.
        memory: Visibility of memories that the program asks for with ``@Visible``, or None.
        sensor: Visibility of sensors that the program asks for with ``@Visible``, or None.
        warnings: What may not do what was meant, in the order of the text.
        needed: The predicates with rows that `Robot` leans on, each after what it leans on itself;
            `Robot` is the last.
        uses: By predicate of the program's own the predicates that it mentions, also those
            of the game and of the prelude, in the order in which it does.
        recursions: For each recursive predicate how many steps it takes, and an SQL query for
            whether one more would change anything.
        tuned: The same queries for quicker tables, by predicate name and for recursions by
            ``name + " grows"``; of those that could be rewritten.
    """

    text: str
    predicates: tuple[Predicate, ...]
    statements: Mapping[str, str]
    memory: Literal["own", "seen", "all"] | None = None
    sensor: Literal["own", "all"] | None = None
    warnings: tuple[Diagnostic, ...] = ()
    needed: tuple[str, ...] = ()
    uses: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    recursions: Mapping[str, tuple[int, str]] = field(default_factory=dict)
    tuned: Mapping[str, Tuned] = field(default_factory=dict)

    @classmethod
    def compile(
        cls,
        text: str,
        *,
        stop: threading.Event | None = None,
        limits: Limits | None = None,
        report: Report | None = None,
    ) -> Program:
        """Compile Logica text. Blocks; the work is done in a process of its own.

        Args:
            text: The program.
            stop: Set it from another thread to give up; takes effect within 0.1 s.
            limits: Bounds on the text and on compiling it.
            report: Called meanwhile with the number of predicates compiled and of all.

        Raises:
            ProgramError: The program is wrong; holds diagnostics with line, column and hint.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import check_text, compiled

        check_text(text, limits)
        return compiled({"text": text}, cls, stop=stop, limits=limits, report=report)

    def question(
        self, query: str, *, stop: threading.Event | None = None, limits: Limits | None = None
    ) -> Question:
        """Compile a question about this program, to be answered by `Mind.ask`. Blocks.

        Args:
            query: A call, an expression, conditions, or whole rules of which the last is asked.
            stop: Set it from another thread to give up.
            limits: Bounds on the text and on compiling it.

        Raises:
            ProgramError: The query is wrong; the diagnostics speak of its lines and columns.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import check_text, compiled

        check_text(query, limits)
        columns = {
            table: sorted({n for t in self.tuned.values() for n in t.columns.get(table, ())})
            for table in ("Memory", "Item")
        }
        request = {"text": self.text, "query": query, "columns": columns}
        return compiled(request, Question, stop=stop, limits=limits)

    def take_apart(
        self,
        predicate: str,
        within: str = "",
        *,
        stop: threading.Event | None = None,
        limits: Limits | None = None,
    ) -> Probing:
        """Take the rules of a predicate apart, for `Mind.why`. Blocks.

        Args:
            predicate: One of this program's own predicates.
            within: A predicate made with ``:=`` in whose rules it is asked, or "".
            stop: Set it from another thread to give up.
            limits: Bounds on compiling.

        Raises:
            QueryError: There is no such predicate, or it can't be computed.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import compiled
        from logical_robots_tui.mind.why.probing import Probing

        known = self.predicate(predicate)
        if known is None or known.kind != "program":
            raise QueryError(f"The program has no rules for {predicate}.")
        if not (known.has_rows or known.is_function or within):
            raise QueryError(known.reason)
        request = {
            "text": self.text,
            "predicate": predicate,
            "within": within,
            "with_rows": [p.name for p in self.predicates if p.kind == "program" and p.has_rows],
        }
        try:
            return compiled(request, Probing, stop=stop, limits=limits)
        except ProgramError as error:
            raise QueryError(f"{predicate} can't be taken apart: {error}") from None

    def predicate(self, name: str) -> Predicate | None:
        """The predicate of that name, or None."""
        return next((p for p in self.predicates if p.name == name), None)
