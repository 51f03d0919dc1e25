"""Parts of bodies, heads, calls and expressions. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.explain.why import probing
from logical_robots_tui.language.tree import (
    COMPARISONS,
    JUNCTIONS,
    REST,
    Aggregate,
    Aggregation,
    Atom,
    Call,
    Choice,
    Disjunction,
    Expression,
    FieldAccess,
    Literal,
    PredicateName,
    Record,
    Variable,
    children,
    conjuncts,
    operands,
    variable_of,
    walk,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from logical_robots_tui.explain.why.probing import TermKind
    from logical_robots_tui.language.tree import Node, Proposition, Rule, Tree

MOST_CLAUSES = 32


class Names:
    """The predicates that rules may call.

    Args:
        functions: The required columns of each predicate that needs arguments.
        origins: For each copy, its original and the predicate made with ``:=``.
    """

    def __init__(
        self,
        functions: Mapping[str, Collection[str]],
        tables: Mapping[str, str],
        origins: Mapping[str, tuple[str, str]],
    ) -> None:
        self.functions = functions
        self.tables = tables
        self.origins = origins

    def is_own(self, name: str) -> bool:
        return name in self.functions or name in self.tables

    def call(self, name: str, arguments: Mapping[str, str]) -> probing.Call:
        return probing.Call(*self.origins.get(name, (name, "")), arguments)


def head_of(rule: Rule) -> tuple[dict[str, Expression], dict[str, Aggregation]]:
    plain: dict[str, Expression] = {}
    others: dict[str, Aggregation] = {}
    for each in rule.head.columns:
        if isinstance(each.value, Aggregation):
            others[each.column] = each.value
        elif each.field != REST:
            plain[each.column] = each.value
    return plain, others


def alternatives(body: Iterable[Proposition]) -> list[tuple[list[Proposition], list[Proposition]]]:
    """Return each choice of alternatives: the parts of the body, and what was chosen.

    Raises:
        TooManyError: There are too many to show.
    """
    found: list[tuple[list[Proposition], list[Proposition]]] = [([], [])]
    for part in body:
        options: list[tuple[list[Proposition], list[Proposition]]] = [([part], [])]
        if isinstance(part, Disjunction):
            options = [
                (parts, [branch, *taken])
                for branch in part.alternatives
                for parts, taken in alternatives(conjuncts(branch))
            ]
        if len(found) * len(options) > MOST_CLAUSES:
            raise TooManyError
        found = [
            ([*parts, *more], [*taken, *chosen])
            for parts, taken in found
            for more, chosen in options
        ]
    return found


class TooManyError(Exception):
    """A body has too many choices of alternatives."""


def values_in(node: Node, column: str) -> Iterator[Expression]:
    """Yield the expressions that a call has for a column."""
    for argument in node.arguments if isinstance(node, Atom | Call) else ():
        if argument.column == column and argument.expression:
            yield argument.expression


def kind_of(node: Node) -> TermKind:
    match node:
        case Literal() | PredicateName():
            return "literal"
        case Variable():
            return "variable"
        case Aggregate():
            return "aggregate"
        case Choice():
            return "if"
        case FieldAccess():
            return "field"
        case Record() if all(isinstance(each.field, str) for each in node.arguments):
            return "record"
        case Call(name="Coalesce"):
            return "coalesce"
        case Call(name="TryCast"):
            return "cast"
        case Call(name=name) if name in COMPARISONS | JUNCTIONS | {"!"}:
            return "truth"
    return "value"


def parts_of(node: Expression) -> list[Expression]:
    match kind_of(node), node:
        case "if", Choice():
            pairs = [part for each in node.branches for part in (each.condition, each.value)]
            return [*pairs, node.otherwise]
        case (("coalesce" | "truth"), Call()):
            return [*operands(node.arguments)]
        case "cast", Call():
            return [*operands(node.arguments)[:1]]
        case "field", _:
            while isinstance(node, FieldAccess):
                node = node.record
            return [node]
        case "record", Record():
            return [*operands(node.arguments)]
        case "value", _:
            inner = filter(_needs_explanation, walk(children(node), _needs_explanation))
            last = {each: each for each in inner if isinstance(each, Expression)}
            return [*last.values()]
    return []


def names_of(node: Expression) -> tuple[str, ...]:
    """Return the field names of a record, or the path that is read from one."""
    if isinstance(node, Record) and kind_of(node) == "record":
        return tuple(str(each.field) for each in node.arguments)
    names: list[str] = []
    while isinstance(node, FieldAccess):
        names.append(str(node.field))
        node = node.record
    return tuple(reversed(names))


def chains(tree: Tree) -> Iterator[FieldAccess]:
    """Yield the field accesses in a tree: ``sensor.radar``, ``memory.plan.at``."""
    found = walk(tree, chain_root)
    return (node for node in found if isinstance(node, FieldAccess) and chain_root(node))


def chain_root(node: Node) -> str:
    if not isinstance(node, FieldAccess):
        return ""
    while isinstance(node, FieldAccess):
        node = node.record
    return variable_of(node)


def _needs_explanation(node: Node) -> bool:
    """Return whether a part of a calculation or list needs its own explanation."""
    if isinstance(node, Choice | Aggregate | Variable | FieldAccess):
        return True
    return isinstance(node, Call) and kind_of(node) in ("coalesce", "cast", "truth")
