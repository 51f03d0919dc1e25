"""Decompose a predicate's rules and compile them. In the compile process.

Queries read called predicates from tables with their rows at the moment in question, so an
explanation refers to exactly these rows.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Container, Mapping, Sequence
from functools import lru_cache
from typing import Any

from logical_robots_tui.explain.bodies import (
    Names,
    Scope,
    head_of,
    in_order,
    make_rule,
    outer_aggregates,
)
from logical_robots_tui.explain.normal_form import Builder
from logical_robots_tui.explain.why.probing import DECIDED_BY_ONE, LOWER, ROWS, Probing, RuleParts
from logical_robots_tui.language.definitions import names_used
from logical_robots_tui.language.expansion import Expanded, expand, rename
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import (
    Atom,
    Call,
    Equation,
    Expression,
    Proposition,
    Rule,
    Statement,
    Variable,
    arguments,
    conjuncts,
    is_aggregate,
    variable_of,
    variables,
    walk,
)
from logical_robots_tui.language.types import Plain, Tables, is_nested, load_kind
from logical_robots_tui.mind.compiling.compiler import compile_statements, read_program
from logical_robots_tui.mind.compiling.worker import is_prepared_soon
from logical_robots_tui.mind.relations import GIVEN, with_given, with_remarks
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.schema import INPUTS, VALUE

_ALL = "WhyAll"
_FEW_STEPS = 4  # of a clause whose queries are compiled at once
_GIVEN_COLUMN = re.compile(rf"\b{GIVEN}\.g(\d+)\b")


@lru_cache(maxsize=2)  # its further queries are often wanted next
def decompose(text: str, predicate: str, within: str, kinds: str) -> Decomposition:
    """Decompose a predicate's rules.

    `within` is the predicate made with ``:=`` whose copy of the rules to use, or "".
    `kinds` has the predicates with rows, each with the types of its columns, as JSON.
    """
    return Decomposition(text, predicate, within, json.loads(kinds))


class Decomposition:
    """The clauses of a predicate's rules; `probing` holds the queries that most answers need."""

    def __init__(
        self, text: str, predicate: str, within: str, kinds: Mapping[str, Mapping[str, Any]]
    ) -> None:
        self._source, program = read_program(text)
        self._expanded = expanded = expand(program)
        name = expanded.name_of(predicate, within)
        self._functions = functions = _functions(expanded, kinds)
        reach = expanded.reach(name)
        # The predicates that are mutually recursive with this one, itself included, or none.
        circle = {each for each in reach & expanded.rules.keys() if name in expanded.reach(each)}
        self._tables = {
            each: f"{LOWER if each in circle else ROWS}{each}"
            for each in expanded.rules
            if each not in functions
        }
        builder = Builder(self._source, Names(functions, self._tables, expanded.origins))
        rules = expanded.rules.get(name, [])
        given = tuple(functions.get(name, ()))
        parts = tuple(_rule(rule, given, builder) for rule in rules)
        columns = _columns(rules)
        if given:
            builder.probes[_ALL] = _all(name, columns, given)
        self._probes = builder.probes
        read = [each for each in _read(name, expanded, functions) if each in self._tables]
        copies, of_copies = _sources(
            {*read, *(() if given else (name,))} - {*kinds}, expanded, self._source
        )
        self._known = {
            self._tables[each]: of_copies.get(each)
            or {column: load_kind(kind) for column, kind in kinds[each].items()}
            for each in read
            if each in of_copies or each in kinds
        }
        long = (c for rule in parts for c in rule.clauses if len(c.steps) > _FEW_STEPS)
        later = tuple((c.start_query, *(step.query for step in c.steps[:-1])) for c in long)
        self.probing = Probing(
            predicate,
            within,
            name,
            expanded.bases.get(name, ""),
            columns,
            given,
            any(rule.is_distinct for rule in rules),
            parts,
            {},
            _ALL if given else "",
            {each: self._tables[each] for each in read},
            copies,
            {each: expanded.origins.get(each, (each, "")) for each in sorted(circle)},
            _is_founded(circle, expanded, functions),
            later,
        )

    def queries(self, database: Database, wanted: Collection[str] = ()) -> dict[str, str]:
        """Return the queries `wanted`, or all but later ones, that are prepared in time."""
        for each, table in self.probing.tables.items():
            database.define(table, _columns(self._expanded.rules[each]), ())
        later = {query for group in self.probing.lazy_groups for query in group}
        probes = [*(wanted or (query for query in self._probes if query not in later))]
        own = [rule for name in self._functions for rule in self._expanded.rules[name]]
        flags = [each for each in self._expanded.annotations if each.name == "@DefineFlag"]
        asked: list[Statement] = [*own, *flags, *(self._probes[query] for query in probes)]
        renamed = [rename(each, self._tables) for each in asked]
        compiled = compile_statements(renamed, self._source, self._known)
        return {
            query: with_remarks(
                sql,
                [c for c, kind in compiled.kinds[query].items() if kind is Plain.TRUTH],
                [c for c, kind in compiled.kinds[query].items() if is_nested(kind)],
            )
            for query, sql in compiled.statements(probes).items()
            for number in [1 + max(map(int, _GIVEN_COLUMN.findall(sql)), default=-1)]
            if is_prepared_soon(database, with_given(sql, number), number)
        }


def _columns(rules: list[Rule]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(c for rule in rules for part in head_of(rule) for c in part))


def _rule(rule: Rule, given: tuple[str, ...], builder: Builder) -> RuleParts:
    head, collected = head_of(rule)
    bound: dict[str, Expression] = {}
    checks: list[Proposition] = []
    for number, column in enumerate(given):
        value = head[column]
        if not variable_of(value) or value in bound.values():
            bound[f"g{number}"] = Variable(f"why_given_{number}")
            checks.append(Equation(bound[f"g{number}"], value))
        else:
            bound[f"g{number}"] = value
    clauses = builder.clauses([*checks, *conjuncts(rule.body)], head, collected, bound)
    return RuleParts(builder.span(rule), clauses)


def _all(name: str, columns: tuple[str, ...], given: tuple[str, ...]) -> Rule:
    values = {column: Variable(f"why_{i}") for i, column in enumerate(columns)}
    taken = {f"g{i}": values[column] for i, column in enumerate(given)}
    fields = {c: int(c[3:]) for c in columns if c.startswith("col") and c[3:].isdigit()}
    named = {fields.get(column, column): value for column, value in values.items()}
    body = [Atom(GIVEN, arguments(taken)), Atom(name, arguments(named))]
    return make_rule(_ALL, {f"c{i}": value for i, value in enumerate(values.values())}, body)


def _read(name: str, expanded: Expanded, functions: Collection[str]) -> set[str]:
    found: set[str] = set()
    waiting = [name]
    while waiting:
        for other in names_used(expanded.rules.get(waiting.pop(), ())):
            if other not in found:
                found.add(other)
                waiting += [other] if other in functions else []
    return found


def _functions(expanded: Expanded, with_rows: Container[str]) -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    named = {*expanded.rules} - {*expanded.origins}
    grew = True
    while grew:
        grew = False
        for name, rules in expanded.rules.items():
            if name in found or name in with_rows:
                continue
            needed = _needs(rules, found)
            if not needed and name in named:
                needed = tuple(c for c in head_of(rules[0])[0] if c != VALUE)
            if needed:
                found[name] = needed
                grew = True
    return found


def _needs(rules: list[Rule], functions: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    needed: list[str] = []
    columns = [column for column in head_of(rules[0])[0] if column != VALUE]
    for column in columns:
        if all(not _open(rule, needed, functions) for rule in rules):
            break
        if any(column in _open(rule, needed, functions) for rule in rules):
            needed.append(column)
    return tuple(needed)


def _open(rule: Rule, given: Sequence[str], functions: Mapping[str, tuple[str, ...]]) -> set[str]:
    """Return the columns with unknown values; all of them if the body can't be queried."""
    head, body = head_of(rule)[0], conjuncts(rule.body)
    whole = [*body, *head.values()]
    known = variables(head[column] for column in given if column in head)
    inner = walk(whole, is_aggregate)
    calls = [Atom(each.name, each.arguments) for each in inner if isinstance(each, Call)]
    ordered, left = in_order([*body, *calls], Scope(functions, variables(whole)), known)
    after = ordered[-1][1] if ordered else known
    lacking = {column for column, value in head.items() if not variables(value) <= after}
    return lacking or ({*head} - {*given} if left else set())


def _is_founded(
    circle: set[str], expanded: Expanded, functions: Mapping[str, Collection[str]]
) -> bool:
    """Return whether earlier rows can explain a recursion's rows.

    False if a step negates or aggregates all rows of the previous one.
    """
    for name in circle:
        for rule in expanded.rules[name]:
            if name in functions:
                return False
            if any(used in circle for each in outer_aggregates(rule) for used in names_used(each)):
                return False
            if any(each.operator not in DECIDED_BY_ONE for each in head_of(rule)[1].values()):
                return False
    return True


def _sources(
    wanted: Collection[str], expanded: Expanded, source: Prepared
) -> tuple[dict[str, str], Tables]:
    copies = sorted(name for name in wanted if name in expanded.rules and name not in INPUTS)
    if not copies:
        return {}, {}
    rules = [rule for own in expanded.rules.values() for rule in own]
    compiled = compile_statements([*expanded.annotations, *rules], source)
    return compiled.statements(copies), compiled.kinds
