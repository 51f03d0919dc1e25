"""A predicate's rules taken apart and compiled. In the compile process."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.mind.compiling import complaints
from logical_robots_tui.mind.compiling.compiler import compiled_rules, read_rules
from logical_robots_tui.mind.compiling.rules import VALUE, called, head_name, heads, value_of
from logical_robots_tui.mind.why import sides, trees
from logical_robots_tui.mind.why.building import Builder
from logical_robots_tui.mind.why.probing import Probing, with_given

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.why.probing import Part, Query, RuleParts

__all__ = ["take_apart"]


def take_apart(
    text: str,
    predicate: str,
    within: str,
    functions: frozenset[str],
    is_quick: Callable[[str, int], bool],
) -> Probing:
    """Take the rules of a predicate apart.

    Args:
        text: A program that can be compiled.
        predicate: One of its own predicates.
        within: A predicate made with ``:=`` whose fillings-in are to hold, or "".
        functions: Names of those that have rows only for given arguments.
        is_quick: Whether SQLite prepares a query with so many parameters without much ado.
    """
    source, raw = read_rules(text)
    own = heads(raw)
    made = _made(predicate, own)
    base = made[-1][1] if made else predicate
    within = predicate if made else within
    made = _made(within, own)
    builder = Builder(text, source, own, functions)
    rules = own.get(base, [])
    is_function = predicate in functions or (bool(made) and any(map(builder.needs_given, rules)))
    given = _arguments(rules[0]) if is_function and rules else ()
    parts = [builder.rule(rule, is_function=is_function) for rule in rules]
    probes = list(builder.probes.values())
    names: dict[str, str] = {}
    for name, rule in builder.probes.items():
        names[name], makes = _filled_in(name, rule, made, own)
        probes += makes
    compiled = compiled_rules([*raw, *probes], text, source)
    statements: dict[str, str] = {}
    for name, asked in names.items():
        try:
            sql = compiled.FormattedPredicateSql(asked).rstrip().removesuffix(";")
        except complaints.COMPLAINTS:
            continue  # the next part answers for this one, too
        if is_quick(with_given(sql, given), len(given)):
            statements[name] = sql
    return Probing(
        predicate,
        base if base != predicate else "",
        within,
        given,
        tuple(_with_sql(rule, statements) for rule in parts),
    )


def _made(predicate: str, own: Mapping[str, list[Rule]]) -> list[tuple[Rule, str]]:
    """How a predicate is made with ``:=``, the last step first, each with what it is made from."""
    found: list[tuple[Rule, str]] = []
    while predicate in own and head_name(own[predicate][0]) == "@Make":
        (rule, *_) = own[predicate]
        predicate = str(_value(rule, 1)["literal"]["the_predicate"]["predicate_name"])
        if any(predicate == base for _, base in found):
            break
        found.append((rule, predicate))
    return found


def _value(rule: Rule, place: int) -> Rule:
    return value_of(rule["head"]["record"]["field_value"][place]) or {}


def _filled_in(
    name: str, rule: Rule, made: list[tuple[Rule, str]], own: Mapping[str, list[Rule]]
) -> tuple[str, list[Rule]]:
    """The name of a probe with what it leaves open filled in, and the rules that do so."""
    makes: list[Rule] = []
    for step, (make, _) in enumerate(reversed(made)):
        reach = _reach(rule, own)
        given = _value(make, 2)["record"]["field_value"]
        columns = {fv["field"]: value for fv in given if (value := value_of(fv))}
        columns = {field: value for field, value in columns.items() if str(field) in reach}
        if not columns:
            continue
        makes.append(trees.make(f"{name}_made{step}", name, columns))
        name = f"{name}_made{step}"
    return name, makes


def _reach(rule: Rule, own: Mapping[str, list[Rule]]) -> set[str]:
    """Names of the predicates that a rule leans on, directly or not."""
    found: set[str] = set()
    waiting = list(map(str, called(rule)))
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += map(str, called(own.get(name, [])))
    return found


def _arguments(rule: Rule) -> tuple[str, ...]:
    return tuple(
        name for name, _ in sides.asks({"record": rule["head"]["record"]}) if name != VALUE
    )


def _with_sql(rule: RuleParts, statements: Mapping[str, str]) -> RuleParts:
    return replace(
        rule,
        start=_compiled(rule.start, statements),
        parts=tuple(_part(part, statements) for part in rule.parts),
    )


def _part(part: Part, statements: Mapping[str, str]) -> Part:
    inside = tuple(
        replace(
            each,
            start=_compiled(each.start, statements),
            parts=tuple(_part(inner, statements) for inner in each.parts),
        )
        for each in part.inside
    )
    return replace(part, query=_compiled(part.query, statements), inside=inside)


def _compiled(query: Query | None, statements: Mapping[str, str]) -> Query | None:
    if query is None or query.sql not in statements:
        return None
    return replace(query, sql=statements[query.sql])
