"""Words for the cursor's place in a program, and help on a word.

A cursor is a line and a column, from 0.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.language.services.lexer import KEYWORDS
from logical_robots_tui.language.source_text import Prepared, prepare
from logical_robots_tui.schema import RECORDS


class WordHelp(NamedTuple):
    """A word with how it is used, such as ``Least(x, y, ...)``, and what it means."""

    name: str
    shape: str
    meaning: str


class Definition(NamedTuple):
    """The line, from 0, that first defines a predicate, and the head there."""

    line: int
    head: str


_FIELDS = tuple(
    WordHelp(field.name, f"{record.path}.{field.name}", field.explanation)
    for record in RECORDS
    for field in record.fields
)
_INPUTS = (
    WordHelp("Sensor", "Sensor(robot_name:, sensor:)", "sensor readings of this tick"),
    WordHelp("Memory", "Memory(robot_name:, memory:)", "memories after the previous tick"),
    WordHelp("Robot", "Robot(robot_name:, desire:, memory:)", "decisions, which you define"),
)
_FUNCTIONS = tuple(
    WordHelp(entry.name, entry.signature, entry.summary)
    for entry in REFERENCE
    if entry.kind != "operator"
)
NAMES = tuple(word.name for word in (*_FUNCTIONS, *_INPUTS, *_FIELDS))
"""Words without a definition in the program: functions, inputs, fields."""

_LOOKED_BACK = 2_000  # characters before the cursor that are looked at for what it is in
_LINES_BACK = 40  # of the text before the cursor that may begin the call that it is in
_AROUND = 10_000  # characters before and after the cursor that are read to complete a word

_HEAD = re.compile(r"^(?P<name>[A-Z]\w*)\s*(?:(?P<arguments>\([^)]{0,500}\)?)|:=)", re.MULTILINE)
_STATEMENT = re.compile(r"^(?=[A-Z@])", re.MULTILINE)
_WORD_AT_END = re.compile(r"(?:([A-Za-z_]\w*)\.)?(\w*)$")
_BRACKET = re.compile(r"(?:(?<!\w)[^\WA-Z]*+([A-Z]\w*+)\s*+)?([(){}\[\],])")
VARIABLE = re.compile(
    r"(?:(?<![\w.])|(?<=\.\.))[a-z_]\w*\b(?!\s*:(?![-=])\s*[^\s,)}\]])(?!\s*[(?])"
)
"""A variable, which may also be the column of ``name:``; or a keyword."""
_ACCESS = re.compile(r"\b(\w+)(?=\.(\w+))")
_FIELD = re.compile(r"\.([a-z_]\w*)|\b([a-z_]\w*)\s*:(?!-)")


def definitions(text: str) -> Mapping[str, Definition]:
    by_name: dict[str, Definition] = {}
    line = offset = 0
    for match in _HEAD.finditer(text):
        name = match["name"]
        if name not in by_name:
            line += text.count("\n", offset, match.start())
            offset = match.start()
            by_name[name] = Definition(line, name + " ".join((match[2] or "(...)").split()))
    return by_name


def word_before(text: str) -> tuple[str, str]:
    """Return the unfinished word at the end of a text, after the name whose field it is, or ""."""
    owner, word = _WORD_AT_END.findall(text[-_LOOKED_BACK:])[0]
    return owner, word


def words_for(text: str, cursor: tuple[int, int]) -> list[WordHelp]:
    """Return words for a place: variables and fields, predicates, functions; or none."""
    lines = text.splitlines(keepends=True)[: cursor[0]]
    stop = min(sum(map(len, lines)) + cursor[1], len(text))
    predicates = definitions(text)
    window = max(0, stop - _AROUND)
    if window and (statement := _STATEMENT.search(text, window, stop)):
        window = statement.start()
    text, stop = text[window : stop + _AROUND], stop - window
    source = prepare(text)
    owner, typed = word_before(text[:stop].rpartition("\n")[2])
    start = stop - len(typed)
    if _is_blanked(source.skeleton, text, start, stop):
        return []
    groups = (
        _fields(source.skeleton, owner, typed) if owner else _names(source, start, stop, predicates)
    )
    words = (word for group in groups for word in sorted(group, key=lambda word: word.name.lower()))
    by_name = {w.name: w for w in words if _last_part(w).lower().startswith(typed.lower())}
    # What is written as typed comes first.
    return sorted(by_name.values(), key=lambda w: not _last_part(w).startswith(typed))


def _last_part(word: WordHelp) -> str:
    """Return the last part of a word, such as the field of ``sensor.radar``."""
    return word.name.rpartition(".")[2]


def _is_blanked(skeleton: str, text: str, start: int, stop: int) -> bool:
    """Return whether a word, or what is before it in its line, is in a comment or quotes."""
    end = len(text[:start].rstrip(" "))
    neighbours = ("\n", skeleton[max(end - 1, 0) : end])
    return text[start:stop] != skeleton[start:stop] or text[max(end - 1, 0) : end] not in neighbours


def _names(
    source: Prepared, start: int, stop: int, predicates: Mapping[str, Definition]
) -> Iterator[list[WordHelp]]:
    skeleton = source.skeleton
    rule_start = max((end + 1 for end in source.ends if end < start), default=0)
    rule_stop = min((end for end in source.ends if end >= stop), default=len(skeleton))
    rule = f"{skeleton[rule_start:start]} {skeleton[stop:rule_stop]}"
    variables = {*VARIABLE.findall(rule)}.difference(KEYWORDS)
    yield [WordHelp(name, name, "a variable of this rule") for name in variables]
    if start < stop:
        yield [
            WordHelp(field.shape, *field[1:])
            for field in _FIELDS
            if field.shape.rpartition(".")[0] in variables
        ]
    yield [
        *(_help_on_predicate(name, definition) for name, definition in predicates.items()),
        *(word for word in _INPUTS if word.name not in predicates),
    ]
    yield [word for word in _FUNCTIONS if word.name not in predicates]


def _fields(skeleton: str, owner: str, typed: str) -> Iterator[list[WordHelp]]:
    """Yield the fields of a name's value: those used with it first, then all others."""
    if fields := [field for field in _FIELDS if field.shape.split(".")[-2] == owner]:
        yield fields
        return
    counts = Counter(name or key for name, key in _FIELD.findall(skeleton))
    counts[typed] -= 1  # the word being typed
    meanings = dict.fromkeys(+counts, "a field of this program")
    meanings |= {field.name: field.meaning for field in _FIELDS}
    used = re.findall(rf"\b{owner}\.([a-z_]\w*)", skeleton)
    for names in ([name for name in used if counts[name] > 0], meanings):
        yield [WordHelp(name, f".{name}", meanings[name]) for name in names]


def help_at(text: str, cursor: tuple[int, int]) -> WordHelp | None:
    """Return help on the name at a place, or else on the innermost call around it."""
    lines = text.split("\n", cursor[0] + 1)[: cursor[0] + 1]
    line, column = lines[-1], cursor[1]
    word = word_around(line, column)
    owners = [owner for owner, name in _ACCESS.findall(line) if name == word]
    for field in _FIELDS:
        if field.name == word and field.shape.split(".")[-2] in owners:
            return field
    prefix = "\n".join([*lines[-_LINES_BACK:-1], line[:column]])
    return help_on(text, word, call_before(prefix)[0])


def help_on(text: str, *names: str) -> WordHelp | None:
    """Return help on the first of some names that is a predicate of a program or of the game."""
    names = tuple(name for name in names if name[:1].isupper())
    predicates = definitions(text) if names else {}
    words = {word.name: word for word in (*_FUNCTIONS, *_INPUTS)}
    words |= {
        name: _help_on_predicate(name, predicates[name]) for name in names if name in predicates
    }
    return next((words[name] for name in names if name in words), None)


def _help_on_predicate(name: str, definition: Definition) -> WordHelp:
    return WordHelp(name, definition.head, f"defined in line {definition.line + 1}")


def call_before(text: str) -> tuple[str, int]:
    """Return the innermost call or aggregate at the end of a text, or "", and its commas."""
    calls: list[tuple[str, int]] = []
    for name, sign in _BRACKET.findall(text[-_LOOKED_BACK:]):
        if sign in "({[":
            calls.append((name, 0))
        elif sign != ",":
            del calls[-1:]
        elif calls:
            calls[-1] = calls[-1][0], calls[-1][1] + 1
    return next((call for call in reversed(calls) if call[0]), ("", 0))


def word_around(line: str, column: int) -> str:
    words = re.finditer(r"\w+", line)
    return next((word[0] for word in words if word.start() <= column <= word.end()), "")
