"""Building syntax trees in the form of the `logica` package's parser, and the places of such trees.

In the compile process.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    equated,
    is_aggregate,
    nodes,
    operands,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.why.probing import Span

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping, Sequence

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared


def variable(name: str) -> Rule:
    """Return a variable."""
    return {"variable": {"var_name": name}}


def number(text: str) -> Rule:
    """Return a number."""
    return {"literal": {"the_number": {"number": text}}}


def text(value: str) -> Rule:
    """Return a text."""
    return {"literal": {"the_string": {"the_string": value}}, "expression_heritage": value}


def record(columns: Mapping[Any, Rule]) -> Rule:
    """Return a record."""
    return {"record": _record(columns)}


def call(name: str, *given: Rule, **named: Rule) -> Rule:
    """Return a call of a function or an operator."""
    columns: dict[int | str, Rule] = dict(enumerate(given))
    columns.update(named)
    return {"call": {"predicate_name": name, "record": _record(columns)}}


def asked(predicate: str, columns: Mapping[Any, Rule]) -> Rule:
    """Return a call of a predicate, as part of a body."""
    return {"predicate": {"predicate_name": predicate, "record": _record(columns)}}


def equal(left: Rule, right: Rule) -> Rule:
    """Return an equation, as part of a body."""
    return {"unification": {"left_hand_side": left, "right_hand_side": right}}


def rule(name: str, columns: Mapping[Any, Rule], body: Iterable[Rule], text: str) -> Rule:
    """Return a rule; its parts are copied, so that no node is shared."""
    found: Rule = {
        "head": {
            "predicate_name": name,
            "record": _record({field: deep_copy(value) for field, value in columns.items()}),
        },
        "full_text": parse.HeritageAwareString(text),
    }
    if conjuncts := [deep_copy(part) for part in body]:
        found["body"] = {"conjunction": {"conjunct": conjuncts}}
    return found


def fields(columns: Mapping[Any, Rule]) -> list[Rule]:
    """Return the fields of a record, a head or a call."""
    return [{"field": name, "value": {"expression": value}} for name, value in columns.items()]


def _record(columns: Mapping[Any, Rule]) -> Rule:
    return {"field_value": fields(columns)}


_OPENS = {"(": ")", "[": "]", "{": "}"}


def span_of(tree: Any, source: Prepared) -> Span:
    """Return the place of a syntax tree's text."""
    places = list(_places(tree, source.text))
    start = min((start for start, _ in places), default=0)
    stop = max((stop for _, stop in places), default=0)
    return span_of_text(start, _closed(source.skeleton, start, stop), source.original)


def span_of_text(start: int, stop: int, text: str) -> Span:
    """Return a piece of a text, given by its offsets."""
    while start < stop and text[start].isspace():
        start += 1
    lines = (
        line.split("#")[0] if '"' not in line else line for line in text[start:stop].split("\n")
    )
    return Span(start, stop, text.count("\n", 0, start) + 1, " ".join(" ".join(lines).split()))


def _places(tree: Any, text: str) -> Iterator[tuple[int, int]]:
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            waiting.extend(node.values())
        elif isinstance(node, list):
            waiting.extend(node)
        elif getattr(node, "heritage", None) == text and str(node) == text[node.start : node.stop]:
            yield node.start, node.stop


def _closed(skeleton: str, start: int, stop: int) -> int:
    """Extend a piece to close the brackets that it opens."""
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
        return call("==", left=pair[0], right=pair[1])
    return {"call": part["predicate"]}


def as_part(condition: Rule, *, holds: bool) -> Rule:
    """Return a part that holds where an expression is true, or where it is false or null."""
    known = call("Coalesce", condition, _FALSE)
    if holds:
        return {"predicate": call("!=", left=known, right=_FALSE)["call"]}
    return equal(known, _FALSE)


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
    found = rule(name, columns, body, name)
    columns_of_head = found["head"]["record"]["field_value"]
    for place, value in differences.items():
        columns_of_head.append(_collected(f"l{place}", "Min", filled(value, {})))
        columns_of_head.append(_collected(f"h{place}", "Max", filled(value, {})))
    columns_of_head.append(_collected("n", "+", number("1")))
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
