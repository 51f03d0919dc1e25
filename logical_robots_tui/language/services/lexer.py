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

_SWITCHES = r"""
    (?P<line_comment>\#.*)
  | (?P<block>/\*)
  | (?P<long>\"\"\")
  | (?P<string>"[^"]*"?|'(?:[^'\\]|\\.)*'?|`[^`]*`?)
"""
_SWITCH = re.compile(_SWITCHES, re.VERBOSE)
"""What decides on the state of the next line; far fewer matches than all tokens."""

_TOKEN = re.compile(
    rf"""
    {_SWITCHES}
  | (?P<annotation>@\w+)
  | (?P<number>\b\d+(?:\.\d+)?(?:[eE][+-]?\d+)?\b)
  | (?P<keyword>\b(?:{"|".join(KEYWORDS)}|(?:limit|order_by)(?=\s*\())\b)
  | (?P<predicate>\b[A-Z]\w*)
  | (?P<field>\b[a-z_]\w*(?=\s*:(?![-=])))
  | (?P<operator>:-|->|=>|:=|[-+*/^%=<>!&|~]+)
  | \w+
    """,
    re.VERBOSE,
)
_ENDS = {"/*": "*/", '"""': '"""'}


def pieces(line: str, state: State = "") -> list[Piece]:
    return [] if len(line) > LONGEST_LINE else _scan(line, state, _TOKEN)[0]


def state_after(line: str, state: State) -> State:
    return _scan(line, state, _SWITCH)[1]


def _scan(line: str, state: State, token: re.Pattern[str]) -> tuple[list[Piece], State]:
    parts: list[Piece] = []
    start = end = 0
    while True:
        if state:
            closing = line.find(_ENDS[state], end)
            end = len(line) if closing < 0 else closing + len(_ENDS[state])
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
        while len(self._states) <= line:
            text, state = text_of(len(self._states) - 1), self._states[-1]
            is_plain = not (state or "/*" in text or '"""' in text)
            self._states.append("" if is_plain else state_after(text, state))
        return self._states[line]
