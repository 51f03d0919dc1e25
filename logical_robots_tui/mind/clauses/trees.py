"""Building syntax trees in the form of the `logica` package's parser, and the places of such trees.

In the compile process.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.why.probing import Span

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared

__all__ = [
    "asked",
    "call",
    "equal",
    "fields",
    "number",
    "record",
    "rule",
    "span_of",
    "span_of_text",
    "text",
    "variable",
]


def variable(name: str) -> Rule:
    """Return a variable."""
    return {"variable": {"var_name": name}}


def number(text: str) -> Rule:
    """Return a number."""
    return {"literal": {"the_number": {"number": text}}}


def text(value: str) -> Rule:
    """Return a text."""
    return {"literal": {"the_string": {"the_string": value}}, "expression_heritage": value}


def record(columns: Mapping[Any, Rule]) -> Rule:
    """Return a record."""
    return {"record": _record(columns)}


def call(name: str, *given: Rule, **named: Rule) -> Rule:
    """Return a call of a function or an operator."""
    columns: dict[int | str, Rule] = dict(enumerate(given))
    columns.update(named)
    return {"call": {"predicate_name": name, "record": _record(columns)}}


def asked(predicate: str, columns: Mapping[Any, Rule]) -> Rule:
    """Return a call of a predicate, as part of a body."""
    return {"predicate": {"predicate_name": predicate, "record": _record(columns)}}


def equal(left: Rule, right: Rule) -> Rule:
    """Return an equation, as part of a body."""
    return {"unification": {"left_hand_side": left, "right_hand_side": right}}


def rule(name: str, columns: Mapping[Any, Rule], body: Iterable[Rule], text: str) -> Rule:
    """Return a rule; its parts are copied, so that no node is shared."""
    found: Rule = {
        "head": {
            "predicate_name": name,
            "record": _record({field: deep_copy(value) for field, value in columns.items()}),
        },
        "full_text": parse.HeritageAwareString(text),
    }
    if conjuncts := [deep_copy(part) for part in body]:
        found["body"] = {"conjunction": {"conjunct": conjuncts}}
    return found


def fields(columns: Mapping[Any, Rule]) -> list[Rule]:
    """Return the fields of a record, a head or a call."""
    return [{"field": name, "value": {"expression": value}} for name, value in columns.items()]


def _record(columns: Mapping[Any, Rule]) -> Rule:
    return {"field_value": fields(columns)}


_OPENS = {"(": ")", "[": "]", "{": "}"}


def span_of(tree: Any, source: Prepared) -> Span:
    """Return the place of a syntax tree's text."""
    places = list(_places(tree, source.text))
    start = min((start for start, _ in places), default=0)
    stop = max((stop for _, stop in places), default=0)
    return span_of_text(start, _closed(source.skeleton, start, stop), source.original)


def span_of_text(start: int, stop: int, text: str) -> Span:
    """Return a piece of a text, given by its offsets."""
    while start < stop and text[start].isspace():
        start += 1
    lines = (
        line.split("#")[0] if '"' not in line else line for line in text[start:stop].split("\n")
    )
    return Span(start, stop, text.count("\n", 0, start) + 1, " ".join(" ".join(lines).split()))


def _places(tree: Any, text: str) -> Iterator[tuple[int, int]]:
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            waiting.extend(node.values())
        elif isinstance(node, list):
            waiting.extend(node)
        elif getattr(node, "heritage", None) == text and str(node) == text[node.start : node.stop]:
            yield node.start, node.stop


def _closed(skeleton: str, start: int, stop: int) -> int:
    """Extend a piece to close the brackets that it opens."""
    open_brackets: list[str] = []
    for at in range(start, len(skeleton)):
        character = skeleton[at]
        if at >= stop and not open_brackets:
            return at
        if character in _OPENS:
            open_brackets.append(_OPENS[character])
        elif open_brackets and character == open_brackets[-1]:
            open_brackets.pop()
            if at >= stop and not open_brackets:
                return at + 1
    return max(stop, min(len(skeleton), stop))
