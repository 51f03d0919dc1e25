"""Preparing a program to be watched, with what it writes into memories. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.clauses.functors import expand
from logical_robots_tui.mind.clauses.scopes import flat
from logical_robots_tui.mind.clauses.trees import span_of
from logical_robots_tui.mind.compiling.compiler import read_rules, statements_of
from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    head_name,
    heads,
    nodes,
    operands,
    reached,
    text_of,
    value_of,
)
from logical_robots_tui.mind.diagnosis.sites import Checkup, Field, RuleSite
from logical_robots_tui.mind.diagnosis.tracing import Tracer
from logical_robots_tui.mind.program import INPUTS, VALUE, Program

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared
    from logical_robots_tui.mind.why.probing import Span

_MOST_PROBES = 400


def check_up(text: str, functions: frozenset[str], is_quick: Callable[[str, int], bool]) -> Checkup:
    """Prepare a program to be watched."""
    source, raw = read_rules(text)
    expanded = expand(raw)
    own = heads(raw)
    made = {name for name, rules in own.items() if head_name(rules[0]) == "@Make"}
    rules = [(name, rule) for name in own if name not in made for rule in own[name]]
    functions |= {name for name, mine in own.items() if _is_constant(mine)}
    functions |= {n for n, (first, _) in expanded.origins.items() if first in functions}
    needed = reached(own[MAIN], own) | {MAIN}
    tracer = Tracer(source, expanded, functions, [rule for _, rule in rules])
    for name, rule in rules:
        if name in needed and name not in functions:
            tracer.rule(rule, tells_robot=name == MAIN)
    for name, (_, within) in tracer.copies.items():
        if within in needed and name not in functions:
            tracer.copy(name)
    asked = dict(list(tracer.probes.items())[:_MOST_PROBES])
    copied = [rule for mine in expanded.rules.values() for rule in mine]
    probed = [rule for rule, _ in asked.values()]
    compiled = statements_of([*asked], [*expanded.others, *copied, *probed], source)
    statements = {name: sql for name, sql in compiled.items() if is_quick(sql, 0)}
    probes = [asked[name][1] for name in statements]
    writes, writes_all = written_fields(own, functions, source)
    return Checkup(
        tuple(
            _site(name, rule, source, is_function=name in functions, is_needed=name in needed)
            for name, rule in rules
        ),
        tuple(tracer.sites),
        tuple(probes),
        Program(text, (), statements),
        tuple(tracer.reads.values()),
        tuple(writes),
        tracer.reads_all,
        writes_all,
        tuple(texts_of((rule for name, rule in rules if name in needed), own, source)),
        tracer.left_out + len(tracer.probes) - len(probes),
    )


def _site(
    name: str, rule: Rule, source: Prepared, *, is_function: bool, is_needed: bool
) -> RuleSite:
    span = span_of(rule, source)
    memory = next(
        (
            span_of([fv["field"], fv["value"].get("expression", {})], source)
            for fv in rule["head"]["record"]["field_value"]
            if fv["field"] == "memory"
        ),
        None,
    )
    body = span_of(rule["body"], source) if "body" in rule else None
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


_DEEPEST = 8


def written_fields(
    own: Mapping[str, list[Rule]], functions: frozenset[str], source: Prepared
) -> tuple[list[Field], bool]:
    """Return the fields of `Robot`'s memory records, and whether there may be others."""
    found: dict[str, Field] = {}
    is_open = False

    def look(value: Rule, rule: Rule, depth: int) -> None:
        nonlocal is_open
        call = value.get("call", {})
        name = str(call.get("predicate_name", ""))
        if "record" in value:
            for fv in value["record"]["field_value"]:
                place = fv["value"].get("expression", {})
                span = span_of([fv["field"], place], source)
                found.setdefault(str(fv["field"]), Field(str(fv["field"]), span))
        elif "implication" in value:
            for branch in value["implication"]["if_then"]:
                look(branch["consequence"], rule, depth)
            look(value["implication"]["otherwise"], rule, depth)
        elif "variable" in value and (bound := _bound(value, rule)) is not None:
            look(bound, rule, depth)
        elif name in functions and name in own and depth < _DEEPEST:
            for inner in own[name]:
                for fv in inner["head"]["record"]["field_value"]:
                    if fv["field"] == VALUE and (given := value_of(fv)) is not None:
                        look(given, inner, depth + 1)
        elif "literal" not in value or "the_list" in value["literal"]:
            is_open = True

    for rule in own.get(MAIN, ()):
        for fv in rule["head"]["record"]["field_value"]:
            if fv["field"] == "memory":
                value = value_of(fv)
                if value is None:
                    is_open = True
                else:
                    look(value, rule, 0)
    return list(found.values()), is_open


def texts_of(rules: Iterable[Rule], own: Container[str], source: Prepared) -> Iterator[Field]:
    """Return the texts in some rules that are compared or passed to a predicate."""
    for rule in rules:
        for node in nodes(rule):
            for value in _meant_for_something(node, own, is_fact="body" not in rule):
                name = text_of(value)
                if name:
                    yield Field(name, span_of(value, source))


def _meant_for_something(node: Rule, own: Container[str], *, is_fact: bool) -> Iterator[Rule]:
    """Yield the values in a node that are compared with something, or are in a fact."""
    for key in ("call", "predicate"):
        call = node.get(key)
        if isinstance(call, dict) and "record" in call:
            name = str(call["predicate_name"])
            if name in COMPARISONS or name in own or name in INPUTS:
                yield from operands(call)
    if "unification" in node:
        yield from node["unification"].values()
    if "inclusion" in node:
        yield from (
            node["inclusion"]["list"].get("literal", {}).get("the_list", {}).get("element", ())
        )
    if is_fact and "head" in node:
        yield from operands(node["head"])


def _bound(value: Rule, rule: Rule) -> Rule | None:
    """Return the expression that a variable is equal to in a body, or None."""
    for part in flat(rule.get("body")):
        pair = part.get("unification")
        if pair is not None and pair["left_hand_side"] == value:
            right: Rule = pair["right_hand_side"]
            return right
    return None
