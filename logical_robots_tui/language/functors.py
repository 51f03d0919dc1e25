"""Predicates made with ``:=``, expanded into rules of their own."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from logical_robots_tui.language.definitions import definitions, reach
from logical_robots_tui.language.tree import (
    Aggregate,
    Aggregation,
    Annotation,
    Argument,
    Atom,
    Call,
    Functor,
    Head,
    PredicateName,
    Rule,
    Variable,
    arguments,
    has_rows,
    rebuild,
)
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import TypeVar

    from logical_robots_tui.language.tree import Node, Statement

    N = TypeVar("N", bound=Node)


@dataclass(frozen=True, slots=True)
class Expanded:
    """The rules of a program with every ``:=`` expanded.

    Attributes:
        rules: The rules of each predicate, including copies made by ``:=``.
        annotations: Its annotations.
        names: The name of the copy, by predicate and the made predicate that it belongs to.
        origins: The reverse of `names`.
        bases: For each made predicate, the one that it is ultimately made from.
    """

    rules: dict[str, list[Rule]]
    annotations: list[Annotation]
    names: dict[tuple[str, str], str] = field(default_factory=dict)
    origins: dict[str, tuple[str, str]] = field(default_factory=dict)
    bases: dict[str, str] = field(default_factory=dict)

    def name_of(self, predicate: str, within: str) -> str:
        return self.names.get((predicate, within), predicate)

    def reach(self, name: str) -> set[str]:
        return reach(self.rules.get(name, ()), self.rules)


def expand(program: Iterable[Statement]) -> Expanded:
    program = list(program)
    functors: dict[str, Functor] = {}
    rules: dict[str, list[Rule]] = {}
    for name, own in definitions(program).items():
        if isinstance(own[0], Functor):
            functors[name] = own[0]
        else:
            rules[name] = [each for each in own if isinstance(each, Rule)]
    expanded = Expanded(rules, [each for each in program if isinstance(each, Annotation)])
    while functors:
        ready = [n for n, functor in functors.items() if _is_ready(functor, functors, expanded)]
        for name in ready or list(functors):
            _make(functors.pop(name), expanded)
    return expanded


def expand_functors(program: list[Statement]) -> list[Statement]:
    """Expand every ``:=`` if one makes what the package can't: from a recursion, or whole rows."""
    if not any(isinstance(each, Functor) for each in program):
        return program
    expanded = expand(program)
    made = {**expanded.bases, **{copy: first for copy, (first, _) in expanded.origins.items()}}
    recursive = {name for name in expanded.rules if name in expanded.reach(name)}
    if not has_rows(program) and not recursive & {*made, *made.values()}:
        return program
    copies = [
        rename(annotation, {original: name})
        for name, original in made.items()
        for annotation in expanded.annotations
        if annotation.subject == original and (annotation.name != "@Recursive" or name in recursive)
    ]
    rules = (rule for own in expanded.rules.values() for rule in own)
    return [*expanded.annotations, *copies, *rules]


def _is_ready(functor: Functor, waiting: Mapping[str, Functor], expanded: Expanded) -> bool:
    needed = {functor.base, *expanded.reach(functor.base)}
    for argument in functor.arguments:
        if isinstance(argument.value, PredicateName):
            needed |= {argument.value.name, *expanded.reach(argument.value.name)}
    return not needed & waiting.keys()


def _make(functor: Functor, expanded: Expanded) -> None:
    name, base = functor.name, functor.base
    given = {}
    for number, argument in enumerate(functor.arguments):
        if isinstance(argument.value, PredicateName):
            given[str(argument.field)] = argument.value.name
        else:
            constant = f"{name}_given{number}"
            given[str(argument.field)] = constant
            columns = (Argument(VALUE, argument.value),)
            expanded.rules[constant] = [Rule(Head(constant, columns))]
    expanded.bases[name] = expanded.bases.get(base, base)
    if not given and base in expanded.reach(base) and expanded.rules.get(base):
        expanded.rules[name] = [_same_rows(name, expanded.rules[base][0].head)]
        return
    used = {base, *expanded.reach(base)}
    touched = {p for p in used - given.keys() if expanded.reach(p) & given.keys()} | {base}
    copies = {p: f"{p}_in_{name}" for p in touched if p in expanded.rules} | {base: name}
    renaming = {f"{old}": f"{new}" for old, new in {**copies, **given}.items()}
    for original, copy in copies.items():
        expanded.rules[copy] = [
            replace(renamed, head=replace(renamed.head, name=f"{copy}"))
            for renamed in (rename(rule, renaming) for rule in expanded.rules.get(original, ()))
        ]
        if copy != name:
            first = expanded.origins.get(original, (original, ""))[0]
            expanded.names[first, name] = copy
            expanded.origins[copy] = first, name


def _same_rows(name: str, head: Head) -> Rule:
    """Return a rule that gives a predicate the rows of another."""
    columns = arguments({each.field: Variable(f"c{n}") for n, each in enumerate(head.columns)})
    return Rule(Head(name, columns), Atom(head.name, columns))


def rename(node: N, names: Mapping[str, str]) -> N:
    """Return a node in which other predicates are called."""

    def change(inner: Node) -> Node:
        inner = rebuild(inner, change)
        if isinstance(inner, Call | Atom | PredicateName) and inner.name in names:
            return replace(inner, name=names[inner.name])
        if isinstance(inner, Aggregate | Aggregation) and inner.operator in names:
            return replace(inner, operator=names[inner.operator])
        return inner

    return change(node)  # type: ignore[return-value]  # a kind for its kind
