"""Text that the compiler inserts into SQL unchanged: types, columns, and flags in texts."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from logical_robots_tui.language.definitions import calls
from logical_robots_tui.language.source_text import diagnostic_for
from logical_robots_tui.language.tree import (
    Annotation,
    Functor,
    PredicateName,
    Text,
    text_of,
    walk,
)
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.language.signatures import Signature
    from logical_robots_tui.language.tree import Node, Statement

_TYPES = (
    *("BIGINT", "BOOL", "BOOLEAN", "DOUBLE", "FLOAT", "FLOAT64", "INT", "INT64", "INTEGER"),
    *("NUMERIC", "REAL", "STRING", "TEXT", "VARCHAR"),
)
_PLAIN = re.compile(r"[^'\"`$\\\n]*")  # can't end an SQL text
_COLUMNS = re.compile(r"\s*(\w+)(?:\s+(?:ASC|DESC))?\s*", re.ASCII | re.IGNORECASE)


def verbatim(
    program: Sequence[Statement], known: Mapping[str, Signature], text: str
) -> Iterator[Diagnostic]:
    """Find invalid types and columns, and flags that would end an SQL text."""
    for call in calls(program):
        for argument in call.arguments[1:2] if call.name == "Cast" else ():
            name = text_of(argument.expression)
            if name is None or name.strip().upper() not in _TYPES:
                shown = "this" if name is None else name[:40]
                message = f"{shown} is not a type that Cast knows"
                hint = f"Write one of these in quotes: {', '.join(_TYPES)}."
                yield diagnostic_for(text, call.name, message, hint)
    is_within_a_text = any("${" in n.value for n in walk(program) if isinstance(n, Text))
    for each in program:
        if isinstance(each, Functor) and any(map(_is_cast, walk(each))):
            yield diagnostic_for(text, "Cast", "Cast can't be given to a functor", "Call it.")
        if not isinstance(each, Annotation):
            continue
        if each.name == "@DefineFlag" and is_within_a_text:
            for value in each.values[:1]:
                if _PLAIN.fullmatch(text_of(value) or "") is None:
                    message = "a flag that ${...} puts into a text can't hold quotes, \\ or $"
                    hint = 'Write FlagValue("name") instead of ${name}.'
                    yield diagnostic_for(text, each.name, message, hint)
        if each.name == "@OrderBy":
            for value in each.values:
                ordered = text_of(value)  # other types are reported elsewhere
                signature = known.get(each.subject)
                if ordered is not None and (wrong := _wrong_column(ordered, signature)):
                    hint = 'Write only names of columns, such as @OrderBy(P, "col0 DESC");'
                    yield diagnostic_for(text, each.name, wrong, hint)


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


def _is_cast(node: Node) -> bool:
    if isinstance(node, Functor):
        return node.base == "Cast"
    return isinstance(node, PredicateName) and node.name == "Cast"
