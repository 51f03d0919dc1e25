"""What a part of a rule compares, and which predicates of the program it asks with what.

In the compile process.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.compiling.rules import COMPARISONS, JUNCTIONS
from logical_robots_tui.mind.why.scopes import combines

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["asks", "column_name", "compared", "has_conditions", "outer_calls"]


def compared(part: Rule) -> Iterator[tuple[Rule, bool]]:
    """The expressions whose values tell why a part holds or not, and whether each is a truth."""
    if "unification" in part:
        pair = part["unification"]
        yield from _of_values(pair["left_hand_side"])
        yield from _of_values(pair["right_hand_side"])
    elif "inclusion" in part:
        yield from _of_values(part["inclusion"]["list"])
    elif "predicate" in part:
        call = part["predicate"]
        name = str(call["predicate_name"])
        for operand in _operands(call):
            yield from _of_truth(operand) if name in JUNCTIONS else _of_values(operand)


def has_conditions(expression: Rule) -> bool:
    """Whether there is an ``if`` in an expression."""
    return any("implication" in node for node in _outer(expression))


def outer_calls(tree: Any, own: Container[str]) -> Iterator[Rule]:
    """The calls of the program's own predicates in a syntax tree, outside of its aggregates."""
    for node in _outer(tree):
        for key in ("call", "predicate"):
            if isinstance(node.get(key), dict) and str(node[key]["predicate_name"]) in own:
                yield node[key]


def asks(call: Rule) -> Iterator[tuple[str, Rule]]:
    """The columns that a call gives or takes, by their names, and the expressions there."""
    for argument in call["record"]["field_value"]:
        name, value = argument["field"], argument["value"].get("expression")
        if value is not None and name != "*":
            yield column_name(name), value


def column_name(field: str | int) -> str:
    """The column that a field of a head or a call is: those by position are col0, col1 ..."""
    return f"col{field}" if isinstance(field, int) else str(field)


def _of_values(expression: Rule) -> Iterator[tuple[Rule, bool]]:
    if "literal" in expression and "the_list" not in expression["literal"]:
        return
    if "implication" in expression:
        implication = expression["implication"]
        for branch in implication["if_then"]:
            yield from _of_truth(branch["condition"])
        for value in (
            *(b["consequence"] for b in implication["if_then"]),
            implication["otherwise"],
        ):
            if has_conditions(value):
                yield from _of_values(value)
        return
    call = expression.get("call", {})
    if str(call.get("predicate_name", "")) in COMPARISONS | JUNCTIONS | {"!"}:
        yield from _of_truth(expression)
    elif has_conditions(expression):
        for branch in _branches(expression):
            yield from _of_values(branch)
    elif not any(combines(expression)):
        yield expression, False


def _of_truth(expression: Rule) -> Iterator[tuple[Rule, bool]]:
    """A condition and what it compares."""
    yield expression, True
    call = expression.get("call", {})
    name = str(call.get("predicate_name", ""))
    for operand in _operands(call) if call else ():
        if name in JUNCTIONS or name == "!":
            yield from _of_truth(operand)
        elif name in COMPARISONS:
            yield from _of_values(operand)


def _branches(expression: Rule) -> Iterator[Rule]:
    """The outermost ``if`` of each part of an expression."""
    for node in _outer(expression, stop="implication"):
        if "implication" in node:
            yield node


def _operands(call: Rule) -> list[Rule]:
    values = (argument["value"].get("expression") for argument in call["record"]["field_value"])
    return [value for value in values if value is not None]


def _outer(tree: Any, stop: str = "") -> Iterator[Rule]:
    """The nodes of a syntax tree that do not stand in an aggregate."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            if "combine" in node:
                continue
            yield node
            if not stop or stop not in node:
                waiting.extend(reversed(list(node.values())))
        elif isinstance(node, list):
            waiting.extend(reversed(node))
