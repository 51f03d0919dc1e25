"""Names in a program's text: where the one at a place is used, and renaming it; its statements.

Offsets count characters from 0. All of it works on broken programs, too.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from logical_robots_tui.errors import InputError
from logical_robots_tui.language.diagnostics import TextChange
from logical_robots_tui.language.services.completion import NAMES, VARIABLE, definitions
from logical_robots_tui.language.services.lexer import KEYWORDS
from logical_robots_tui.language.source_text import QUOTED_NAME, Prepared, prepare, statements
from logical_robots_tui.schema import MAIN
from logical_robots_tui.wording import clip

_PREDICATE = re.compile(r"(?<![\w@])[A-Z]\w*")
_WORD = re.compile(r"\w+")
_HEAD = re.compile(r"@?\w+")
_LINE_HEAD = re.compile(r"^(?=[A-Z@])", re.MULTILINE)
_COLON = re.compile(r"\s*:(?![-=])")
_LONGEST = 30
_LOOKED_BACK = 1_000  # characters before a head that tell whether a statement ends there


class Symbol(NamedTuple):
    """A predicate, or a variable of one rule.

    Attributes:
        name: As written.
        places: The offsets at which it stands.
        neighbours: The other names of its kind where it is known.
    """

    name: str
    places: tuple[int, ...]
    neighbours: frozenset[str]

    @property
    def is_predicate(self) -> bool:
        return self.name[0].isupper()


class Section(NamedTuple):
    """A statement with the name that it begins with, without its ``;``."""

    name: str
    start: int
    stop: int


def symbol_at(text: str, offset: int) -> Symbol | None:
    source = prepare(text)
    code = QUOTED_NAME.sub(lambda name: " " * len(name[0]), source.skeleton)
    line = code.rfind("\n", 0, offset) + 1
    words = _WORD.finditer(code, line, (code.find("\n", offset) + 1 or len(code) + 1) - 1)
    word = next((word for word in words if word.start() <= offset <= word.end()), None)
    if word is None:
        return None
    if word[0][0].isupper():
        names = [*_PREDICATE.finditer(code)]
    else:
        start, stop = _rule_around(source, word.start())
        names = [n for n in VARIABLE.finditer(code, start, stop) if n[0] not in KEYWORDS]
    places = tuple(name.start() for name in names if name[0] == word[0])
    neighbours = frozenset(name[0] for name in names) - {word[0]}
    return Symbol(word[0], places, neighbours) if word.start() in places else None


def _rule_around(source: Prepared, offset: int) -> tuple[int, int]:
    ends = (-1, *source.ends, len(source.skeleton))
    index = bisect_left(ends, offset)
    return ends[index - 1] + 1, ends[index]


def renaming(text: str, offset: int, name: str) -> list[TextChange]:
    """Return the changes that give the predicate or variable at an offset another name.

    Raises:
        InputError: There is none, or the program would mean something else.
    """
    symbol = symbol_at(text, offset)
    if symbol is None or (
        symbol.is_predicate and symbol.name in NAMES and symbol.name not in definitions(text)
    ):
        raise InputError("Put the cursor on a predicate of this program, or on a variable, first.")
    kind, pattern, case = (
        ("predicate", r"[A-Z]\w*", "capital")
        if symbol.is_predicate
        else ("variable", r"(?!x_)[a-z_]\w*", "lower case")
    )
    if symbol.name == MAIN:
        raise InputError(f"{MAIN} decides what robots do, and keeps its name.")
    if re.fullmatch(pattern, name, re.ASCII) is None:
        raise InputError(f"A {kind}'s name starts with a {case} letter.")
    if name in symbol.neighbours:
        raise InputError(f"{clip(name, _LONGEST)} is the name of another {kind} here.")
    if name in KEYWORDS or (symbol.is_predicate and name in NAMES):
        raise InputError(f"{name} is a word of the language.")
    changes = []
    for place in symbol.places if name != symbol.name else ():
        stop = place + len(symbol.name)
        colon = None if symbol.is_predicate else _COLON.match(text, stop)
        # In `name:` a column has the variable's name, and keeps it.
        changes.append(
            TextChange(colon.end(), colon.end(), f" {name}")
            if colon
            else TextChange(place, stop, name)
        )
    return changes


def changed(text: str, changes: Sequence[TextChange]) -> str:
    for change in sorted(changes, reverse=True):
        text = text[: change.start] + change.text + text[change.stop :]
    return text


def sections(text: str) -> Iterator[Section]:
    """Yield the statements of a program; also where the ``;`` before a head is missing."""
    source = prepare(text)
    for start, stop in statements(source):
        piece = source.skeleton[start:stop]
        heads = [head.start() for head in _LINE_HEAD.finditer(piece, 1)]
        cuts = [0, *(head for head in heads if _is_whole(source.text, start, start + head))]
        for first, end in zip(cuts, [*cuts[1:], len(piece)], strict=True):
            if head := _HEAD.match(piece, first):
                yield Section(head[0], start + first, start + len(piece[:end].rstrip()))


def _is_whole(text: str, start: int, stop: int) -> bool:
    """Return whether a statement may end there, because a text ends with no operator or comma."""
    *_, last = ["", *text[max(start, stop - _LOOKED_BACK) : stop].split()[-1:]]
    return re.search(r"[\w)\]}\"`]$", last) is not None and last not in KEYWORDS
