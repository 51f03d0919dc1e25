"""Records and lists as DuckDB writes them in texts: ``{'n': 1, 'w': hi}``, ``[a, 'b, c', NULL]``.

Source: DuckDB's casts between VARCHAR, STRUCT and LIST, which the tests ask.
"""

from __future__ import annotations

import re

_SPACES = " \t\n\v\f\r"
_SPACE = re.compile(f"[{_SPACES}]*")
_SPECIAL = re.compile(r"""["'(),:=\[\\\]{}]""")
_ESCAPED = re.compile(r"""['\\]""")
_CLOSES = {"{": "}", "[": "]", "(": ")"}
_PLAIN = re.compile(r"""[^"',:\\{}()\[\]]+""")
_QUOTED = {quote: re.compile(rf"(?:[^\\{quote}]|\\.)*{quote}", re.DOTALL) for quote in "'\""}
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)


def quote(text: str) -> str:
    """Return a text in quotes, as the name of a field always is."""
    return "'" + _ESCAPED.sub(r"\\\g<0>", text) + "'"


def write(text: str) -> str:
    """Return a text as it stands in a record or list: in quotes only if it could be misread."""
    is_plain = (
        text
        and text.strip(_SPACES) == text
        and text.upper() != "NULL"
        and not _SPECIAL.search(text)
    )
    return text if is_plain else quote(text)


def read_record(text: str) -> dict[str, str | None] | None:
    """Return a record's fields as texts, or None if the text spells no record."""
    reader = _Reader(text, "{")
    found: dict[str, str | None] = {}
    while not reader.is_at_end:
        name, ended = reader.part(":")
        if not name or ended != ":":
            return None
        found[name], ended = reader.part(",")
        if ended == "," and reader.is_at_end:
            return None
    return found if reader.is_complete else None


def read_list(text: str) -> list[str | None] | None:
    """Return a list's elements as texts, or None if the text spells no list."""
    reader = _Reader(text, "[")
    found: list[str | None] = []
    ended = "" if reader.is_at_end else ","
    while ended == ",":
        element, ended = reader.part(",")
        found.append(element)
    return found if reader.is_complete else None


class _Reader:
    """Reads the parts between two brackets, one after the other."""

    def __init__(self, text: str, opening: str) -> None:
        self._text = text.strip(_SPACES)
        self._closing = _CLOSES[opening]
        self._at = 1
        self._is_broken = self._text[:1] != opening

    @property
    def is_at_end(self) -> bool:
        """Whether there is nothing more before the closing bracket, or in the text."""
        rest = _SPACE.match(self._text, self._at)
        at = rest.end() if rest else self._at
        return self._is_broken or at >= len(self._text) or self._text[at] == self._closing

    @property
    def is_complete(self) -> bool:
        """Whether everything was read, and quotes and brackets match."""
        return not self._is_broken and self._text[self._at :].strip(_SPACES) == self._closing

    def part(self, separator: str) -> tuple[str | None, str]:
        """Return the next part, or None for an unquoted null; and what it ended with."""
        text, pieces = self._text, [""]
        ended = ""
        while self._at < len(text) and not self._is_broken and text[self._at] != self._closing:
            at, character = self._at, text[self._at]
            if character == separator:
                self._at += 1
                ended = separator
                break
            if character in _QUOTED:
                found = _QUOTED[character].match(text, at + 1)
                self._move(found.end() if found else -1)
                pieces += [_ESCAPE.sub(r"\1", found.group()[:-1]) if found else "", ""]
            elif character in _CLOSES:
                self._move(_closed(text, at))
                pieces[-1] += text[at : self._at]
            elif character == "\\" and text[at + 1 : at + 2] in _QUOTED:
                self._move(at + 2)
                pieces[-1] += text[at + 1]
            else:
                plain = _PLAIN.match(text, at)
                self._move(plain.end() if plain else at + 1)
                pieces[-1] += text[at : self._at]
        part = _join(pieces)
        return None if part.upper() == "NULL" and len(pieces) == 1 else part, ended

    def _move(self, at: int) -> None:
        self._is_broken = at < 0
        self._at = max(self._at, at)


def _join(pieces: list[str]) -> str:
    """Return a part without the spaces round it; quoted pieces, every second one, keep theirs."""
    pieces[0] = pieces[0].lstrip(_SPACES)
    pieces[-1] = pieces[-1].rstrip(_SPACES)
    return "".join(pieces)


def _closed(text: str, at: int) -> int:
    """Return the offset after the bracket that closes the one at an offset, or -1."""
    waiting: list[str] = []
    while at < len(text):
        character = text[at]
        at += 1
        if character in _CLOSES:
            waiting.append(_CLOSES[character])
        elif character in _QUOTED:
            found = _QUOTED[character].match(text, at)
            if found is None:
                return -1
            at = found.end()
        elif character == "\\" and text[at : at + 1] in _QUOTED:
            at += 1
        elif character == waiting[-1]:
            waiting.pop()
            if not waiting:
                return at
    return -1
