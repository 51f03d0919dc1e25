"""From Logica text to SQL with the `logica` package. Runs in the compile process only.

The package keeps global state, so one process compiles one program at a time.
"""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

from logica.compiler import dialects, functors, universe

from logical_robots_tui.mind.checking import error_messages
from logical_robots_tui.mind.checking.checks import IGNORED, check
from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.clauses.functors import recursions_written_out
from logical_robots_tui.mind.compiling import package_patches
from logical_robots_tui.mind.compiling.dialect import RobotDialect
from logical_robots_tui.mind.compiling.fixpoint import (
    Fixpoint,
    fixpoints,
    grows,
    growth_check,
    with_fixpoints,
)
from logical_robots_tui.mind.compiling.parsing import parse_statements, rewritten
from logical_robots_tui.mind.compiling.rules import (
    Rule,
    called,
    defined,
    head_name,
    heads,
    lacking,
    nodes,
    prelude_rules,
    reached,
    subject,
    text_of,
    value_of,
)
from logical_robots_tui.mind.compiling.spelling import spell_out, written_out
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.mind.program import INPUTS, Predicate, Program
from logical_robots_tui.mind.source_text import Prepared, diagnostic_for, prepare
from logical_robots_tui.mind.tuning import MOST_TUNED
from logical_robots_tui.mind.typed import as_on_duckdb

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sqlglot import exp

    from logical_robots_tui.mind.compilation import Report

_RECURSION_DEPTH = 32  # as on DuckDB; the package's SQLite default is 8
_DEEPEST_RECURSION = 200
_MOST_STEPS = 1_000  # of a recursion that is not unrolled
_VISIBILITY = {"Memory": ("own", "seen", "all"), "Sensor": ("own", "all")}
_MOST_DIAGNOSTICS = 25


def compile_text(text: str, report: Report | None = None) -> tuple[Program, dict[str, exp.Query]]:
    """Compile a program and all its predicates.

    Returns:
        The program, and the trees of its statements by their texts.

    Raises:
        ProgramError: The program has errors; holds all that can be found at once.
    """
    source = prepare(text)
    parsed = parse_statements(source)
    found = check(parsed, text)
    raw, visibility, invalid = _take_visibility(parsed.rules, text)
    _refuse([*found, *invalid])
    compiled = compiled_rules(raw, source)
    statements, predicates, problems = _compile_predicates(
        compiled, raw, source, report or (lambda _done, _all: None)
    )
    _refuse([*found, *problems])
    uses = _uses(raw)
    needed = _needed(uses, statements)
    inputs = tuple(Predicate(name, "input", None, has_rows=True) for name in INPUTS)
    program = Program(
        text,
        (*inputs, *sorted(predicates, key=lambda p: p.line or len(text))),
        statements,
        **visibility,
        warnings=tuple(found),
        needed=needed,
        uses=uses,
        recursions=compiled.growth_checks({name: statements[name] for name in needed}),
    )
    return program, compiled.trees


def read_rules(text: str) -> tuple[Prepared, list[Rule]]:
    """Return the prepared text of a program and its rules as written.

    The last result is cached, because callers decompose one predicate after the other.
    """
    source, rules = _read(text)
    return source, package_patches.deep_copy(rules)


@lru_cache(maxsize=1)
def _read(text: str) -> tuple[Prepared, list[Rule]]:
    source = prepare(text)
    return source, plain_rules(parse_statements(source).rules, text)


def plain_rules(rules: list[Rule], text: str) -> list[Rule]:
    """Return the rules of a program without the game's own annotations."""
    return _take_visibility(rules, text)[0]


def compiled_rules(rules: list[Rule], source: Prepared) -> RobotProgram:
    """Return the package's program for some rules and the prelude.

    Raises:
        ProgramError: They can't be compiled.
    """
    try:
        written = rewritten(recursions_written_out(rules))
        written_out(written)
        spell_out(written, source.original)
        return RobotProgram(_with_prelude(written), user_flags={"logica_default_engine": "sqlite"})
    except error_messages.COMPLAINTS as error:
        raise ProgramError(
            (_endless(error, rules, source.original) or error_messages.explain(error, source),)
        ) from None


def statements_of(wanted: list[str], rules: list[Rule], source: Prepared) -> dict[str, str]:
    """Return SQL for the rows of those predicates that can be computed alone.

    Raises:
        ProgramError: The rules can't be compiled.
    """
    compiled = compiled_rules(rules, source)
    found = {}
    for name in wanted:
        with suppress(*error_messages.COMPLAINTS):
            found[name] = compiled.FormattedPredicateSql(name).rstrip().removesuffix(";")
    return found


def _refuse(found: list[Diagnostic]) -> None:
    """Raise an error if there is one among the diagnostics."""
    if any(problem.severity == "error" for problem in found):
        wrong = {(p.line, p.column) for p in found if p.severity == "error"}
        found = [p for p in found if p.severity == "error" or (p.line, p.column) not in wrong]
        unique = {(p.line, p.column, p.message): p for p in found}.values()
        found = sorted(unique, key=lambda p: (p.severity, p.line, p.column))[:_MOST_DIAGNOSTICS]
        raise ProgramError(tuple(sorted(found, key=lambda p: (p.line, p.column))))


class RobotProgram(universe.LogicaProgram):  # type: ignore[misc]  # the package has no types
    """The package's program, as single queries that create no tables."""

    def __init__(self, rules: list[Rule], **options: Any) -> None:
        self.steps: dict[str, int] = {}
        self.fixpoints: list[Fixpoint] = []
        self.trees: dict[str, exp.Query] = {}  # by statement
        self._step_queries: dict[Fixpoint, str] = {}
        super().__init__(rules, **options)

    def growth_checks(self, statements: Mapping[str, str]) -> dict[str, tuple[int, str]]:
        """Return each recursive predicate's steps, and a query for whether more would matter."""
        checks = {
            name: (steps, growth_check(statements[name], name, steps))
            for name, steps in self.steps.items()
            if name in statements
        }
        for fixpoint in self.fixpoints:
            if fixpoint.name in statements:
                checks[fixpoint.name] = (fixpoint.depth, grows(fixpoint, self._steps()))
        return {name: check for name, check in checks.items() if check[1]}

    def FormattedPredicateSql(self, name: str) -> str:
        """Return the SQL of a predicate, with DuckDB's types.

        Raises:
            Exception: The package's exceptions, if it can't be compiled.
        """
        if any(fixpoint.name == name for fixpoint in self.fixpoints):
            sql = f"SELECT * FROM {name}"  # noqa: S608 - a name
        else:
            sql = super().FormattedPredicateSql(name)
        text, tree = as_on_duckdb(with_fixpoints(sql, self._steps()))
        if tree is not None and sum(map(len, self.trees)) + len(text) <= MOST_TUNED:
            self.trees[text] = tree
        return text

    def _steps(self) -> dict[Fixpoint, str]:
        """Return the query for a step of each recursion that is computed by iterating."""
        if not self._step_queries:
            self._step_queries = {
                fixpoint: super(RobotProgram, self).FormattedPredicateSql(fixpoint.step)
                for fixpoint in self.fixpoints
            }
        return self._step_queries

    def UnfoldRecursion(self, rules: list[Rule]) -> list[Rule]:
        """Unroll every recursion in place; the package would repeat statements."""
        annotations = universe.Annotations(rules, {"logica_default_engine": "sqlite"})
        depths: dict[str, Any] = annotations.annotations.get("@Recursive", {})
        for options in depths.values():
            options.pop("stop", None)
            if options.get("1") == -1:
                options["1"] = _RECURSION_DEPTH
        rules, self.fixpoints = fixpoints(
            rules, lambda name: min(depths.get(name, {}).get("1", _RECURSION_DEPTH), _MOST_STEPS)
        )
        for fixpoint in self.fixpoints:
            depths.pop(fixpoint.name, None)
        unfolding = functors.Functors(rules)
        recursive, _ = unfolding.RecursiveAnalysis(depths, False, _RECURSION_DEPTH)
        for name in recursive:
            options = depths.setdefault(name, {})
            options["iterative"] = False
            options["1"] = min(options.get("1", _RECURSION_DEPTH), _DEEPEST_RECURSION)
            self.steps[name] = options["1"]
        return cast("list[Rule]", unfolding.UnfoldRecursions(depths, False, _RECURSION_DEPTH))


def _endless(error: BaseException, raw: list[Rule], text: str) -> Diagnostic | None:
    """Return the diagnostic for a recursion without a start, at the predicate that is recursive."""
    if "nothing to start from" not in error_messages.plain_message(error):
        return None
    own = heads(raw)
    culprit = next((name for name, rules in own.items() if name in reached(rules, own)), None)
    if culprit is None:
        return None
    message = f"the recursion of {culprit} has nothing to start from"
    return diagnostic_for(text, culprit, message, "Add a rule of it that does not mention itself.")


def _compile_predicates(
    compiled: RobotProgram, raw: list[Rule], source: Prepared, report: Report
) -> tuple[dict[str, str], list[Predicate], list[Diagnostic]]:
    """Return SQL by predicate, all predicates, and the errors if `Robot` can't be compiled."""
    statements: dict[str, str] = {}
    predicates = []
    problems: list[Diagnostic] = []
    own = heads(raw)
    names = {name: name for name in own}
    left_open = lacking(raw)
    for done, name in enumerate((MAIN, *(n for n in own if n != MAIN))):
        report(done, len(own))
        is_function = False
        try:
            reason = error_messages.OPEN.format(name, left_open[name]) if name in left_open else ""
            if not reason:
                statements[name] = compiled.FormattedPredicateSql(name)
        except error_messages.COMPLAINTS as error:
            reason = error_messages.FUNCTION.format(name)
            is_function = name != MAIN and _lacks_arguments(error, own[name])
            if not is_function:
                reason = f"{name} can't be computed: {error_messages.plain_message(error)}"
                problems.append(error_messages.explain(error, source))
        line = source.original.count("\n", 0, getattr(names[name], "start", 0)) + 1
        predicates.append(Predicate(name, "program", line, not reason, reason, is_function))
    for name in dict.fromkeys(head_name(r) for r in prelude_rules()):
        if name not in own and name.isidentifier():
            reason = error_messages.FUNCTION.format(name)
            predicates.append(Predicate(name, "prelude", None, has_rows=False, reason=reason))
    return statements, predicates, problems if MAIN not in statements else []


def _with_prelude(rules: list[Rule]) -> list[Rule]:
    """Return the rules and those of the prelude that the program does not define."""
    own = set(defined(rules))
    added = [r for r in prelude_rules() if head_name(r) not in own]
    return [*(_ground_in_query(r) for r in rules), *package_patches.deep_copy(added)]


def _ground_in_query(rule: Rule) -> Rule:
    """Compute a grounded predicate once per query instead of in a table."""
    if head_name(rule) != "@Ground":
        return rule
    rule = package_patches.deep_copy(rule)
    rule["head"]["predicate_name"] = "@With"
    rule["head"]["record"]["field_value"] = rule["head"]["record"]["field_value"][:1]
    return rule


def _take_visibility(
    rules: list[Rule], text: str
) -> tuple[list[Rule], dict[str, Any], list[Diagnostic]]:
    """Separate ``@Visible``, which the package does not know, and annotations without effect."""
    visibility: dict[str, Any] = {}
    rest = []
    problems = []
    for rule in rules:
        if head_name(rule) != "@Visible":
            if head_name(rule) not in IGNORED:
                rest.append(rule)
            continue
        values = [value_of(fv) or {} for fv in rule["head"]["record"]["field_value"]]
        of, wanted = subject(rule), "".join(text_of(value) or "" for value in values[1:2])
        if wanted in _VISIBILITY.get(of, ()):
            visibility[of.lower()] = wanted
        else:
            message = "this is not a visibility that robots can have"
            hint = (
                'Write @Visible(Memory, "own"), "seen" or "all", or '
                '@Visible(Sensor, "own") or "all".'
            )
            problems.append(diagnostic_for(text, head_name(rule), message, hint))
    return rest, visibility, problems


def _lacks_arguments(error: BaseException, rules: list[Rule]) -> bool:
    """Return whether a predicate can't be computed only because it is a function."""
    arguments = {
        node["variable"]["var_name"]
        for rule in rules
        for node in nodes(rule["head"]["record"])
        if "variable" in node
    }
    names = error_messages.unassigned(error)
    return error_messages.is_function(error) and arguments.issuperset(names)


def _uses(rules: list[Rule]) -> dict[str, tuple[str, ...]]:
    """Return for each of the program's predicates those that it mentions, in order."""
    own = heads(rules)
    library = (name for name in map(head_name, prelude_rules()) if name.isidentifier())
    known = {*own, *INPUTS, *library}
    return {
        str(name): tuple(
            dict.fromkeys(
                str(other)
                for rule in mine
                for other in called(rule)
                if other in known and not (head_name(rule) == "@Make" and other == name)
            )
        )
        for name, mine in own.items()
    }


def _needed(uses: Mapping[str, tuple[str, ...]], statements: Mapping[str, str]) -> tuple[str, ...]:
    """Return the predicates with rows that `Robot` uses, each after those it uses, `Robot` last."""
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


dialects.DIALECTS["sqlite"] = RobotDialect
package_patches.install()
