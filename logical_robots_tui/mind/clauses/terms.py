"""Kinds of expressions, and the parts that explain where their value comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    JUNCTIONS,
    nodes,
    operands,
    variable_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.why.probing import TermKind

__all__ = ["chain_root", "chains", "kind_of", "names_of", "parts_of"]


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
