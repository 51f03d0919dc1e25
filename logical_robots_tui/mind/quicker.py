"""A few functions of the `logica` package, rewritten so that compiling takes half the time.

The package puts expressions into each other without copying them, so the same part hangs in many
places, and walks through it once for every place. Here it is walked through once. And for every
character that its parser looks at, it makes a text that knows where it stands; but of a single
character nobody asks that.
"""

from __future__ import annotations

from typing import Any

from logica.compiler import rule_translate
from logica.parser_py import parse

__all__ = ["install", "mentioned_variables", "replace_variable"]


def replace_variable(old_var: Any, new_expr: Any, s: dict[str, Any] | list[Any]) -> None:
    """Replace a variable in a syntax tree of the package.

    Args:
        old_var: Name of the variable.
        new_expr: The tree that takes its place everywhere; not copied.
        s: The tree; changed in place.
    """
    assert isinstance(s, dict | list)
    waiting: list[Any] = [s]
    seen = set()
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            if isinstance(value, dict):
                if "variable" in value and value["variable"]["var_name"] == old_var:
                    node[key] = value = new_expr
                if isinstance(value, dict | list):
                    waiting.append(value)
            elif isinstance(value, list):
                waiting.append(value)


def mentioned_variables(
    x: Any, dive_in_combines: bool = False, this_is_select: bool = False
) -> set[Any]:
    """Names of the variables in a syntax tree of the package.

    Args:
        x: The tree.
        dive_in_combines: Whether to look into aggregating expressions.
        this_is_select: Whether the tree is a record of columns, one of which may be called
            ``variable``.
    """
    found = set()
    waiting = [x]
    seen = set()
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, dict):
            if "variable" in node and not (this_is_select and node is x):
                found.add(node["variable"]["var_name"])
            for key, value in node.items():
                if isinstance(value, dict | list) and (dive_in_combines or key != "combine"):
                    waiting.append(value)
        elif isinstance(node, list):
            waiting += [value for value in node if isinstance(value, dict | list)]
    return found


def _slice(self: parse.HeritageAwareString, start: int, stop: int) -> parse.HeritageAwareString:
    """A part of a text that knows where it stands."""
    size = len(self)
    part = parse.HeritageAwareString.__new__(
        parse.HeritageAwareString, str.__getitem__(self, slice(start, stop))
    )
    part.start = self.start + start
    part.stop = self.start + (size if stop > size else stop if stop >= 0 else size + stop)
    part.heritage = self.heritage
    return part


def _item(self: parse.HeritageAwareString, place: int | slice) -> str:
    if isinstance(place, slice):
        stop = place.stop
        part: str = _slice(self, place.start or 0, len(self) if stop is None else stop)
        return part
    character: str = str.__getitem__(self, place)
    return character


def install() -> None:
    """Let the package use them."""
    parse.HeritageAwareString.GetSlice = _slice
    parse.HeritageAwareString.__getitem__ = _item
    rule_translate.ReplaceVariable = replace_variable
    rule_translate.AllMentionedVariables = mentioned_variables
