"""Pieces of syntax trees, as the `logica` package's parser makes them. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.compiling.quicker import deep_copy

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["any_value", "asked", "equal", "make", "number", "renamed", "rule", "variable"]


def variable(name: str) -> Rule:
    """A variable."""
    return {"variable": {"var_name": name}}


def number(text: str) -> Rule:
    """A number."""
    return {"literal": {"the_number": {"number": text}}}


def asked(predicate: str, columns: Mapping[str | int, Rule]) -> Rule:
    """A call of a predicate, as part of a body."""
    return {"predicate": {"predicate_name": predicate, "record": _record(columns)}}


def equal(left: Rule, right: Rule) -> Rule:
    """An equation, as part of a body."""
    return {"unification": {"left_hand_side": left, "right_hand_side": right}}


def any_value(of: Rule, local: str) -> Rule:
    """The value of an expression, or null if it has none.

    Args:
        of: The expression.
        local: Name of a variable that is used nowhere else.
    """
    text = parse.HeritageAwareString("AnyValue")
    collected = {
        "operator": "AnyValue",
        "argument": variable(local),
        "expression_heritage": text,
    }
    head = {"field": "logica_value", "value": {"aggregation": collected}}
    combine = {
        "head": {"predicate_name": "Combine", "record": {"field_value": [head]}},
        "distinct_denoted": True,
        "full_text": text,
        "body": {"conjunction": {"conjunct": [equal(variable(local), of)]}},
    }
    return {"combine": combine}


def rule(name: str, columns: Mapping[str | int, Rule], body: Iterable[Rule], text: str) -> Rule:
    """A rule; each of its parts is copied, so that none stands in two places.

    Args:
        name: The predicate that it defines.
        columns: The expressions of its head.
        body: The parts of its body.
        text: What to call it in a complaint.
    """
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


def make(name: str, base: str, given: Mapping[str | int, Rule]) -> Rule:
    """A rule that makes a predicate from another, with ``:=``.

    Args:
        name: The new predicate.
        base: What it is made from.
        given: What is filled in, by the names of what is left open.
    """
    predicates = [{"literal": {"the_predicate": {"predicate_name": each}}} for each in (name, base)]
    columns: dict[str | int, Rule] = dict(enumerate([*predicates, {"record": _record(given)}]))
    return rule("@Make", columns, (), name)


def renamed(tree: Any, names: Mapping[str, str]) -> Any:
    """A copy of a syntax tree with other names of variables."""
    tree = deep_copy(tree)
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            if isinstance(node.get("variable"), dict):
                name = node["variable"]["var_name"]
                node["variable"]["var_name"] = names.get(name, name)
            waiting.extend(node.values())
        elif isinstance(node, list):
            waiting.extend(node)
    return tree


def _record(columns: Mapping[str | int, Rule]) -> Rule:
    return {
        "field_value": [
            {"field": name, "value": {"expression": value}} for name, value in columns.items()
        ]
    }
