"""Limits on level files, checked as fast as a search to protect the parser."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_MOST_BESIDES = 4_000_000  # characters outside long literal strings such as a drawing
_MOST_LITERALS = 10_000
_MOST_OF_TOML = {"=": 60_000, "[": 60_000, "{": 30_000, ",": 300_000, "\n": 300_000, '"': 300_000}
_MOST_OF_JSON = {"{": 30_000, "[": 60_000, ",": 300_000, '"': 600_000}

_OPENING = re.compile(r"'''|\"\"\"|[\"'#]")
_BASIC_END = re.compile(r'[^"\\\n]*+(?:\\.[^"\\\n]*+)*+')
_LONG_BASIC_END = re.compile(r'[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*+', re.DOTALL)

_KEYS = re.compile(r"""(?<![\w"'-])(?:(?:[\w-]++|""|'')[ \t]*+\.[ \t]*+){10}""")
_NUMBER = re.compile(r"(?<![\w-])[\d_]{10000}")
_NUMBER_OF_JSON = re.compile(r"[:\[,]\s*+-?\d{10000}")


def excess_of_toml(text: str) -> str:
    """Return what a TOML text has too much of, as an object of "The file has", or ""."""
    pieces: list[str] = []
    size = 0
    for piece in _besides_literals(text):
        size += len(piece)
        pieces.append(piece if piece[0] not in "\"'#" else "''")
        if size > _MOST_BESIDES:
            return f"more than {_MOST_BESIDES:,} characters besides its drawing"
        if len(pieces) > 2 * _MOST_OF_TOML['"']:
            return "too many strings"
    bare = "".join(pieces)
    if found := _too_many(bare, _MOST_OF_TOML):
        return found
    if _KEYS.search(bare):
        return "a key of more than 10 parts"
    return "a number of more than 10,000 digits" if _NUMBER.search(bare) else ""


def excess_of_json(text: str) -> str:
    if found := _too_many(text, _MOST_OF_JSON):
        return found
    return "a number of more than 10,000 digits" if _NUMBER_OF_JSON.search(text) else ""


def _too_many(text: str, most: dict[str, int]) -> str:
    for character, number in most.items():
        if text.count(character) > number:
            shown = "lines" if character == "\n" else f"of the character {character}"
            return f"more than {number:,} {shown}"
    return ""


def _besides_literals(text: str) -> Iterator[str]:
    at = literals = 0
    while opening := _OPENING.search(text, at):
        if opening.start() > at:
            yield text[at : opening.start()]
        begin = opening.end()
        if opening[0] == "'''":
            end = text.find("'''", begin)
            literals += 1
            at = len(text) if end < 0 or literals > _MOST_LITERALS else end + 3
            if literals > _MOST_LITERALS:
                yield " " * (_MOST_BESIDES + 1)
            continue
        end = _end_of(text, opening[0], begin)
        yield text[opening.start() : end]
        at = end
    if at < len(text):
        yield text[at:]


def _end_of(text: str, opening: str, begin: int) -> int:
    """Return where a string or a comment ends, including its closing quotes."""
    if opening in "#'":
        newline = text.find("\n", begin)
        newline = len(text) if newline < 0 else newline
        quote = text.find("'", begin, newline) if opening == "'" else -1
        return quote + 1 if quote >= 0 else newline
    pattern = _BASIC_END if opening == '"' else _LONG_BASIC_END
    found = pattern.match(text, begin)
    end = found.end() if found else begin
    return min(end + len(opening), len(text)) if text.startswith(opening, end) else max(end, begin)


MOST_SIDE = 4000
"""Largest width and height in map units."""

MOST_OF_A_KIND = 1000
"""Largest number of robots, beacons, areas or hints."""

MOST_OF_A_NUMBER = 1_000_000

LONGEST_NAME = 60
"""Characters."""

LONGEST_TEXT = 20_000
"""Characters of a briefing, a lesson or a hint."""

MOST_BYTES = 64 * 2**20
"""Largest size of a level file."""
