"""Building syntax trees of bodies and expressions. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    VALUE,
    equated,
    is_aggregate,
    nodes,
    operands,
    value_of,
    variable_of,
)

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = [
    "as_expression",
    "as_part",
    "compared",
    "counted",
    "field_of",
    "filled",
    "outer_calls",
    "parameters",
]

_FALSE = {"literal": {"the_bool": {"the_bool": "false"}}}


def filled(tree: Any, given: Mapping[str, Rule]) -> Any:
    """Return a copy of a syntax tree with variables replaced by expressions."""
    if isinstance(tree, list):
        return [filled(each, given) for each in tree]
    if not isinstance(tree, dict):
        return tree
    if isinstance(tree.get("variable"), dict):
        name = variable_of(tree)
        return given[name] if name in given else {**tree, "variable": dict(tree["variable"])}
    return {key: filled(value, given) for key, value in tree.items()}


def as_expression(part: Rule) -> Rule:
    """Return a condition of a body as a boolean expression."""
    pair = equated(part)
    if pair is not None:
        return trees.call("==", left=pair[0], right=pair[1])
    return {"call": part["predicate"]}


def as_part(condition: Rule, *, holds: bool) -> Rule:
    """Return a part that holds where an expression is true, or where it is false or null."""
    known = trees.call("Coalesce", condition, _FALSE)
    if holds:
        return {"predicate": trees.call("!=", left=known, right=_FALSE)["call"]}
    return trees.equal(known, _FALSE)


def compared(condition: Rule) -> tuple[str, Rule, Rule] | None:
    """Return the comparison of a condition and its two sides, or None."""
    call = condition.get("call", {})
    sides = operands(call) if call else []
    name = str(call.get("predicate_name", ""))
    return (name, sides[0], sides[1]) if name in COMPARISONS and len(sides) == 2 else None


def field_of(subscript: Rule) -> str:
    """Return the field that is read from a record."""
    return str(subscript["subscript"]["literal"]["the_symbol"]["symbol"])


def counted(
    name: str, columns: Mapping[str, Rule], differences: Mapping[int, Rule], body: Sequence[Rule]
) -> Rule:
    """Return a rule that counts the ways in which a body holds, grouped by columns.

    Args:
        name: The predicate that it defines.
        columns: The columns to group by.
        differences: Numbers whose least and greatest value is wanted.
        body: The body.
    """
    head: dict[str | int, Rule] = {}
    head.update(columns)
    found = trees.rule(name, head, body, name)
    fields = found["head"]["record"]["field_value"]
    for number, value in differences.items():
        fields.append(_collected(f"l{number}", "Min", filled(value, {})))
        fields.append(_collected(f"h{number}", "Max", filled(value, {})))
    fields.append(_collected("n", "+", trees.number("1")))
    return {**found, "distinct_denoted": True}


def _collected(column: str, operator: str, argument: Rule) -> Rule:
    heritage = parse.HeritageAwareString(operator)
    aggregation = {"operator": operator, "argument": argument, "expression_heritage": heritage}
    return {"field": column, "value": {"aggregation": aggregation}}


def parameters(rule: Rule) -> list[tuple[int | str, str]] | None:
    """Return the fields of a function's head with their variables, or None if it has others."""
    found = []
    for fv in rule["head"]["record"]["field_value"]:
        if fv["field"] == VALUE:
            continue
        value = value_of(fv) or {}
        if "variable" not in value or fv["field"] == "*":
            return None
        found.append((fv["field"], variable_of(value)))
    return found


def outer_calls(tree: Any, own: Container[str]) -> Iterator[Rule]:
    """Yield the calls of the program's own predicates in a syntax tree, outside aggregates."""
    for node in nodes(tree, is_aggregate):
        for key in ("call", "predicate"):
            if isinstance(node.get(key), dict) and str(node[key]["predicate_name"]) in own:
                yield node[key]
