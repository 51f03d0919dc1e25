"""Places of pieces of the syntax tree in a program's text. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.why.probing import Span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["span_of", "span_of_text"]

_OPENS = {"(": ")", "[": "]", "{": "}"}


def span_of(tree: Any, text: str, source: Prepared) -> Span:
    """Return the place of a syntax tree's text.

    Args:
        tree: The tree, with the places from the parser.
        text: The program.
        source: The same, prepared.
    """
    places = list(_places(tree, source.text))
    start = min((start for start, _ in places), default=0)
    stop = max((stop for _, stop in places), default=0)
    return span_of_text(start, _closed(source.skeleton, start, stop), text)


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
