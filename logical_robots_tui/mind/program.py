"""Programs: Logica text, compiled."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError

if TYPE_CHECKING:
    import threading
    from collections.abc import Mapping

    from logical_robots_tui.mind.compilation import Report
    from logical_robots_tui.mind.limits import Limits

STEPS = "t_0_steps_of_"
"""The prefix of named queries with the steps of a recursion."""

TRUTH_MARK = "?"
"""The suffix of boolean fields in the result of a tuned query."""


@dataclass(frozen=True, slots=True)
class Predicate:
    """A predicate that the inspector can show.

    Attributes:
        name: As written in the program.
        kind: ``input`` (Sensor, Memory), ``program`` (defined in the text) or ``prelude``.
        line: Line of its first rule in the program's text, from 1, or None.
        has_rows: False for a function of its arguments, which has no rows of its own.
        reason: Why it has no rows, one sentence, or "".
        is_function: Whether it needs arguments.
    """

    name: str
    kind: Literal["input", "program", "prelude"]
    line: int | None
    has_rows: bool
    reason: str = ""
    is_function: bool = False


@dataclass(frozen=True, slots=True)
class Question:
    """A compiled question about a program.

    Attributes:
        text: The question as typed.
        sql: The query.
        gives: The kind of its rows: the ``rows`` of a predicate or of conditions, the single
            ``value`` of an expression, or the ``truth`` of conditions without variables.
        tuned: The same query for tuned tables, if it could be rewritten.
    """

    text: str
    sql: str
    gives: Literal["rows", "value", "truth"] = "rows"
    tuned: Tuned | None = None


@dataclass(frozen=True, slots=True)
class Tuned:
    """A query rewritten for tables with all robots' rows and with fields in columns.

    Attributes:
        sql: The query. Its parameters are the numbers of the first and the last visible row of
            ``Sensor``, then of ``Memory``.
        bounds: The number of these parameters.
        columns: For each table, the columns that are read besides ``id``.
        result: Names of the answer's columns, each with the fields of its record if the query
            returns them as separate columns, boolean ones with `TRUTH_MARK`; () if the
            answer needs no assembly.
        together: The query for all viewers at once, if each sees only its own sensor, or "". It has
            one more column, the viewer's number, and as last parameter the offset between the
            visible rows of ``Memory`` of successive viewers.
        together_alike: The same for viewers that all see the same memories, without that parameter.
        crowd: The first query and the two together for many robots, if they differ from those for
            few; else ().
    """

    sql: str
    bounds: int
    columns: Mapping[str, tuple[str, ...]]
    result: tuple[tuple[str, tuple[str, ...]], ...]
    together: str = ""
    together_alike: str = ""
    crowd: tuple[str, ...] = ()

    def for_crowd(self) -> Tuned:
        """Return the same for many robots."""
        if not self.crowd:
            return self
        one, together, alike = self.crowd
        return replace(self, sql=one, together=together, together_alike=alike, crowd=())

    def for_all(self, *, alike: bool) -> tuple[str, int]:
        """Return the query for all viewers, or "", and its number of parameters."""
        memories = 2 if alike else 3
        bounds = 2 + memories if "Memory" in self.columns else 2
        return self.together_alike if alike else self.together, bounds


@dataclass(frozen=True, slots=True)
class Settled:
    """A program's text with other values of its constants."""

    text: str


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
        needed: The predicates with rows that `Robot` uses, each after those that it uses itself;
            `Robot` is last.
        uses: For each of the program's predicates those that it mentions, including the game's
            and the prelude's, in order.
        recursions: For each recursive predicate its number of steps, and an SQL query for whether
            another step would change anything.
        tuned: The queries that could be rewritten for tuned tables, by predicate name; those of
            `recursions` by ``name + " grows"``.
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
        """Compile Logica text in a separate process. Blocks.

        Args:
            text: The program, or the programs of several teams as `join_teams` returns them.
            stop: Set it from another thread to cancel; takes effect within 0.1 s.
            limits: Limits for the text and for compiling it.
            report: Called with the number of compiled predicates and of all.

        Raises:
            ProgramError: The program has errors; holds diagnostics with line, column and hint, and
                the team.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import check_text, compiled

        def of_one(text: str) -> Program:
            check_text(text, limits)
            return compiled({"text": text}, Program, stop=stop, limits=limits, report=report)

        texts = split_teams(text)
        if texts is None:
            return of_one(text)
        parts = {}
        for team, part in texts.items():
            try:
                parts[team] = of_one(part)
            except ProgramError as error:
                error.team = team
                raise
        return TeamProgram.of(parts)

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
        from logical_robots_tui.mind.compilation import check_text, compiled

        check_text(text, limits)
        return compiled({"text": text, "constants": dict(values)}, Settled, limits=limits).text

    def question(
        self, query: str, *, stop: threading.Event | None = None, limits: Limits | None = None
    ) -> Question:
        """Compile a question about this program, for `Mind.ask`. Blocks.

        Args:
            query: A call, an expression, conditions, or rules, of which the last is queried.
            stop: Set it from another thread to cancel.
            limits: Limits for the text and for compiling it.

        Raises:
            ProgramError: The query has errors; the diagnostics refer to its lines and columns.
            Stopped: `stop` was set.
        """
        from logical_robots_tui.mind.compilation import check_text, compiled

        check_text(query, limits)
        columns = {
            table: sorted({n for t in self.tuned.values() for n in t.columns.get(table, ())})
            for table in ("Memory", "Item")
        }
        request = {"text": self.own.text, "query": query, "columns": columns}
        return compiled(request, Question, stop=stop, limits=limits)

    def predicate(self, name: str) -> Predicate | None:
        """Return the predicate of that name, or None."""
        return next((p for p in self.predicates if p.name == name), None)

    @property
    def own(self) -> Program:
        """The program without those of other teams."""
        return self

    @property
    def first(self) -> Program:
        """The program of the first team, without those of others."""
        return self

    def for_team(self, team: str) -> Program:
        """Return the program as a team's robots think with it; the same if all think alike."""
        return self


@dataclass(frozen=True, slots=True)
class TeamProgram(Program):
    """The programs of several teams; seen as a program, it is that of one of them.

    Attributes:
        text: All texts, as `join_teams` returns them.
        teams: The compiled programs by team, in the order of the teams.
        team: The team whose program it is seen as.
        views: The same for other teams, as far as they were needed.
    """

    teams: Mapping[str, Program] = field(default_factory=dict)
    team: str = ""
    views: dict[str, TeamProgram] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(cls, teams: Mapping[str, Program]) -> TeamProgram:
        """Return the programs of teams as one, seen as that of the first team."""
        text = join_teams({team: program.text for team, program in teams.items()})
        return cls(text, (), {}, teams=teams).for_team(next(iter(teams)))

    @property
    def own(self) -> Program:
        """The program of the team alone."""
        return self.teams[self.team]

    @property
    def first(self) -> Program:
        """The program of the first team alone."""
        return next(iter(self.teams.values()))

    def for_team(self, team: str) -> TeamProgram:
        """Return the program as a team's robots think with it; the same if it has no such team."""
        if team not in self.teams:
            return self
        if team not in self.views:
            part = self.teams[team]
            seen = {f.name: getattr(part, f.name) for f in fields(Program) if f.name != "text"}
            self.views[team] = replace(self, team=team, views=self.views, **seen)
        return self.views[team]


_TEAMS = "# teams: "


def join_teams(texts: Mapping[str, str]) -> str:
    """Return the texts of the teams' programs as one text, from which none can get at another.

    Args:
        texts: Logica texts by team. The text of "", which is no team, is returned as it is.
    """
    if "" in texts:
        return texts[""]
    lines = {team: text.count("\n") + 1 for team, text in texts.items()}
    return "\n".join([_TEAMS + json.dumps(lines), *texts.values()])


def split_teams(text: str) -> dict[str, str] | None:
    """Return the texts of the teams' programs by team, or None if the text is not that of teams."""
    head, _, rest = text.partition("\n")
    try:
        counts = json.loads(head.removeprefix(_TEAMS)) if head.startswith(_TEAMS) else None
    except ValueError:
        return None
    if not isinstance(counts, dict) or not counts:
        return None
    lines, texts = rest.split("\n"), {}
    for team, count in counts.items():
        if type(count) is not int or not 0 < count <= len(lines):
            return None
        texts[team] = "\n".join(lines[:count])
        lines = lines[count:]
    return None if lines else texts
