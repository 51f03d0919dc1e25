"""Conditions, rules and places that explanations need. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language import tree
from logical_robots_tui.language.tree import (
    COMPARISONS,
    REST,
    Aggregation,
    Argument,
    Atom,
    Boolean,
    Call,
    Conjunction,
    Equation,
    Head,
    Number,
    Rule,
    arguments,
    call,
    equated,
    is_aggregate,
    operands,
    variable_of,
    walk,
)
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence

    from logical_robots_tui.language.source_text import Prepared
    from logical_robots_tui.language.tree import Expression, Proposition, Tree

_OPENS = {"(": ")", "[": "]", "{": "}"}
_FALSE = Boolean("false")


def make_rule(
    name: str,
    columns: Mapping[str, Expression] | Mapping[int | str, Expression],
    body: Sequence[Proposition],
) -> Rule:
    """Make a rule."""
    return Rule(Head(name, arguments(columns)), Conjunction(tuple(body)) if body else None)


def span_of(node: Tree, source: Prepared) -> Span:
    """Return the place of a tree's text."""
    start, stop = tree.span_of(node) or (0, 0)
    return span_of_text(start, _closed(source.skeleton, start, stop), source.original)


def span_of_text(start: int, stop: int, text: str) -> Span:
    while start < stop and text[start].isspace():
        start += 1
    lines = (
        line.split("#")[0] if '"' not in line else line for line in text[start:stop].split("\n")
    )
    return Span(start, stop, text.count("\n", 0, start) + 1, " ".join(" ".join(lines).split()))


def _closed(skeleton: str, start: int, stop: int) -> int:
    open_brackets: list[str] = []
    for at in range(start, len(skeleton)):
        character = skeleton[at]
        if at >= stop and not open_brackets:
            return at
        if character in _OPENS:
            open_brackets.append(_OPENS[character])
        elif open_brackets and character == open_brackets[-1]:
            open_brackets.pop()
            if at >= stop and not open_brackets:
                return at + 1
    return max(stop, min(len(skeleton), stop))


def as_expression(part: Proposition) -> Expression:
    pair = equated(part)
    if pair is not None:
        return call("==", left=pair[0], right=pair[1])
    assert isinstance(part, Atom)
    return Call(part.name, part.arguments, span=part.span)


def as_part(condition: Expression, *, holds: bool) -> Proposition:
    """Return a part that holds where an expression is true, or where it is false or null."""
    known = call("Coalesce", condition, _FALSE)
    if holds:
        return Atom("!=", arguments({"left": known, "right": _FALSE}))
    return Equation(known, _FALSE)


def compared(condition: Expression) -> tuple[str, Expression, Expression] | None:
    if not isinstance(condition, Call) or condition.name not in COMPARISONS:
        return None
    sides = operands(condition.arguments)
    return (condition.name, sides[0], sides[1]) if len(sides) == 2 else None


def count_rule(
    name: str,
    columns: Mapping[str, Expression],
    differences: Mapping[int, Expression],
    body: Sequence[Proposition],
) -> Rule:
    """Make a rule that counts the ways in which a body holds, grouped by columns.

    Args:
        name: The predicate that it defines.
        columns: The columns to group by.
        differences: Numbers whose least and greatest value is wanted.
        body: The body.
    """
    aggregated = [
        Argument(f"{letter}{place}", Aggregation(operator, value))
        for place, value in differences.items()
        for letter, operator in (("l", "Min"), ("h", "Max"))
    ]
    number = Argument("n", Aggregation("+", Number("1")))
    head = Head(name, (*arguments(columns), *aggregated, number))
    return Rule(head, Conjunction(tuple(body)) if body else None, is_distinct=True)


def parameters(rule: Rule) -> list[tuple[str, str]] | None:
    """Return the columns of a function's head with their variables, or None if it has others."""
    found = []
    for each in rule.head.columns:
        if each.field == VALUE:
            continue
        variable = variable_of(each.expression)
        if not variable or each.field == REST:
            return None
        found.append((each.column, variable))
    return found


def outer_calls(node: Tree, own: Container[str]) -> Iterator[Call | Atom]:
    """Yield the calls of the program's own predicates in a tree, outside aggregates."""
    for each in walk(node, is_aggregate):
        if isinstance(each, Call | Atom) and each.name in own:
            yield each
