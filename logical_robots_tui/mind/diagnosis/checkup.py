"""Preparing a program to be watched. In the compile process."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from logical_robots_tui.mind.checking import error_messages
from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.clauses.functors import made_from
from logical_robots_tui.mind.clauses.spans import span_of
from logical_robots_tui.mind.compiling.compiler import compiled_rules, read_rules
from logical_robots_tui.mind.compiling.rules import VALUE, head_name, heads, reached, value_of
from logical_robots_tui.mind.diagnosis.expressions import text_of
from logical_robots_tui.mind.diagnosis.memory import texts_of, written_fields
from logical_robots_tui.mind.diagnosis.sites import Checkup, RuleSite
from logical_robots_tui.mind.diagnosis.tracing import Tracer
from logical_robots_tui.mind.program import Program
from logical_robots_tui.mind.tuning import tune_all

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnosis.sites import Probe, Span
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["check_up"]

_MOST_PROBES = 400


def check_up(
    text: str,
    functions: frozenset[str],
    is_quick: Callable[[str, int], bool],
    is_quick_tuned: Callable[[str, int], bool],
) -> Checkup:
    """Prepare a program to be watched.

    Args:
        text: A program that can be compiled.
        functions: Names of its predicates that need arguments.
        is_quick: Whether SQLite can prepare a query with so many parameters in reasonable time.
        is_quick_tuned: The same for tuned queries.
    """
    source, raw = read_rules(text)
    own = heads(raw)
    plain = {
        name: [rule for rule in rules if head_name(rule) != "@Make"] for name, rules in own.items()
    }
    functions |= {name for name, mine in plain.items() if _is_constant(mine)}
    rules = [(name, rule) for name, mine in plain.items() for rule in mine]
    tracer = Tracer(text, source, plain, functions, [rule for _, rule in rules])
    needed = reached(own[MAIN], own) | {MAIN}
    for name, rule in rules:
        if name in needed and name not in functions:
            tracer.rule(rule, tells_robot=name == MAIN)
    fillings = _trace_what_is_made(tracer, own, plain, needed, functions)
    asked = dict(list(tracer.probes.items())[:_MOST_PROBES])
    names, makes = _filled_in(asked, fillings, own)
    compiled = compiled_rules([*raw, *(rule for rule, _ in asked.values()), *makes], text, source)
    probes: list[Probe] = []
    statements: dict[str, str] = {}
    for name, (_, probe) in asked.items():
        with suppress(*error_messages.COMPLAINTS):
            sql = compiled.FormattedPredicateSql(names[name]).rstrip().removesuffix(";")
            if is_quick(sql, 0):
                probes.append(probe)
                statements[name] = sql
    tuned = tune_all(statements)
    quick = {name: each for name, each in tuned.items() if is_quick_tuned(each.sql, each.bounds)}
    writes, writes_all = written_fields(plain, functions, text, source)
    return Checkup(
        tuple(
            _site(name, rule, text, source, is_function=name in functions, is_needed=name in needed)
            for name, rule in rules
        ),
        tuple(tracer.sites),
        tuple(probes),
        Program(text, (), statements, tuned=quick),
        tuple(tracer.reads.values()),
        tuple(writes),
        tracer.reads_all,
        writes_all,
        tuple(texts_of((rule for name, rule in rules if name in needed), own, text, source)),
        tracer.left_out + len(tracer.probes) - len(probes),
    )


def _site(
    name: str, rule: Rule, text: str, source: Prepared, *, is_function: bool, is_needed: bool
) -> RuleSite:
    span = span_of(rule, text, source)
    memory = next(
        (
            span_of([fv["field"], fv["value"].get("expression", {})], text, source)
            for fv in rule["head"]["record"]["field_value"]
            if fv["field"] == "memory"
        ),
        None,
    )
    body = span_of(rule["body"], text, source) if "body" in rule else None
    return RuleSite(
        name, span, is_function, is_needed, "body" not in rule, _key(rule, span), memory, body
    )


def _key(rule: Rule, span: Span) -> str:
    """Return a fact's key: the text in its first column, or all of its text."""
    first = value_of(rule["head"]["record"]["field_value"][0]) if "body" not in rule else None
    found = text_of(first or {})
    return span.text if found is None else found


def _is_constant(rules: list[Rule]) -> bool:
    """Return whether these are the rules of a constant: no arguments and no conditions."""
    fields = [fv["field"] for rule in rules for fv in rule["head"]["record"]["field_value"]]
    return (
        fields == [VALUE]
        and "body" not in rules[0]
        and value_of(rules[0]["head"]["record"]["field_value"][0]) is not None
    )


def _trace_what_is_made(
    tracer: Tracer,
    own: Mapping[str, list[Rule]],
    plain: Mapping[str, list[Rule]],
    needed: set[str],
    functions: frozenset[str],
) -> dict[str, tuple[str, dict[str, Rule]]]:
    """Trace the rules of predicates made with ``:=``, with their substitutions.

    Returns:
        By name of a probe, its predicate and the substitutions.
    """
    fillings: dict[str, tuple[str, dict[str, Rule]]] = {}
    made = {n: made_from(rules[0]) for n, rules in own.items() if head_name(rules[0]) == "@Make"}
    for name, (base, given) in made.items():
        if name not in needed:
            continue
        tracer.within = name
        before = set(tracer.probes)
        changed = given.keys()
        for other in sorted({base, *reached(own.get(base, []), own)}):
            if other in plain and other not in functions and reached(plain[other], own) & changed:
                for rule in plain[other]:
                    tracer.rule(rule, tells_robot=False)
        fillings |= dict.fromkeys(tracer.probes.keys() - before, (name, given))
    tracer.within = ""
    return fillings


def _filled_in(
    asked: Mapping[str, tuple[Rule, Probe]],
    fillings: Mapping[str, tuple[str, dict[str, Rule]]],
    own: Mapping[str, list[Rule]],
) -> tuple[dict[str, str], list[Rule]]:
    """Return for each probe the predicate to query, and the rules that define it."""
    names = {name: name for name in asked}
    makes = []
    for name, (rule, _) in asked.items():
        within, given = fillings.get(name, ("", {}))
        reach = reached(rule, own)
        columns = {field: value for field, value in given.items() if field in reach}
        if columns:
            names[name] = f"{name}_{within}"
            makes.append(trees.make(names[name], name, columns))
    return names, makes
