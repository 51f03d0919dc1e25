"""From Logica text to SQL with the `logica` package. Runs in the compile process only.

The package keeps global state, so one process compiles one program at a time.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

from logica.compiler import dialects, functors, universe
from sqlglot import exp

from logical_robots_tui.language import error_messages, package_patches, tree
from logical_robots_tui.language.adapter import Raw, parse, to_package
from logical_robots_tui.language.checks import IGNORED, check
from logical_robots_tui.language.definitions import (
    column_labels,
    definitions,
    missing_parameters,
    names_used,
    prelude,
    reach,
    rules_of,
)
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError, most_important
from logical_robots_tui.language.expansion import expand_functors, expand_rows, spell_out
from logical_robots_tui.language.source_text import Prepared, diagnostic_at, diagnostic_for, prepare
from logical_robots_tui.language.tree import Annotation, Functor, Rule, Statement
from logical_robots_tui.language.types import Kind, Plain, Tables, dump_kind
from logical_robots_tui.language.web import web_remarks
from logical_robots_tui.mind.compiling import fixpoint
from logical_robots_tui.mind.compiling.dialect import RobotDialect, runs
from logical_robots_tui.mind.compiling.duckdb_types import as_on_duckdb
from logical_robots_tui.mind.compiling.fixpoint import Fixpoint, fixpoints
from logical_robots_tui.mind.program import Predicate, Program
from logical_robots_tui.mind.tuning import MOST_TUNED
from logical_robots_tui.schema import INPUTS, MAIN

if TYPE_CHECKING:
    from logical_robots_tui.mind.compilation import Report

_DEEPEST_RECURSION = 200
_ALWAYS_USED = ("->", "`=`", "Arrow")  # by the package, too
_VISIBILITY = {"Memory": ("own", "seen", "all"), "Sensor": ("own", "all")}


def compile_text(text: str, report: Report | None = None) -> tuple[Program, dict[str, exp.Query]]:
    """Compile a program; return it and its statements' trees by text; raise ProgramError."""
    source = prepare(text)
    parsed = parse(source)
    found, mentions = check(parsed, text, runs)
    rest, visibility, invalid = _take_visibility(parsed.statements, text)
    _refuse([*found, *invalid], parsed.excess)
    try:
        compiled = compile_statements(rest, source)
    except ProgramError as error:
        _refuse([*found, *error.diagnostics])
        raise
    statements, predicates, problems = _compile_predicates(
        compiled, rest, source, report or (lambda _done, _all: None)
    )
    _refuse([*found, *problems])
    uses, own = _uses(rest), definitions(rest)
    needed = _order_needed(uses, statements)
    inputs = (Predicate(name, "input", None, has_rows=True) for name in INPUTS)
    kinds = {
        name: {column: dump_kind(kind) for column, kind in compiled.kinds[name].items()}
        for name in statements
    }
    program = Program(
        text,
        (*inputs, *sorted(predicates, key=lambda p: p.line or len(text))),
        statements,
        **visibility,
        warnings=most_important(found),
        web=tuple(web_remarks(parsed.statements, source.original)),
        mentions=mentions,
        needed=needed,
        uses=uses,
        truths={name: truths for name in statements if (truths := compiled.truths(name))},
        labels={name: labels for name in own if (labels := column_labels(name, own))},
        kinds=json.dumps(kinds),
        recursions=compiled.growth_checks({name: statements[name] for name in needed}),
    )
    return program, compiled.trees


@lru_cache(maxsize=1)  # callers decompose one predicate after the other
def read_program(text: str) -> tuple[Prepared, tuple[Statement, ...]]:
    """Return the prepared text of a program, and its statements without the game's own."""
    source = prepare(text)
    return source, tuple(without_visibility(parse(source).statements, text))


def without_visibility(program: Sequence[Statement], text: str) -> list[Statement]:
    """Return the statements of a program without the game's own annotations."""
    return _take_visibility(program, text)[0]


def compile_statements(
    program: Sequence[Statement], source: Prepared, tables: Tables | None = None
) -> RobotProgram:
    """Return the package's program for some statements and the prelude.

    `tables` are those that the statements may read besides the inputs.

    Raises:
        ProgramError: They can't be compiled.
    """
    try:
        expanded = expand_rows(expand_functors([*program]))
        # A grounded predicate is computed once per query instead of in a table.
        grounded = [
            replace(each, name="@With", arguments=each.arguments[:1])
            if isinstance(each, Annotation) and each.name == "@Ground"
            else each
            for each in expanded
        ]
        spelled = spell_out(grounded, source)
        own, used = definitions(spelled), {*names_used(spelled), *_ALWAYS_USED}
        library = [rule for rule in prelude() if rule.name in used and rule.name not in own]
        iterated, found = fixpoints([*spelled, *library])
        flags = {"logica_default_engine": "sqlite"}
        return RobotProgram(to_package(iterated, source), found, tables or {}, user_flags=flags)
    except error_messages.COMPLAINTS as error:
        problem = _endless(error, program, source.original)
        raise ProgramError((problem or error_messages.explain(error, source),)) from None


def _refuse(found: list[Diagnostic], more: int = 0) -> None:
    if any(problem.severity == "error" for problem in found):
        wrong = {(p.line, p.column) for p in found if p.severity == "error"}
        found = [p for p in found if p.severity == "error" or (p.line, p.column) not in wrong]
        unique = {(p.line, p.column, p.message): p for p in found}.values()
        raise ProgramError(most_important(unique, more))


class RobotProgram(universe.LogicaProgram):  # type: ignore[misc]  # the package has no types
    """The package's program, as single queries that create no tables."""

    def __init__(
        self, rules: list[Raw], fixpoints: list[Fixpoint], tables: Tables, **options: Any
    ) -> None:
        self.tables = tables
        self.steps: dict[str, int] = {}
        self.fixpoints = fixpoints
        self.trees: dict[str, exp.Query] = {}  # by statement
        self.kinds: dict[str, Mapping[str, Kind]] = {}  # of columns, by predicate
        self._step_queries: dict[Fixpoint, tuple[str, ...]] = {}
        super().__init__(rules, **options)

    def growth_checks(self, statements: Mapping[str, str]) -> dict[str, tuple[int, str]]:
        checks = {
            name: (steps, fixpoint.growth_check(statements[name], name, steps))
            for name, steps in self.steps.items()
            if name in statements
        }
        for each in self.fixpoints:
            if any(name in statements for name in each.names):
                grows = fixpoint.grows(each, self._steps())
                checks[each.names[0]] = (each.depth, grows)
        return {name: check for name, check in checks.items() if check[1]}

    def FormattedPredicateSql(self, name: str) -> str:
        """Return a predicate's SQL with DuckDB's types; raise the package's exceptions."""
        iterated = next((each for each in self.fixpoints if name in each.names), None)
        sql = iterated.all_rows(name) if iterated else super().FormattedPredicateSql(name)
        text, read, self.kinds[name] = as_on_duckdb(
            fixpoint.with_fixpoints(sql, self._steps()), self.tables
        )
        if read is not None and sum(map(len, self.trees)) + len(text) <= MOST_TUNED:
            self.trees[text] = read
        return text

    def truths(self, name: str) -> tuple[str, ...]:
        """Return the boolean columns of a predicate that was compiled."""
        kinds = self.kinds.get(name, {})
        return tuple(column for column, kind in kinds.items() if kind is Plain.TRUTH)

    def statements(self, wanted: Iterable[str]) -> dict[str, str]:
        """Return SQL for the rows of those predicates that can be computed alone."""
        found = {}
        for name in wanted:
            with suppress(*error_messages.COMPLAINTS):
                found[name] = self.FormattedPredicateSql(name).rstrip().removesuffix(";")
        return found

    def _steps(self) -> dict[Fixpoint, tuple[str, ...]]:
        if not self._step_queries:
            compiled = super().FormattedPredicateSql
            self._step_queries = {each: tuple(map(compiled, each.asked)) for each in self.fixpoints}
        return self._step_queries

    def UnfoldRecursion(self, rules: list[Raw]) -> list[Raw]:
        """Unroll every recursion in place; the package would repeat statements."""
        annotations = universe.Annotations(rules, {"logica_default_engine": "sqlite"})
        depths: dict[str, Any] = annotations.annotations.get("@Recursive", {})
        for options in depths.values():
            options.pop("stop", None)
            if options.get("1") == -1:
                options["1"] = fixpoint.DEPTH
        unfolding = functors.Functors(rules)
        recursive, _ = unfolding.RecursiveAnalysis(depths, False, fixpoint.DEPTH)
        for name in recursive:
            options = depths.setdefault(name, {})
            options["iterative"] = False
            options["1"] = min(options.get("1", fixpoint.DEPTH), _DEEPEST_RECURSION)
            self.steps[name] = options["1"]
        return cast("list[Raw]", unfolding.UnfoldRecursions(depths, False, fixpoint.DEPTH))


def _endless(error: BaseException, program: Sequence[Statement], text: str) -> Diagnostic | None:
    if "nothing to start from" not in error_messages.plain_message(error):
        return None
    own = definitions(program)
    culprit = next((name for name, rules in own.items() if name in reach(rules, own)), None)
    if culprit is None:
        return None
    message = f"The recursion of {culprit} has nothing to start from"
    return diagnostic_for(text, culprit, message, "Add a rule for it that does not use it.")


def _compile_predicates(
    compiled: RobotProgram, program: Sequence[Statement], source: Prepared, report: Report
) -> tuple[dict[str, str], list[Predicate], list[Diagnostic]]:
    statements: dict[str, str] = {}
    predicates = []
    problems: list[Diagnostic] = []
    own, left_open = definitions(program), missing_parameters(program)
    starts = {name: max(0, getattr(name, "start", 0)) for name in own}
    for done, name in enumerate((MAIN, *(n for n in own if n != MAIN))):
        report(done, len(own))
        is_function = False
        try:
            reason = error_messages.OPEN.format(name, left_open[name]) if name in left_open else ""
            if not reason:
                statements[name] = compiled.FormattedPredicateSql(name)
        except error_messages.COMPLAINTS as error:
            reason = error_messages.FUNCTION.format(name)
            heads = [each.head if isinstance(each, Rule) else each for each in own[name]]
            lacking_ones = error_messages.unbound_variables(error)
            is_function = (
                name != MAIN
                and error_messages.is_function(error)
                and tree.variables(heads, inside=True).issuperset(lacking_ones)
            )
            if not is_function:
                reason = f"{name} can't be computed: {error_messages.plain_message(error)}"
                problems.append(explain(error, source, program))
        line = source.original.count("\n", 0, starts[name]) + 1
        predicates.append(Predicate(name, "program", line, not reason, reason, is_function))
    for name in definitions(prelude()):
        if name not in own and name.isidentifier():
            reason = error_messages.FUNCTION.format(name)
            predicates.append(Predicate(name, "prelude", None, has_rows=False, reason=reason))
    return statements, predicates, problems if MAIN not in statements else []


def _take_visibility(
    program: Sequence[Statement], text: str
) -> tuple[list[Statement], dict[str, Any], list[Diagnostic]]:
    visibility: dict[str, Any] = {}
    rest: list[Statement] = []
    problems = []
    for each in program:
        if not isinstance(each, Annotation) or each.name != "@Visible":
            if each.name not in IGNORED:
                rest.append(each)
            continue
        wanted = "".join(tree.text_of(value) or "" for value in each.values[:1])
        if wanted in _VISIBILITY.get(each.subject, ()):
            visibility[each.subject.lower()] = wanted
        else:
            message = "This is not a visibility that robots can have"
            hint = 'Write @Visible(Memory, "own"), "seen" or "all", '
            hint += 'or @Visible(Sensor, "own") or "all".'
            problems.append(diagnostic_for(text, each.name, message, hint))
    return rest, visibility, problems


def _uses(program: Sequence[Statement]) -> dict[str, tuple[str, ...]]:
    own = definitions(program)
    library = (name for name in definitions(prelude()) if name.isidentifier())
    known = {*own, *INPUTS, *library}
    return {
        str(name): tuple(
            dict.fromkeys(
                str(other)
                for statement in mine
                for other in names_used(statement)
                if other in known and not (isinstance(statement, Functor) and other == name)
            )
        )
        for name, mine in own.items()
    }


def _order_needed(
    uses: Mapping[str, tuple[str, ...]], statements: Mapping[str, str]
) -> tuple[str, ...]:
    ordered: list[str] = []
    seen = set()

    def visit(name: str) -> None:
        if name in uses and name not in seen:
            seen.add(name)
            for other in uses[name]:
                visit(other)
            if name in statements:
                ordered.append(name)

    visit(MAIN)
    return tuple(ordered)


def explain(error: BaseException, source: Prepared, program: Sequence[Statement]) -> Diagnostic:
    """Return the diagnostic for an exception raised for a program that could be parsed."""
    found = error_messages.explain(error, source)
    names = error_messages.unbound_variables(error)
    start, _ = error_messages.rule_of(error, source)
    rules = (each for each in program if isinstance(each, Rule))
    rule = next((r for r in rules if r.span and r.span.start <= start < r.span.stop), None)
    if not names or rule is None:
        return found
    name = found.excerpt if found.excerpt in names else names[0]
    own = definitions(program)
    called = [n for n in tree.walk(rule) if isinstance(n, tree.Atom | tree.Call) and n.name in own]
    if name not in tree.variables(rule, inside=True):
        for each in called:
            heads = [other.head for other in rules_of(own[each.name])]
            if name in tree.variables(heads, inside=True) and each.span:
                message = f"{each.name} needs a value for {name}"
                hint, length = "Add the missing argument.", len(each.name)
                return diagnostic_at(source.original, each.span.start, length, message, hint)
    elif isinstance(rule.body, tree.Disjunction):
        hint = "A '|' divides the whole body: put the alternatives in brackets, (a | b)."
        at = next(n.span.start for n in _uses_of(name, rule) if n.span)
        message = f"{name} has no value in one of the alternatives"
        return diagnostic_at(source.original, at, len(name), message, hint)
    takers = [
        e.name for e in called for v in tree.operands(e.arguments) if tree.variable_of(v) == name
    ]
    is_given_only = len(takers) == sum(1 for _ in _uses_of(name, rule.body or ()))
    if len({*takers}) == 1 and is_given_only and not found.hint.startswith("Did you mean"):
        taker = takers[0]
        hint = f"{taker} gives it no value: set it here, or in the rule of {taker}."
        return replace(found, hint=hint)
    return found


def _uses_of(name: str, part: tree.Tree) -> Iterator[tree.Variable]:
    return (n for n in tree.walk(part) if isinstance(n, tree.Variable) and n.name == name)


dialects.DIALECTS["sqlite"] = RobotDialect
package_patches.install()
