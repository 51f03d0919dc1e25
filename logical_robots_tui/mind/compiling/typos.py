"""Variables that are used once and look like a misspelling of another one."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from logical_robots_tui.mind.close import distance
from logical_robots_tui.mind.compiling.rules import head_name, nodes
from logical_robots_tui.mind.text import diagnostic_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic

__all__ = ["typos"]

_SHORTEST = 4  # letters of a word that can be recognised as misspelt
_LONG = 7  # letters of a word in which two may be wrong


def typos(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    """Warnings about variables that are probably meant to be another one of their rule."""
    for rule in rules:
        if head_name(rule).startswith("@"):
            continue
        variables = [n["variable"]["var_name"] for n in nodes(rule) if "variable" in n]
        shorthand = {n["field"] for n in nodes(rule) if _is_shorthand(n)}
        counts = Counter(map(str, variables))
        for at, name in enumerate(variables):
            if counts[name] > 1 or name in shorthand:
                continue
            earlier = dict.fromkeys(map(str, variables[:at]))
            others = (o for o in counts if o in earlier or counts[o] > 1)
            meant = next((o for o in others if o != name and _looks_like(name, o)), "")
            if meant:
                message = f"{name} is used only once; is it a misspelt {meant}?"
                hint = f"Write {meant} if you mean the same."
                yield diagnostic_for(text, name, message, hint, "warning")


def _is_shorthand(node: Rule) -> bool:
    """Whether this is `name:`, which names a column and its variable at once."""
    if "field" not in node:
        return False
    variable = node["value"].get("expression", {}).get("variable")
    return bool(variable) and variable["var_name"] == node["field"]


def _looks_like(name: str, other: str) -> bool:
    """Whether two names differ by a slip in one long word and by nothing that means something."""
    left, right = name.split("_"), other.split("_")
    if len(left) != len(right):
        return False
    different = [(a, b) for a, b in zip(left, right, strict=True) if a != b]
    if len(different) != 1:
        return False
    one, two = different[0]
    if min(len(one), len(two)) < _SHORTEST or one.rstrip("s") == two.rstrip("s"):
        return False
    if any(c.isdigit() for c in one + two):
        return False
    allowed = 2 if min(len(one), len(two)) >= _LONG else 1
    return distance(one, two) <= allowed and one[0] == two[0]
