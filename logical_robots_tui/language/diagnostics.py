"""Errors and warnings of a program: what is wrong, where, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from logical_robots_tui.errors import LogicalRobotsError


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake in a program.

    Attributes:
        line: Line in the program's text, from 1.
        column: Column in that line, from 1.
        message: What is wrong, one plain sentence.
        hint: What to do about it, or "".
        excerpt: The offending text, one line, or "".
        severity: Whether the program can't run, or may not do what was meant.
    """

    line: int
    column: int
    message: str
    hint: str = ""
    excerpt: str = ""
    severity: Literal["error", "warning"] = "error"

    def __str__(self) -> str:
        head = f"line {self.line}, column {self.column}: {self.message}"
        return f"{head} {self.hint}" if self.hint else head


class ProgramError(LogicalRobotsError):
    """A program can't be compiled.

    Attributes:
        diagnostics: At least one, in text order.
        is_unfinished: Whether compiling was given up, so that another attempt may end otherwise.
        team: The team whose program it is, or "".
    """

    title = "This program can't run yet"

    def __init__(self, diagnostics: tuple[Diagnostic, ...], *, is_unfinished: bool = False) -> None:
        self.diagnostics = diagnostics
        self.is_unfinished = is_unfinished
        self.team = ""
        super().__init__("\n".join(str(d) for d in diagnostics))


class QueryError(LogicalRobotsError):
    """A predicate has no rows to show, or failed at this tick."""

    title = "No rows"


class Stopped(LogicalRobotsError):  # noqa: N818 - not an error: somebody asked for it
    """The caller stopped the work before it was done."""

    title = "Stopped"


def printable(text: str) -> str:
    """Return a text with control, bidirectional and invisible characters replaced one by one."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def closest(name: str, known: Iterable[str], cutoff: float = 0.76) -> str:
    """Return the known name closest to a name, ignoring case, or ""."""
    import difflib  # only mistakes need it

    by_lower = {k.lower(): k for k in sorted(known, reverse=True) if k.isidentifier()}
    found = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=cutoff)
    return by_lower[found[0]] if found else ""


def most_similar(text: str, texts: Iterable[str]) -> str:
    """Return the text most similar to another, or ""; first of all one with other capitals."""
    known = sorted(filter(None, texts))
    lower, most = text.lower(), min(2, len(text) // 3)
    by_case = (each for each in known if each.lower() == lower)
    near = (each for each in known if distance(each.lower(), lower) <= most)
    return next(by_case, "") or next(near, "") or closest(text, known)


def distance(left: str, right: str) -> int:
    """Return the optimal string alignment distance (insert, delete, change, swap letters)."""
    rows = [list(range(len(right) + 1))]
    for i, a in enumerate(left, 1):
        row = [i]
        for j, b in enumerate(right, 1):
            best = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (a != b))
            if i > 1 and j > 1 and a == right[j - 2] and left[i - 2] == b:
                best = min(best, rows[-2][j - 2] + 1)
            row.append(best)
        rows.append(row)
    return rows[-1][-1]
