"""Constants of a program, `Near() = 40;`, given other values in its parsed rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.compiling.parsing import parse_statements
from logical_robots_tui.mind.compiling.rules import fields, heads, value_of
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.source_text import prepare

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = ["with_constants"]


def with_constants(text: str, values: Mapping[str, str]) -> str:
    """Return the text of a program in whose parsed rules some constants have other values.

    The rest of the text stays as it is, and so do the numbers of its lines.

    Args:
        text: The program.
        values: Expressions on one line by the constants' names.

    Raises:
        ProgramError: The program has errors, or a name is not that of a constant.
    """
    rules = _parsed(text)
    found = heads(rules)
    wanted = deep_copy(rules)
    spans = []
    for name, value in values.items():
        new, *others = _parsed(f"{name}() = {value};")
        old, *more = found.get(name, [{}])
        if others or more or not _is_constant(old):
            hint = f"A constant is one rule without a body: {name}() = {value};"
            raise _refused(f"{name} is not a constant of the program", hint)
        heritage: Any = (value_of(old["head"]["record"]["field_value"][0]) or {})[_HERITAGE]
        spans.append((heritage.start, heritage.stop, value))
        wanted[rules.index(old)]["head"] = new["head"]
    for start, stop, value in sorted(spans, reverse=True):
        lines = text.count("\n", start, stop)
        text = text[:start] + value + "\n" * lines + text[stop:]
    if _without_places(_parsed(text)) != _without_places(wanted):
        raise _refused("the constants can't be written into the program", "Try simpler values.")
    return text


_HERITAGE = "expression_heritage"


def _parsed(text: str) -> list[Rule]:
    parsed = parse_statements(prepare(text))
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    return parsed.rules


def _is_constant(rule: Rule) -> bool:
    """Return whether a rule gives a predicate without arguments one value under no condition."""
    if not rule or rule.keys() - {"head", "full_text"}:
        return False
    record = rule["head"]["record"]
    return fields(record) == [VALUE] and value_of(record["field_value"][0]) is not None


def _refused(message: str, hint: str) -> ProgramError:
    return ProgramError((Diagnostic(1, 1, message, hint),))


def _without_places(tree: Any) -> Any:
    """Return a syntax tree without the pieces of text that its nodes came from."""
    if isinstance(tree, dict):
        return {
            key: _without_places(value)
            for key, value in tree.items()
            if key not in (_HERITAGE, "full_text")
        }
    return [_without_places(each) for each in tree] if isinstance(tree, list) else tree
