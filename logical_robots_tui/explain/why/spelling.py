"""Values and questions as Logica writes them, and reading questions."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from decimal import Decimal

from logical_robots_tui.explain.why.explanation import Ask
from logical_robots_tui.explain.why.probing import Called
from logical_robots_tui.mind.compilation import check_text, compile_request
from logical_robots_tui.schema import VALUE
from logical_robots_tui.values import Value


def spell(value: Value) -> str:
    """Return a value as Logica writes it, in one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{name}: {spell(each)}' for name, each in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(spell, value))}]"
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.0f}" if value.is_integer() else format(Decimal(repr(value)), "f")
    return _quote(value) if isinstance(value, str) else json.dumps(value)


def _quote(text: str) -> str:
    """Return a text in quotes; only single ones know escapes."""
    if text.isprintable() and not any(sign in text for sign in '"\\'):
        return f'"{text}"'
    shown = text.replace("\\", "\\\\").replace("'", "\\'")
    return "'{}'".format("".join(c if c.isprintable() else _escape(c) for c in shown))


def _escape(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def spell_call(asked: Ask) -> str:
    """Return a question as a call: ``Speed(200)``, ``Kind(object: "wall")``, ``F(1) == 2``."""
    given = dict(asked.given)
    result = f" == {spell(given.pop(VALUE))}" if VALUE in given else ""
    arguments = []
    for place, (column, value) in enumerate(given.items()):
        is_in_place = column == f"col{place}"
        name = column.removeprefix("col") if column[3:].isdigit() else column
        arguments.append(spell(value) if is_in_place else f"{name}: {spell(value)}")
    return f"{asked.predicate}({', '.join(arguments)}){result}"


def read_call(text: str, within: str = "") -> Ask:
    """Return the question that a predicate with values is. Blocks.

    Raises:
        ProgramError: It is something else.
    """
    check_text(text, None)
    called = compile_request({"called": text}, Called)
    return Ask(called.predicate, json.loads(called.given), within)
