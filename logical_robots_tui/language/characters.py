# ruff: noqa: RUF001 - this is about them
"""Characters outside of strings that the language does not have, and what was meant by them."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from typing import NamedTuple

_FOREIGN = re.compile(r"\w*[^\W\x00-\x7f]\w*|[^\w\x00-\x7f◇○♡⊕⊗]")
"""A word, or another character, that is not ASCII; the five are operators of one's own."""

_ALIKE = (
    ("−–—‐‑‒×·÷¬。、", "------**/!.,"),
    ("“”„‟«»″", '"' * 7),
    ("‘’‚‛′´", "'" * 6),
    ("АВЕКМНОРСТУХЅІЈ", "ABEKMHOPCTYXSIJ"),  # Cyrillic
    ("аеорсухѕіј", "aeopcyxsij"),
    ("ΑΒΕΖΗΙΚΜΝΟΡΤΥΧ", "ABEZHIKMNOPTYX"),  # Greek
    ("ανορυχ", "avopux"),
)
_MEANT = {
    **{one: other for pair in _ALIKE for one, other in zip(*pair, strict=True)},
    **dict(zip("≤≥≠→⇒∧∨∈…", ("<=", ">=", "!=", "->", "=>", "&&", "||", "in", "..."), strict=True)),
}
"""What stands in ASCII for characters that look like it, or that mean it elsewhere."""

_QUOTES = ("'", '"')
_PLAIN_QUOTES = """Write plain quotes: '...' or "..."."""


class Foreign(NamedTuple):
    """A piece of a program that is not in the language, and how to write it."""

    start: int
    text: str
    message: str
    hint: str


def with_plain_spaces(text: str) -> str:
    """Return a text with a plain space for each other one, such as U+00A0, and line separator."""
    if text.isascii():
        return text
    return "".join(" " if c != "\n" and c.isspace() else c for c in text)


def foreign(text: str) -> Iterator[Foreign]:
    """Yield the pieces of a text that are not in the language; strings must be blanked."""
    if text.isascii():
        return
    for found in _FOREIGN.finditer(text):
        piece = found.group()
        start = found.start()
        meant = "".join(map(_meant, piece))
        strange = next(c for c in piece if not c.isascii())
        shown = f"{strange} (U+{ord(strange):04X})"
        if meant in _QUOTES:
            message = f"{shown} is not a quote of Logica"
            yield Foreign(start, piece, message, _PLAIN_QUOTES)
        elif meant.isascii() and meant.isprintable():
            message = f"{shown} is not a character of Logica"
            yield Foreign(start, piece, message, f"Write {meant} instead.")
        elif strange.isalpha():
            message = f"The name {piece} has letters that Logica does not know"
            yield Foreign(start, piece, message, "Names have the letters a to z, digits and _.")
        elif not strange.isprintable():
            message = f"There is an invisible character here, U+{ord(strange):04X}"
            yield Foreign(start, piece, message, "Delete it.")
        else:
            message = f"{shown} is not a character of Logica"
            yield Foreign(start, piece, message, "Put it in quotes, or delete it.")


def _meant(character: str) -> str:
    if character.isascii():
        return character
    if (digit := unicodedata.decimal(character, None)) is not None:
        return str(digit)
    return _MEANT.get(character) or unicodedata.normalize("NFKC", character)
