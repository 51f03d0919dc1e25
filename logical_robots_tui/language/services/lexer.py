"""Colours for Logica text, one line at a time."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

State = str
"""The state at the start of a line: "", ``/*`` (a comment) or three quotes (a long string)."""

LONGEST_LINE = 2_000
"""Longer lines are not coloured."""


class Piece(NamedTuple):
    """A coloured part of a line: columns from 0 to behind its last, and a style."""

    start: int
    end: int
    kind: str


KEYWORDS = (
    *("in", "is", "not", "if", "then", "else", "combine", "import", "as", "distinct"),
    *("couldbe", "cantbe", "shouldbe", "null", "true", "false"),
)
"""Words that can't be variables."""

TOKENS = {
    "line_comment": r"#.*",
    "block": r"/\*",
    "long": r'"""',
    "string": r""""[^"]*"?|'(?:[^'\\]|\\.)*'?|`[^`]*`?""",
    "annotation": r"@\w+",
    "number": r"\b\d+(?:\.\d+)?(?:[eE][+-]?\d+)?\b",
    "keyword": rf"\b(?:{'|'.join(KEYWORDS)}|(?:limit|order_by)(?=\s*\())\b",
    "predicate": r"\b[A-Z]\w*",
    "field": r"\b[a-z_]\w*(?=\s*:(?![-=]))",
    "operator": r":-|->|=>|:=|[-+*/^%=<>!&|~]+",
}
"""Patterns of tokens within a line, the first of which counts; `block` and `long` go on until
what ends them."""

_SWITCHES = tuple(f"(?P<{kind}>{pattern})" for kind, pattern in TOKENS.items())
_SWITCH = re.compile("|".join(_SWITCHES[:4]))
"""What decides on the state of the next line; far fewer matches than all tokens."""

_TOKEN = re.compile("|".join([*_SWITCHES, r"\w+"]))
ENDS = {"/*": "*/", '"""': '"""'}


def pieces(line: str, state: State = "") -> list[Piece]:
    return [] if len(line) > LONGEST_LINE else _scan(line, state, _TOKEN)[0]


def state_after(line: str, state: State) -> State:
    return _scan(line, state, _SWITCH)[1]


def _scan(line: str, state: State, token: re.Pattern[str]) -> tuple[list[Piece], State]:
    parts: list[Piece] = []
    start = end = 0
    while True:
        if state:
            closing = line.find(ENDS[state], end)
            end = len(line) if closing < 0 else closing + len(ENDS[state])
            if end > start:
                parts.append(Piece(start, end, "comment" if state == "/*" else "string"))
            if closing < 0:
                return parts, state
            state = ""
        match = token.search(line, end)
        if match is None:
            return parts, ""
        kind, start, end = match.lastgroup, *match.span()
        if kind in ("block", "long"):
            state = match.group()
        elif kind is not None:
            parts.append(Piece(start, end, "comment" if kind == "line_comment" else kind))


class LineStates:
    """The states at the starts of a text's lines, computed on demand."""

    def __init__(self) -> None:
        self._states: list[State] = [""]

    def forget(self, row: int = 0) -> None:
        """Forget all states after a line, because it or a later line has changed."""
        del self._states[max(row, 0) + 1 :]

    def at(self, line: int, text_of: Callable[[int], str]) -> State:
        """Return the state at the start of a line, counted from 0."""
        state = self._states[min(line, len(self._states) - 1)]
        for row in range(len(self._states) - 1, line):
            text = text_of(row)
            if state or "/*" in text or '"""' in text:
                state = state_after(text, state)
            self._states.append(state)
        return state
