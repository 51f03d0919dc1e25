"""Programs: Logica text, compiled; queries about them, and the form of the answers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.language.diagnostics import Diagnostic, Mention, ProgramError
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.mind.compilation import Report
    from logical_robots_tui.mind.limits import Limits

Texts: TypeAlias = "Mapping[str, str]"
"""The programs of a run by team, as Logica texts; only that of "" if all robots think alike."""

STEPS = "t_0_steps_of_"
"""The prefix of named queries with the steps of a recursion."""

TRUTH_MARK = "?"
"""The suffix of boolean fields in the result of a tuned query."""


@dataclass(frozen=True, slots=True)
class Predicate:
    """A predicate that the inspector can show, on line `line` from 1.

    Attributes:
        kind: ``input`` (Sensor, Memory), ``program`` (defined in the text) or ``prelude``.
        reason: Why it has no rows of its own, one sentence, or "".
    """

    name: str
    kind: Literal["input", "program", "prelude"]
    line: int | None
    has_rows: bool
    reason: str = ""
    is_function: bool = False

    @property
    def is_listed(self) -> bool:
        """Whether lists name it: functions of the prelude never have rows to show."""
        return self.has_rows or self.kind != "prelude"


@dataclass(frozen=True, slots=True)
class CompiledQuery:
    """A compiled query about a program.

    It gives the ``rows`` of a predicate or of conditions, the ``value`` of an expression, or
    the ``truth`` of conditions without variables. `truths` names its boolean columns, `labels`
    has what columns are called where SQL has another name.
    """

    text: str
    sql: str
    gives: Literal["rows", "value", "truth"] = "rows"
    truths: tuple[str, ...] = ()
    labels: Mapping[str, str] = field(default_factory=dict)
    tuned: Tuned | None = None

    @property
    def reads_inputs(self) -> bool:
        """Whether its rows may depend on sensors or memories, and so on who is asked."""
        return _INPUTS.search(self.sql) is not None


_INPUTS = re.compile(r"\b(?:Sensor|Memory)\b", re.IGNORECASE)  # their tables are named so


@dataclass(frozen=True, slots=True)
class Tuned:
    """A query rewritten for tables with all robots' rows and with fields in columns.

    Attributes:
        sql: Its parameters, `bounds` in number, are the numbers of the first and the last
            visible row of ``Sensor``, then of ``Memory``.
        columns: The columns read of each table, besides ``id``.
        result: The answer's columns, each with the fields of its record if the query returns
            them separately, boolean ones with `TRUTH_MARK`; () if it needs no assembly.
        together: The query for all viewers, if each sees only its own sensor, or "". Its last
            column is the viewer's number, its last parameter the offset between the visible
            rows of ``Memory`` of successive viewers.
        together_alike: The same, without that parameter, if all see the same memories.
        crowd: The variants of all three for many robots, if they differ; else ().
    """

    sql: str
    bounds: int
    columns: Mapping[str, tuple[str, ...]]
    result: tuple[tuple[str, tuple[str, ...]], ...]
    together: str = ""
    together_alike: str = ""
    crowd: tuple[str, ...] = ()

    def for_crowd(self) -> Tuned:
        """Return the queries for many robots."""
        if not self.crowd:
            return self
        crowd_sql, together, alike = self.crowd
        return replace(self, sql=crowd_sql, together=together, together_alike=alike, crowd=())

    def for_all(self, *, alike: bool) -> tuple[str, int]:
        """Return the query for all viewers at once, or "", and the number of its parameters."""
        memories = 2 if alike else 3
        bounds = 2 + memories if "Memory" in self.columns else 2
        return self.together_alike if alike else self.together, bounds


@dataclass(frozen=True, slots=True)
class Program:
    """A compiled program; create one with `Program.compile`.

    Attributes:
        text: The Logica text.
        predicates: Inputs first, then the program's own in text order, then the prelude.
        statements: One SQL query per predicate with rows.
        memory: The visibility of memories that ``@Visible`` sets, or None.
        sensor: The visibility of sensors that ``@Visible`` sets, or None.
        warnings: Warnings, in text order.
        web: What would fail or mean something else on the web platform, in text order.
        mentions: The names that it compares with labels and robots' names, in text order.
        needed: The predicates with rows that `Robot` uses, each after those that it uses itself;
            `Robot` is last.
        uses: For each of the program's predicates those that it mentions, including the game's
            and the prelude's, in order.
        recursions: For each recursive predicate its number of steps, and an SQL query for whether
            another step would change anything.
        tuned: The queries that could be rewritten for tuned tables, by predicate name; those of
            `recursions` by ``name + " grows"``.
        truths: The boolean columns of predicates that have some.
        kinds: The predicates with rows, each with the types of its columns, as JSON.
        labels: What columns are called where SQL has another name, by predicate.
        team: The team whose program it is, or "" if all robots think with it.
        teams: The programs of all teams, in order; {} if all robots think with it.
    """

    text: str
    predicates: tuple[Predicate, ...]
    statements: Mapping[str, str]
    memory: Literal["own", "seen", "all"] | None = None
    sensor: Literal["own", "all"] | None = None
    warnings: tuple[Diagnostic, ...] = ()
    web: tuple[Diagnostic, ...] = ()
    mentions: tuple[Mention, ...] = ()
    needed: tuple[str, ...] = ()
    uses: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    recursions: Mapping[str, tuple[int, str]] = field(default_factory=dict)
    tuned: Mapping[str, Tuned] = field(default_factory=dict)
    truths: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    kinds: str = "{}"
    labels: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    team: str = ""
    teams: Mapping[str, Program] = field(default_factory=dict)

    @classmethod
    def compile(
        cls,
        text: str | Texts,
        *,
        stop: threading.Event | None = None,
        limits: Limits | None = None,
        report: Report | None = None,
    ) -> Program:
        """Compile Logica text in a separate process. Blocks.

        Args:
            text: The program, or the programs by team, of which it is the first.
            stop: Set it from another thread to cancel; takes effect within 0.1 s.
            limits: Limits for the text and for compiling it.
            report: Called with the number of compiled predicates and of all.

        Raises:
            ProgramError: The program has errors; holds diagnostics with line, column and hint, and
                the team.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import CompileProgram, check_text, compile_task

        teams: dict[str, Program] = {}
        for team, team_text in ({"": text} if isinstance(text, str) else text).items():
            try:
                check_text(team_text, limits)
                task = CompileProgram(team_text)
                teams[team] = compile_task(task, Program, stop=stop, limits=limits, report=report)
            except ProgramError as error:
                error.team = team
                raise
        first = next(iter(teams))
        return replace(teams[first], team=first, teams=teams) if first else teams[first]

    @classmethod
    def check(cls, text: str, limits: Limits | None = None) -> Program:
        """Check Logica text without compiling it, a tenth of the work. Blocks.

        The program that it returns has warnings and mentions, but no statements.

        Args:
            text: The program.
            limits: Limits for the text and for checking it.

        Raises:
            ProgramError: The program has errors; compiling it may find others.
        """
        from logical_robots_tui.mind.compilation import CheckProgram, check_text, compile_task

        check_text(text, limits)
        return compile_task(CheckProgram(text), cls, limits=limits)

    @staticmethod
    def with_constants(text: str, values: Mapping[str, str], limits: Limits | None = None) -> str:
        """Return the text of a program with other values of its constants. Blocks.

        A constant is a rule such as ``Near() = 40;``. It is replaced in the parsed program; the
        rest of the text stays as it is.

        Args:
            text: The program.
            values: Logica expressions by the constants' names.
            limits: Limits for the text and for parsing it.

        Raises:
            ProgramError: The program has errors, or a name is not that of a constant.
        """
        from logical_robots_tui.mind.compilation import SetConstants, check_text, compile_task

        check_text(text, limits)
        return compile_task(SetConstants(text, dict(values)), str, limits=limits)

    def question(
        self, query: str, *, stop: threading.Event | None = None, limits: Limits | None = None
    ) -> CompiledQuery:
        """Compile a question about this program, for `Mind.ask`. Blocks.

        Args:
            query: A call, an expression, conditions, or rules, of which the last is queried.
            stop: Set it from another thread to cancel.
            limits: Limits for the text and for compiling it.

        Raises:
            ProgramError: The query has errors; the diagnostics refer to its lines and columns.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import CompileQuestion, check_text, compile_task

        check_text(query, limits)
        columns = {
            table: sorted({n for t in self.tuned.values() for n in t.columns.get(table, ())})
            for table in ("Memory", "Item")
        }
        task = CompileQuestion(self.text, query, columns)
        return compile_task(task, CompiledQuery, stop=stop, limits=limits)

    def predicate(self, name: str) -> Predicate | None:
        """Return the predicate of that name, or None."""
        return next((p for p in self.predicates if p.name == name), None)

    def label(self, predicate: str, column: str) -> str:
        """Return a column's name; a positional column is named by its number."""
        label = self.labels.get(predicate, {}).get(column, column)
        is_place = label == column and column[:3] == "col" and column[3:].isdigit()
        return f"argument {int(column[3:]) + 1}" if is_place else label

    @property
    def texts(self) -> Texts:
        """What the robots think with."""
        return {team: program.text for team, program in self.teams.items()} or {"": self.text}

    @property
    def first(self) -> Program:
        """The same as the program of the first team, which is the player's."""
        return self.for_team(next(iter(self.teams), ""))

    def for_team(self, team: str) -> Program:
        """Return the same as the program of another team, if there is that team."""
        if team == self.team or team not in self.teams:
            return self
        return replace(self.teams[team], team=team, teams=self.teams)


@dataclass(frozen=True, slots=True)
class ResultTable:
    """Rows of a predicate; records are dicts, lists are lists.

    Attributes:
        viewers: For each row the robot in whose mind it holds; () if all think alike.
        truncated: Whether further rows were left out.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]
    viewers: tuple[str, ...] = ()
    truncated: bool = False

    def in_mind_of(self, robot: str | None) -> ResultTable:
        """Return the rows in one robot's mind; all if no robot is named, or if all think alike."""
        if not robot or not self.viewers:
            return self
        return self.select([n for n, viewer in enumerate(self.viewers) if viewer == robot])

    def select(self, numbers: Collection[int]) -> ResultTable:
        """Return the rows with some numbers, in their order."""
        viewers = tuple(self.viewers[n] for n in numbers) if self.viewers else ()
        return replace(self, rows=tuple(self.rows[n] for n in numbers), viewers=viewers)

    def once(self) -> ResultTable:
        """Return rows that name a robot once if they are equal but for their viewer.

        They are in that robot's mind if it is among the viewers; if all are, no viewers are given.
        """
        if not self.viewers or "robot_name" not in self.columns:
            return self
        names = [row[self.columns.index("robot_name")] for row in self.rows]
        counts, numbers = Counter[tuple[str, str]](), dict[tuple[str, int], int]()
        for number, (row, viewer) in enumerate(zip(self.rows, self.viewers, strict=True)):
            text = repr(row)
            counts[text, viewer] += 1
            key = text, counts[text, viewer]
            numbers[key] = number if viewer == names[number] else numbers.get(key, number)
        table = self.select(numbers.values())
        is_own = all(self.viewers[number] == names[number] for number in numbers.values())
        return replace(table, viewers=()) if is_own else table


@dataclass(frozen=True, slots=True)
class QueryPlan:
    """How a predicate is computed at a moment, for one robot or for all that think alike.

    Attributes:
        tuned: The tuned SQL that is run instead of `generated`, or "".
        plan: SQLite's plan for the SQL that is run, one indented step per line.
        milliseconds: The time for all robots together.
    """

    predicate: str
    generated: str
    tuned: str
    plan: tuple[str, ...]
    milliseconds: float
