"""Changes of a program's text as text: indentation, searching, and lines that move."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import compress, count
from operator import ne

from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import line_of, place_of

WIDTH = 2
"""Columns of an indentation step."""

_WORD = re.compile(r"\w+")
_OPENS = (":-", "(", "[", "{")


def indentation_after(line: str) -> str:
    """Return the indentation after a line: a bracket or ``:-`` adds, a rule's end resets."""
    indentation = line[: len(line) - len(line.lstrip())]
    code = line.partition("#")[0].rstrip()
    if code.endswith(";"):
        return ""
    return indentation + " " * WIDTH if code.endswith(_OPENS) else indentation


def shift_lines(lines: list[str], *, back: bool) -> list[str]:
    if not back:
        return [" " * WIDTH + line if line.strip() else line for line in lines]
    return [re.sub(f"^(\t| {{1,{WIDTH}}})", "", line) for line in lines]


def toggle_comments(lines: list[str]) -> list[str]:
    """Return lines as comments, or as code if all of them are comments."""
    if all(line.lstrip()[:1] in ("", "#") for line in lines):
        return [re.sub("# ?", "", line, count=1) for line in lines]
    return [f"# {line}" if line.strip() else line for line in lines]


def find_after(
    text: str, pattern: str, place: tuple[int, int], *, inclusive: bool = False
) -> tuple[int, int] | None:
    """Return the next place of a pattern, wrapping around, or None; positions count from 0.

    Case matters only if the pattern has capitals. `inclusive` lets a match at the place count.
    """
    if not pattern:
        return None
    if pattern == pattern.lower() and len(text.lower()) == len(text):
        text = text.lower()
    start = line_of(text, place[0] + 1) + place[1]
    offset = text.find(pattern, start + (not inclusive))
    if offset < 0:
        offset = text.find(pattern)
    if offset < 0:
        return None
    line, column = place_of(text, offset)
    return line - 1, column - 1


def width_of(diagnostic: Diagnostic, line: str) -> tuple[int, int]:
    """Return the columns of a diagnostic: its excerpt if it is there, or a word or a character."""
    start = min(diagnostic.column - 1, max(len(line) - 1, 0))
    if diagnostic.excerpt and line.startswith(diagnostic.excerpt, start):
        return start, start + len(diagnostic.excerpt)
    word = _WORD.match(line, start)
    return start, word.end() if word else start + 1


def follow_rows(
    rows: Sequence[int], old_lines: Sequence[str], new_lines: Sequence[str]
) -> list[int | None]:
    """Return new line numbers after a change, all from 0, or None for lines that are gone.

    A changed line keeps its number, unless lines were added or removed at the same place.
    """
    shorter = min(len(old_lines), len(new_lines))
    head = next(compress(count(), map(ne, old_lines, new_lines)), shorter)
    differences = map(ne, reversed(old_lines), reversed(new_lines))
    tail = min(next(compress(count(), differences), shorter), shorter - head)
    growth = len(new_lines) - len(old_lines)
    changed = len(old_lines) - tail - head
    is_split, is_joined = changed == 1 and growth > 0, changed + growth == 1
    replacement = head if is_split or is_joined else None

    def new_row(row: int) -> int | None:
        if row < head or (growth == 0 and row < head + changed):
            return row
        return row + growth if row >= head + changed else replacement

    return [new_row(row) for row in rows]
