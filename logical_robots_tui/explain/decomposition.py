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
    CallablePredicates,
    Scope,
    head_of,
    make_rule,
    order_parts,
    outer_aggregates,
)
from logical_robots_tui.explain.normal_form import Builder
from logical_robots_tui.explain.why.probing import DECIDED_BY_ONE, LOWER, ROWS, Probing, RuleParts
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import names_used
from logical_robots_tui.language.expansion import Expanded, expand, rename
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import Atom, Call, Proposition, Rule, Statement, Variable
from logical_robots_tui.language.types import Plain, Tables, is_nested, load_kind
from logical_robots_tui.mind.compiling.compiler import compile_statements, read_program
from logical_robots_tui.mind.compiling.worker import is_prepared_soon
from logical_robots_tui.mind.relations import GIVEN, with_given, with_remarks
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.schema import INPUTS, VALUE

_ALL = "WhyAll"
_FEW_STEPS = 4  # of a clause whose queries are compiled at once
_GIVEN_COLUMN = re.compile(rf"\b{GIVEN}\.g(\d+)\b")


@lru_cache(maxsize=2)  # its lazy queries are often needed next
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
        model = read_program(text)
        self._source = model.source
        self._expanded = expanded = expand(model)
        name = expanded.name_of(predicate, within)
        self._functions = functions = _functions(expanded, kinds)
        reach = expanded.reach(name)
        # The predicates that are mutually recursive with this one, itself included, or none.
        circle = {p for p in reach & expanded.rules.keys() if name in expanded.reach(p)}
        self._tables = {
            p: f"{LOWER if p in circle else ROWS}{p}" for p in expanded.rules if p not in functions
        }
        builder = Builder(
            self._source, CallablePredicates(functions, self._tables, expanded.origins)
        )
        rules = expanded.rules.get(name, [])
        parameters = tuple(functions.get(name, ()))
        parts = tuple(_rule(rule, parameters, builder) for rule in rules)
        columns = _columns(rules)
        if parameters:
            builder.probes[_ALL] = _rows_rule(name, columns, parameters)
        self._probes = builder.probes
        reads = [p for p in _called_predicates(name, expanded, functions) if p in self._tables]
        copies, copy_kinds = _sources(
            {*reads, *(() if parameters else (name,))} - {*kinds}, expanded, self._source
        )
        self._kinds = {
            self._tables[p]: copy_kinds.get(p)
            or {column: load_kind(kind) for column, kind in kinds[p].items()}
            for p in reads
            if p in copy_kinds or p in kinds
        }
        long_clauses = (c for rule in parts for c in rule.clauses if len(c.steps) > _FEW_STEPS)
        lazy_groups = tuple(
            (c.start_query, *(step.query for step in c.steps[:-1])) for c in long_clauses
        )
        self.probing = Probing(
            predicate,
            within,
            name,
            expanded.bases.get(name, ""),
            columns,
            parameters,
            any(rule.is_distinct for rule in rules),
            parts,
            {},
            _ALL if parameters else "",
            {p: self._tables[p] for p in reads},
            copies,
            {p: expanded.origins.get(p, (p, "")) for p in sorted(circle)},
            _is_founded(circle, expanded, functions),
            lazy_groups,
        )

    def queries(self, database: Database, names: Collection[str] = ()) -> dict[str, str]:
        """Return the queries `names`, or all but lazy ones, that are prepared in time."""
        for name, table in self.probing.tables.items():
            database.define(table, _columns(self._expanded.rules[name]), ())
        lazy = {query for group in self.probing.lazy_groups for query in group}
        probes = [*(names or (query for query in self._probes if query not in lazy))]
        rules = [rule for name in self._functions for rule in self._expanded.rules[name]]
        flags = [a for a in self._expanded.annotations if a.name == "@DefineFlag"]
        statements: list[Statement] = [*rules, *flags, *(self._probes[query] for query in probes)]
        renamed = [rename(statement, self._tables) for statement in statements]
        compiled = compile_statements(renamed, self._source, self._kinds)
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


def _rule(rule: Rule, parameters: tuple[str, ...], builder: Builder) -> RuleParts:
    head, collected = head_of(rule)
    bindings: dict[str, tree.Expression] = {}
    checks: list[Proposition] = []
    for number, column in enumerate(parameters):
        value = head[column]
        if not tree.variable_of(value) or value in bindings.values():
            bindings[f"g{number}"] = Variable(f"why_given_{number}")
            checks.append(tree.Equation(bindings[f"g{number}"], value))
        else:
            bindings[f"g{number}"] = value
    clauses = builder.clauses([*checks, *tree.conjuncts(rule.body)], head, collected, bindings)
    return RuleParts(builder.span(rule), clauses)


def _rows_rule(name: str, columns: tuple[str, ...], parameters: tuple[str, ...]) -> Rule:
    values = {column: Variable(f"why_{i}") for i, column in enumerate(columns)}
    inputs = {f"g{i}": values[column] for i, column in enumerate(parameters)}
    fields = {c: int(c[3:]) for c in columns if c.startswith("col") and c[3:].isdigit()}
    cells = {fields.get(column, column): value for column, value in values.items()}
    body = [Atom(GIVEN, tree.arguments(inputs)), Atom(name, tree.arguments(cells))]
    return make_rule(_ALL, {f"c{i}": value for i, value in enumerate(values.values())}, body)


def _called_predicates(name: str, expanded: Expanded, functions: Collection[str]) -> set[str]:
    names: set[str] = set()
    queue = [name]
    while queue:
        for callee in names_used(expanded.rules.get(queue.pop(), ())):
            if callee not in names:
                names.add(callee)
                queue += [callee] if callee in functions else []
    return names


def _functions(expanded: Expanded, with_rows: Container[str]) -> dict[str, tuple[str, ...]]:
    functions: dict[str, tuple[str, ...]] = {}
    originals = {*expanded.rules} - {*expanded.origins}
    grew = True
    while grew:
        grew = False
        for name, rules in expanded.rules.items():
            if name in functions or name in with_rows:
                continue
            parameters = _required_columns(rules, functions)
            if not parameters and name in originals:
                parameters = tuple(c for c in head_of(rules[0])[0] if c != VALUE)
            if parameters:
                functions[name] = parameters
                grew = True
    return functions


def _required_columns(
    rules: list[Rule], functions: Mapping[str, tuple[str, ...]]
) -> tuple[str, ...]:
    required: list[str] = []
    columns = [column for column in head_of(rules[0])[0] if column != VALUE]
    for column in columns:
        if all(not _unbound_columns(rule, required, functions) for rule in rules):
            break
        if any(column in _unbound_columns(rule, required, functions) for rule in rules):
            required.append(column)
    return tuple(required)


def _unbound_columns(
    rule: Rule, parameters: Sequence[str], functions: Mapping[str, tuple[str, ...]]
) -> set[str]:
    """Return the columns with unknown values; all of them if the body can't be queried."""
    head, body = head_of(rule)[0], tree.conjuncts(rule.body)
    trees = [*body, *head.values()]
    bound = tree.variables(head[column] for column in parameters if column in head)
    inner = tree.walk(trees, tree.is_aggregate)
    calls = [Atom(node.name, node.arguments) for node in inner if isinstance(node, Call)]
    ordered, unordered = order_parts(
        [*body, *calls], Scope(functions, tree.variables(trees)), bound
    )
    bound_after = ordered[-1][1] if ordered else bound
    unbound = {column for column, value in head.items() if not tree.variables(value) <= bound_after}
    return unbound or ({*head} - {*parameters} if unordered else set())


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
            if any(name in circle for a in outer_aggregates(rule) for name in names_used(a)):
                return False
            if any(a.operator not in DECIDED_BY_ONE for a in head_of(rule)[1].values()):
                return False
    return True


def _sources(
    names: Collection[str], expanded: Expanded, source: Prepared
) -> tuple[dict[str, str], Tables]:
    copies = sorted(name for name in names if name in expanded.rules and name not in INPUTS)
    if not copies:
        return {}, {}
    rules = [rule for group in expanded.rules.values() for rule in group]
    compiled = compile_statements([*expanded.annotations, *rules], source)
    return compiled.statements(copies), compiled.kinds
