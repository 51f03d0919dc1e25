"""How many rules a program has."""

from __future__ import annotations

from logical_robots_tui.mind.source_text import prepare, statements

__all__ = ["count_rules"]


def count_rules(text: str) -> int:
    """The number of rules of a program that compiles.

    Every statement counts as one, however long it is and however many cases it has; annotations,
    which begin with ``@``, don't.
    """
    source = prepare(text)
    return sum(source.text[start] != "@" for start, _ in statements(source))
