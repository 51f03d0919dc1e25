"""Places in a program's text, and preparing the text for the parser.

Every change keeps the length of the text, so that offsets are valid in the player's text.
"""

from __future__ import annotations

import re
import unicodedata
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import islice
from sys import maxunicode
from typing import NamedTuple

from logical_robots_tui.language.diagnostics import (
    MOST_DIAGNOSTICS,
    Diagnostic,
    Proposal,
    Severity,
    TextChange,
)

COMMENT_HINT = "Comments begin with '#'."

_DEEPEST = 60  # nested brackets; SQLite's parser fails at about 100
_CLOSES = {")": "(", "}": "{", "]": "["}
_NESTING = dict.fromkeys(_CLOSES, -1) | dict.fromkeys(_CLOSES.values(), 1)
_BRACKET = re.compile(r"[(){}\[\]]")
_SPACE_BEFORE_BRACE = re.compile(r"(?<![\w`])([A-Z]\w*)(\s+)\{")
QUOTED_NAME = re.compile(r"`[^`\n]*`?")
_MOST_FOREIGN = 25  # pieces that are reported
_LONGEST_EXCERPT = 1_000  # characters that are looked at
_WIDE_SPACE = re.compile(r"[^\S\x00-\x7f]")  # such as U+00A0, and line separators
_IMPORT = re.compile(r"(?:^|;)\s*(import)\s")
_TOKEN = re.compile(
    r"(?P<comment>#[^\n]*|/\*(?:.*?\*/|.*))"
    r'|(?P<text>"{3}(?:.*?"{3}|.*)|"[^"\n]*["\n]?|`[^`\n]*[`\n]?'
    r"|'(?:\\[^\n]|[^'\\\n])*'?)"
    r"|(?P<sign>[(){}\[\];])|[^#/\"'`(){}\[\];]+|.",
    re.DOTALL,
)
_LEXEME = re.compile(
    r':-|"{3}.*?"{3}|"[^"]*"|`[^`]*`|\d+\.\d+|is\s+not\b|\w+'
    r"|[-:=!<>]=|[-=]>|&&|\|\||\+\+|[][(){},.:?]|[-+*/%^=<>!~|]",
    re.DOTALL,
)
PUNCTUATION = frozenset([*"()[]{},.:?", ":-", "then", "else", "distinct"])
"""Lexemes that are no symbols."""

# Substitutes in texts for the parser, which knows no single quotes.
_INNER_QUOTE = "\ue022"
_INNER_BACKSLASH = "\ue05c"
_ESCAPE = re.compile(
    r"\\(?:x[0-9a-fA-F]{2}|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|[0-7]{1,3}|.)", re.DOTALL
)
_ESCAPES = {
    **dict(zip("abfnrtv", "\a\b\f\n\r\t\v", strict=True)),
    **{character: character for character in "\\'\""},
}
_SURROGATES = (0xD800, 0xDFFF)


class Prepared(NamedTuple):
    """A program's text prepared for the parser, of unchanged length.

    Attributes:
        text: Without comments, with ``Name {`` as ``Name{ ``, and with double-quoted texts.
        skeleton: The same with quoted texts blanked, to search for names.
        problems: Errors that the parser would explain worse; `broken` are their offsets.
        ends: Offsets of the ``;`` that end statements.
        excess: Errors that are not among the problems, because they are too many.
    """

    original: str
    text: str
    skeleton: str
    problems: tuple[Diagnostic, ...]
    broken: tuple[int, ...] = ()
    ends: tuple[int, ...] = ()
    excess: int = 0


def with_newlines(text: str) -> str:
    """Return a text of the same length whose lines are ended by newlines alone."""
    return text.replace("\r\n", " \n").replace("\r", "\n")


def prepare(source: str) -> Prepared:
    """Blank comments, check brackets and quotes, allow a space between an aggregate and ``{``."""
    source = with_newlines(source)
    texts: list[str] = []
    skeleton: list[str] = []
    brackets = _Brackets(source)
    for match in _TOKEN.finditer(source):
        token, kind, offset = match.group(), match.lastgroup, match.start()
        blank = "".join("\n" if c == "\n" else " " for c in token) if kind else ""
        if kind == "comment" and token.startswith("/*") and not _is_closed(token, "/*", "*/"):
            brackets.report(offset, 2, "This comment is never closed", "Add */ at its end.")
        if kind == "text":
            brackets.text(offset, token)
        elif kind == "sign":
            brackets.note(offset, token)
        elif kind is None:
            token = _WIDE_SPACE.sub(" ", token)
        texts.append(blank if kind == "comment" else _in_double_quotes(token))
        is_blank = kind == "comment" or (kind == "text" and token[0] != "`")
        skeleton.append(blank if is_blank else token)
    brackets.end_statement()
    bare = "".join(skeleton)
    unquoted = QUOTED_NAME.sub(lambda name: " " * len(name[0]), "" if bare.isascii() else bare)
    for match in islice(_FOREIGN.finditer(unquoted), _MOST_FOREIGN):
        brackets.report(match.start(), len(match.group()), *_complaint(match.group()))
    for match in _IMPORT.finditer(bare):
        hint = "Copy the predicates that you need into this program."
        brackets.report(match.start(1), 6, "Robots can't import other files", hint)
    # The parser's form of an aggregate is ``Name{ ``.
    pieces, offset = [], 0
    text = "".join(texts)
    for match in _SPACE_BEFORE_BRACE.finditer(bare):
        pieces += [text[offset : match.end(1)], "{", text[match.start(2) : match.end(2)]]
        offset = match.end()
    text = "".join(pieces) + text[offset:]
    places, ends = tuple(brackets.places), tuple(brackets.ends)
    excess = len(places) - len(brackets.problems)
    return Prepared(source, text, bare, tuple(brackets.problems), places, ends, excess)


def statements(source: Prepared) -> Iterator[tuple[int, int]]:
    """Return start and end of each statement, without surrounding space and its ``;``."""
    start = 0
    for end in (*source.ends, len(source.text)):
        piece = source.text[start:end]
        if bare := piece.strip():
            first = start + piece.index(bare)
            yield first, first + len(bare)
        start = end + 1


def size_of(text: str) -> int:
    """Return the number of symbols of a program: its names, literals and operators.

    These are the leaves and operators of its tree, counted as tokens, which takes no parser.
    Punctuation, ``:-``, ``then``, ``else``, ``distinct``, comments and annotations don't count.
    """
    return sum(lexeme not in PUNCTUATION for line in lexemes_of(text) for lexeme in line)


def lexemes_of(text: str) -> Iterator[list[str]]:
    """Yield names, literals, operators and punctuation of each statement but annotations."""
    source = prepare(text)
    for start, stop in statements(source):
        if source.text[start] != "@":
            yield _LEXEME.findall(source.text, start, stop)


def with_whole_brackets(skeleton: str, start: int, stop: int) -> tuple[int, int]:
    """Return a place with the other halves of its brackets, which the package takes off."""
    depth = lowest = 0
    for bracket in _BRACKET.finditer(skeleton, start, stop):
        depth += _NESTING[bracket.group()]
        lowest = min(lowest, depth)
    opened = depth - lowest
    while lowest and start:
        start -= 1
        lowest += _NESTING.get(skeleton[start], 0)
    while opened and stop < len(skeleton):
        opened += _NESTING.get(skeleton[stop], 0)
        stop += 1
    return start, stop


def nesting(skeleton: str) -> int:
    """Return how many more brackets a text opens than it closes."""
    return sum(_NESTING[bracket.group()] for bracket in _BRACKET.finditer(skeleton))


class _Brackets:
    """Checks brackets and quotes; reports at most one bracket error per statement."""

    def __init__(self, source: str) -> None:
        self.problems: list[Diagnostic] = []
        self.places: list[int] = []
        self.ends: list[int] = []
        self._source = source
        self._opened: list[tuple[str, int]] = []
        self._has_complained = False

    def report(self, offset: int, length: int, message: str, hint: str, *related: int) -> None:
        if len(self.problems) < MOST_DIAGNOSTICS:
            problem = diagnostic_at(self._source, offset, length, message, hint)
            self.problems.append(replace(problem, related=related))
        self.places.append(offset)

    def text(self, offset: int, token: str) -> None:
        quote = '"""' if token.startswith('"""') else token[0]
        if not _is_closed(token, quote, quote):
            self._has_complained = True
            message = f"This string is never closed with {quote}"
            line = self._source[self._source.rfind("\n", 0, offset) + 1 : offset]
            is_comment = "--" in line or "//" in line
            hint = COMMENT_HINT if is_comment else f"Add {quote} at its end."
            self.report(offset, len(token), message, hint)
        for escape in _ESCAPE.finditer(token) if quote == "'" else ():
            if _character(escape.group()) is None:
                message = f"{escape.group()} is not a valid escape sequence"
                hint = r"Write \\ for a backslash, or put the text in double quotes."
                self.report(offset + escape.start(), len(escape.group()), message, hint)

    def note(self, offset: int, sign: str) -> None:
        """Note a bracket or the end of a statement."""
        if sign == ";":
            self.ends.append(offset)
            self.end_statement()
        elif sign not in _CLOSES:
            self._opened.append((sign, offset))
            if len(self._opened) > _DEEPEST:
                hint = "Split it into named parts."
                self._complain(offset, "Brackets are nested too deeply here", hint)
        elif self._opened and self._opened[-1][0] == _CLOSES[sign]:
            self._opened.pop()
        elif not self._opened:
            self._complain(offset, f"This '{sign}' closes nothing", "Remove it.")
        else:
            bracket, place = self._opened[-1]
            line, _ = place_of(self._source, place)
            message = f"This '{sign}' does not match the '{bracket}' of line {line}"
            hint = "Brackets close in the order in which they were opened."
            self._complain(offset, message, hint, line)

    def end_statement(self) -> None:
        """End a statement, and report its first bracket that was never closed."""
        if self._opened:
            bracket, place = self._opened[0]
            self._complain(place, f"This '{bracket}' is never closed", "Add the closing bracket.")
        self._opened.clear()
        self._has_complained = False

    def _complain(self, offset: int, message: str, hint: str, *related: int) -> None:
        if not self._has_complained:
            self._has_complained = True
            self.report(offset, 1, message, hint, *related)


def _is_closed(token: str, opening: str, closing: str) -> bool:
    return len(token) >= len(opening) + len(closing) and token.endswith(closing)


def diagnostic_at(
    source: str,
    start: int,
    length: int,
    message: str,
    hint: str = "",
    severity: Severity = "error",
) -> Diagnostic:
    start = max(0, min(start, len(source)))
    line, column = place_of(source, start)
    excerpt = source[start : start + min(length, _LONGEST_EXCERPT)].split("\n", 1)[0].strip()
    fix = Proposal.fix(hint, start, start + length)
    return Diagnostic(line, column, message, str(hint), excerpt[:80], severity, fix)


def distinct_after_head(source: Prepared, start: int, stop: int) -> TextChange:
    """Return the change that makes a rule distinct, given its start and end."""
    piece = source.skeleton[start:stop]
    necks = (neck.start() for neck in re.finditer(":-", piece))
    neck = next((place for place in necks if not nesting(piece[:place])), len(piece))
    place = start + len(source.text[start : start + neck].rstrip())
    return TextChange(place, place, " distinct")


def place_of(source: str, offset: int) -> tuple[int, int]:
    """Return line and column of an offset, from 1."""
    line = bisect_right(_line_starts(source), offset)
    return line, offset - _line_starts(source)[line - 1] + 1


def line_of(source: str, line: int) -> int:
    """Return the offset at which a line begins; lines count from 1."""
    return _line_starts(source)[line - 1]


@lru_cache(maxsize=4)
def _line_starts(source: str) -> list[int]:
    return [0, *(newline.end() for newline in re.finditer("\n", source))]


def _in_double_quotes(token: str) -> str:
    if token[0] != "'" or len(token) < len("''"):
        return token
    return '"' + token[1:-1].replace('"', _INNER_QUOTE).replace("\\", _INNER_BACKSLASH) + '"'


def original_text(parsed: str) -> str:
    """Return a string as the player wrote it, from its prepared form."""
    text = parsed.replace(_INNER_QUOTE, '"')
    if _INNER_BACKSLASH not in text:
        return text
    escaped = text.replace(_INNER_BACKSLASH, "\\")
    return _ESCAPE.sub(lambda match: _character(match.group()) or "", escaped)


def _character(escape: str) -> str | None:
    """Return the character of a Python escape, or None if a text here can't hold it."""
    letter, digits = escape[1], escape[2:]
    if letter in _ESCAPES:
        return _ESCAPES[letter]
    if letter in "01234567":
        code = int(escape[1:], 8)
    elif letter in "xuU" and digits:
        code = int(digits, 16)
    else:
        return None if letter in "xuUN" else escape
    return chr(code) if 0 < code < _SURROGATES[0] or _SURROGATES[1] < code <= maxunicode else None


# -- characters outside of strings --------------------------------------------------------------

_FOREIGN = re.compile(
    r"\w*(?:[^\W\x00-\x7f]|(?<=\w)[\u0300-\u036f])[\w\u0300-\u036f]*|[^\w\x00-\x7f◇○♡⊕⊗]"
)
"""A word, with its accents, or another character, that is not ASCII; the five are operators."""

_LOOKALIKES = {
    **dict(zip("−–—‐‑‒×·÷¬。、", "------**/!.,", strict=True)),
    **dict.fromkeys("“”„‟«»″‘’‚‛′´", "'"),
    **dict(zip("АВЕКМНОРСТУХЅІЈаеорсухѕіј", "ABEKMHOPCTYXSIJaeopcyxsij", strict=True)),  # Cyrillic
    **dict(zip("ΑΒΕΖΗΙΚΜΝΟΡΤΥΧανορυχ", "ABEZHIKMNOPTYXavopux", strict=True)),  # Greek
    **dict(zip("≤≥≠→⇒∧∨∈…", ("<=", ">=", "!=", "->", "=>", "&&", "||", "in", "..."), strict=True)),
}
"""ASCII for characters that look like it, or that mean it elsewhere."""


def _complaint(piece: str) -> tuple[str, str]:
    """Return a message and a hint for a piece that is not in the language."""
    strange = next(c for c in piece if not c.isascii())
    subject = f"{strange} (U+{ord(strange):04X}) is not a"
    replacement = "".join(map(_in_ascii, piece))
    if replacement in ("'", '"'):
        return f"{subject} quote of Logica", """Write plain quotes: '...' or "..."."""
    if replacement.isascii() and replacement.isprintable():
        return f"{subject} character of Logica", Proposal(replacement, "Write {} instead.")
    if strange.isalpha() or piece[0].isalpha():
        message = f"The name {piece} has letters that Logica does not know"
        return message, "Names have the letters a to z, digits and _."
    if not strange.isprintable():
        return f"There is an invisible character here, U+{ord(strange):04X}", "Delete it."
    return f"{subject} character of Logica", "Put it in quotes, or delete it."


def _in_ascii(character: str) -> str:
    if character.isascii():
        return character
    if (digit := unicodedata.decimal(character, None)) is not None:
        return str(digit)
    return _LOOKALIKES.get(character) or unicodedata.normalize("NFKC", character)
