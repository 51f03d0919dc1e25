"""Reading and checking the values in the records of a level file of either format."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import NamedTuple, TypeVar

from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.world.level import LevelError

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


_T = TypeVar("_T")

_COLOR = re.compile(r"#[0-9a-fA-F]{3}(?:[0-9a-fA-F]{3})?|[A-Za-z]{3,30}")


class Fields(NamedTuple):
    """One record of a level file; methods raise ``LevelError`` with the key's place.

    A key whose value is null counts as missing.
    """

    record: Mapping[str, object]
    file: str
    path: str = ""

    def error(self, key: str, message: str, hint: str = "") -> LevelError:
        """Return an error that names one key of this record, for the caller to raise."""
        where = f"{self.path}.{key}" if self.path and key else self.path or key
        return LevelError(message, place=f"{self.file}: {where}" if where else self.file, hint=hint)

    def refuse_unknown(self, known: Collection[str]) -> None:
        for key in self.record:
            if key not in known:
                hint = did_you_mean(key, known) or f"Known keys: {', '.join(known)}."
                raise self.error(_show(key), f'"{_show(key)}" is not a known key.', hint)

    def has(self, key: str) -> bool:
        """Return whether a key is present and not null."""
        return self.record.get(key) is not None

    def number(self, key: str, default: float | None = None, *, least: float = -math.inf) -> float:
        """Return a finite number; required if there is no default."""
        if not self.has(key) and default is not None:
            return default
        value = self._required(key)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self._wrong(key, "a number")
        if isinstance(value, float) and not math.isfinite(value):
            raise self.error(key, f'"{key}" must be a finite number, not {value}.')
        if value < least:
            raise self.error(key, f'"{key}" must be {least:g} or more, not {value:.12g}.')
        if abs(value) > MOST_OF_A_NUMBER:
            raise self.error(key, f'"{key}" is too large; at most {MOST_OF_A_NUMBER} is allowed.')
        return float(value)

    def whole(self, key: str, *, least: int) -> int:
        value = self.number(key, least=least)
        if not value.is_integer():
            raise self.error(key, f'"{key}" must be a whole number, not {value:g}.')
        return int(value)

    def flag(self, key: str, default: bool = False) -> bool:
        value = self.record.get(key)
        if value is not None and not isinstance(value, bool):
            raise self._wrong(key, "true or false")
        return default if value is None else value

    def text(self, key: str, default: str | None = None) -> str:
        if not self.has(key) and default is not None:
            return default
        value = self._required(key)
        if not isinstance(value, str):
            raise self._wrong(key, "text")
        if len(value) > LONGEST_TEXT:
            raise self.error(key, f'"{key}" is longer than {LONGEST_TEXT} characters.')
        if not all(line.isprintable() for line in re.split(r"[\n\t]", value)):
            raise self.error(key, f'"{key}" has a character that can\'t be shown.')
        return value

    def name(self, key: str, default: str | None = None) -> str:
        """Return a name: one short line that can be shown; required if there is no default."""
        if not self.has(key) and default is not None:
            return default
        value = self._required(key)
        if not isinstance(value, str):
            raise self._wrong(key, "text")
        return self._checked_name(key, value)

    def names(self, key: str) -> tuple[str, ...]:
        return tuple(self._checked_name(item, text) for item, text in self._texts(key))

    def texts(self, key: str) -> tuple[str, ...]:
        return tuple(
            Fields({item: text}, self.file, self.path).text(item) for item, text in self._texts(key)
        )

    def choice(self, key: str, options: tuple[_T, ...], default: _T) -> _T:
        if not self.has(key):
            return default
        for option in options:
            if self.record[key] == option:
                return option
        listed = " or ".join(f'"{option}"' for option in options)
        raise self.error(key, f'"{key}" must be {listed}.')

    def color(self, key: str, default: str) -> str:
        """Return a colour, ``#rgb``, ``#rrggbb`` or a word; the default if missing."""
        if not self.has(key):
            return default
        value = self.record[key]
        if not isinstance(value, str):
            raise self._wrong(key, "text")
        if not _COLOR.fullmatch(value):
            hint = 'Write it like "#3fb950", "#3b5" or "green".'
            raise self.error(key, f'"{key}" is not a colour.', hint)
        return value

    def table(self, key: str) -> Fields:
        """Return a record inside this one; an empty one if missing."""
        value = self.record.get(key)
        if value is not None and not isinstance(value, dict):
            raise self._wrong(key, "a record")
        return Fields(value or {}, self.file, f"{self.path}.{key}" if self.path else key)

    def each(self, key: str, read: Callable[[Fields], _T]) -> tuple[_T, ...]:
        items = self._list(key)
        if len(items) > MOST_OF_A_KIND:
            raise self.error(
                key, f"There are {len(items)} {key}; at most {MOST_OF_A_KIND} are allowed."
            )
        for i, item in enumerate(items):
            if not isinstance(item, dict):
                raise self.error(f"{key}[{i}]", f"This must be a record, not {_kind(item)}.")
        return tuple(
            read(Fields(item, self.file, f"{key}[{i}]"))
            for i, item in enumerate(items)
            if isinstance(item, dict)
        )

    def check_size(self, key: str, width: int, height: int) -> None:
        if max(width, height) > MOST_SIDE:
            limit = f"{MOST_SIDE} x {MOST_SIDE}"
            raise self.error(
                key, f"The map is {width} x {height} units; at most {limit} is allowed."
            )

    def _required(self, key: str) -> object:
        if not self.has(key):
            raise self.error(key, f'"{key}" is missing.')
        return self.record[key]

    def _wrong(self, key: str, wanted: str) -> LevelError:
        return self.error(key, f'"{key}" must be {wanted}, not {_kind(self.record[key])}.')

    def _list(self, key: str) -> list[object]:
        value = self.record.get(key)
        if value is None:
            return []
        if not isinstance(value, list):
            raise self._wrong(key, "a list")
        return value

    def _texts(self, key: str) -> list[tuple[str, str]]:
        texts = []
        for i, item in enumerate(self._list(key)):
            if not isinstance(item, str):
                raise self.error(f"{key}[{i}]", f"This must be text, not {_kind(item)}.")
            texts.append((f"{key}[{i}]", item))
        return texts

    def _checked_name(self, key: str, value: str) -> str:
        if not value.strip():
            raise self.error(key, f'"{key}" is empty.')
        if len(value) > LONGEST_NAME:
            raise self.error(key, f'"{key}" is longer than {LONGEST_NAME} characters.')
        if not value.isprintable():
            raise self.error(key, f'"{key}" has a character that can\'t be shown.')
        return value


def check_robot_names(top: Fields, names: tuple[str, ...]) -> None:
    if not names:
        raise top.error("robots", "The level has no robots.", "It needs at least one.")
    for i, name in enumerate(names):
        if name in names[:i]:
            raise top.error(
                f"robots[{i}].name",
                f'Two robots are called "{name}".',
                "A program tells robots apart by their names, so each needs its own.",
            )


def _show(key: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in key)[:LONGEST_NAME]


def _kind(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true or false"
    kinds = {int: "a number", float: "a number", str: "text", list: "a list", dict: "a record"}
    return kinds.get(type(value), "a date or time")
