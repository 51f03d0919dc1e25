"""Errors and warnings of a program: what is wrong, where, what to do; names that no level has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.schema import NO_LABEL, WALL
from logical_robots_tui.wording import count_of

MOST_DIAGNOSTICS = 100
"""Most diagnostics of a program that are made and shown."""

MULTIPLIES = "uses itself and is not distinct, so its rows can multiply in each round"
"""The end of the message about a recursion, which its failures repeat."""

_OTHERS_HINT = "Correct these first."
_MOST_LISTED = 4
_LONGEST = 60  # characters of a name in a message

Severity: TypeAlias = Literal["error", "warning"]


@dataclass(frozen=True, slots=True, order=True)
class TextChange:
    """A text that replaces a piece of a program, between two offsets from 0."""

    start: int
    stop: int
    text: str


class Proposal(str):
    """A hint that proposes to write something instead of what a diagnostic is about.

    Attributes:
        replacement: What to write.
    """

    __slots__ = ("replacement",)
    replacement: str

    def __new__(cls, replacement: str, words: str = "Did you mean {}?") -> Proposal:
        """Make a hint of words in which braces stand for the replacement."""
        hint = super().__new__(cls, words.replace("{}", replacement))
        hint.replacement = str(replacement)  # it may be a name with its place
        return hint

    @classmethod
    def fix(cls, hint: str, start: int, stop: int) -> TextChange | None:
        """Return the change of a piece of the text that a hint proposes, or None."""
        return TextChange(start, stop, hint.replacement) if isinstance(hint, cls) else None


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One error or warning in a program.

    Attributes:
        line: Line in the program's text, from 1.
        column: Column in that line, from 1.
        message: What is wrong, one plain sentence.
        hint: What to do about it, or "".
        excerpt: The offending text, one line, or "".
        severity: Whether the program can't run, or may not do what was meant.
        fix: The change that the hint proposes, if it is a single one.
        has_effect: Whether the text does anything in the program.
        related: Other lines that the message names.
    """

    line: int
    column: int
    message: str
    hint: str = ""
    excerpt: str = ""
    severity: Severity = "error"
    fix: TextChange | None = None
    has_effect: bool = True
    related: tuple[int, ...] = ()

    def __str__(self) -> str:
        head = f"line {self.line}, column {self.column}: {self.message}"
        return f"{head} {self.hint}" if self.hint else head


def most_important(diagnostics: Iterable[Diagnostic], excess: int = 0) -> tuple[Diagnostic, ...]:
    """Return the first hundred in text order, errors before warnings.

    If there are others, the last one says how many, including `excess` that nobody has made.
    """
    by_severity = sorted(diagnostics, key=lambda d: (d.severity, d.line, d.column))
    visible, hidden = by_severity[:MOST_DIAGNOSTICS], by_severity[MOST_DIAGNOSTICS:]
    last = visible[-1] if visible else None
    visible.sort(key=lambda d: (d.line, d.column))
    if last is not None and (excess := excess + len(hidden)):
        message = f"{excess:,} more problem{'s' * (excess > 1)} not shown"
        visible.append(Diagnostic(last.line, last.column, message, _OTHERS_HINT, "", last.severity))
    return tuple(visible)


def errors_in(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return those that keep a program from running."""
    return [diagnostic for diagnostic in diagnostics if diagnostic.severity == "error"]


def count_words(diagnostics: Sequence[Diagnostic]) -> str:
    """Return how many there are by severity, such as ``1 error, 24 warnings``, or ""."""
    messages = [d.message for d in diagnostics if d.hint == _OTHERS_HINT]
    counts = Counter(d.severity for d in diagnostics if d.hint != _OTHERS_HINT)
    return ", ".join([*(count_of(counts[noun], noun) for noun in sorted(counts)), *messages])


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

    @property
    def first(self) -> Diagnostic:
        """The first error; there may be warnings before it."""
        return errors_in(self.diagnostics)[0]


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


def closest(name: str, names: Iterable[str], cutoff: float = 0.76) -> str:
    """Return the one of some names that is closest to a name, ignoring case, or ""."""
    import difflib  # only mistakes need it

    by_lower = {k.lower(): k for k in sorted(names, reverse=True) if k.isidentifier()}
    matches = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=cutoff)
    return by_lower[matches[0]] if matches else ""


def most_similar(text: str, texts: Iterable[str]) -> str:
    """Return the text most similar to another, or ""; one that differs only in case comes first."""
    candidates = sorted(filter(None, texts))
    lower, limit = text.lower(), min(2, len(text) // 3)
    by_case = (c for c in candidates if c.lower() == lower)
    by_distance = (c for c in candidates if distance(c.lower(), lower) <= limit)
    return next(by_case, "") or next(by_distance, "") or closest(text, candidates)


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


@dataclass(frozen=True, slots=True)
class Mention:
    """A name that a program compares with a label or with a robot's name.

    Attributes:
        text: The name.
        field: ``label`` or ``robot_name``.
        place: A warning there, still without a message.
        span: Its offsets in the program.
    """

    text: str
    field: str
    place: Diagnostic
    span: tuple[int, int]


@dataclass(frozen=True, slots=True)
class LevelNames:
    """The names in a level.

    Attributes:
        robots: Those of its robots.
        landmarks: Those of its beacons and of areas that can be solid.
    """

    robots: frozenset[str] = frozenset()
    landmarks: frozenset[str] = frozenset()


def unknown_names(mentions: Iterable[Mention], names: LevelNames) -> Iterator[Diagnostic]:
    """Yield a warning for each mentioned name that no robot of a level can sense.

    A program is compiled without a level, so it only tells what it mentions.
    """
    for mention in mentions:
        if mention.field == "robot_name":
            level_names, subject = names.robots, "No robot of this level"
        else:
            level_names = names.robots | names.landmarks | {WALL, NO_LABEL}
            subject = "No robot, beacon or solid area of this level"
        if mention.text not in level_names:
            message = f'{subject} is called "{printable(mention.text[:_LONGEST])}"'
            hint = name_hint(mention.text, level_names)
            fix = Proposal.fix(hint, *mention.span)
            excerpt = printable(mention.place.excerpt)
            yield replace(mention.place, message=message, hint=str(hint), excerpt=excerpt, fix=fix)


def name_hint(text: str, names: Iterable[str]) -> str:
    """Return what to write instead of a name that is not among the known `names`."""
    close = most_similar(text, names)
    if close:
        return Proposal(f'"{printable(close[:_LONGEST])}"')
    *quoted, last = sorted(f'"{printable(name)}"' for name in names) or [""]
    if not last or len(quoted) >= _MOST_LISTED or sum(map(len, names)) > _LONGEST:
        return "Compare it with the names in the labyrinth."
    return f"It can be {', '.join(quoted)} or {last}." if quoted else f"It can be {last}."
