"""Text that the compiler inserts into SQL unchanged: types, columns, and flags in texts."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from logical_robots_tui.mind.compiling.rules import (
    calls,
    head_name,
    nodes,
    predicate_of,
    text_of,
    value_of,
)
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.source_text import diagnostic_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.mind.checking.signatures import Signature
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic

_TYPES = (
    *("BIGINT", "BOOL", "BOOLEAN", "DOUBLE", "FLOAT", "FLOAT64", "INT", "INT64", "INTEGER"),
    *("NUMERIC", "REAL", "STRING", "TEXT", "VARCHAR"),
)
_PLAIN = re.compile(r"[^'\"`$\\\n]*")  # can't end an SQL text
_COLUMNS = re.compile(r"\s*(\w+)(?:\s+(?:ASC|DESC))?\s*", re.ASCII | re.IGNORECASE)


def verbatim(rules: list[Rule], known: Mapping[str, Signature], text: str) -> Iterator[Diagnostic]:
    """Find invalid types and columns, and flags that would end an SQL text."""
    for call, _ in calls(rules):
        if call["predicate_name"] == "Cast":
            for value in call["record"]["field_value"][1:2]:
                name = text_of(value_of(value) or {})
                if name is None or name.strip().upper() not in _TYPES:
                    shown = "this" if name is None else name[:40]
                    message = f"{shown} is not a type that Cast knows"
                    hint = f"Write one of these in quotes: {', '.join(_TYPES)}."
                    yield diagnostic_for(text, call["predicate_name"], message, hint)
    is_within_a_text = any("${" in literal for rule in rules for literal in _strings(rule))
    for rule in rules:
        if head_name(rule) == "@DefineFlag" and is_within_a_text:
            for value in rule["head"]["record"]["field_value"][1:2]:
                if _PLAIN.fullmatch(text_of(value_of(value) or {}) or "") is None:
                    message = "a flag that ${...} puts into a text can't hold quotes, \\ or $"
                    hint = 'Write FlagValue("name") instead of ${name}.'
                    yield diagnostic_for(text, "@DefineFlag", message, hint)
        if head_name(rule) == "@Make" and any(map(_is_cast, nodes(rule))):
            yield diagnostic_for(text, "Cast", "Cast can't be given to a functor", "Call it.")
        if head_name(rule) == "@OrderBy":
            predicate, *columns = rule["head"]["record"]["field_value"]
            name = predicate_of(value_of(predicate) or {})
            for column in columns:
                ordered = text_of(value_of(column) or {})  # other types are reported elsewhere
                if ordered is not None and (wrong := _wrong_column(ordered, known.get(name))):
                    hint = 'Write only names of columns, such as @OrderBy(P, "col0 DESC");'
                    yield diagnostic_for(text, "@OrderBy", wrong, hint)


def _wrong_column(columns: str, signature: Signature | None) -> str:
    if columns in ("ASC", "DESC"):
        return ""
    for part in columns.split(","):
        found = _COLUMNS.fullmatch(part)
        if found is None:
            return "@OrderBy takes names of columns"
        if signature is not None and found[1] not in _columns_of(signature):
            return f"there is no column {found[1]} to order by"
    return ""


def _columns_of(signature: Signature) -> set[str]:
    numbered = {f"col{number}" for number in range(signature.count)}
    return {*numbered, *signature.named, *([VALUE] if signature.has_value else [])}


def _strings(rule: Rule) -> Iterator[str]:
    """Return all quoted text in a rule."""
    for node in nodes(rule):
        found = node.get("the_string")
        if isinstance(found, str):
            yield found


def _is_cast(node: Rule) -> bool:
    predicate = node.get("the_predicate")
    return isinstance(predicate, dict) and predicate.get("predicate_name") == "Cast"
