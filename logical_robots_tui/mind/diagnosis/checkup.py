"""A program made ready to be watched. In the compile process."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.mind.compiling import complaints
from logical_robots_tui.mind.compiling.compiler import compiled_rules, read_rules
from logical_robots_tui.mind.compiling.robot_rule import MAIN
from logical_robots_tui.mind.compiling.rules import VALUE, called, head_name, heads, value_of
from logical_robots_tui.mind.diagnosis.expressions import text_of
from logical_robots_tui.mind.diagnosis.memory import texts_of, written_fields
from logical_robots_tui.mind.diagnosis.sites import Checkup, RuleSite
from logical_robots_tui.mind.diagnosis.tracing import Tracer
from logical_robots_tui.mind.program import Program
from logical_robots_tui.mind.tuning import tune_all
from logical_robots_tui.mind.why import trees
from logical_robots_tui.mind.why.spans import span_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from logical_robots_tui.mind.diagnosis.sites import Probe, Span
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.text import Prepared

__all__ = ["check_up"]

_MOST_PROBES = 400


def check_up(
    text: str,
    functions: frozenset[str],
    is_quick: Callable[[str, int], bool],
    is_quick_tuned: Callable[[str, int], bool],
) -> Checkup:
    """Make a program ready to be watched.

    Args:
        text: A program that can be compiled.
        functions: Names of its predicates that have rows only for given arguments.
        is_quick: Whether SQLite prepares a query with so many parameters without much ado.
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
    needed = _reach(MAIN, own) | {MAIN}
    made = {name: step for name, mine in own.items() if (step := _made(name, mine[0]))}
    bases = {base for base, _ in made.values()}
    fillings: dict[str, tuple[str, Mapping[str | int, Rule]]] = {}
    for name, rule in rules:
        if name in needed and name not in functions:
            tracer.rule(rule, tells_robot=name == MAIN)
    for name, (base, given) in made.items():
        if name not in needed:
            continue
        tracer.within = name
        before = set(tracer.probes)
        filled_in = frozenset(map(str, given))
        for other in sorted({base, *_reach(base, own)}):
            if other in plain and other not in functions and _reach(other, own) & filled_in:
                for rule in plain[other]:
                    tracer.rule(rule, tells_robot=False)
        fillings |= {probe: (name, given) for probe in tracer.probes.keys() - before}
    tracer.within = ""
    probes: list[Probe] = []
    statements: dict[str, str] = {}
    asked = dict(list(tracer.probes.items())[:_MOST_PROBES])
    names, makes = {}, []
    for name, (rule, _) in asked.items():
        names[name] = name
        if name in fillings:
            within, given = fillings[name]
            reach = _reach_of(rule, own)
            columns = {field: value for field, value in given.items() if str(field) in reach}
            if columns:
                names[name] = f"{name}_{within}"
                makes.append(trees.make(names[name], name, columns))
    compiled = compiled_rules([*raw, *(rule for rule, _ in asked.values()), *makes], text, source)
    left_out = tracer.left_out + len(tracer.probes) - len(asked)
    for name, (_, probe) in asked.items():
        try:
            sql = compiled.FormattedPredicateSql(names[name]).rstrip().removesuffix(";")
        except complaints.COMPLAINTS:
            left_out += 1
            continue
        if is_quick(sql, 0):
            probes.append(replace(probe, name=name))
            statements[name] = sql
        else:
            left_out += 1
    tuned = {
        name: each
        for name, each in tune_all(statements).items()
        if is_quick_tuned(each.sql, each.bounds)
    }
    writes, writes_all = written_fields(plain, functions, text, source)
    return Checkup(
        tuple(
            _site(name, rule, text, source, is_function=name in functions, is_needed=name in needed)
            for name, rule in rules
        ),
        tuple(tracer.sites),
        tuple(probes),
        Program(text, (), statements, tuned=tuned),
        tuple(tracer.reads.values()),
        tuple(writes),
        tracer.reads_all,
        writes_all,
        tuple(texts_of((rule for name, rule in rules if name in needed), text, source)),
        left_out,
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
    """What a fact is found by: the text in its first column, or else all that it says."""
    first = value_of(rule["head"]["record"]["field_value"][0]) if "body" not in rule else None
    found = text_of(first or {})
    return span.text if found is None else found


def _is_constant(rules: list[Rule]) -> bool:
    """Whether these are the rules of a function without arguments that only has a value."""
    fields = [fv["field"] for rule in rules for fv in rule["head"]["record"]["field_value"]]
    return (
        fields == [VALUE]
        and "body" not in rules[0]
        and value_of(rules[0]["head"]["record"]["field_value"][0]) is not None
    )


def _made(name: str, rule: Rule) -> tuple[str, dict[str | int, Rule]] | None:
    """What a predicate is made from with ``:=``, and what is filled in; None if it isn't."""
    if head_name(rule) != "@Make":
        return None
    _, base, given = (value_of(fv) or {} for fv in rule["head"]["record"]["field_value"])
    fields = given["record"]["field_value"]
    columns = {fv["field"]: value for fv in fields if (value := value_of(fv))}
    return str(base["literal"]["the_predicate"]["predicate_name"]), columns


def _reach(name: str, own: Mapping[str, list[Rule]]) -> set[str]:
    """Names of the predicates that a predicate leans on, directly or not."""
    return {found for rule in own.get(name, ()) for found in _reach_of(rule, own)}


def _reach_of(rule: Rule, own: Mapping[str, list[Rule]]) -> set[str]:
    found: set[str] = set()
    waiting = list(map(str, called(rule)))
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += map(str, called(own.get(name, [])))
    return found
