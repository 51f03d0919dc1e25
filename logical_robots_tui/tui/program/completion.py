"""Completion: words for the cursor's place, and the list to choose from."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from textwrap import wrap
from typing import NamedTuple

from textual.content import Content
from textual.geometry import Offset
from textual.widgets.option_list import Option

from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.language.source_text import Prepared, prepare
from logical_robots_tui.schema import RECORDS
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.program.lexer import KEYWORDS
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip


class Word(NamedTuple):
    """A word to insert, with how it is used, such as ``Least(x, y, ...)``."""

    name: str
    shape: str
    told: str


class Place(NamedTuple):
    """A place in a text: line and column, from 0."""

    line: int
    column: int


_FIELDS = tuple(
    Word(field.name, f"{record.path}.{field.name}", field.explanation)
    for record in RECORDS
    for field in record.fields
)
_GIVEN = (
    Word("Sensor", "Sensor(robot_name:, sensor:)", "sensor readings of this tick"),
    Word("Memory", "Memory(robot_name:, memory:)", "memories after the previous tick"),
    Word("Robot", "Robot(robot_name:, desire:, memory:)", "decisions, which you define"),
)
_BUILT_IN = tuple(
    Word(entry.name, entry.signature, entry.summary)
    for entry in REFERENCE
    if entry.kind != "operator"
)
NAMES = tuple(word.name for word in (*_BUILT_IN, *_GIVEN, *_FIELDS))
"""Words without a definition in the program: functions, inputs, fields."""

_LOOKED_BACK = 2_000  # characters before the cursor that are looked at for what it is in
_AROUND = 10_000  # characters before and after the cursor that are read to complete a word

_HEAD = re.compile(r"^(?P<name>[A-Z]\w*)\s*(?:(?P<arguments>\([^)]{0,500}\)?)|:=)", re.MULTILINE)
_STATEMENT = re.compile(r"^(?=[A-Z@])", re.MULTILINE)
_BEFORE = re.compile(r"(?:(?P<owner>[A-Za-z_]\w*)\.)?(?P<begun>\w*)$")
_VARIABLE = re.compile(r"(?<![\w.])[a-z_]\w*\b(?!\s*:(?!-)\s*[^\s,)}])(?!\s*\()")
_FIELD = re.compile(r"\.([a-z_]\w*)|\b([a-z_]\w*)\s*:(?!-)")


def definitions(text: str) -> Mapping[str, tuple[Place, str]]:
    found: dict[str, tuple[Place, str]] = {}
    line = counted = 0
    for match in _HEAD.finditer(text):
        name = match["name"]
        if name not in found:
            line += text.count("\n", counted, match.start())
            counted = match.start()
            arguments = match["arguments"] or "(...)"
            found[name] = Place(line, 0), name + " ".join(arguments.split())
    return found


def word_before(before: str) -> str:
    """Return the unfinished word at the end of a text, which a completion replaces."""
    return _word_before(before)["begun"]


def _word_before(text: str) -> re.Match[str]:
    match = _BEFORE.search(text[-_LOOKED_BACK:])
    assert match is not None
    return match


def words_for(text: str, place: Place) -> list[Word]:
    """Return words for a place: variables and fields, predicates, functions; or none."""
    lines = text.splitlines(keepends=True)[: place.line]
    at = min(sum(map(len, lines)) + place.column, len(text))
    own = definitions(text)
    begin = max(0, at - _AROUND)
    if begin and (statement := _STATEMENT.search(text, begin, at)):
        begin = statement.start()
    text, at = text[begin : at + _AROUND], at - begin
    source = prepare(text)
    match = _word_before(text[:at].rpartition("\n")[2])
    owner, typed = match["owner"], match["begun"]
    first = at - len(typed)
    if text[first:at] != source.skeleton[first:at] or _is_blanked(text, source.skeleton, first - 1):
        return []
    groups = _fields(source.skeleton, owner, typed) if owner else _names(source, first, at, own)
    ordered = [
        word for group in groups for word in sorted(group, key=lambda word: word.name.lower())
    ]
    words = {w.name: w for w in ordered if _last(w).lower().startswith(typed.lower())}
    # What is written as typed comes first.
    return sorted(words.values(), key=lambda w: not _last(w).startswith(typed))


def _last(word: Word) -> str:
    """Return the last part of a word, such as the field of ``sensor.radar``."""
    return word.name.rpartition(".")[2]


def _is_blanked(text: str, skeleton: str, at: int) -> bool:
    """Return whether the last non-blank up to `at` is in a comment or quotes."""
    while at >= 0 and text[at] == " ":
        at -= 1
    return at >= 0 and text[at] != "\n" and text[at] != skeleton[at]


def _names(
    source: Prepared, first: int, at: int, own: Mapping[str, tuple[Place, str]]
) -> list[list[Word]]:
    start = max((end + 1 for end in source.ends if end < first), default=0)
    stop = min((end for end in source.ends if end >= at), default=len(source.skeleton))
    rule = f"{source.skeleton[start:first]} {source.skeleton[at:stop]}"
    variables = {*_VARIABLE.findall(rule)}.difference(KEYWORDS)
    held = [word for word in _FIELDS if word.shape.rpartition(".")[0] in variables]
    return [
        [Word(name, name, "a variable of this rule") for name in variables],
        [Word(word.shape, word.shape, word.told) for word in held] if first < at else [],
        [
            *(_own(name, found) for name, found in own.items()),
            *(word for word in _GIVEN if word.name not in own),
        ],
        [word for word in _BUILT_IN if word.name not in own],
    ]


def _fields(skeleton: str, owner: str, typed: str) -> list[list[Word]]:
    """Return the fields of a name's value: those used with it first, then all others."""
    if given := [word for word in _FIELDS if word.shape.split(".")[-2] == owner]:
        return [given]
    told = {word.name: word.told for word in _FIELDS}
    counts = Counter(name or key for name, key in _FIELD.findall(skeleton))
    counts[typed] -= 1  # the word being typed
    known = dict.fromkeys(+counts, "a field of this program") | told
    used = re.findall(rf"\b{owner}\.([a-z_]\w*)", skeleton)
    first = [name for name in used if counts[name] > 0]
    return [[Word(name, f".{name}", known[name]) for name in group] for group in (first, known)]


def help_on(text: str, name: str) -> Word | None:
    if (own := definitions(text).get(name)) is not None:
        return _own(name, own)
    return next((word for word in (*_BUILT_IN, *_GIVEN) if word.name == name), None)


def _own(name: str, found: tuple[Place, str]) -> Word:
    return Word(name, found[1], f"defined in line {found[0].line + 1}")


def call_before(before: str) -> str:
    depth = 0
    before = before[-_LOOKED_BACK:]
    for at in range(len(before) - 1, -1, -1):
        char = before[at]
        if char in ")}]":
            depth += 1
        elif char in "({[":
            depth -= 1
            if depth < 0:
                if name := _predicate_at_end(before[:at]):
                    return name
                depth = 0
    return ""


def _predicate_at_end(text: str) -> str:
    """Return the predicate name that a text ends with, or ""; linear in the name's length."""
    end = len(text.rstrip())
    start = end
    while start and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    match = re.search(r"[A-Z]\w*", text[start:end])
    return match[0] if match else ""


def word_around(line: str, column: int) -> str:
    for match in re.finditer(r"\w+", line):
        if match.start() <= column <= match.end():
            return match.group()
    return ""


_MOST = 60
_WIDEST, _MARGIN = 90, 6  # columns of the list, and those left beside it
_NARROWEST = 8  # columns that a word needs; where there are fewer, none is offered
_LONGEST = 40  # characters of a shape before what is said of it stands below


class Completion(Listing, can_focus=False):
    """The list of offered words; the editor keeps the focus and forwards keys."""

    DEFAULT_CSS = """
    Completion {
        overlay: screen; display: none; height: auto; max-height: 12;
        constrain: inside inside; border: round $frame-here; padding: 0; background: $panel;
    }
    Completion > .option-list--option-highlighted { background: $here; color: $here-ink; }
    """

    def __init__(self) -> None:
        super().__init__(id="completion")
        self._words: list[Word] = []

    def offer(self, words: list[Word], at: Offset) -> None:
        width = min(self.screen.size.width - _MARGIN, _WIDEST)
        self._words = words[:_MOST] if width >= _NARROWEST else []
        self.display = bool(self._words)
        if not self._words:
            return
        lines = list(lines_of(self._words, width))
        self.styles.width = max(line.get_optimal_width({}, 0) for line in lines) + 4
        self.clear_options()
        self.add_options([Option(line) for line in lines])
        self.highlighted = 0
        self.absolute_offset = at + Offset(0, 1)

    def close(self) -> None:
        self.display = False

    @property
    def names(self) -> list[str]:
        return [word.name for word in self._words]

    @property
    def chosen(self) -> Word | None:
        number = self.highlighted
        return self._words[number] if number is not None and number < len(self._words) else None


def lines_of(words: Sequence[Word], width: int) -> Iterator[Content]:
    """Yield each word with all that is said of it, in so many columns."""
    shapes = [len(word.shape) for word in words if len(word.shape) <= _LONGEST]
    beside = max(shapes, default=0) + 2
    for word in words:
        if len(word.shape) <= _LONGEST and beside + len(word.told) <= width:
            first, told = f"{word.shape:<{beside}}", [word.told]
        else:
            first = f"{clip(word.shape, width)}\n"
            told = wrap(word.told, width - 2, initial_indent="  ", subsequent_indent="  ")
        yield Content.assemble((first, INK.text), ("\n".join(told), INK.dim))
