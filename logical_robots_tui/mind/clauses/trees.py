"""Building syntax trees in the form of the `logica` package's parser. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.compiling.package_patches import deep_copy

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["asked", "call", "equal", "fields", "number", "record", "rule", "text", "variable"]


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
    """Return a rule; its parts are copied, so that no node is shared.

    Args:
        name: The predicate that it defines.
        columns: The expressions of its head.
        body: The parts of its body.
        text: Its text in error messages.
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


def fields(columns: Mapping[Any, Rule]) -> list[Rule]:
    """Return the fields of a record, a head or a call."""
    return [{"field": name, "value": {"expression": value}} for name, value in columns.items()]


def _record(columns: Mapping[Any, Rule]) -> Rule:
    return {"field_value": fields(columns)}
