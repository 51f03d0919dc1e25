"""Parameters of a program: predicates that ``New := Old(Open: Given)`` substitutes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.compiling.rules import called, head_name, heads, value_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["filled_in", "lacking", "mentioned_by_make", "parameters"]


def parameters(rules: list[Rule]) -> frozenset[str]:
    """Return the names of predicates that are substituted somewhere and defined nowhere."""
    filled = {name for rule in rules for name in filled_in(rule)}
    return frozenset(filled.difference(heads(rules)))


def lacking(rules: list[Rule]) -> dict[str, str]:
    """Return for each predicate that uses an unsubstituted parameter the name of that parameter."""
    own, left_open = heads(rules), parameters(rules)

    def first_open(name: str, filled: frozenset[str], seen: set[str]) -> Iterator[str]:
        if name in left_open:
            if name not in filled:
                yield name
        elif name in own and name not in seen:
            seen.add(name)
            for rule in own[name]:
                inside = filled.union(filled_in(rule))
                for other in map(str, called(rule)):
                    yield from first_open(other, inside, seen)

    found = {name: next(first_open(name, frozenset(), set()), "") for name in own}
    return {name: other for name, other in found.items() if other}


def mentioned_by_make(rule: Rule) -> set[str]:
    """Return the predicates that a rule with ``:=`` makes, copies, substitutes or puts in."""
    return {*map(str, called(rule)), *filled_in(rule)}


def filled_in(rule: Rule) -> list[str]:
    """Return the names that a rule with ``:=`` substitutes."""
    if head_name(rule) != "@Make":
        return []
    arguments = rule["head"]["record"]["field_value"]
    given = value_of(arguments[2]) if len(arguments) > 2 else None
    record = (given or {}).get("record", {})
    return [str(fv["field"]) for fv in record.get("field_value", [])]
