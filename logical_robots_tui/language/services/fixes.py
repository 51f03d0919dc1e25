"""What the hint of a diagnostic proposes, as a change of the text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.services.symbols import TextChange, sections
from logical_robots_tui.language.source_text import line_of

_INSTEAD = re.compile(
    r"(?:Did you mean (@?[\w.]+|\".*\")\?"
    r"|Write ([^\s'(]+?)(?: instead(?: of \S+?)?| if you mean the same| without quotes)?\.)$"
)
_END = re.compile(r"\s*;")
_LACKS_DISTINCT = re.compile(r"^Add `distinct`|is distinct in line \d+, but not here")


class Fix(NamedTuple):
    """A change, and what it does."""

    title: str
    change: TextChange


def fixes(text: str, diagnostic: Diagnostic) -> Iterator[Fix]:
    """Yield the changes that a diagnostic of a text proposes."""
    message, hint, excerpt = diagnostic.message, diagnostic.hint, diagnostic.excerpt
    start = line_of(text, min(diagnostic.line, text.count("\n") + 1)) + diagnostic.column - 1
    if (match := _INSTEAD.search(hint)) and excerpt and text.startswith(excerpt, start):
        word = match[1] or match[2]
        yield Fix(f"Write {word}", TextChange(start, start + len(excerpt), word))
    elif "';'" in f"{message} {hint}" and "missing" in f"{message} {hint}":
        for section, following in pairwise(sections(text)):
            if section.start <= start <= following.stop and not _END.match(text, section.stop):
                yield Fix(
                    f"Add ; after {section.name}", TextChange(section.stop, section.stop, ";")
                )
    elif _LACKS_DISTINCT.search(message):
        for section in sections(text):
            neck = text.find(":-", section.start, section.stop)
            if section.start <= start <= section.stop:
                place = len(text[:neck].rstrip()) if neck >= 0 else section.stop
                yield Fix("Add distinct", TextChange(place, place, " distinct"))
