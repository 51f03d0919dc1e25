"""Operations on the text of a program: indentation, moving lines, search and renaming."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from logical_robots_tui.tui.program.lexer import LineStates, pieces

if TYPE_CHECKING:
    from collections.abc import Sequence


def followed(rows: Sequence[int], before: Sequence[str], after: Sequence[str]) -> list[int | None]:
    """Return new line numbers after a change, all from 0, or None for lines that are gone.

    A changed line keeps its number, unless lines were added or removed at the same place.
    """
    same, most = 0, min(len(before), len(after))
    while same < most and before[same] == after[same]:
        same += 1
    most -= same
    tail = 0
    while tail < most and before[-1 - tail] == after[-1 - tail]:
        tail += 1
    grown = len(after) - len(before)
    changed = len(before) - tail - same

    def new(row: int) -> int | None:
        if row < same:
            return row
        if row >= same + changed:
            return row + grown
        if grown == 0:
            return row
        was_split, was_joined = changed == 1 and grown > 0, changed + grown == 1
        return same if was_split or was_joined else None

    return [new(row) for row in rows]


WIDTH = 2
"""Columns of an indentation step."""

_OPENS = (":-", "(", "[", "{")


def indentation_after(before: str) -> str:
    """Return the indentation after a line: a bracket or ``:-`` adds, a rule's end resets."""
    given = before[: len(before) - len(before.lstrip())]
    written = before.partition("#")[0].rstrip()
    if written.endswith(";"):
        return ""
    return given + " " * WIDTH if written.endswith(_OPENS) else given


def shifted(lines: list[str], *, back: bool) -> list[str]:
    if not back:
        return [" " * WIDTH + line if line.strip() else line for line in lines]
    return [re.sub(f"^(\t| {{1,{WIDTH}}})", "", line) for line in lines]


def is_predicate_name(text: str) -> bool:
    return re.fullmatch(r"[A-Z]\w*", text) is not None


def find_after(
    text: str, wanted: str, place: tuple[int, int], *, there: bool = False
) -> tuple[int, int] | None:
    """Return the next place of a text, wrapping around, or None; positions count from 0.

    Case matters only if `wanted` has capitals. `there` lets a match at the place itself count.
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
    """Rename a predicate outside comments and texts; return the program and the count."""
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
