"""Reading and checking the values in the records of a level file of either format."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple, TypeVar

from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.world.level import LevelError

MOST_SIDE = 4000
"""Largest width and height in map units."""

MOST_OF_A_KIND = 1000
"""Largest number of robots, beacons, areas, hints and so on."""

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

    def refuse_unknown(self, keys: Collection[str]) -> None:
        for key in self.record:
            if key not in keys:
                hint = did_you_mean(key, keys) or f"Known keys: {', '.join(keys)}."
                raise self.error(_show(key), f'"{_show(key)}" is not a known key.', hint)

    def has(self, key: str) -> bool:
        """Return whether a key is present and not null."""
        return self.record.get(key) is not None

    def number(
        self, key: str, default: float | None = None, *, minimum: float = -math.inf
    ) -> float:
        """Return a finite number; required if there is no default."""
        if not self.has(key) and default is not None:
            return default
        value = self._required(key)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self._type_error(key, "a number")
        if isinstance(value, float) and not math.isfinite(value):
            raise self.error(key, f'"{key}" must be a finite number, not {value}.')
        if abs(value) > MOST_OF_A_NUMBER:
            raise self.error(key, f'"{key}" is too large; at most {MOST_OF_A_NUMBER} is allowed.')
        if value < minimum:
            raise self.error(key, f'"{key}" must be {minimum:g} or more, not {value:.12g}.')
        return float(value)

    def integer(self, key: str, *, minimum: int) -> int:
        value = self.number(key, minimum=minimum)
        if not value.is_integer():
            raise self.error(key, f'"{key}" must be a whole number, not {value:g}.')
        return int(value)

    def integers(self, key: str, *, minimum: int) -> tuple[int, ...]:
        items = self._items(key)
        return tuple(fields.integer(item, minimum=minimum) for item, fields in items)

    def flag(self, key: str, default: bool = False) -> bool:
        value = self.record.get(key)
        if value is not None and not isinstance(value, bool):
            raise self._type_error(key, "true or false")
        return default if value is None else value

    def text(self, key: str, default: str | None = None) -> str:
        value = self._text(key, default)
        if len(value) > LONGEST_TEXT:
            raise self.error(key, f'"{key}" is longer than {LONGEST_TEXT} characters.')
        if not all(line.isprintable() for line in re.split(r"[\n\t]", value)):
            raise self.error(key, f'"{key}" has a character that can\'t be shown.')
        return value

    def name(self, key: str, default: str | None = None) -> str:
        """Return a name: one short line that can be shown; required if there is no default."""
        value = self._text(key, default)
        if not self.has(key):
            return value
        if not value.strip():
            raise self.error(key, f'"{key}" is empty.')
        if len(value) > LONGEST_NAME:
            raise self.error(key, f'"{key}" is longer than {LONGEST_NAME} characters.')
        if not value.isprintable():
            raise self.error(key, f'"{key}" has a character that can\'t be shown.')
        return value

    def names(self, key: str) -> tuple[str, ...]:
        return tuple(fields.name(item) for item, fields in self._items(key, "text"))

    def texts(self, key: str) -> tuple[str, ...]:
        return tuple(fields.text(item) for item, fields in self._items(key, "text"))

    def choice(self, key: str, options: tuple[_T, ...], default: _T) -> _T:
        if not self.has(key):
            return default
        for option in options:
            if self.record[key] == option:
                return option
        listed = " or ".join(f'"{option}"' for option in options)
        raise self.error(key, f'"{key}" must be {listed}.')

    def name_and_position(self) -> tuple[str, float, float]:
        """Return the name of an object, and its place in map units."""
        return self.name("name"), self.number("x"), self.number("y")

    def color(self, key: str, default: str) -> str:
        """Return a colour, ``#rgb``, ``#rrggbb`` or a word; the default if missing."""
        value = self._text(key, default)
        if not _COLOR.fullmatch(value):
            hint = 'Write it like "#3fb950", "#3b5" or "green".'
            raise self.error(key, f'"{key}" is not a colour.', hint)
        return value

    def table(self, key: str, keys: Collection[str]) -> Fields:
        """Return a record inside this one, which has no other keys; an empty one if missing."""
        value = self.record.get(key)
        if value is not None and not isinstance(value, dict):
            raise self._type_error(key, "a record")
        table = Fields(value or {}, self.file, f"{self.path}.{key}" if self.path else key)
        table.refuse_unknown(keys)
        return table

    def records(
        self, key: str, read: Callable[[Fields], _T], keys: Collection[str] | None = None
    ) -> tuple[_T, ...]:
        """Return the records of a list; with `keys` they may have no others."""
        records = []
        for i, item in enumerate(self._list(key)):
            if not isinstance(item, dict):
                raise self.error(f"{key}[{i}]", f"This must be a record, not {_kind(item)}.")
            record = Fields(item, self.file, f"{key}[{i}]")
            if keys is not None:
                record.refuse_unknown(keys)
            records.append(record)
        return tuple(map(read, records))

    def check_size(self, key: str, width: int, height: int) -> None:
        if max(width, height) > MOST_SIDE:
            limit = f"at most {MOST_SIDE} x {MOST_SIDE} is allowed"
            raise self.error(key, f"The labyrinth is {width} x {height} units; {limit}.")

    def _text(self, key: str, default: str | None) -> str:
        if not self.has(key) and default is not None:
            return default
        value = self._required(key)
        if not isinstance(value, str):
            raise self._type_error(key, "text")
        return value

    def _required(self, key: str) -> object:
        if not self.has(key):
            raise self.error(key, f'"{key}" is missing.')
        return self.record[key]

    def _type_error(self, key: str, expected: str) -> LevelError:
        return self.error(key, f'"{key}" must be {expected}, not {_kind(self.record[key])}.')

    def _list(self, key: str) -> list[object]:
        value = self.record.get(key)
        if value is None:
            return []
        if not isinstance(value, list):
            raise self._type_error(key, "a list")
        if len(value) > MOST_OF_A_KIND:
            message = f"There are {len(value)} {key}; at most {MOST_OF_A_KIND} are allowed."
            raise self.error(key, message)
        return value

    def _items(self, key: str, kind: str = "") -> list[tuple[str, Fields]]:
        """Return the items of a list, perhaps all of a kind, as fields with names of their own."""
        items = []
        for i, value in enumerate(self._list(key)):
            item = f"{key}[{i}]"
            if kind and _kind(value) != kind:
                raise self.error(item, f"This must be {kind}, not {_kind(value)}.")
            items.append((item, Fields({item: value}, self.file, self.path)))
        return items


def check_robot_names(top: Fields, names: tuple[str, ...]) -> None:
    if not names:
        raise top.error("robots", "The level has no robots.", "It needs at least one.")
    for i, name in enumerate(names):
        if name in names[:i]:
            hint = "A program tells robots apart by their names, so each needs its own."
            raise top.error(f"robots[{i}].name", f'Two robots are called "{name}".', hint)


def _show(key: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in key)[:LONGEST_NAME]


def _kind(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true or false"
    kinds = {int: "a number", float: "a number", str: "text", list: "a list", dict: "a record"}
    return kinds.get(type(value), "a date or time")
