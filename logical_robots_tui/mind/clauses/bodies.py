"""Parts of bodies, heads, calls and expressions in the syntax tree. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses.scopes import column_name, flat
from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    JUNCTIONS,
    nodes,
    operands,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.why.probing import Call

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.why.probing import TermKind

MOST_CLAUSES = 32


class Names:
    """What is known about the predicates that rules may call.

    Args:
        functions: For each predicate that needs arguments, the columns that must be given.
        tables: For each other predicate, the table with its rows.
        origins: For each copy, its original and the predicate that it belongs to.
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
        """Return whether the program defines a predicate."""
        return name in self.functions or name in self.tables

    def call(self, name: str, arguments: Mapping[str, str]) -> Call:
        """Return a call of a predicate."""
        return Call(*self.origins.get(name, (name, "")), arguments)


def head_of(rule: Rule) -> tuple[dict[str, Rule], dict[str, Rule]]:
    """Return the expressions of a head's plain columns, and the aggregations of the others."""
    fields = rule["head"]["record"]["field_value"]
    plain = {column_name(f["field"]): value_of(f) for f in fields if f["field"] != "*"}
    others = {column_name(f["field"]): f["value"].get("aggregation") for f in fields}
    return (
        {column: value for column, value in plain.items() if value is not None},
        {column: value for column, value in others.items() if value is not None},
    )


def alternatives(body: Iterable[Rule]) -> list[tuple[list[Rule], list[Rule]]]:
    """Yield each choice of alternatives: the parts of the body, and what was chosen.

    Raises:
        TooManyError: There are too many to show.
    """
    found: list[tuple[list[Rule], list[Rule]]] = [([], [])]
    for part in body:
        options: list[tuple[list[Rule], list[Rule]]] = [([part], [])]
        if "disjunction" in part:
            options = [
                (parts, [branch, *taken])
                for branch in part["disjunction"]["disjunct"]
                for parts, taken in alternatives(flat(branch))
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


def values_in(call: Rule, column: str) -> Iterator[Rule]:
    """Return the expression that a call has for a column, or None."""
    for argument in call.get("record", {}).get("field_value", ()):
        if column_name(argument["field"]) == column and "expression" in argument["value"]:
            yield argument["value"]["expression"]


def is_denial(combine: Rule) -> bool:
    """Return whether this is the package's form of a negation."""
    (column,) = combine["head"]["record"]["field_value"]
    argument = column["value"].get("aggregation", {}).get("argument", {})
    literal = argument.get("literal", {}).get("the_number", {}).get("number")
    return literal == "1" and not hasattr(literal, "heritage")


def plain_text(tree: Any) -> str:
    """Return a text that is equal for equal expressions, wherever they are."""
    if isinstance(tree, dict):
        inner = (f"{k}:{plain_text(v)}" for k, v in tree.items() if k not in _HERITAGE)
        return f"{{{','.join(inner)}}}"
    if isinstance(tree, list):
        return f"[{','.join(map(plain_text, tree))}]"
    return repr(str(tree))


_HERITAGE = ("expression_heritage", "full_text")


def kind_of(tree: Rule) -> TermKind:
    """Return the kind of an expression."""
    if "literal" in tree and "the_list" not in tree["literal"]:
        return "literal"
    if "variable" in tree:
        return "variable"
    if "combine" in tree:
        return "aggregate"
    if "implication" in tree:
        return "if"
    if "subscript" in tree:
        return "field"
    if "record" in tree and all(isinstance(f["field"], str) for f in _fields(tree)):
        return "record"
    name = str(tree.get("call", {}).get("predicate_name", ""))
    if name in ("Coalesce", "TryCast"):
        return "coalesce" if name == "Coalesce" else "cast"
    return "truth" if name in COMPARISONS | JUNCTIONS | {"!"} else "value"


def parts_of(tree: Rule, kind: TermKind) -> list[Rule]:
    """Return the parts of an expression that explain where its value comes from."""
    if kind == "if":
        implication = tree["implication"]
        branches = implication["if_then"]
        pairs = [b[part] for b in branches for part in ("condition", "consequence")]
        return [*pairs, implication["otherwise"]]
    if kind in ("coalesce", "truth"):
        return operands(tree["call"])
    if kind == "cast":
        return operands(tree["call"])[:1]
    if kind == "field":
        while "subscript" in tree:
            tree = tree["subscript"]["record"]
        return [tree]
    if kind == "record":
        return [f["value"]["expression"] for f in _fields(tree) if "expression" in f["value"]]
    return list(_inside(tree)) if kind == "value" else []


def names_of(tree: Rule, kind: TermKind) -> tuple[str, ...]:
    """Return the field names of a record, or the path that is read from one."""
    if kind == "record":
        return tuple(str(f["field"]) for f in _fields(tree) if "expression" in f["value"])
    names: list[str] = []
    while kind == "field" and "subscript" in tree:
        symbol = tree["subscript"]["subscript"].get("literal", {}).get("the_symbol", {})
        names.append(str(symbol.get("symbol", "")))
        tree = tree["subscript"]["record"]
    return tuple(reversed(names))


def chains(tree: Any) -> Iterator[Rule]:
    """Yield the field accesses in a syntax tree: ``sensor.radar``, ``memory.plan.at``."""
    return filter(chain_root, nodes(tree, chain_root))


def chain_root(tree: Rule) -> str:
    """Return the variable at the root of a chain of field accesses, or ""."""
    if "subscript" not in tree:
        return ""
    while "subscript" in tree:
        tree = tree["subscript"].get("record", {})
    return variable_of(tree)


def _fields(tree: Rule) -> list[Rule]:
    found: list[Rule] = tree["record"]["field_value"]
    return found


def _inside(tree: Rule) -> Iterator[Rule]:
    """Yield the parts of a calculation or list that need their own explanation."""
    return filter(_is_told, nodes([*tree.values()], _is_told))


def _is_told(node: Rule) -> bool:
    if {"implication", "combine", "variable", "subscript"} & node.keys():
        return True
    return "call" in node and kind_of(node) in ("coalesce", "cast", "truth")
