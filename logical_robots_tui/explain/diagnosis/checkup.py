"""Prepare a program to be watched, and find its memory fields. In the compile process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from logical_robots_tui.explain.bodies import span_of
from logical_robots_tui.explain.diagnosis.sites import Checkup, NamedPlace, RuleSite
from logical_robots_tui.explain.diagnosis.tracing import Tracer
from logical_robots_tui.explain.diagnosis.watching import Sources, decisive_columns
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import Model, is_constant, names_used
from logical_robots_tui.language.expansion import expand
from logical_robots_tui.language.source_text import Prepared
from logical_robots_tui.language.tree import Call, Equation, Expression, Head, Node, Rule, Statement
from logical_robots_tui.mind.compiling.compiler import compile_statements, read_program
from logical_robots_tui.mind.program import Program
from logical_robots_tui.schema import INPUTS, MAIN

_MOST_PROBES = 400


def check_up(text: str, functions: frozenset[str], is_quick: Callable[[str, int], bool]) -> Checkup:
    model = read_program(text)
    source, expanded = model.source, expand(model)
    rules = [(rule.name, rule) for rule in model.rules]
    predicates: dict[str, list[Rule]] = {}
    for name, rule in rules:
        predicates.setdefault(name, []).append(rule)
    rules = [(name, rule) for name in predicates for rule in predicates[name]]
    functions |= {
        name for name, group in predicates.items() if len(group) == 1 and is_constant(group[0])
    }
    functions |= {n for n, (first, _) in expanded.origins.items() if first in functions}
    # A pattern that is only copied by `:=` is not needed itself.
    reachable = expanded.reach(MAIN) | {MAIN}
    tracer = Tracer(source, expanded, functions, [rule for _, rule in rules])
    for name, rule in rules:
        if name in reachable and name not in functions:
            tracer.rule(rule, tells_robot=name == MAIN)
    for name in tracer.copies:
        if name in reachable and name not in functions:
            tracer.copy(name)
    required = reachable | {tracer.copies[name][0] for name in reachable & tracer.copies.keys()}
    candidates = dict(list(tracer.probes.items())[:_MOST_PROBES])
    rules_with_copies = [rule for group in expanded.rules.values() for rule in group]
    probe_rules = [rule for rule, _ in candidates.values()]
    watched: list[Statement] = [*expanded.annotations, *rules_with_copies, *probe_rules]
    compiled = compile_statements(watched, source).statements(candidates)
    statements = {name: sql for name, sql in compiled.items() if is_quick(sql, 0)}
    probes = [candidates[name][1] for name in statements]
    for name in tracer.probes.keys() - statements.keys():
        if tracer.probes[name][1].closeness != "closer":
            tracer.miss_probe(tracer.probes[name][1])
    writes, writes_all = memory_fields(predicates, functions, source)
    sites = []
    for name, rule in rules:
        site = _site(name, rule, source, is_function=name in functions, is_needed=name in required)
        decisive = decisive_columns(rule, expanded.rules) if name == MAIN else ()
        sites.append(replace(site, sources=tuple(sorted({predicate for predicate, _ in decisive}))))
    return Checkup(
        tuple(sites),
        tuple(tracer.sites),
        tuple(probes),
        Program(text, (), statements),
        tuple(tracer.reads.values()),
        tuple(writes),
        tracer.reads_all,
        writes_all,
        tuple(texts_of((rule for name, rule in rules if name in required), predicates, source)),
        tracer.skipped_probes + len(tracer.probes) - len(probes),
        tuple(sorted(tracer.missed_sites())),
        tuple(sorted(tracer.missed_rules)),
        tuple(unused(model)),
        tuple(duplicate_copies(model)),
    )


def unused(model: Model) -> Iterator[NamedPlace]:
    """Yield the predicates that nothing else in a program mentions."""
    users = (
        (user, name)
        for user, statements in model.definitions.items()
        for name in {*names_used(statements)}
    )
    used_names = {name for user, name in users if user != name} | {MAIN}
    for name, (first, *_) in model.definitions.items():
        if name not in used_names:
            yield NamedPlace(name, span_of(first, model.source))


def duplicate_copies(model: Model) -> Iterator[tuple[NamedPlace, NamedPlace]]:
    """Yield the pairs of predicates that ``:=`` makes of the same."""
    firsts: dict[tuple[str, frozenset[tree.Argument]], NamedPlace] = {}
    for functor in model.functors:
        field = NamedPlace(functor.name, span_of(functor, model.source))
        first = firsts.setdefault((functor.base, frozenset(functor.arguments)), field)
        if first != field:
            yield field, first


def _site(
    name: str, rule: Rule, source: Prepared, *, is_function: bool, is_needed: bool
) -> RuleSite:
    column = rule.head.column("memory")
    memory = span_of(column, source) if column and column.expression else None
    body = span_of(rule.body, source) if rule.body else None
    span = span_of(rule, source)
    text = None if rule.body else tree.text_of(rule.head.columns[0].expression)
    key = span.text if text is None else text
    return RuleSite(str(name), span, is_function, is_needed, not rule.body, key, memory, body)


_DEEPEST = 8


def memory_fields(
    predicates: Mapping[str, Sequence[Rule]], functions: frozenset[str], source: Prepared
) -> tuple[list[NamedPlace], bool]:
    """Return the fields of `Robot`'s memory records, and whether there may be others."""
    fields: dict[str, NamedPlace] = {}
    is_open = False
    sources = Sources(source, predicates)

    def visit(value: Expression, rule: Rule, depth: int) -> None:
        nonlocal is_open
        match value:
            case tree.Record():
                for argument in value.arguments:
                    places = sources.of(argument.value, rule)
                    field = NamedPlace(str(argument.field), span_of(argument, source), places)
                    fields.setdefault(field.name, field)
            case tree.Choice():
                for branch in value.branches:
                    visit(branch.value, rule, depth)
                visit(value.otherwise, rule, depth)
            case tree.Variable() if bound := [
                part.right
                for part in tree.conjuncts(rule.body)
                if isinstance(part, Equation) and part.left == value
            ]:
                visit(bound[0], rule, depth)
            case Call(name=name) if name in functions and name in predicates and depth < _DEEPEST:
                for inner in predicates[name]:
                    if inner.value is not None:
                        visit(inner.value, inner, depth + 1)
            case tree.Literal() | tree.PredicateName():
                pass
            case _:
                is_open = True

    for rule in predicates.get(MAIN, ()):
        column = rule.head.column("memory")
        if column is not None and column.expression is None:
            is_open = True
        elif column is not None and column.expression is not None:
            visit(column.expression, rule, 0)
    return list(fields.values()), is_open


def texts_of(
    rules: Iterable[Rule], predicates: Container[str], source: Prepared
) -> Iterator[NamedPlace]:
    """Yield the texts in rules that are only compared or passed to a predicate."""
    rules = list(rules)
    times = Counter(
        node.value for rule in rules for node in tree.walk(rule) if isinstance(node, tree.Text)
    )
    for rule in rules:
        for node in tree.walk(rule):
            for value in _constants_in(node, predicates, is_fact=not rule.body):
                name = tree.text_of(value)
                if name and times[name] == 1:
                    yield NamedPlace(name, span_of(value, source))


def _constants_in(node: Node, predicates: Container[str], *, is_fact: bool) -> Sequence[Expression]:
    """Return the values in a node that are compared with something, or are in a fact."""
    match node:
        case Call() | tree.Atom() if (
            node.name in tree.COMPARISONS or node.name in predicates or node.name in INPUTS
        ):
            return tree.operands(node.arguments)
        case Equation():
            return node.left, node.right
        case tree.Membership(collection=tree.List(elements=elements)):
            return elements
        case Head() if is_fact:
            return tree.operands(node.columns)
    return ()
