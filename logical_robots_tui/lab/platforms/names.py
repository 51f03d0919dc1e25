"""Names and texts of strangers: what they are compared by, and how they are decoded."""

from __future__ import annotations

import codecs
import re
import unicodedata

from logical_robots_tui.paths import decoded

_MOST_COMPARED = 40  # words of a name
_LETTERS = str.maketrans(
    {
        "\N{LATIN SMALL LETTER DOTLESS I}": "i",
        "ł": "l",
        "ø": "o",
        "đ": "d",
        "ð": "d",
        "æ": "ae",
        "œ": "oe",
        "þ": "th",
    }
)
"""Letters of names that are not composed of others, and what is typed for them."""

Words = tuple[str, ...]


def plain(text: str) -> str:
    """Return a name as it is compared: letters and digits, without case and accents."""
    # One by one, because the time to put marks in order grows with the square of their number.
    parts = (unicodedata.normalize("NFKD", character) for character in text.casefold())
    text = "".join(parts).translate(_LETTERS)
    return "".join(character for character in text if character.isalnum())


def words_of(text: str) -> Words:
    marked = re.findall(r"[\w\u0300-\u036f]+", text.replace("_", " "))
    return tuple(word for word in map(plain, marked[:_MOST_COMPARED]) if word)


def encoding_of(content: bytes) -> str:
    """Return UTF-16 or UTF-8 by the mark at the start, and UTF-8 without one."""
    if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return "utf-16"
    return "utf-8-sig" if content.startswith(codecs.BOM_UTF8) else "utf-8"


def text_of(content: bytes) -> str:
    """Return a text in UTF-8, in UTF-16 with its mark, or else in Windows' Western code page."""
    if encoding_of(content) == "utf-16":
        content = content.decode("utf-16", errors="replace").encode()
    try:
        return decoded(content)
    except UnicodeDecodeError:
        return decoded(content.decode("cp1252", errors="replace").encode())
