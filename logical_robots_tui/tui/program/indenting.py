"""How far the lines of a program are indented."""

from __future__ import annotations

import re

__all__ = ["WIDTH", "indentation_after", "shifted"]

WIDTH = 2
"""Columns of a step."""

_COMMENT = re.compile(r"\s*#.*")
_OPENS = (":-", "(", "[", "{")


def indentation_after(before: str) -> str:
    """Return the white space that a line begins with, behind another one.

    Args:
        before: That other line, or as much of it as stays there. One step is added behind what
            opens something, and a rule that ends is followed by another one, not indented.
    """
    given = before[: len(before) - len(before.lstrip())]
    written = _COMMENT.sub("", before).rstrip()
    if written.endswith(";"):
        return ""
    return given + " " * WIDTH if written.endswith(_OPENS) else given


def shifted(lines: list[str], *, back: bool) -> list[str]:
    """Return lines a step further to the right, or as far back as they can go, up to a step."""
    if not back:
        return [" " * WIDTH + line if line.strip() else line for line in lines]
    return [re.sub(f"^(\t| {{1,{WIDTH}}})", "", line) for line in lines]
