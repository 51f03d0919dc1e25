"""Memory fields that a program writes, and texts that it compares. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.clauses.scopes import flat
from logical_robots_tui.mind.clauses.spans import span_of
from logical_robots_tui.mind.compiling.rules import (
    COMPARISONS,
    VALUE,
    nodes,
    operands,
    text_of,
    value_of,
)
from logical_robots_tui.mind.diagnosis.sites import Field
from logical_robots_tui.mind.program import INPUTS

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["texts_of", "written_fields"]

_DEEPEST = 8


def written_fields(
    own: Mapping[str, list[Rule]], functions: frozenset[str], text: str, source: Prepared
) -> tuple[list[Field], bool]:
    """Return the fields of `Robot`'s memory records, and whether there may be others.

    Args:
        own: The rules of the program's own predicates.
        functions: Names of those that need arguments.
        text: The program.
        source: The same, prepared.
    """
    found: dict[str, Field] = {}
    is_open = False

    def look(value: Rule, rule: Rule, depth: int) -> None:
        nonlocal is_open
        call = value.get("call", {})
        name = str(call.get("predicate_name", ""))
        if "record" in value:
            for fv in value["record"]["field_value"]:
                place = fv["value"].get("expression", {})
                span = span_of([fv["field"], place], text, source)
                found.setdefault(str(fv["field"]), Field(str(fv["field"]), span))
        elif "implication" in value:
            for branch in value["implication"]["if_then"]:
                look(branch["consequence"], rule, depth)
            look(value["implication"]["otherwise"], rule, depth)
        elif "variable" in value and (bound := _bound(value, rule)) is not None:
            look(bound, rule, depth)
        elif name in functions and name in own and depth < _DEEPEST:
            for inner in own[name]:
                for fv in inner["head"]["record"]["field_value"]:
                    if fv["field"] == VALUE and (given := value_of(fv)) is not None:
                        look(given, inner, depth + 1)
        elif "literal" not in value or "the_list" in value["literal"]:
            is_open = True

    for rule in own.get(MAIN, ()):
        for fv in rule["head"]["record"]["field_value"]:
            if fv["field"] == "memory":
                value = value_of(fv)
                if value is None:
                    is_open = True
                else:
                    look(value, rule, 0)
    return list(found.values()), is_open


def texts_of(
    rules: Iterable[Rule], own: Container[str], text: str, source: Prepared
) -> Iterator[Field]:
    """Return the texts in some rules that are compared or passed to a predicate.

    Args:
        rules: The rules.
        own: Names of the program's own predicates.
        text: The program.
        source: The same, prepared.
    """
    for rule in rules:
        for node in nodes(rule):
            for value in _meant_for_something(node, own, is_fact="body" not in rule):
                name = text_of(value)
                if name:
                    yield Field(name, span_of(value, text, source))


def _meant_for_something(node: Rule, own: Container[str], *, is_fact: bool) -> Iterator[Rule]:
    """Yield the values in a node that are compared with something, or are in a fact."""
    for key in ("call", "predicate"):
        call = node.get(key)
        if isinstance(call, dict) and "record" in call:
            name = str(call["predicate_name"])
            if name in COMPARISONS or name in own or name in INPUTS:
                yield from operands(call)
    if "unification" in node:
        yield from node["unification"].values()
    if "inclusion" in node:
        yield from (
            node["inclusion"]["list"].get("literal", {}).get("the_list", {}).get("element", ())
        )
    if is_fact and "head" in node:
        yield from operands(node["head"])


def _bound(value: Rule, rule: Rule) -> Rule | None:
    """Return the expression that a variable is equal to in a body, or None."""
    for part in flat(rule.get("body")):
        pair = part.get("unification")
        if pair is not None and pair["left_hand_side"] == value:
            right: Rule = pair["right_hand_side"]
            return right
    return None
