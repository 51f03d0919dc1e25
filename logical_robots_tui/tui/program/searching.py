"""Finding, replacing and renaming in the text of a program."""

from __future__ import annotations

import re

from logical_robots_tui.tui.program.lexer import LineStates, pieces

__all__ = ["find_after", "is_predicate_name", "rename"]


def is_predicate_name(text: str) -> bool:
    """Whether a predicate may be called so."""
    return re.fullmatch(r"[A-Z]\w*", text) is not None


def find_after(
    text: str, wanted: str, place: tuple[int, int], *, there: bool = False
) -> tuple[int, int] | None:
    """Return where a text stands next, from the top again after the end; None if nowhere.

    Args:
        text: Where to look.
        wanted: What to look for; capitals count only if it has some.
        place: Line and column, from 0, after which to look.
        there: Whether a text that begins right at the place counts, too.
    """
    if not wanted:
        return None
    if wanted == wanted.lower() and len(text.lower()) == len(text):
        text = text.lower()
    lines = text.split("\n")
    offset = sum(len(line) + 1 for line in lines[: place[0]]) + place[1]
    at = text.find(wanted, offset + (not there))
    if at < 0:
        at = text.find(wanted)
    if at < 0:
        return None
    return text.count("\n", 0, at), at - (text.rfind("\n", 0, at) + 1)


def rename(text: str, old: str, new: str) -> tuple[str, int]:
    """Give a predicate another name wherever it is used; comments and texts stay as they are.

    Args:
        text: The program.
        old: The predicate's name.
        new: Its new name.

    Returns:
        The program, and in how many places it was changed.
    """
    lines, states, count = text.split("\n"), LineStates(), 0
    changed = []
    for number, line in enumerate(lines):
        written = line
        for start, end, kind in reversed(pieces(line, states.at(number, lines.__getitem__))):
            if kind == "predicate" and line[start:end] == old:
                written = written[:start] + new + written[end:]
                count += 1
        changed.append(written)
    return "\n".join(changed), count
