"""Constants of a program, ``Near() = 40;``, that can be given other values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.definitions import definitions
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.tree import Rule
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.language.tree import Functor, Statement


def with_constants(text: str, values: Mapping[str, str]) -> str:
    """Set constants to one-line expressions; all other text and line numbers stay the same.

    Raises:
        ProgramError: The program has errors, or a name is not that of a constant.
    """
    program = _parsed(text)
    found = definitions(program)
    wanted = list(program)
    places = []
    for name, value in values.items():
        new, *others = _parsed(f"{name}() = {value};")
        old, *more = found.get(name, [None])
        if others or more or not is_constant(old) or not isinstance(new, Rule):
            hint = f"A constant is one rule without a body: {name}() = {value};"
            raise _refused(f"{name} is not a constant of the program", hint)
        assert isinstance(old, Rule)
        assert old.value is not None
        assert old.value.span is not None
        places.append((*old.value.span, value))
        wanted[program.index(old)] = new
    for start, stop, value in sorted(places, reverse=True):
        lines = text.count("\n", start, stop)
        text = text[:start] + value + "\n" * lines + text[stop:]
    if _parsed(text) != wanted:
        raise _refused("the constants can't be written into the program", "Try simpler values.")
    return text


def is_constant(rule: Rule | Functor | None) -> bool:
    """Return whether a rule gives a predicate without arguments one value under no condition."""
    if not isinstance(rule, Rule) or rule.body or rule.is_distinct or rule.modalities:
        return False
    return [each.field for each in rule.head.columns] == [VALUE] and rule.value is not None


def _parsed(text: str) -> list[Statement]:
    parsed = parse(prepare(text))
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    return parsed.statements


def _refused(message: str, hint: str) -> ProgramError:
    return ProgramError((Diagnostic(1, 1, message, hint),))
