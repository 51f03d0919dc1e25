"""From Logica text to SQL, by the `logica` package. Runs in the compile process only.

The package keeps global state, so one process compiles one program at a time.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Literal, cast

from logica.compiler import dialects, functors, rule_translate, universe
from logica.parser_py import parse

from logical_robots_tui.mind import complaints
from logical_robots_tui.mind.checks import MAIN, check
from logical_robots_tui.mind.diagnostics import ProgramError
from logical_robots_tui.mind.dialect import RobotDialect
from logical_robots_tui.mind.program import INPUTS, Predicate, Program
from logical_robots_tui.mind.rules import Rule, defined, head_name, prelude_rules, subject
from logical_robots_tui.mind.text import Prepared, diagnostic_at, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["compile_text"]

_RECURSION_DEPTH = 32  # as on DuckDB; the package's SQLite default is 8
_DEEPEST_RECURSION = 200
_VISIBILITY = {"Memory": ("own", "seen", "all"), "Sensor": ("own", "all")}


def compile_text(text: str) -> Program:
    """Compile a program and every predicate of it.

    Raises:
        ProgramError: The program is wrong.
    """
    source = prepare(text)
    if source.problems:
        raise ProgramError(source.problems)
    rules = _parse(text, source)
    rules, visibility = _take_visibility(rules, text, source)
    check(rules, text, source)
    try:
        compiled = _RobotProgram(
            _with_prelude(rules), user_flags={"logica_default_engine": "sqlite"}
        )
        main = compiled.FormattedPredicateSql(MAIN)
    except _COMPLAINTS as error:
        raise ProgramError((complaints.explain(error, text, source),)) from None
    statements = {MAIN: main}
    predicates = []
    for name, kind in _names(rules):
        line = complaints.line_of_definition(name, text, source) if kind == "program" else None
        reason = ""
        if kind == "prelude":
            reason = complaints.FUNCTION.format(name)
        elif name not in statements:
            sql, reason = _sql(compiled, name)
            if sql:
                statements[name] = sql
        predicates.append(Predicate(name, kind, line, has_rows=not reason, reason=reason))
    inputs = tuple(Predicate(name, "input", None, has_rows=True) for name in INPUTS)
    predicates.sort(key=lambda p: p.line or len(text))
    return Program(text, (*inputs, *predicates), statements, **visibility)


_COMPLAINTS = (
    parse.ParsingException,
    rule_translate.RuleCompileException,
    functors.FunctorError,
    AssertionError,
    KeyError,
    TypeError,
    IndexError,
    AttributeError,
    ValueError,
    RuntimeError,
)
"""What the package raises about a program that it can't compile; it does not keep to its own."""


class _RobotProgram(universe.LogicaProgram):  # type: ignore[misc]  # the package has no types
    """The package's program, computed in one query that makes no tables."""

    def UnfoldRecursion(self, rules: list[Rule]) -> list[Rule]:
        """Unroll every recursion in place, where the package would repeat statements."""
        annotations = universe.Annotations(rules, {"logica_default_engine": "sqlite"})
        depths: dict[str, Any] = annotations.annotations.get("@Recursive", {})
        for options in depths.values():
            options.pop("stop", None)
            if options.get("1") == -1:
                options["1"] = _RECURSION_DEPTH
        unfolding = functors.Functors(rules)
        recursive, _ = unfolding.RecursiveAnalysis(depths, False, _RECURSION_DEPTH)
        for name in recursive:
            options = depths.setdefault(name, {})
            options["iterative"] = False
            options["1"] = min(options.get("1", _RECURSION_DEPTH), _DEEPEST_RECURSION)
        return cast("list[Rule]", unfolding.UnfoldRecursions(depths, False, _RECURSION_DEPTH))


def _parse(text: str, source: Prepared) -> list[Rule]:
    parse.TOO_MUCH = "too much"  # a program can switch the package to other syntax for good
    try:
        return cast("list[Rule]", parse.ParseFile(source.text)["rule"])
    except _COMPLAINTS as error:
        raise ProgramError((complaints.explain(error, text, source),)) from None


def _with_prelude(rules: list[Rule]) -> list[Rule]:
    """The rules, with those of the prelude that the program does not define itself."""
    own = set(defined(rules))
    added = [r for r in prelude_rules() if head_name(r) not in own]
    return [_ground_in_query(r) for r in rules] + copy.deepcopy(added)


def _ground_in_query(rule: Rule) -> Rule:
    """Compute a grounded predicate once per query and not in a table of its own."""
    if head_name(rule) != "@Ground":
        return rule
    rule = copy.deepcopy(rule)
    rule["head"]["predicate_name"] = "@With"
    rule["head"]["record"]["field_value"] = rule["head"]["record"]["field_value"][:1]
    return rule


def _names(rules: list[Rule]) -> Iterator[tuple[str, Literal["program", "prelude"]]]:
    own = list(defined(rules))
    for name in own:
        yield name, "program"
    for name in dict.fromkeys(head_name(r) for r in prelude_rules()):
        if name not in own and name.isidentifier():
            yield name, "prelude"


def _sql(compiled: _RobotProgram, name: str) -> tuple[str, str]:
    """SQL of one predicate, or why it has no rows."""
    try:
        return compiled.FormattedPredicateSql(name), ""
    except _COMPLAINTS as error:
        if complaints.is_function(error):
            return "", complaints.FUNCTION.format(name)
        return "", f"{name} can't be computed: {complaints.plain_message(error)}"


def _take_visibility(
    rules: list[Rule], text: str, source: Prepared
) -> tuple[list[Rule], dict[str, Any]]:
    """Separate ``@Visible`` from the rules, which the package does not know."""
    visibility: dict[str, Any] = {}
    rest = []
    for rule in rules:
        if head_name(rule) != "@Visible":
            rest.append(rule)
            continue
        of = subject(rule)
        wanted = _second_text(rule)
        place = source.skeleton.find("@Visible")
        if of not in _VISIBILITY or wanted not in _VISIBILITY[of]:
            raise ProgramError(
                (
                    diagnostic_at(
                        text,
                        place,
                        8,
                        "this is not a visibility that robots can have",
                        'Write @Visible(Memory, "own"), "seen" or "all", or '
                        '@Visible(Sensor, "own") or "all".',
                    ),
                )
            )
        visibility[of.lower()] = wanted
    return rest, visibility


def _second_text(rule: Rule) -> str:
    try:
        value = rule["head"]["record"]["field_value"][1]["value"]["expression"]["literal"]
        return str(value["the_string"]["the_string"])
    except (KeyError, IndexError):
        return ""


dialects.DIALECTS["sqlite"] = RobotDialect
