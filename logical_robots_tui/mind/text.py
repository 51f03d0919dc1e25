"""Places in a program's text, and what is done to the text before the parser sees it.

Every change keeps the length of the text, so that a place found later is a place in what the
player wrote.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from logical_robots_tui.mind.diagnostics import Diagnostic

__all__ = ["Prepared", "diagnostic_at", "prepare"]

_DEEPEST = 60  # brackets in brackets; SQLite's parser gives up at about 100
_CLOSES = {")": "(", "}": "{", "]": "["}
_SPACE_BEFORE_BRACE = re.compile(r"(?<![\w`])([A-Z]\w*)(\s+)\{")
_IMPORT = re.compile(r"(?:^|;)\s*(import)\s")


@dataclass(frozen=True, slots=True)
class Prepared:
    """A program's text made ready for the parser.

    Attributes:
        text: The same text, of the same length, without comments and with ``Name {`` as ``Name{ ``.
        skeleton: The same again with what stands in quotes blanked, to search for names in.
        problems: Mistakes seen on the way that the parser would explain worse.
    """

    text: str
    skeleton: str
    problems: tuple[Diagnostic, ...]


def prepare(source: str) -> Prepared:
    """Blank comments, check brackets and quotes, allow a space between an aggregate and ``{``."""
    kept: list[str] = []
    skeleton: list[str] = []
    problems: list[Diagnostic] = []
    opened: list[tuple[str, int]] = []
    at = 0
    while at < len(source):
        end, kind = _token(source, at)
        token = source[at:end]
        blank = "".join("\n" if c == "\n" else " " for c in token)
        if kind == "comment":
            kept.append(blank)
            skeleton.append(blank)
        elif kind == "string":
            if problem := _string_problem(source, at, token):
                problems.append(problem)
            kept.append(token)
            skeleton.append(blank if token[0] == '"' else token)
        else:
            kept.append(token)
            skeleton.append(token)
            if token in _CLOSES.values():
                opened.append((token, at))
                if len(opened) > _DEEPEST and not problems:
                    problems.append(_too_deep(source, at))
            elif token in _CLOSES:
                if opened and opened[-1][0] == _CLOSES[token]:
                    opened.pop()
                elif not problems:
                    problems.append(_unmatched(source, at, token, opened))
        at = end
    if opened and not problems:
        bracket, place = opened[0]
        problems.append(
            diagnostic_at(
                source, place, 1, f"this '{bracket}' is never closed", "Add the closing bracket."
            )
        )
    bare = "".join(skeleton)
    text = _join_braces("".join(kept), bare)
    if found := _IMPORT.search(bare):
        problems.append(
            diagnostic_at(
                source,
                found.start(1),
                6,
                "robots can't import other files",
                "Copy the predicates that you need into this program.",
            )
        )
    return Prepared(text, bare, tuple(problems))


def diagnostic_at(source: str, start: int, length: int, message: str, hint: str = "") -> Diagnostic:
    """A diagnostic for a place in the text given as an offset."""
    start = max(0, min(start, len(source)))
    before = source[:start]
    line_start = before.rfind("\n") + 1
    excerpt = source[start : start + length].split("\n", 1)[0].strip()
    return Diagnostic(
        line=before.count("\n") + 1,
        column=start - line_start + 1,
        message=message,
        hint=hint,
        excerpt=excerpt[:80],
    )


def _token(source: str, at: int) -> tuple[int, str]:
    """End and kind of the token at an offset: a comment, a quoted text, or one character."""
    if source[at] == "#":
        end = source.find("\n", at)
        return (len(source) if end < 0 else end), "comment"
    if source.startswith("/*", at):
        end = source.find("*/", at + 2)
        return (len(source) if end < 0 else end + 2), "comment"
    if source.startswith('"""', at):
        end = source.find('"""', at + 3)
        return (len(source) if end < 0 else end + 3), "string"
    if source[at] in '"`':
        end = at + 1
        while end < len(source) and source[end] not in (source[at], "\n"):
            end += 1
        return min(end + 1, len(source)), "string"
    return at + 1, "other"


def _string_problem(source: str, at: int, token: str) -> Diagnostic | None:
    quote = '"""' if token.startswith('"""') else token[0]
    if len(token) >= 2 * len(quote) and token.endswith(quote):
        return None
    return diagnostic_at(
        source,
        at,
        len(token),
        f"this text is never closed with {quote}",
        f"Add {quote} at its end.",
    )


def _too_deep(source: str, at: int) -> Diagnostic:
    return diagnostic_at(
        source, at, 1, "brackets are nested too deeply here", "Give parts of it names of their own."
    )


def _unmatched(source: str, at: int, token: str, opened: list[tuple[str, int]]) -> Diagnostic:
    if not opened:
        return diagnostic_at(source, at, 1, f"this '{token}' closes nothing", "Remove it.")
    bracket, place = opened[-1]
    line = source.count("\n", 0, place) + 1
    return diagnostic_at(
        source,
        at,
        1,
        f"this '{token}' does not match the '{bracket}' of line {line}",
        "Brackets close in the order in which they were opened.",
    )


def _join_braces(text: str, bare: str) -> str:
    """Turn ``Name {`` into ``Name{ ``, which is how the parser wants an aggregate."""
    pieces: list[str] = []
    at = 0
    for found in _SPACE_BEFORE_BRACE.finditer(bare):
        pieces += [text[at : found.end(1)], "{", text[found.start(2) : found.end(2)]]
        at = found.end()
    return "".join(pieces) + text[at:]
