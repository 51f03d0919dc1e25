"""Questions as Logica writes them, and how values differ."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress

from logical_robots_tui.explain.why.explanation import Ask
from logical_robots_tui.explain.why.probing import Called
from logical_robots_tui.mind.compilation import check_text, compile_request
from logical_robots_tui.schema import VALUE
from logical_robots_tui.values import Value, read_value, spell


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


def unlike_types(one: Value, other: Value) -> str:
    """Return that two values differ in nothing but that one is a text, or ""."""
    if isinstance(one, str) == isinstance(other, str):
        return ""
    text, value = (one, other) if isinstance(one, str) else (other, one)
    with suppress(ValueError, RecursionError):
        if read_value(str(text)) == value:
            return f"text {spell(text)} is not {_kind(value)}{spell(value)}"
    return ""


def _kind(value: Value) -> str:
    if value is None or isinstance(value, bool):
        return ""
    if isinstance(value, int | float):
        return "the number "
    return "the record " if isinstance(value, Mapping) else "the list "


def read_call(text: str, within: str = "") -> Ask:
    """Return the question that a predicate with values is. Blocks.

    Raises:
        ProgramError: It is something else.
    """
    check_text(text, None)
    called = compile_request({"called": text}, Called)
    return Ask(called.predicate, json.loads(called.given), within)
