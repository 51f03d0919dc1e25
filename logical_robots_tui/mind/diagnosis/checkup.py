"""Preparing a program to be watched. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.clauses.functors import expand
from logical_robots_tui.mind.clauses.spans import span_of
from logical_robots_tui.mind.compiling.compiler import read_rules, statements_of
from logical_robots_tui.mind.compiling.rules import (
    VALUE,
    head_name,
    heads,
    reached,
    text_of,
    value_of,
)
from logical_robots_tui.mind.diagnosis.memory import texts_of, written_fields
from logical_robots_tui.mind.diagnosis.sites import Checkup, RuleSite
from logical_robots_tui.mind.diagnosis.tracing import Tracer
from logical_robots_tui.mind.program import Program

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnosis.sites import Span
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["check_up"]

_MOST_PROBES = 400


def check_up(text: str, functions: frozenset[str], is_quick: Callable[[str, int], bool]) -> Checkup:
    """Prepare a program to be watched.

    Args:
        text: A program that can be compiled.
        functions: Names of its predicates that need arguments.
        is_quick: Whether SQLite can prepare a query with so many parameters in reasonable time.
    """
    source, raw = read_rules(text)
    expanded = expand(raw)
    own = heads(raw)
    made = {name for name, rules in own.items() if head_name(rules[0]) == "@Make"}
    rules = [(name, rule) for name in own if name not in made for rule in own[name]]
    functions |= {name for name, mine in own.items() if _is_constant(mine)}
    functions |= {n for n, (first, _) in expanded.origins.items() if first in functions}
    needed = reached(own[MAIN], own) | {MAIN}
    tracer = Tracer(text, source, expanded, functions, [rule for _, rule in rules])
    for name, rule in rules:
        if name in needed and name not in functions:
            tracer.rule(rule, tells_robot=name == MAIN)
    for name, (_, within) in tracer.copies.items():
        if within in needed and name not in functions:
            tracer.copy(name)
    asked = dict(list(tracer.probes.items())[:_MOST_PROBES])
    copied = [rule for mine in expanded.rules.values() for rule in mine]
    probed = [rule for rule, _ in asked.values()]
    compiled = statements_of([*asked], [*expanded.others, *copied, *probed], text, source)
    statements = {name: sql for name, sql in compiled.items() if is_quick(sql, 0)}
    probes = [asked[name][1] for name in statements]
    writes, writes_all = written_fields(own, functions, text, source)
    return Checkup(
        tuple(
            _site(name, rule, text, source, is_function=name in functions, is_needed=name in needed)
            for name, rule in rules
        ),
        tuple(tracer.sites),
        tuple(probes),
        Program(text, (), statements),
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
    given = [fv for rule in rules for fv in rule["head"]["record"]["field_value"]]
    is_value = [fv["field"] for fv in given] == [VALUE] and value_of(given[0]) is not None
    return is_value and "body" not in rules[0]
