"""From Logica text to SQL with the `logica` package. Runs in the compile process only.

The package keeps global state, so one process compiles one program at a time.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, cast

from logica.compiler import dialects, functors, universe
from sqlglot import exp

from logical_robots_tui.language import error_messages, package_patches, tree
from logical_robots_tui.language.adapter import Raw, parse, to_package
from logical_robots_tui.language.checks import IGNORED, check
from logical_robots_tui.language.definitions import (
    Model,
    calls,
    column_labels,
    names_used,
    prelude,
    rules_of,
)
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError, most_important
from logical_robots_tui.language.expansion import expand_functors, expand_rows, spell_out
from logical_robots_tui.language.source_text import Prepared, prepare
from logical_robots_tui.language.tree import Annotation, Functor, Rule, Span, Statement
from logical_robots_tui.language.types import Kind, Plain, Tables, dump_kind
from logical_robots_tui.language.web import web_remarks
from logical_robots_tui.mind.compiling import fixpoint
from logical_robots_tui.mind.compiling.dialect import RobotDialect, runs
from logical_robots_tui.mind.compiling.duckdb_types import as_on_duckdb
from logical_robots_tui.mind.compiling.fixpoint import Fixpoint, fixpoints
from logical_robots_tui.mind.program import Predicate, Program
from logical_robots_tui.mind.tuning import MOST_TUNED
from logical_robots_tui.schema import INPUTS, MAIN, VALUE

if TYPE_CHECKING:
    from logical_robots_tui.mind.compilation import Report

_MAX_RECURSION = 200
_ALWAYS_USED = ("->", "`=`", "Arrow")  # by the package, too
_VISIBILITY = {"Memory": ("own", "seen", "all"), "Sensor": ("own", "all")}


def compile_text(text: str, report: Report | None = None) -> tuple[Program, dict[str, exp.Query]]:
    """Compile a program; return it and its statements' trees by text; raise ProgramError."""
    program, model, diagnostics = check_text(text)
    remaining = without_visibility(model)
    try:
        compiled = compile_statements(remaining.statements, model.source)
    except ProgramError as error:
        _refuse([*diagnostics, *error.diagnostics])
        raise
    statements, predicates, problems = _compile_predicates(
        compiled, remaining, report or (lambda _done, _all: None)
    )
    _refuse([*diagnostics, *problems])
    uses, rules = _uses(remaining), remaining.definitions
    needed = _order_needed(uses, statements)
    inputs = (Predicate(name, "input", None, has_rows=True) for name in INPUTS)
    kinds = {
        name: {column: dump_kind(kind) for column, kind in compiled.kinds[name].items()}
        for name in statements
    }
    program = replace(
        program,
        predicates=(*inputs, *sorted(predicates, key=lambda p: p.line or len(text))),
        statements=statements,
        needed=needed,
        uses=uses,
        truths={name: truths for name in statements if (truths := compiled.truths(name))},
        labels={name: labels for name in rules if (labels := column_labels(name, rules))},
        kinds=json.dumps(kinds),
        recursions=compiled.growth_checks({name: statements[name] for name in needed}),
    )
    return program, compiled.trees


def check_text(text: str) -> tuple[Program, Model, list[Diagnostic]]:
    """Check a program without compiling it; return it and its warnings; raise ProgramError."""
    parsed = parse(prepare(text))
    model = Model(parsed.statements, parsed.source, parsed.doubtful)
    diagnostics, mentions = check(model, parsed.problems, runs)
    visibility, visibility_problems = _visibility(model)
    _refuse([*diagnostics, *visibility_problems], parsed.excess)
    warnings, web = most_important(diagnostics), tuple(web_remarks(model))
    program = Program(text, (), {}, **visibility, warnings=warnings, web=web, mentions=mentions)
    return program, model, diagnostics


@lru_cache(maxsize=1)  # callers decompose one predicate after the other
def read_program(text: str) -> Model:
    """Return a program without the game's own annotations."""
    parsed = parse(prepare(text))
    return without_visibility(Model(parsed.statements, parsed.source))


def without_visibility(model: Model) -> Model:
    ignored = IGNORED | {"@Visible"}
    return Model((s for s in model.statements if s.name not in ignored), model.source)


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
            replace(statement, name="@With", arguments=statement.arguments[:1])
            if isinstance(statement, Annotation) and statement.name == "@Ground"
            else statement
            for statement in expanded
        ]
        spelled_out = spell_out(grounded, source)
        rules, names = Model(spelled_out).definitions, {*names_used(spelled_out), *_ALWAYS_USED}
        library = [r for r in prelude().rules if r.name in names and r.name not in rules]
        iterated, recursions = fixpoints([*spelled_out, *library])
        flags = {"logica_default_engine": "sqlite"}
        return RobotProgram(
            to_package(iterated, source), recursions, tables or {}, user_flags=flags
        )
    except error_messages.COMPLAINTS as error:
        problem = _baseless_recursion(error, Model(program, source))
        raise ProgramError((problem or error_messages.explain(error, source),)) from None


def _refuse(diagnostics: list[Diagnostic], omitted: int = 0) -> None:
    if any(problem.severity == "error" for problem in diagnostics):
        places = {(p.line, p.column) for p in diagnostics if p.severity == "error"}
        diagnostics = [
            p for p in diagnostics if p.severity == "error" or (p.line, p.column) not in places
        ]
        unique = {(p.line, p.column, p.message): p for p in diagnostics}.values()
        raise ProgramError(most_important(unique, omitted))


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
        super().__init__(rules, **options)

    def growth_checks(self, statements: Mapping[str, str]) -> dict[str, tuple[int, str]]:
        checks = {
            name: (steps, fixpoint.growth_check(statements[name], name, steps))
            for name, steps in self.steps.items()
            if name in statements
        }
        for recursion in self.fixpoints:
            if any(name in statements for name in recursion.names):
                growth_query = fixpoint.growth_query(recursion, self._step_queries)
                checks[recursion.names[0]] = (recursion.depth, growth_query)
        return {name: check for name, check in checks.items() if check[1]}

    def FormattedPredicateSql(self, name: str) -> str:
        """Return a predicate's SQL with DuckDB's types; raise the package's exceptions."""
        recursion = next((f for f in self.fixpoints if name in f.names), None)
        sql = recursion.all_rows(name) if recursion else super().FormattedPredicateSql(name)
        text, query_tree, self.kinds[name] = as_on_duckdb(
            fixpoint.with_fixpoints(sql, self._step_queries), self.tables
        )
        if query_tree is not None and sum(map(len, self.trees)) + len(text) <= MOST_TUNED:
            self.trees[text] = query_tree
        return text

    def truths(self, name: str) -> tuple[str, ...]:
        """Return the boolean columns of a predicate that was compiled."""
        kinds = self.kinds.get(name, {})
        return tuple(column for column, kind in kinds.items() if kind is Plain.TRUTH)

    def statements(self, names: Iterable[str]) -> dict[str, str]:
        """Return SQL for the rows of the predicates that can be computed alone."""
        statements = {}
        for name in names:
            with suppress(*error_messages.COMPLAINTS):
                statements[name] = self.FormattedPredicateSql(name).rstrip().removesuffix(";")
        return statements

    @cached_property
    def _step_queries(self) -> dict[Fixpoint, tuple[str, ...]]:
        compile_predicate = super().FormattedPredicateSql
        return {
            recursion: tuple(map(compile_predicate, recursion.step_predicates))
            for recursion in self.fixpoints
        }

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
            options["1"] = min(options.get("1", fixpoint.DEPTH), _MAX_RECURSION)
            self.steps[name] = options["1"]
        return cast("list[Raw]", unfolding.UnfoldRecursions(depths, False, fixpoint.DEPTH))


def _baseless_recursion(error: BaseException, model: Model) -> Diagnostic | None:
    if "nothing to start from" not in error_messages.plain_message(error):
        return None
    culprit = next((name for name in model.definitions if name in model.reach(name)), None)
    if culprit is None:
        return None
    message = f"The recursion of {culprit} has nothing to start from"
    return model.diagnostic(culprit, message, "Add a rule for it that does not use it.")


def _compile_predicates(
    compiled: RobotProgram, model: Model, report: Report
) -> tuple[dict[str, str], list[Predicate], list[Diagnostic]]:
    statements: dict[str, str] = {}
    predicates = []
    problems: list[Diagnostic] = []
    rules, unbound_variables = model.definitions, model.missing_parameters
    starts = {name: max(0, getattr(name, "start", 0)) for name in rules}
    for number, name in enumerate((MAIN, *(n for n in rules if n != MAIN))):
        report(number, len(rules))
        is_function = False
        try:
            reason = ""
            if name in unbound_variables:
                reason = error_messages.OPEN.format(name, unbound_variables[name])
            else:
                statements[name] = compiled.FormattedPredicateSql(name)
        except error_messages.COMPLAINTS as error:
            reason = error_messages.FUNCTION.format(name)
            heads = [rule.head if isinstance(rule, Rule) else rule for rule in rules[name]]
            unbound = error_messages.unbound_variables(error)
            is_function = (
                name != MAIN
                and error_messages.is_function(error)
                and tree.variables(heads, inside=True).issuperset(unbound)
            )
            if not is_function:
                reason = f"{name} can't be computed: {error_messages.plain_message(error)}"
                problems.append(explain(error, model))
        line = model.text.count("\n", 0, starts[name]) + 1
        predicates.append(Predicate(name, "program", line, not reason, reason, is_function))
    for name in prelude().definitions:
        if name not in rules and name.isidentifier():
            reason = error_messages.FUNCTION.format(name)
            predicates.append(Predicate(name, "prelude", None, has_rows=False, reason=reason))
    return statements, predicates, problems if MAIN not in statements else []


def _visibility(model: Model) -> tuple[dict[str, Any], list[Diagnostic]]:
    visibility: dict[str, Any] = {}
    problems = []
    for annotation in model.annotations:
        if annotation.name != "@Visible":
            continue
        name = "".join(tree.text_of(value) or "" for value in annotation.values[:1])
        if name in _VISIBILITY.get(annotation.subject, ()):
            visibility[annotation.subject.lower()] = name
        else:
            message = "This is not a visibility that robots can have"
            hint = 'Write @Visible(Memory, "own"), "seen" or "all", '
            hint += 'or @Visible(Sensor, "own") or "all".'
            problems.append(model.diagnostic(annotation.name, message, hint))
    return visibility, problems


def _uses(model: Model) -> dict[str, tuple[str, ...]]:
    library = (name for name in prelude().definitions if name.isidentifier())
    names = {*model.definitions, *INPUTS, *library}
    return {
        str(name): tuple(
            dict.fromkeys(
                str(used_name)
                for statement in rules
                for used_name in names_used(statement)
                if used_name in names and not (isinstance(statement, Functor) and used_name == name)
            )
        )
        for name, rules in model.definitions.items()
    }


def _order_needed(
    uses: Mapping[str, tuple[str, ...]], statements: Mapping[str, str]
) -> tuple[str, ...]:
    ordered: list[str] = []
    visited = set()

    def visit(name: str) -> None:
        if name in uses and name not in visited:
            visited.add(name)
            for used_name in uses[name]:
                visit(used_name)
            if name in statements:
                ordered.append(name)

    visit(MAIN)
    return tuple(ordered)


def explain(error: BaseException, model: Model) -> Diagnostic:
    """Return the diagnostic for an exception raised for a program that could be parsed."""
    diagnostic = error_messages.explain(error, model.source)
    names = error_messages.unbound_variables(error)
    start, _ = error_messages.rule_of(error, model.source)
    rule = next((r for r in model.rules if r.span and r.span.start <= start < r.span.stop), None)
    if not names or rule is None:
        return diagnostic
    name = diagnostic.excerpt if diagnostic.excerpt in names else names[0]
    rules_by_name = model.definitions
    program_calls = [call for call in calls(rule) if call.name in rules_by_name]
    if name not in tree.variables(rule, inside=True):
        for call in program_calls:
            heads = [callee_rule.head for callee_rule in rules_of(rules_by_name[call.name])]
            if name in tree.variables(heads, inside=True) and call.span:
                message = f"{call.name} needs a value for {name}"
                start = call.span.start
                place = Span(start, start + len(call.name))
                return model.diagnostic(place, message, "Add the missing argument.")
    elif separate := _separate_rules(names, rule, model):
        return separate
    elif isinstance(rule.body, tree.Disjunction):
        hint = "A '|' divides the whole body: put the alternatives in brackets, (a | b)."
        offset = next(n.span.start for n in _uses_of(name, rule) if n.span)
        message = f"{name} has no value in one of the alternatives"
        return model.diagnostic(Span(offset, offset + len(name)), message, hint)
    callees = [
        call.name
        for call in program_calls
        for value in tree.operands(call.arguments)
        if tree.variable_of(value) == name
    ]
    is_given_only = len(callees) == sum(1 for _ in _uses_of(name, rule.body or ()))
    if len({*callees}) == 1 and is_given_only and diagnostic.fix is None:
        callee = callees[0]
        hint = f"{callee} gives it no value: set it here, or in the rule of {callee}."
        return replace(diagnostic, hint=hint)
    return diagnostic


def _separate_rules(unbound: Sequence[str], rule: Rule, model: Model) -> Diagnostic | None:
    """Explain a parameter without a value; the package inlines only a single rule into callers."""
    rules = rules_of(model.definitions[rule.name])
    parameters = [column.value for column in rule.head.columns if column.field != VALUE]
    names = [name for value in parameters if (name := tree.variable_of(value)) in unbound]
    parts = [*tree.walk([r.body for r in rules if r.body])]
    computed = {tree.variable_of(s) for part in parts for s in tree.equation_sides(part) or ()}
    if rule.name == MAIN or not names or not {*unbound}.difference(names) <= computed:
        return None
    first, *uses = _uses_of(names[0], rule)
    tables = {*model.definitions, *INPUTS}
    sources = [
        part
        for part in parts
        if isinstance(part, tree.Membership)
        or (isinstance(part, tree.Atom) and part.name in tables)
    ]
    related: list[int] = []
    advice = f"Take {names[0]} from a predicate in the body."
    if len(rules) > 1:
        related = [model.text.count("\n", 0, r.span.start) + 1 for r in rules if r.span]
        *lines, last = map(str, related)
        cause = f"{rule.name} has {len(rules)} rules, in lines {', '.join(lines)} and {last}"
    elif rule.is_distinct:
        cause = f"{rule.name} is distinct"
    elif any(isinstance(part, tree.Disjunction) for part in parts) and (
        names[0] not in tree.variables(sources)
    ):
        cause = f"'|' makes several rules of {rule.name}"
    else:
        return None
    if not rule.is_distinct and not sources and computed.isdisjoint(names):
        merged = " = (if a then b else c)" if rule.value else " :- a || b"
        advice = f"Write one: {rule.name}(...){merged};"
    message = f"{names[0]} has no value: {cause}"
    hint = f"Callers give values only to a single rule that is not distinct. {advice}"
    if not uses or first.span is None:
        return None
    return replace(model.diagnostic(first.span, message, hint), related=tuple(related))


def _uses_of(name: str, part: tree.Tree) -> Iterator[tree.Variable]:
    return (n for n in tree.walk(part) if isinstance(n, tree.Variable) and n.name == name)


dialects.DIALECTS["sqlite"] = RobotDialect
package_patches.install()
